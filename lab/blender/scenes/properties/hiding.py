# SPDX-License-Identifier: GPL-3.0-or-later
"""Properties that hide, replace or multiply objects and what they wear: each builder adds one to the plain scene."""

from __future__ import annotations

import bpy
import numpy as np
from bpy.types import Object, Scene
from vibe_render.core import rendered

from .plain import AddProperty, apart, cube, instanced, lamp, layer_collection, material, obstacle, shader

# --- objects ----------------------------------------------------------------------------------------


def hidden_object(scene: Scene, subject: Object) -> None:
    """An obstacle that is disabled in renders."""
    obstacle(scene).hide_render = True


def disabled_collection(scene: Scene, subject: Object) -> None:
    """Obstacle and light in collections inside a disabled one."""
    outer = apart(scene)
    apart(scene, obstacle(scene), inside=outer)
    apart(scene, lamp(scene), inside=outer)
    outer.hide_render = True


def excluded_collection(scene: Scene, subject: Object) -> None:
    """Obstacle and light that the view layer excludes."""
    made = apart(scene, obstacle(scene), lamp(scene))
    layer_collection(scene, made).exclude = True


def indirect_only(scene: Scene, subject: Object) -> None:
    """An obstacle that only lights indirectly."""
    made = apart(scene, obstacle(scene))
    layer_collection(scene, made).indirect_only = True


def holdout_collection(scene: Scene, subject: Object) -> None:
    """An obstacle that cuts a hole."""
    made = apart(scene, obstacle(scene))
    layer_collection(scene, made).holdout = True


def shadow_catcher(scene: Scene, subject: Object) -> None:
    """A floor that shows nothing but shadows."""
    scene.objects["Floor"].is_shadow_catcher = True


def hidden_from_camera(scene: Scene, subject: Object) -> None:
    """An obstacle that camera rays pass."""
    obstacle(scene).visible_camera = False


def instance_of_hidden(scene: Scene, subject: Object) -> None:
    """An instance of an obstacle that is disabled in renders."""
    thing = obstacle(scene)
    thing.hide_render = True
    instanced(scene, thing)


def hidden_instancer(scene: Scene, subject: Object) -> None:
    """Instances of obstacle and light by an object that is disabled in renders."""
    instanced(scene, obstacle(scene), lamp(scene)).hide_render = True


def background_set(scene: Scene, subject: Object) -> None:
    """A wall and a light of another scene."""
    behind = bpy.data.scenes.new("Set")
    lamp(behind, "POINT")
    wall = cube(behind, "Wall", (0.0, 3.0, 0.0), 5.0)
    material("Plaster", (0.8, 0.7, 0.1), wall)
    scene.background_set = behind


def unused_first_layer(scene: Scene, subject: Object) -> None:
    """An obstacle that only a view layer which is not rendered has."""
    made = apart(scene, obstacle(scene))
    scene.view_layers.new("Second")
    scene.view_layers[0].use = False
    layer_collection(scene, made).exclude = True


def simplified(scene: Scene, subject: Object) -> None:
    """A subdivision that Simplify switches off."""
    subject.modifiers.new("Round", "SUBSURF").render_levels = 3
    scene.render.use_simplify, scene.render.simplify_subdivision_render = True, 0


def culled(scene: Scene, subject: Object) -> None:
    """Objects outside the view may be left out."""
    scene.render.use_simplify = scene.cycles.use_camera_cull = True


def hidden_in_viewport(scene: Scene, subject: Object) -> None:
    """An obstacle that only renders show."""
    thing = obstacle(scene)
    thing.hide_viewport = True
    thing.hide_set(True)


def collection_hidden_in_viewport(scene: Scene, subject: Object) -> None:
    """Obstacle and light in a collection that only renders show."""
    made = apart(scene, obstacle(scene), lamp(scene))
    made.hide_viewport = layer_collection(scene, made).hide_viewport = True


def two_homes(scene: Scene, subject: Object) -> None:
    """An obstacle in a disabled collection and in another one."""
    thing = obstacle(scene)
    made = bpy.data.collections.new("Disabled")
    scene.collection.children.link(made)
    made.objects.link(thing)
    made.hide_render = True


def included_child(scene: Scene, subject: Object) -> None:
    """An obstacle in a collection that is included, inside one that is excluded."""
    outer = apart(scene, lamp(scene))
    apart(scene, obstacle(scene), inside=outer)
    row = layer_collection(scene, outer)
    row.exclude, row.children[0].exclude = True, False


