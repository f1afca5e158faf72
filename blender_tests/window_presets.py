# SPDX-License-Identifier: GPL-3.0-or-later
"""An artist's way with presets: saved, found, put on another scene. See window_driver.py."""

import bpy
from window_scene import another_scene, values
from window_steps import PRESETS, a_result, confirm, header


def presets(screen):
    """A look is saved with its picture, found in the grid, put on another scene; then it is kept."""
    from bl_ext.user_default.vibe_render.looks import library
    from bl_ext.user_default.vibe_render.scene import snapshot

    yield from a_result(screen)
    yield from screen.scroll(5, 8)
    yield from screen.away()
    screen.shoot("what_changed")
    yield from screen.click_on("vibe.preset_save", 801, (0.7,), page=1)
    yield 0.5
    screen.shoot("save")
    held = bpy.context.window_manager.vibe_presets
    yield from confirm(screen, lambda: held.chosen, "the preset is saved")
    yield from screen.away()
    screen.shoot("saved")
    screen.observed["saved"] = library.preset_at(held.chosen).name
    yield from screen.click_on("vibe.keep", 665, (0.2,))
    yield from screen.wait(lambda: not snapshot.exists(bpy.context.scene), 60, "it is kept")
    yield from screen.away()
    screen.shoot("kept")
    screen.observed["kept"] = values()["Monkey.Base Color"] != repr([0.75, 0.6, 0.45, 1.0])

    with screen.over(screen.view):
        another_scene()
        bpy.ops.ed.undo_push(message="Another scene")
    screen.area.spaces.active.region_3d.view_perspective = "CAMERA"
    before = values()
    yield 0.5
    yield from header(screen, PRESETS)
    top = yield from screen.top_of("vibe.run", 345)
    yield from screen.click_at(top + 119, 0.45)  # Browse: a popover's button says nothing of itself
    yield 1.5
    screen.shoot("grid")
    yield from search(screen, held, top)
    yield from screen.click_on("vibe.preset_apply", 733)
    yield from screen.wait(lambda: snapshot.exists(bpy.context.scene), 120, "the preset is applied")
    yield from screen.away()
    screen.shoot("applied")
    screen.observed["applied"] = [change.name for change in bpy.context.scene.vibe.changes]
    screen.observed["rest"] = held.rest.splitlines()
    yield from screen.click_on("vibe.revert", 377, (0.7,), page=1)
    yield from screen.wait(lambda: not snapshot.exists(bpy.context.scene), 60, "revert")
    screen.observed["preset_revert_restores"] = values() == before


def search(screen, held, top):
    """Words are typed into the grid's search field, and pictures' buttons are clicked; it is below Browse."""
    from bl_ext.user_default.vibe_render.looks import library

    yield from screen.click_at(top + 159, 0.45)
    screen.type("misty")
    screen.press("Return")
    yield 1.0
    own = held.chosen
    for number, place in enumerate((-0.21, -0.62)):  # the second and the first of those that are left
        yield from screen.click_at(top + 289, place)
        yield from screen.wait(lambda n=number: (held.chosen == own) == bool(n), 30, "a picture is chosen")
        yield 0.7
        screen.shoot(f"search_{number + 1}")
    screen.observed["searched"] = held.search
    screen.observed["chosen"] = library.preset_at(held.chosen).name
