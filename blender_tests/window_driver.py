# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs inside a Blender with a window: an artist's ways through the panel, with mouse and keyboard.

    blender --python window_driver.py -- WAY ZIP OUT

Writes a screenshot of every step and OUT/steps.json: what was seen, or what went wrong.
"""

import faulthandler
import subprocess
import sys
import time
import traceback
from pathlib import Path
from typing import Any

import bpy

sys.path.append(str(Path(__file__).parent))
from window_files import files
from window_further import further
from window_hour import hour
from window_mix import light_mix
from window_presets import presets
from window_scene import a_scene, effort, same, values
from window_screen import Screen
from window_steps import AFFECT, CHANGES, PROMPT, a_result, header, open_panel, prompted, running
from window_still import still
from window_tour import tour, tour_double
from window_without import without_engine
from window_words import words

WAY, ZIP, OUT = sys.argv[sys.argv.index("--") + 1 :][:3]
observed: dict[str, Any] = {}


def start(screen):
    """The extension is installed, and the panel is open."""
    with screen.over(screen.view):
        bpy.ops.extensions.package_install_files(filepath=ZIP, repo="user_default", enable_on_install=True)
        a_scene()
        bpy.ops.ed.undo_push(message="Scene")
    observed["schema_is_the_copy"] = not any(name.startswith("proxy_renderer") for name in sys.modules)
    yield from open_panel(screen)


def ways_out(screen):
    """The preferences; a prompt is typed; a vibe is stopped and given up, by button and by Esc."""
    from bl_ext.user_default.vibe_render.run.state import addon_state
    from bl_ext.user_default.vibe_render.scene import snapshot

    yield from preferences(screen)
    screen.shoot("panel")
    before = values()
    yield from screen.type_into("vibe.prompt", PROMPT, 117)
    yield from screen.wait(lambda: bpy.context.scene.vibe.prompt, 60, "the prompt arrives")
    yield 0.5
    observed["prompt"] = bpy.context.scene.vibe.prompt
    screen.shoot("prompt")

    def stop():
        yield from screen.click_on("vibe.stop", 508)

    def cancel():
        yield from screen.click_on("vibe.cancel", 534)

    def esc():
        screen.press("Escape")
        yield 0.0

    def esc_twice():
        screen.press("Escape", "Escape")
        yield 0.0

    for name, end in (("stop", stop), ("cancel", cancel), ("esc", esc), ("esc_twice", esc_twice)):
        yield from running(screen)
        yield from end()
        yield from screen.wait(lambda: not addon_state.running, 600, f"{name} ends it")
        yield from screen.away()
        screen.shoot(name)
        if name in ("stop", "esc"):
            observed[f"{name}_takes_the_best"] = snapshot.exists(bpy.context.scene) and not addon_state.failure
            yield from screen.undo()
            yield from screen.wait(lambda: not snapshot.exists(bpy.context.scene), 30, f"undo of {name}")
            yield 0.7
        observed[f"{name}_restores"] = values() == before and not snapshot.exists(bpy.context.scene)


def choosing(screen):
    """A result: undone, compared, dimmed, another variant, locks, saved as a preset, again, kept or reverted."""
    from bl_ext.user_default.vibe_render.run.state import addon_state
    from bl_ext.user_default.vibe_render.scene import snapshot

    before, scene = values(), bpy.context.scene
    yield from prompted(screen)
    yield from header(screen, AFFECT)
    yield from a_result(screen, variants=2)
    screen.shoot("result")
    observed["failure"] = str(addon_state.failure or "")
    after = values()
    observed["changed"] = [key for key in after if after[key] != before.get(key)]
    observed["listed"] = [change.name for change in scene.vibe.changes]
    yield from screen.undo()
    yield from screen.wait(lambda: not snapshot.exists(bpy.context.scene), 60, "undo")
    yield 0.7
    observed["undo_restores"] = values() == before
    screen.press("ctrl+shift+z")
    yield from screen.wait(lambda: snapshot.exists(bpy.context.scene), 60, "redo")
    yield 0.7
    observed["redo_restores"] = values() == after

    scene = bpy.context.scene
    yield from screen.click_on("show_original", 716, (0.2,))
    yield from screen.wait(lambda: scene.vibe.show_original, 60, "Before is pressed")
    observed["before_shows_before"] = same(values(), before, after)
    yield from screen.away()
    screen.shoot("before")
    yield from screen.click_on("show_original", 716, (0.7,))
    yield from screen.wait(lambda: not scene.vibe.show_original, 60, "After is pressed")
    observed["after_shows_after"] = same(values(), after, after)
    yield from screen.type_into("strength", "0.5", 733)
    yield from screen.wait(lambda: scene.vibe.strength == 0.5, 30, "half the strength")
    observed["strength_dims"] = not same(values(), after, after) and not same(values(), before, after)
    yield from screen.away()
    screen.shoot("strength")
    yield from screen.click_on("vibe.variant(number=1)", 886, (0.67,))
    yield from screen.wait(lambda: scene.vibe.variant == 1, 60, "the second variant")
    observed["variant_differs"] = not same(values(), after, after)
    yield from screen.away()
    screen.shoot("variant")
    yield from locks(screen)

    yield from screen.click_on("vibe.revert", 665, (0.7,))
    yield from screen.wait(lambda: not snapshot.exists(bpy.context.scene), 60, "revert")
    yield from screen.away()
    screen.shoot("reverted")
    observed["revert_restores"] = values() == before


def locks(screen):
    """The key light's power and the fog are locked; then the same words once more."""
    from bl_ext.user_default.vibe_render.run.state import addon_state

    settings, key = bpy.context.scene.vibe, "light/Key/power"
    yield from header(screen, CHANGES, "vibe.preset_save", 597, page=1)
    yield from screen.click_on(f'vibe.lock(key="{key}"', 512, (0.82, 0.84, 0.8), page=1)
    yield from screen.wait(lambda: key in settings.locks, 30, "a lock for one value")
    yield from screen.away()
    screen.shoot("one_lock")
    yield from screen.click_on("change_volume", 818, (0.72,), page=3)
    yield from screen.wait(lambda: not settings.change_volume, 30, "a lock for the fog")
    yield from screen.away()
    screen.shoot("group_lock")
    power, kept = values()["Key.energy"], locked_values(key)
    yield from screen.click_on("vibe.run(again=True)", 648, (0.2,), page=3)
    yield from screen.wait(lambda: addon_state.running, 60, "Retry starts")
    yield from screen.wait(lambda: not addon_state.running, 900, "Retry ends")
    yield from screen.away()
    screen.shoot("again")
    observed["locked_stays"] = values()["Key.energy"] == power
    observed["again"] = [change.name for change in bpy.context.scene.vibe.changes]
    now = locked_values(key)
    observed["locked_changed"] = [name for name in {**kept, **now} if now.get(name) != kept.get(name)]