def holdout_material(scene: Scene, subject: Object) -> None:
    """An obstacle whose material cuts a hole."""
    tree = obstacle(scene).data.materials[0].node_tree
    output = next(n for n in tree.nodes if n.type == "OUTPUT_MATERIAL")
    tree.links.new(tree.nodes.new("ShaderNodeHoldout").outputs[0], output.inputs["Surface"])


def shadowless_object(scene: Scene, subject: Object) -> None:
    """A cube without shadow."""
    cube(scene, "Cloud", (0.8, 0.3, 1.9), 0.9).visible_shadow = False


def hidden_from_diffuse(scene: Scene, subject: Object) -> None:
    """A cube that bounced light passes."""
    thing = cube(scene, "Block", (-1.0, 0.6, 0.5))
    material("Red", (0.9, 0.02, 0.02), thing)
    thing.visible_diffuse = False


def driven_hiding(scene: Scene, subject: Object) -> None:
    """An obstacle that a driver disables in renders."""
    obstacle(scene).driver_add("hide_render").driver.expression = "frame > 0"


def keyed_hiding(scene: Scene, subject: Object) -> None:
    """An obstacle that is disabled in renders at this frame."""
    thing = obstacle(scene)
    for frame, hidden in ((1, True), (5, False)):
        thing.hide_render = hidden
        thing.keyframe_insert("hide_render", frame=frame)
    scene.frame_set(1)


def render_only_modifier(scene: Scene, subject: Object) -> None:
    """Copies that only renders show."""
    array = subject.modifiers.new("Array", "ARRAY")
    array.count, array.show_viewport = 2, False
    array.relative_offset_displace = (-1.2, 0.0, 0.0)


def vertex_instances(scene: Scene, subject: Object) -> None:
    """Cubes at the corners of an instancer that renders do not show."""
    holder = cube(scene, "Holder", (0.0, 0.0, 1.2), 1.2)
    thing = cube(scene, "Bead", (0.0, 0.0, 0.0), 0.3)
    material("Red", (0.9, 0.02, 0.02), thing)
    thing.parent = holder
    holder.instance_type, holder.show_instancer_for_render = "VERTS", False


def nodes_instances(scene: Scene, subject: Object) -> None:
    """Instances by geometry nodes of an obstacle that is disabled in renders."""
    thing = obstacle(scene)
    thing.hide_render = True
    group = bpy.data.node_groups.new("Scatter", "GeometryNodeTree")
    group.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    kinds = ("MeshLine", "ObjectInfo", "InstanceOnPoints")
    line, info, points = (group.nodes.new(f"GeometryNode{kind}") for kind in kinds)
    line.inputs["Count"].default_value, line.inputs["Offset"].default_value = 3, (0.0, 0.0, 0.6)
    info.inputs["Object"].default_value, info.inputs["As Instance"].default_value = thing, True
    group.links.new(line.outputs["Mesh"], points.inputs["Points"])
    group.links.new(info.outputs["Geometry"], points.inputs["Instance"])
    group.links.new(points.outputs["Instances"], group.nodes.new("NodeGroupOutput").inputs[0])
    cube(scene, "Scatter", (-1.1, 0.0, 0.3), 0.3).modifiers.new("Scatter", "NODES").node_group = group


def particles(scene: Scene, subject: Object) -> None:
    """Instances of a cube by particles."""
    thing = cube(scene, "Flake", (0.0, 0.0, -2.0), 0.15)
    material("Red", (0.9, 0.02, 0.02), thing)
    settings = scene.objects["Floor"].modifiers.new("Flakes", "PARTICLE_SYSTEM").particle_system.settings
    settings.type, settings.count, settings.render_type, settings.instance_object = ("HAIR", 60, "OBJECT", thing)
    settings.hair_length, settings.particle_size = 1.0, 1.0


def nested_sets(scene: Scene, subject: Object) -> None:
    """A set with a set of its own."""
    background_set(scene, subject)
    farther = bpy.data.scenes.new("Farther")
    material("Red", (0.9, 0.02, 0.02), cube(farther, "Post", (-1.4, 0.5, 0.5), 0.6))
    scene.background_set.background_set = farther


