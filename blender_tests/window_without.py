# SPDX-License-Identifier: GPL-3.0-or-later
"""An artist's way without an engine: what the panel says about it, and all that works without. See window_driver.py."""

import shutil

import bpy
from window_scene import same, values
from window_steps import KEPT, header

EARLIER = ("golden hour, soft haze", "noir, one hard light")
KEY = "light/Key/power"


def without_engine(screen):
    """The panel, earlier prompts, single locks, a preset compared, dimmed and reverted, the preferences."""
    from bl_ext.user_default.vibe_render.scene import snapshot
    from bl_ext.user_default.vibe_render.ui.engine_state import engine_state

    yield from screen.wait(lambda: engine_state.problem, 60, "no engine is found")
    yield from screen.away()
    screen.shoot("no_engine")
    screen.observed["vibe_it_waits"] = not bpy.ops.vibe.run.poll()
    yield from earlier_prompts(screen)
    yield from single_values(screen)
    before = values()
    yield from a_preset(screen)
    yield from compared(screen, before, values())
    yield from screen.click_on("vibe.revert", 495, (0.7,))
    yield from screen.wait(lambda: not snapshot.exists(bpy.context.scene), 60, "revert")
    screen.observed["revert_restores"] = values() == before
    yield from preferences(screen, engine_state)


def earlier_prompts(screen):
    """One is chosen from the menu, then all are forgotten."""
    from bl_ext.user_default.vibe_render.ui import words

    bpy.ops.vibe.clear_history()
    for prompt in reversed(EARLIER):
        words.remember(prompt)
    yield from screen.find("vibe.prompt", 153)
    row = screen.observed["found"]["vibe.prompt"][1]
    yield from screen.open(row, 0.83)
    screen.shoot("earlier_prompts")
    yield from screen.click_at(row + 47, 0.97)
    yield from screen.wait(lambda: bpy.context.scene.vibe.prompt, 30, "an earlier prompt")
    screen.observed["recalled"] = bpy.context.scene.vibe.prompt
    yield from screen.away()
    screen.shoot("recalled")
    yield from screen.open(row, 0.83)
    yield from screen.click_at(row + 75, 0.97)
    yield from screen.wait(lambda: not words.history(), 30, "they are forgotten")


def single_values(screen):
    """The list is opened, a value locked in it, and all set free."""
    locks = bpy.context.scene.vibe.locks
    yield from header(screen, 107, "vibe.look_for_engine")  # Affect
    yield from screen.find("offset_keys", 648)  # the last row above the list
    header_of_list = screen.observed["found"]["offset_keys"][1] + 32
    yield from screen.open(header_of_list, 0.4)
    yield from screen.wait(lambda: bpy.context.window_manager.vibe_values.rows, 30, "the list")
    yield from screen.away()
    screen.shoot("single_values")
    yield from screen.click_on(f'vibe.lock(key="{KEY}"', 801, (0.73,))
    yield from screen.wait(lambda: KEY in locks, 30, "a lock in the list")
    yield from screen.away()
    screen.shoot("single_lock")
    yield from screen.click_on("vibe.unlock_all", 852)
    yield from screen.wait(lambda: not locks, 30, "no lock")
    screen.observed["unlocked"] = True
    yield from screen.click_at(header_of_list, 0.4)


def a_preset(screen):
    """One of the presets is applied with the button next to its name."""
    from bl_ext.user_default.vibe_render.looks import library
    from bl_ext.user_default.vibe_render.scene import snapshot

    shutil.rmtree(library.preset_folder(), ignore_errors=True)  # so that ours are at the same places every time
    top = yield from header(screen, 79, "vibe.look_for_engine", 375)
    yield from screen.click_at(top + 110, 0.45)  # Browse; nothing tells that its grid is there
    yield 1.5
    screen.shoot("grid")
    # Moonlight: the grid opens above, and is wider than the sidebar.
    yield from screen.click_at(top - 85, 1.73)
    yield from screen.wait(lambda: snapshot.exists(bpy.context.scene), 60, "the preset is applied")
    screen.observed["preset"] = bpy.context.scene.vibe.vibed_preset
    screen.press("Escape")
    yield 1.0
    yield from screen.away()
    screen.shoot("applied")


def compared(screen, before, after):
    """Strength is dragged, and the scene follows; Before and After; the viewport is set to Rendered."""
    settings = bpy.context.scene.vibe
    yield from screen.find("strength", 546)
    place, row, _ = screen.observed["found"]["strength"]
    x, powers = screen.sidebar.x + screen.sidebar.width * place, []
    for wait in screen.drag((x, row), (x - 100, row), "strength_dragged"):
        powers.append(bpy.data.objects["Key"].data.energy)
        yield wait
    screen.observed["strength"], screen.observed["powers_on_the_way"] = settings.strength, sorted(set(powers))
    dimmed = values()
    screen.observed["dimmed"] = not same(dimmed, before, after) and not same(dimmed, after, after)
    yield from screen.click_on("show_original", row - 20, (0.2,))
    yield from screen.wait(lambda: settings.show_original, 30, "Before")
    screen.observed["before_shows_before"] = same(values(), before, after)
    yield from screen.click_on("show_original", row - 20, (0.7,))
    yield from screen.wait(lambda: not settings.show_original, 30, "After")
    yield from screen.click_on("type", row + 20)
    shading = screen.area.spaces.active.shading
    yield from screen.wait(lambda: shading.type == "RENDERED", 30, "it is seen rendered")
    yield from screen.away()
    yield 8.0 if KEPT else 0.1  # EEVEE's first picture
    screen.shoot("rendered")
    shading.type = "SOLID"
    screen.observed["rendered"] = True


def preferences(screen, engine_state):
    """The panel's button opens them; the test says what is missing, and nothing is downloaded offline."""
    yield from screen.click_on("preferences.addon_show", 376, (0.7,))
    windows = bpy.context.window_manager.windows
    yield from screen.wait(lambda: len(windows) == 2, 30, "the preferences")
    yield 1.0
    screen.look("PREFERENCES")
    screen.shoot("preferences")
    yield from screen.click_on("vibe.test_engine", 361, (0.7, 0.6, 0.8))
    yield from screen.wait(lambda: engine_state.outcome, 60, "the test's answer")
    yield 0.7
    screen.shoot("tested")
    screen.observed["tested"] = engine_state.outcome
    yield from screen.click_on("vibe.setup_engine", 361, (0.5, 0.45))
    yield 1.0
    screen.observed["offline_sets_up_nothing"] = not engine_state.setup
    screen.shoot("set_up_offline")
    bpy.context.preferences.system.use_online_access = True
    yield from screen.click_on("vibe.setup_engine", 361, (0.5, 0.45))
    yield 1.0
    screen.shoot("set_up_asks_first")
    screen.observed["asks_before_it_downloads"] = not engine_state.setup
    screen.press("Escape")
    yield 1.0
    screen.observed["esc_sets_up_nothing"] = not engine_state.setup
