# SPDX-License-Identifier: GPL-3.0-or-later
"""What several ways through the panel begin with. See window_driver.py."""

import os
import time

import bpy
from window_scene import effort

LIGHT_MIX, PRESETS, AFFECT, ADVANCED, REFERENCE_IMAGE = 60, 88, 116, 144, -65
"""Headers of closed panels, pixels below the upper edge of Vibe It."""
CHANGES = -16
"""The header of the changes, below that of Save Preset."""
RIGHT = (0.94, 0.9, 0.86, 0.82, 0.78, 0.755, 0.73, 0.7)
"""Where small buttons are, across the sidebar."""
KEPT = "VIBE_WINDOW_OUT" in os.environ
"""True if screenshots are kept, for the documents: then the viewport renders, and a search has default settings."""
PROMPT = "misty night, cool blue fog, glossy red monkey, vignette"


def open_panel(screen):
    """The sidebar with our tab, beside what the camera sees."""
    screen.look()
    space = screen.area.spaces.active
    space.shading.color_type, space.region_3d.view_perspective = "MATERIAL", "CAMERA"
    space.show_region_ui = True
    yield 0.5
    screen.sidebar.active_panel_category = "Vibe"
    screen.sidebar.tag_redraw()
    yield 0.5


def prompted(screen):
    """The prompt is there, and its words are marked: without it a line is below the button, and the words push panels down."""
    from bl_ext.user_default.vibe_render.run.state import addon_state

    bpy.context.scene.vibe.prompt = PROMPT
    yield from screen.wait(lambda: addon_state.readings.newest.prompt == PROMPT, 120, "words are read")
    yield 0.5


def running(screen):
    """A long vibe is started, and its first picture awaited."""
    from bl_ext.user_default.vibe_render.run.state import addon_state

    bpy.context.scene.vibe.prompt = PROMPT
    effort(20, 60, 160)
    bpy.context.scene.vibe.variants = 2  # one look alone is found too soon to be stopped
    yield from screen.click_on("vibe.run", 342)
    yield from screen.wait(lambda: addon_state.running, 60, "Vibe It starts")
    yield from first_look(screen)
    yield from screen.wait(lambda: addon_state.session.progress, 900, "progress is seen")
    yield 1.0
    screen.shoot("running")


def first_look(screen):
    """The first look is awaited; how long after the click its values and its picture came is noted."""
    from bl_ext.user_default.vibe_render.run import preview
    from bl_ext.user_default.vibe_render.run.state import addon_state

    session, began = addon_state.session, time.monotonic()
    yield from screen.wait(lambda: preview.exists(bpy.context.scene), 300, "the first look is in the scene")
    seen = time.monotonic()
    yield from screen.wait(lambda: session.words, 60, "its picture is in the panel")
    drawn = time.monotonic()
    screen.observed.setdefault("first_looks", []).append([round(seen - began, 2), round(drawn - began, 2)])
    screen.shoot("first_look")


def a_result(screen, variants=1):
    """A short vibe is run to its end."""
    effort(1, 4)
    bpy.context.scene.vibe.variants, bpy.context.scene.vibe.prompt = variants, PROMPT
    bpy.ops.ed.undo_push(message="Words")
    yield from screen.click_on("vibe.run", 342)
    yield from ended(screen, "the vibe")


def ended(screen, what):
    """A search, or a check, is awaited to its end."""
    from bl_ext.user_default.vibe_render.run.state import addon_state

    yield from screen.wait(lambda: addon_state.running, 60, f"{what} starts")
    yield from screen.wait(lambda: not addon_state.running, 900, f"{what} ends")
    yield from screen.away()


def say(screen, sentence, near):
    """A further sentence is typed and searched for; its field is about so many pixels below the window's top."""
    yield from screen.type_into("vibe.further", sentence, near, page=1)
    yield from screen.wait(lambda: bpy.context.scene.vibe.further == sentence, 60, "the sentence arrives")
    bpy.ops.ed.undo_push(message="Sentence")
    yield from screen.click_on("ops.vibe.further", near, RIGHT, page=1)
    yield from ended(screen, f"the search for {sentence}")


def header(screen, below, above="vibe.run", near=345, page=0):
    """Opens the panel whose header is so many pixels below a button's upper edge, which is returned; headers say nothing of themselves."""
    top = yield from screen.top_of(above, near, page)
    yield from screen.open(top + below * screen.scale, 0.4)
    return top


def confirm(screen, condition, what):
    """Presses Return until a dialog is done: once for the text, once for the dialog."""
    for _ in range(4):
        screen.press("Return")
        for _ in range(15):
            yield 0.1
            if condition():
                return
    raise TimeoutError(what)
