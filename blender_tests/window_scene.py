# SPDX-License-Identifier: GPL-3.0-or-later
"""The scenes of the window test, and what is looked at in them. See window_driver.py."""

import re

import bpy


def a_scene():
    """A monkey on a floor, lit by two lamps."""
    bpy.ops.object.select_all(action="SELECT")
    bpy.ops.object.delete()
    bpy.ops.mesh.primitive_plane_add(size=12)
    bpy.ops.mesh.primitive_monkey_add(size=2, location=(0, 0, 1.0))
    monkey = bpy.context.object
    monkey.modifiers.new("Subdivision", "SUBSURF").levels = 1
    bpy.ops.object.shade_smooth()
    _paint(bpy.data.objects["Plane"], "Floor", (0.35, 0.33, 0.3, 1))
    _paint(monkey, "Monkey", (0.75, 0.6, 0.45, 1))
    for name, place, power in (("Key", (3, -3, 4), 400), ("Rim", (-3, 3, 3), 200)):
        bpy.ops.object.light_add(type="AREA", location=place)
        bpy.context.object.name, bpy.context.object.data.energy = name, power
        bpy.context.object.rotation_euler = bpy.context.object.location.to_track_quat("Z", "Y").to_euler()
    _camera()


def another_scene():
    """Two cups on a table under one lamp, in a scene of its own."""
    bpy.ops.scene.new(type="EMPTY")
    bpy.context.scene.world = bpy.data.worlds.new("Room")
    bpy.ops.mesh.primitive_cylinder_add(vertices=64, radius=4, depth=0.2, location=(0, 0, -0.1))
    _paint(bpy.context.object, "Table", (0.3, 0.2, 0.12, 1))
    for name, x, color in (("Cup", -0.8, (0.6, 0.6, 0.55, 1)), ("Jug", 0.9, (0.2, 0.35, 0.5, 1))):
        bpy.ops.mesh.primitive_cone_add(radius1=0.5, radius2=0.8, depth=1.6, location=(x, 0, 0.8))
        bpy.ops.object.shade_smooth_by_angle()
        _paint(bpy.context.object, name, color)
    bpy.ops.object.light_add(type="POINT", location=(2, -3, 4))
    bpy.context.object.data.energy = 600
    _camera()


def _paint(thing, name, color):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    material.diffuse_color = color
    material.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = color
    thing.data.materials.append(material)


def _camera():
    bpy.ops.object.camera_add(location=(0, -6.5, 2.2), rotation=(1.4, 0, 0))
    bpy.context.scene.camera = bpy.context.object


def values():
    """What a vibe may change, as far as scenes like these have it."""
    scene = bpy.context.scene
    dump = {f"{o.name}.{p}": repr(getattr(o.data, p)) for o in scene.objects if o.type == "LIGHT"
            for p in ("energy", "color")}  # fmt: skip
    for thing in (o for o in scene.objects if o.type == "MESH" and o.material_slots):
        material = thing.material_slots[0].material
        shader = material.node_tree.nodes.get("Principled BSDF")
        inputs = shader.inputs if shader else ()  # fog has none
        dump |= {f"{material.name}.{i.name}": _plain(i) for i in inputs if hasattr(i, "default_value")}
    dump |= {f"{o.name}.matrix": str(o.matrix_world) for o in scene.objects if o.type != "MESH"}
    return dump | {"objects": str(len(scene.objects)), "exposure": repr(scene.view_settings.exposure)}


def _plain(socket):
    value = socket.default_value
    return repr(list(value)) if hasattr(value, "__len__") and not isinstance(value, str) else repr(value)


def effort(rounds, steps, size=192):
    """How long the next vibe takes."""
    settings = bpy.context.scene.vibe
    settings.effort, settings.rounds, settings.steps, settings.size = "CUSTOM", rounds, steps, size


def same(now, then, after):
    """Whether all that a vibe changed shows as then; nodes of its own may be there, and turned lights are rounded."""
    return all(_near(now[key], then[key]) for key in then if key != "objects" and key in after)


def _near(a, b):
    ours, theirs = (list(map(float, re.findall(r"-?\d+(?:\.\d+)?(?:e-?\d+)?", text))) for text in (a, b))
    return len(ours) == len(theirs) and all(abs(x - y) < 2e-3 for x, y in zip(ours, theirs, strict=True))