def text_object(scene: Scene, subject: Object) -> None:
    """A text, which becomes a mesh."""
    data = bpy.data.curves.new("Sign", "FONT")
    data.body, data.extrude, data.size = "VIBE", 0.05, 0.8
    thing = bpy.data.objects.new("Sign", data)
    thing.location, thing.rotation_euler = (-0.8, -0.8, 0.1), (1.57, 0.0, 0.3)
    material("Red", (0.9, 0.02, 0.02), thing)
    scene.collection.objects.link(thing)


def odd_names(scene: Scene, subject: Object) -> None:
    """Names with marks of patterns and formats, line breaks, 63 bytes, and from right to left."""
    names = ("[a-z]*", "100%s #{x}", "line\nbreak", "\u05e9\u05dc\u05d5\u05dd \u202e", "\u4e2d" * 21, "a/b\\c:d")
    blocks = [*scene.objects, *bpy.data.materials, *bpy.data.lights, *bpy.data.meshes]
    for number, block in enumerate(blocks):
        block.name = names[number % len(names)]


# --- surfaces ---------------------------------------------------------------------------------------


def object_slots(scene: Scene, subject: Object) -> None:
    """A material that the object has, not its mesh."""
    subject.material_slots[0].link = "OBJECT"
    subject.material_slots[0].material = material("Own", (0.05, 0.1, 0.8))


def material_override(scene: Scene, subject: Object) -> None:
    """A view layer that shows clay."""
    rendered.layer(scene).material_override = material("Clay", (0.1, 0.6, 0.2))


def linear_image(scene: Scene, subject: Object) -> None:
    """A byte image that is not encoded as sRGB."""
    image = bpy.data.images.new("Linear", 8, 8)
    image.colorspace_settings.name = "Linear Rec.709"
    image.pixels.foreach_set(np.tile(np.array([0.5, 0.25, 0.1, 1.0], np.float32), 64))
    image.pack()
    tree = subject.data.materials[0].node_tree
    texture = tree.nodes.new("ShaderNodeTexImage")
    texture.image = image
    tree.links.new(texture.outputs["Color"], shader(tree).inputs["Base Color"])


def empty_slot(scene: Scene, subject: Object) -> None:
    """A slot without a material."""
    subject.material_slots[0].material = None


def set_by_nodes(scene: Scene, subject: Object) -> None:
    """A material that geometry nodes put in place of the object's."""
    group = bpy.data.node_groups.new("Paint", "GeometryNodeTree")
    for way in ("INPUT", "OUTPUT"):
        group.interface.new_socket("Geometry", in_out=way, socket_type="NodeSocketGeometry")
    paint = group.nodes.new("GeometryNodeSetMaterial")
    paint.inputs["Material"].default_value = material("Painted", (0.05, 0.1, 0.8))
    group.links.new(group.nodes.new("NodeGroupInput").outputs[0], paint.inputs["Geometry"])
    group.links.new(paint.outputs["Geometry"], group.nodes.new("NodeGroupOutput").inputs[0])
    subject.modifiers.new("Paint", "NODES").node_group = group


def missing_image(scene: Scene, subject: Object) -> None:
    """An image whose file is gone."""
    image = bpy.data.images.new("Gone", 8, 8)
    image.source, image.filepath = "FILE", "//gone.png"
    tree = subject.data.materials[0].node_tree
    texture = tree.nodes.new("ShaderNodeTexImage")
    texture.image = image
    tree.links.new(texture.outputs["Color"], shader(tree).inputs["Base Color"])


HONORED: tuple[AddProperty, ...] = (
    holdout_collection, holdout_material,
    hidden_object, disabled_collection, excluded_collection, indirect_only, hidden_from_camera, instance_of_hidden,
    hidden_instancer, background_set, nested_sets, unused_first_layer, simplified, hidden_in_viewport,
    collection_hidden_in_viewport, two_homes, included_child, shadowless_object, hidden_from_diffuse, driven_hiding, keyed_hiding,
    render_only_modifier, vertex_instances, nodes_instances, particles, text_object, odd_names, object_slots,
    material_override, linear_image, empty_slot, set_by_nodes, missing_image,
)  # fmt: skip
"""The prediction shows what a render shows."""
REPORTED: dict[AddProperty, str] = {
    holdout_collection: "is a holdout",
    holdout_material: "is a holdout",
    shadow_catcher: "is a shadow catcher",
    culled: "Culling by Simplify",
    material_override: "in place of all materials",
}
"""A note says what the prediction leaves out."""