def locked_values(key):
    """What is listed of the locked values: what they were and are, as text."""
    listed = bpy.context.scene.vibe.changes
    return {c.name: str(c.values()) for c in listed if c.name == key or c.name.startswith("volume/")}


def questions(screen):
    """The question about a shared material, answered both ways."""
    from bl_ext.user_default.vibe_render.run.state import addon_state
    from bl_ext.user_default.vibe_render.scene import snapshot

    floor, monkey = bpy.data.objects["Plane"], bpy.data.objects["Suzanne"]
    floor.data.materials[0] = monkey.data.materials[0]
    bpy.context.scene.vibe.prompt = PROMPT
    effort(1, 2)
    bpy.ops.ed.undo_push(message="Share")
    for answer in ("ALL", "SINGLE"):
        yield from screen.click_on("vibe.run", 312)
        yield from screen.wait(lambda: addon_state.session and addon_state.session.question, 120, "the question")
        yield from screen.away()
        screen.shoot(f"question_{answer.lower()}")
        observed["asked_about"] = list(addon_state.session.question)
        yield from screen.click_on(f"vibe.answer(shared='{answer}')", 254 if answer == "ALL" else 278)
        yield from screen.wait(lambda: not addon_state.running, 900, "the answered vibe ends")
        yield from screen.away()
        screen.shoot(f"answered_{answer.lower()}")
        one = bpy.data.objects["Plane"].data.materials[0] == bpy.data.objects["Suzanne"].material_slots[0].material
        observed[f"answer_{answer.lower()}"] = one == (answer == "ALL") and not addon_state.failure
        yield from screen.undo()
        yield from screen.wait(lambda: not snapshot.exists(bpy.context.scene), 60, "undo of the answered vibe")
        bpy.context.scene.vibe.shared = "ASK"
        yield 0.5


def ends(screen):
    """A second window, another file, and the end of Blender, while a vibe runs."""
    from bl_ext.user_default.vibe_render.run.state import addon_state

    yield from running(screen)
    yield from second_window(screen, addon_state)
    with screen.over(screen.view):
        bpy.ops.wm.read_homefile(use_factory_startup=True)
    yield 1.0
    yield from open_panel(screen)
    observed["load_ends_it"] = not addon_state.running and not addon_state.failure
    yield from screen.away()
    screen.shoot("another_file")
    with screen.over(screen.view):
        a_scene()
    yield 0.5
    yield from running(screen)
    observed["last_engine"] = addon_state._engine._process.pid
    screen.shoot("closed_while_it_runs")


