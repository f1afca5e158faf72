# SPDX-License-Identifier: GPL-3.0-or-later
"""Properties of lights and world that hide, replace or multiply light: each builder adds one to the plain scene."""

from __future__ import annotations

import math

import bpy
import numpy as np
from bpy.types import Object, Scene
from vibe_render.core import compat, rendered

from .plain import AddProperty, background, cube, emissive, instanced, lamp


def portal(scene: Scene, subject: Object) -> None:
    """An area light that gives no light."""
    lamp(scene, "AREA").data.cycles.is_portal = True


def instanced_light(scene: Scene, subject: Object) -> None:
    """A light that a collection instance shows."""
    instanced(scene, lamp(scene, "POINT")).location.x = 0.5


def light_hidden_from_rays(scene: Scene, subject: Object) -> None:
    """A light without reflections."""
    lamp(scene).visible_glossy = False


def glowing_instances(scene: Scene, subject: Object) -> None:
    """Bulbs that geometry nodes place are all the light there is."""
    bpy.data.objects.remove(scene.objects["Sun"])
    background(scene.world).inputs["Strength"].default_value = 0.05
    glow = emissive("Bulb", (1.0, 0.6, 0.2), 60.0)
    group = bpy.data.node_groups.new("Garland", "GeometryNodeTree")
    group.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    kinds = ("MeshGrid", "MeshIcoSphere", "SetMaterial", "InstanceOnPoints")
    grid, bulb, paint, points = (group.nodes.new(f"GeometryNode{kind}") for kind in kinds)
    grid.inputs["Size X"].default_value = grid.inputs["Size Y"].default_value = 3.0
    grid.inputs["Vertices X"].default_value = grid.inputs["Vertices Y"].default_value = 4
    bulb.inputs["Radius"].default_value = 0.08
    paint.inputs["Material"].default_value = glow
    group.links.new(bulb.outputs["Mesh"], paint.inputs["Geometry"])
    group.links.new(grid.outputs["Mesh"], points.inputs["Points"])
    group.links.new(paint.outputs["Geometry"], points.inputs["Instance"])
    group.links.new(points.outputs["Instances"], group.nodes.new("NodeGroupOutput").inputs[0])
    cube(scene, "Garland", (0.0, 0.0, 2.5)).modifiers.new("Garland", "NODES").node_group = group


def linked_light(scene: Scene, subject: Object) -> None:
    """A light of the subject alone."""
    _linked(lamp(scene), "receiver_collection", subject)


def linked_shadow(scene: Scene, subject: Object) -> None:
    """A light whose shadows come from the floor alone."""
    _linked(lamp(scene), "blocker_collection", scene.objects["Floor"])


def linked_glow(scene: Scene, subject: Object) -> None:
    """A glowing panel that lights the subject alone."""
    _linked(_panel(scene), "receiver_collection", subject)


def _linked(light: Object, name: str, thing: Object) -> None:
    linked = bpy.data.collections.new("Linked")
    linked.objects.link(thing)
    setattr(light.light_linking, name, linked)


def _panel(scene: Scene) -> Object:
    """A glowing panel above the left side."""
    thing = cube(scene, "Panel", (-2.2, 0.6, 2.2), 0.8)
    emissive("Glow", (0.3, 1.0, 0.5), 12.0, thing)
    return thing


def glowing_panel(scene: Scene, subject: Object) -> None:
    """A glowing panel."""
    _panel(scene)


def hidden_panel(scene: Scene, subject: Object) -> None:
    """A glowing panel that the camera does not see."""
    thing = _panel(scene)
    thing.location = (-0.9, -1.2, 1.6)
    thing.visible_camera = False


def dark_panel(scene: Scene, subject: Object) -> None:
    """A glowing panel that lights no matte surface."""
    _panel(scene).visible_diffuse = False


def light_nodes(scene: Scene, subject: Object) -> None:
    """A light whose nodes change color and strength."""
    data = lamp(scene).data
    tree = data.node_tree
    if tree is None:
        data.use_nodes = True
        tree = data.node_tree
    node = next(n for n in tree.nodes if n.type == "EMISSION")
    node.inputs["Color"].default_value, node.inputs["Strength"].default_value = (1.0, 0.3, 0.1, 1.0), 0.5


def light_units(scene: Scene, subject: Object) -> None:
    """A light with exposure, temperature and no normalization."""
    data = lamp(scene, "AREA").data
    compat.assign(data, exposure=-1.0, use_temperature=True, temperature=3000.0, normalize=False, size=0.5)
    data.energy = 300.0


