# SPDX-License-Identifier: GPL-3.0-or-later
"""A way through Light Mix in a Blender window. See window_driver.py."""

import bpy
from window_scene import values
from window_steps import LIGHT_MIX, header, prompted


def light_mix(screen):
    """The lights are rendered apart; a slider is dragged, and the image follows; the mix is applied, undone, and written as nodes."""
    from bl_ext.user_default.vibe_render.run.state import addon_state
    from bl_ext.user_default.vibe_render.scene import snapshot

    bpy.context.scene.render.engine = "CYCLES"
    bpy.ops.ed.undo_push(message="Cycles")
    before = values()
    yield from prompted(screen)
    yield from header(screen, LIGHT_MIX)
    x, row = yield from first_slider(screen, 320)
    images = set()
    for wait in screen.drag((x, row), (x + 60, row), "slider_dragged"):
        images.add(addon_state.mix.picture.stat().st_mtime_ns)
        yield wait
    screen.observed["images_on_the_way"] = len(images)
    scene = bpy.context.scene
    screen.observed["factor"] = {c.name: c.factor for c in scene.vibe.mix if c.factor != 1.0}
    screen.observed["scene_stays"] = values() == before and not snapshot.exists(scene)
    (name,) = screen.observed["factor"]
    scene.vibe.mix[name].color = (1.0, 0.4, 0.15)
    bpy.ops.ed.undo_push(message="Color")
    yield 1.0
    yield from screen.away()
    screen.shoot("color")
    yield from screen.click_on("vibe.mix_apply", 620, (0.2,))
    yield from screen.wait(lambda: snapshot.exists(bpy.context.scene), 60, "Apply")
    screen.observed["changed"] = [key for key, value in values().items() if value != before[key]]
    yield from screen.away()
    screen.shoot("applied")
    yield from screen.undo()
    yield from screen.wait(lambda: not snapshot.exists(bpy.context.scene), 60, "undo")
    yield 0.7
    scene = bpy.context.scene
    screen.observed["undo_restores"] = values() == before and scene.vibe.mix[name].factor != 1.0
    screen.shoot("undone")
    yield from screen.click_on("vibe.mix_nodes", 620, (0.6,))
    yield from screen.wait(lambda: snapshot.exists(bpy.context.scene), 60, "Compositor")
    yield from screen.away()
    screen.shoot("nodes")
    screen.observed["light_groups"] = [g.name for g in bpy.context.view_layer.lightgroups]
    with screen.over(screen.view):
        bpy.ops.vibe.revert()
    screen.observed["revert_restores"] = values() == before and not bpy.context.view_layer.lightgroups


def first_slider(screen, near):
    """The lights are rendered apart by a button about so many pixels below the window's top; returns the first slider's place."""
    from bl_ext.user_default.vibe_render.run.state import addon_state

    yield from screen.click_on("vibe.mix_render", near)
    yield from screen.wait(lambda: addon_state.mix, 600, "the lights are rendered")
    yield from screen.away()
    screen.shoot("mix")
    yield from screen.find("factor", near + 200, (0.6,))
    place, row, _ = screen.observed["found"]["factor"]
    return screen.sidebar.x + screen.sidebar.width * place, row