def live(screen):
    """Live is switched on, words are typed; Enter searches, Esc gives that up, and Esc in the field takes a look away."""
    from bl_ext.user_default.vibe_render.run import preview
    from bl_ext.user_default.vibe_render.run.state import addon_state

    before = values()
    effort(20, 60, 256)
    yield from screen.click_on("vibe_live", 227, (0.85, 0.8, 0.9))
    observed["live_looks"] = []
    yield from screen.click_on("vibe.prompt", 117)
    for text in ("misty night", ", cool blue fog", ", glossy red monkey"):
        screen.type(text)
        typed, last = time.monotonic(), addon_state.live and addon_state.live.look
        yield from screen.wait(
            lambda old=last: addon_state.live and addon_state.live.look not in (None, old), 60, "a look"
        )
        observed["live_looks"].append(round(time.monotonic() - typed, 2))
        yield 0.5
        screen.shoot("live")
    observed["live_shows"] = preview.exists(bpy.context.scene) and values() != before
    screen.press("Return")
    yield from screen.wait(lambda: addon_state.running, 60, "Enter begins the search")
    observed["live_stays_on_enter"] = preview.exists(bpy.context.scene)
    yield from screen.wait(lambda: addon_state.session.asked, 300, "the engine is asked")
    screen.press("Escape", "Escape")
    yield from screen.wait(lambda: not addon_state.running, 600, "Esc ends it")
    observed["live_restores"] = values() == before and not preview.exists(bpy.context.scene)
    yield from screen.click_on("vibe.prompt", 117)
    screen.press("End")
    screen.type(", vignette")
    yield from screen.wait(lambda: preview.exists(bpy.context.scene), 300, "a look after the search")
    screen.press("Escape")
    yield from screen.wait(lambda: not preview.exists(bpy.context.scene), 60, "Esc takes the look away")
    yield 1.0
    observed["live_escape_restores"] = values() == before and not preview.exists(bpy.context.scene)
    screen.shoot("live_escaped")


def second_window(screen, addon_state):
    """Opens another window while a vibe runs, and closes it."""
    with screen.over(screen.view):
        bpy.ops.wm.window_new()
    yield 1.0
    other = next(w for w in bpy.context.window_manager.windows if w != screen.window)
    with bpy.context.temp_override(window=other):
        observed["second_window_grays_it_out"] = not bpy.ops.vibe.run.poll() and bpy.ops.vibe.stop.poll()
        screen.shoot("second_window")
        bpy.ops.wm.window_close()
    yield 1.0
    observed["closing_it_changes_nothing"] = addon_state.running and not addon_state.failure


def preferences(screen):
    """What the add-on's preferences look like, and whether they find and try the engine."""
    from bl_ext.user_default.vibe_render.ui.engine_state import engine_state

    kind, screen.area.type = screen.area.type, "PREFERENCES"
    bpy.context.preferences.active_section = "ADDONS"
    bpy.context.window_manager.addon_search = "Vibe"
    with bpy.context.temp_override(window=screen.window, area=screen.area):
        bpy.ops.preferences.addon_expand(module="bl_ext.user_default.vibe_render")
    yield from screen.wait(lambda: engine_state.python, 60, "the engine is found")
    screen.shoot("preferences_before")
    yield from screen.click_on("vibe.test_engine", 395, (0.7, 0.6, 0.8))
    yield from screen.wait(lambda: engine_state.outcome, 600, "the engine answers")
    yield from screen.away()
    observed["engine"] = engine_state.outcome
    screen.shoot("preferences")
    screen.area.type = kind
    yield 0.5


WAYS = {
    way.__name__: way
    for way in (
        ways_out,
        live,
        choosing,
        presets,
        questions,
        ends,
        without_engine,
        files,
        still,
        words,
        further,
        light_mix,
        tour,
        tour_double,
        hour,
    )
}


def walk():
    """One way, step by step."""
    yield 0.5
    screen = Screen(Path(OUT), observed)
    yield from start(screen)
    yield from WAYS[WAY](screen)


def main():
    """Walks on Blender's timer, so that Blender works in between."""
    faulthandler.enable()  # where Python was if Blender crashes
    bpy.context.preferences.view.show_splash = False
    # Otherwise each change draws the viewport eight times, without a graphics card.
    bpy.context.preferences.system.viewport_aa = "OFF"
    steps = walk()

    def tick():
        try:
            return next(steps)
        except StopIteration:
            observed["finished"] = True
        except Exception:
            observed["error"] = traceback.format_exc()
            subprocess.run(["import", "-window", "root", Path(OUT) / "99_error.png"], check=False)
        Screen(Path(OUT), observed).note()
        bpy.ops.wm.quit_blender()
        return None

    bpy.app.timers.register(tick, first_interval=1.0, persistent=True)


if __name__ == "__main__":
    main()