def shadowless_light(scene: Scene, subject: Object) -> None:
    """A light without shadows."""
    lamp(scene).data.use_shadow = False


def light_groups(scene: Scene, subject: Object) -> None:
    """The artist's light groups."""
    groups = rendered.layer(scene).lightgroups
    groups.add(name="key")
    groups.add(name="sky")
    scene.objects["Sun"].lightgroup, scene.world.lightgroup = "key", "sky"


def light_without_diffuse(scene: Scene, subject: Object) -> None:
    """A light that matte surfaces do not show."""
    lamp(scene).visible_diffuse = False


def many_instanced_lights(scene: Scene, subject: Object) -> None:
    """More instances of a light than are predicted."""
    thing = lamp(scene, "POINT")
    thing.data.energy = 20.0
    first = instanced(scene, thing)
    for number in range(29):
        more = first.copy()
        more.location.x = 0.2 * (number + 1)
        scene.collection.objects.link(more)


def world_override(scene: Scene, subject: Object) -> None:
    """A view layer with a world of its own."""
    other = bpy.data.worlds.new("Other")
    background(other).inputs["Color"].default_value = (0.6, 0.3, 0.1, 1.0)
    rendered.layer(scene).world_override = other


def no_world(scene: Scene, subject: Object) -> None:
    """No world at all."""
    scene.world = None


def no_sky(scene: Scene, subject: Object) -> None:
    """A view layer without its environment."""
    rendered.layer(scene).use_sky = False


def sky_texture(scene: Scene, subject: Object) -> None:
    """A Sky texture."""
    tree = compat.enable_nodes(scene.world)
    sky = tree.nodes.new("ShaderNodeTexSky")
    sky.sun_elevation, sky.sun_rotation, sky.sun_disc = 0.5, 2.0, False
    back = background(scene.world)
    back.inputs["Strength"].default_value = 0.2
    tree.links.new(sky.outputs["Color"], back.inputs["Color"])


def _picture(name: str, color: tuple[float, float, float]) -> bpy.types.Image:
    """A small environment: a colored gradient with a bright window."""
    height, width = 16, 32
    sky = np.ones((height, width, 4), np.float32)
    sky[..., :3] = np.linspace(0.1, 0.9, height, dtype=np.float32)[:, None, None] * np.array(color)
    sky[8:12, 4:10, :3] = (6.0, 2.0, 0.5)
    image = bpy.data.images.new(name, width, height, float_buffer=True)
    image.pixels.foreach_set(sky.ravel())
    image.pack()
    return image


def mixed_environments(scene: Scene, subject: Object) -> None:
    """Two environments, mixed."""
    tree = compat.enable_nodes(scene.world)
    mix = tree.nodes.new("ShaderNodeMixShader")
    mix.inputs[0].default_value = 0.3
    for number, color in enumerate([(0.4, 0.6, 1.0), (1.0, 0.5, 0.3)], start=1):
        texture, back = tree.nodes.new("ShaderNodeTexEnvironment"), tree.nodes.new("ShaderNodeBackground")
        texture.image = _picture(f"sky {number}", color)
        tree.links.new(texture.outputs["Color"], back.inputs["Color"])
        tree.links.new(back.outputs[0], mix.inputs[number])
    output = next(n for n in tree.nodes if n.type == "OUTPUT_WORLD")
    tree.links.new(mix.outputs[0], output.inputs["Surface"])


def backdrop_apart(scene: Scene, subject: Object) -> None:
    """A world that the camera sees in another color than it lights with."""
    tree = compat.enable_nodes(scene.world)
    rays, mix = tree.nodes.new("ShaderNodeLightPath"), tree.nodes.new("ShaderNodeMixShader")
    seen = tree.nodes.new("ShaderNodeBackground")
    seen.inputs["Color"].default_value = (0.8, 0.1, 0.5, 1.0)
    tree.links.new(rays.outputs["Is Camera Ray"], mix.inputs[0])
    tree.links.new(background(scene.world).outputs[0], mix.inputs[1])
    tree.links.new(seen.outputs[0], mix.inputs[2])
    output = next(n for n in tree.nodes if n.type == "OUTPUT_WORLD")
    tree.links.new(mix.outputs[0], output.inputs["Surface"])


