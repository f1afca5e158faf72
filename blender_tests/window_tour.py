# SPDX-License-Identifier: GPL-3.0-or-later
"""A first look in an example scene, for the documents' screenshots. See window_driver.py."""

import sys
import time
from pathlib import Path

import bpy
from window_steps import ADVANCED, AFFECT, CHANGES, KEPT, PRESETS, REFERENCE_IMAGE, header, open_panel

PROMPT = "cinematic teal and orange, dramatic light from the left, dark background"
CLOSED = {"advanced": ADVANCED, "affect": AFFECT, "presets": PRESETS, "reference_image": REFERENCE_IMAGE}
EXAMPLES = Path(__file__).resolve().parents[1] / "examples"


def tour(screen, effort="QUICK"):
    """Words are typed and marked, searched for, and their look kept; then the closed panels are opened."""
    from bl_ext.user_default.vibe_render.run import preview
    from bl_ext.user_default.vibe_render.run.notes import words_of
    from bl_ext.user_default.vibe_render.run.state import addon_state
    from bl_ext.user_default.vibe_render.scene import snapshot

    with screen.over(screen.view):
        bust()
    yield 1.0
    yield from open_panel(screen)
    bpy.context.scene.vibe.effort = effort
    with screen.over(screen.view):
        bpy.ops.ed.undo_push(message="Bust")
    yield from screen.wait(lambda: addon_state.engine_runs, 120, "the engine starts with the panel")
    yield from screen.away()
    screen.shoot("open")
    yield from screen.type_into("vibe.prompt", PROMPT, 130)
    yield from screen.wait(lambda: addon_state.readings.newest.prompt == PROMPT, 300, "words are read")
    yield from screen.away()
    yield 1.0
    screen.shoot("marks")
    shading = screen.area.spaces.active.shading
    shading.type = "RENDERED" if KEPT else "SOLID"
    yield from screen.click_on("vibe.run", 295)
    yield from screen.away()
    yield from screen.wait(lambda: preview.exists(bpy.context.scene), 300, "the first look")
    yield from screen.wait(lambda: addon_state.session.progress, 900, "progress is seen")
    yield 1.0
    screen.shoot("running")
    yield from searched(screen, addon_state)
    yield 15.0 if KEPT else 1.0
    screen.shoot("result")
    verdicts = addon_state.session.report["verdicts"]
    screen.observed["visible"] = words_of(verdicts, "visible")
    screen.observed["missed"] = words_of(verdicts, "missed")
    shading.type = "SOLID"
    yield from screen.find("vibe.keep", 630)
    screen.observed["keep"] = screen.observed["found"]["vibe.keep"]
    yield from changes(screen)
    yield from screen.click_on("vibe.keep", 630)
    yield from screen.wait(lambda: not snapshot.exists(bpy.context.scene), 60, "it is kept")
    yield from screen.away()
    screen.shoot("kept")
    yield from opened(screen)


def searched(screen, addon_state):
    """Waits for the end of a search, with a screenshot every four seconds for an animation."""
    shot = 0.0

    def ended():
        nonlocal shot
        if addon_state.running and time.monotonic() > shot + 4.0:
            screen.shoot("search")
            shot = time.monotonic()
        return not addon_state.running

    yield from screen.wait(ended, 1800, "the search ends")


def tour_double(screen):
    """The same at twice the size of everything; at default settings where its images are kept, for the documents."""
    bpy.context.preferences.view.ui_scale = 2.0
    yield 1.0
    yield from tour(screen, "STANDARD" if KEPT else "QUICK")


def bust():
    """The example scene of a bust, in this window."""
    sys.path.append(str(EXAMPLES))
    import building
    import bust as example

    building.empty()
    example.build()


def changes(screen):
    """The list of changes."""
    yield from header(screen, CHANGES, "vibe.preset_save", 635, page=1)
    yield from screen.scroll(5, 30)
    yield from screen.away()
    screen.shoot("changes")


def opened(screen):
    """The closed panels, the lowest first, as it moves no other."""
    for name, below in CLOSED.items():
        yield from header(screen, below)
        yield from screen.away()
        screen.shoot(name)