def mirror_ball(scene: Scene, subject: Object) -> None:
    """An environment that was photographed in a ball."""
    tree = compat.enable_nodes(scene.world)
    texture = tree.nodes.new("ShaderNodeTexEnvironment")
    texture.image, texture.projection = _picture("ball", (0.7, 0.85, 1.0)), "MIRROR_BALL"
    tree.links.new(texture.outputs["Color"], background(scene.world).inputs["Color"])


def world_hidden_from_rays(scene: Scene, subject: Object) -> None:
    """A world that lights no matte surface."""
    scene.world.cycles_visibility.diffuse = False


def world_in_a_group(scene: Scene, subject: Object) -> None:
    """A world as asset add-ons build it: picture, mapping and Background in a group that two worlds share."""
    image = _picture("sky", (0.7, 0.85, 1.0))
    group = bpy.data.node_groups.new("HDRI nodes", "ShaderNodeTree")
    for name, value in (("Rotation", 0.6), ("Strength", 1.2)):
        made = group.interface.new_socket(name, in_out="INPUT", socket_type="NodeSocketFloat")
        made.default_value = value
    group.interface.new_socket("Background", in_out="OUTPUT", socket_type="NodeSocketShader")
    kinds = ("TexCoord", "CombineXYZ", "Mapping", "TexEnvironment", "HueSaturation", "Background")
    coordinates, turn, mapping, texture, hue, back = (group.nodes.new(f"ShaderNode{kind}") for kind in kinds)
    entry, end = group.nodes.new("NodeGroupInput"), group.nodes.new("NodeGroupOutput")
    texture.image = image
    hue.inputs["Saturation"].default_value = 0.8
    for source, target in (
        (entry.outputs["Rotation"], turn.inputs["Z"]),
        (turn.outputs[0], mapping.inputs["Rotation"]),
        (coordinates.outputs["Generated"], mapping.inputs["Vector"]),
        (mapping.outputs[0], texture.inputs["Vector"]),
        (texture.outputs["Color"], hue.inputs["Color"]),
        (hue.outputs[0], back.inputs["Color"]),
        (entry.outputs["Strength"], back.inputs["Strength"]),
        (back.outputs[0], end.inputs[0]),
    ):
        group.links.new(source, target)
    for name, angle in (("Day", 0.6), ("Night", 2.0)):
        tree = compat.enable_nodes(bpy.data.worlds.new(name))
        tree.nodes.clear()
        user = tree.nodes.new("ShaderNodeGroup")
        user.node_tree = group
        user.inputs["Rotation"].default_value, user.inputs["Strength"].default_value = angle, 1.2
        output = tree.nodes.new("ShaderNodeOutputWorld")
        tree.links.new(user.outputs[0], output.inputs["Surface"])
    scene.world = bpy.data.worlds["Day"]
    bpy.data.scenes.new("Other").world = bpy.data.worlds["Night"]


def computed_turn(scene: Scene, subject: Object) -> None:
    """The turn of such a world comes from other nodes, and it is mirrored."""
    world_in_a_group(scene, subject)
    group = bpy.data.node_groups["HDRI nodes"]
    double = group.nodes.new("ShaderNodeMath")
    double.operation = "MULTIPLY"
    double.inputs[1].default_value = math.pi / 2
    turn = next(n for n in group.nodes if n.bl_idname == "ShaderNodeCombineXYZ")
    group.links.new(turn.inputs["Z"].links[0].from_socket, double.inputs[0])
    group.links.new(double.outputs[0], turn.inputs["Z"])
    next(n for n in group.nodes if n.bl_idname == "ShaderNodeMapping").inputs["Scale"].default_value.x = -1.0


HONORED: tuple[AddProperty, ...] = (
    portal, instanced_light, many_instanced_lights, glowing_instances, glowing_panel, hidden_panel, linked_light, light_nodes,
    light_units, shadowless_light, light_groups, world_override, no_world, no_sky, sky_texture, mixed_environments,
    light_hidden_from_rays, light_without_diffuse, dark_panel, world_hidden_from_rays, backdrop_apart, mirror_ball, world_in_a_group, computed_turn,
)  # fmt: skip
"""The prediction shows what a render shows."""
REPORTED: dict[AddProperty, str] = {
    many_instanced_lights: "6 instances of lights, the farthest, are left out",
    linked_shadow: "all objects cast its shadows",
    linked_glow: "in the prediction its glow lights all",
}
"""A note says what the prediction leaves out."""
