# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes with something wrong or unusual in them: each row breaks one thing of the same small scene."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import bpy
import numpy as np
from bpy.types import Material, Mesh, Node, Object, Scene
from mathutils import Matrix, Vector
from small_scenes import cube, light, principled, shader
from vibe_render.core import compat

AIM = Vector((0.0, 0.0, 0.5))


def plain(scene: Scene) -> Object:
    """A cube on a floor, lit by a sun and a plain world, seen a little from above; returns the cube."""
    subject = cube(scene, "Subject", AIM)
    floor = cube(scene, "Floor", (0.0, 0.0, -5.0), 10.0)
    shader(principled("Body", subject)).inputs["Base Color"].default_value = (0.7, 0.2, 0.1, 1.0)
    shader(principled("Ground", floor)).inputs["Base Color"].default_value = (0.3, 0.5, 0.3, 1.0)
    sun = light(scene, "SUN")
    sun.data.energy = 2.0
    scene.camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(scene.camera)
    aim(scene.camera, (1.5, -3.5, 1.8))
    scene.world = bpy.data.worlds.new("World")
    compat.enable_nodes(scene.world)
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.2, 0.25, 0.35, 1.0)
    scene.render.resolution_x, scene.render.resolution_y = 48, 32
    return subject


def aim(thing: Object, place: tuple[float, float, float], at: Vector = AIM) -> None:
    """Puts a camera or lamp somewhere, looking at something."""
    turn = (Vector(place) - at).to_track_quat("Z", "Y").to_matrix().to_4x4()
    thing.matrix_world = Matrix.Translation(place) @ turn


def _mesh(scene: Scene, name: str, points: list, edges: list, faces: list) -> Object:
    made: Mesh = bpy.data.meshes.new(name)
    made.from_pydata(points, edges, faces)
    thing = bpy.data.objects.new(name, made)
    scene.collection.objects.link(thing)
    return thing


def _vertices(subject: Object, change: Callable[[np.ndarray], None]) -> None:
    mesh = subject.data
    places = np.empty(len(mesh.vertices) * 3, np.float32)
    mesh.vertices.foreach_get("co", places)
    change(places)
    mesh.vertices.foreach_set("co", places)


# --- meshes -----------------------------------------------------------------------------------------


def degenerate_triangles(scene: Scene, subject: Object) -> None:
    """Three corners in one place, three in a row, and a sliver."""
    points = [
        (0, 0, 1),
        (0, 0, 1),
        (0, 0, 1),
        (1, 0, 1),
        (2, 0, 1),
        (3, 0, 1),
        (0, 1, 1),
        (1, 1, 1),
        (0.5, 1 + 1e-9, 1),
    ]
    _mesh(scene, "Degenerate", points, [], [(0, 1, 2), (3, 4, 5), (6, 7, 8)])


def all_degenerate(scene: Scene, subject: Object) -> None:
    """The subject itself has no area."""
    _vertices(subject, lambda v: v.fill(0.25))


def nan_vertices(scene: Scene, subject: Object) -> None:
    """One corner is not a number, another infinite."""
    _vertices(subject, lambda v: v.put([0, 4], [math.nan, math.inf]))


def all_nan(scene: Scene, subject: Object) -> None:
    """No corner of an object beside the subject is a number."""
    other = cube(scene, "Lost", (1.0, 0.0, 0.5))
    _vertices(other, lambda v: v.fill(math.nan))


def huge_vertices(scene: Scene, subject: Object) -> None:
    """A corner so far away that its square is infinite."""
    _vertices(cube(scene, "Far", (1.0, 1.0, 0.5)), lambda v: v.put([0], [1e30]))


def zero_scale(scene: Scene, subject: Object) -> None:
    """An object shrunk to nothing, beside the subject."""
    cube(scene, "Nothing", (1.0, 0.0, 0.5)).scale = (0.0, 0.0, 0.0)


def flat_scale(scene: Scene, subject: Object) -> None:
    """The subject pressed flat."""
    subject.scale = (1.0, 1.0, 0.0)
    subject.location.z = 0.3


def zero_scale_subject(scene: Scene, subject: Object) -> None:
    """The subject shrunk to nothing: the rest is the picture."""
    subject.scale = (0.0, 0.0, 0.0)


def non_manifold(scene: Scene, subject: Object) -> None:
    """Three faces on one edge, a face twice, one turned inside out."""
    points = [(0, 0, 0), (0, 0, 1), (1, 0, 0), (-1, 0, 0), (0, -1, 0)]
    _mesh(scene, "Fan", points, [], [(0, 1, 2), (0, 1, 3), (1, 0, 4), (0, 1, 4)])


def no_faces(scene: Scene, subject: Object) -> None:
    """Meshes of edges, of vertices and of nothing; an empty with children."""
    _mesh(scene, "Wire", [(0, 0, 1), (1, 0, 1)], [(0, 1)], [])
    _mesh(scene, "Dots", [(0, 0, 1)], [], [])
    _mesh(scene, "Nothing", [], [], [])


def mirrored(scene: Scene, subject: Object) -> None:
    """A negative scale turns every face inside out."""
    points = [(-0.5, -0.5, -0.5), (0.7, -0.5, -0.5), (0.2, 0.6, -0.5), (0.0, 0.0, 0.7)]
    faces = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]
    pyramid = _mesh(scene, "Pyramid", points, [], faces)
    pyramid.location, pyramid.scale = (0.6, -0.5, 0.5), (-1.0, 1.2, 0.8)
    pyramid.data.materials.append(subject.data.materials[0])
    subject.scale.x = -1.0


def bad_material_index(scene: Scene, subject: Object) -> None:
    """A face whose slot does not exist, and an empty slot."""
    subject.data.materials.append(None)
    subject.data.polygons[0].material_index = 7
    subject.data.polygons[1].material_index = 1


# --- things that become meshes ----------------------------------------------------------------------


def shape_keys(scene: Scene, subject: Object) -> None:
    """A shape key and an armature's pose, between two frames."""
    subject.shape_key_add(name="Basis")
    key = subject.shape_key_add(name="Tall")
    for point in key.data:
        point.co.z *= 1.5
    key.value = 0.0
    key.keyframe_insert("value", frame=1)
    key.value = 1.0
    key.keyframe_insert("value", frame=11)
    rig = bpy.data.objects.new("Rig", bpy.data.armatures.new("Rig"))
    scene.collection.objects.link(rig)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    bone = rig.data.edit_bones.new("Bone")
    bone.head, bone.tail = (0, 0, 0), (0, 0, 1)
    bpy.ops.object.mode_set(mode="OBJECT")
    rig.pose.bones["Bone"].location = (0.3, 0.0, 0.0)
    subject.vertex_groups.new(name="Bone").add(range(8), 1.0, "REPLACE")
    subject.modifiers.new("Rig", "ARMATURE").object = rig
    scene.frame_set(6)


def geometry_nodes(scene: Scene, subject: Object) -> None:
    """Instances by geometry nodes, one of nothing."""
    group = bpy.data.node_groups.new("Scatter", "GeometryNodeTree")
    group.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    grid, points, box, out = (
        group.nodes.new(kind)
        for kind in ("GeometryNodeMeshGrid", "GeometryNodeInstanceOnPoints", "GeometryNodeMeshCube", "NodeGroupOutput")
    )
    box.inputs["Size"].default_value = (0.2, 0.2, 0.2)
    grid.inputs["Size X"].default_value = grid.inputs["Size Y"].default_value = 2.0
    group.links.new(grid.outputs["Mesh"], points.inputs["Points"])
    group.links.new(box.outputs["Mesh"], points.inputs["Instance"])
    group.links.new(points.outputs["Instances"], out.inputs[0])
    field = _mesh(scene, "Field", [(0, 0, 0)], [], [])
    field.location.z = 0.1
    field.modifiers.new("Scatter", "NODES").node_group = group


def hidden_things(scene: Scene, subject: Object) -> None:
    """Hidden from renders, from the camera, from reflections; excluded with their collection."""
    cube(scene, "Hidden", (1.0, 0.0, 0.5)).hide_render = True
    cube(scene, "Unseen", (0.0, 0.0, 3.0)).visible_camera = False
    cube(scene, "Matte", (-1.0, 0.0, 0.5), 0.4).is_holdout = True
    cube(scene, "Catcher", (-1.0, -1.0, 0.2), 0.4).is_shadow_catcher = True
    away = bpy.data.collections.new("Away")
    scene.collection.children.link(away)
    away.objects.link(cube(scene, "Excluded", (1.0, 1.0, 0.5)))
    scene.collection.objects.unlink(bpy.data.objects["Excluded"])
    bpy.context.view_layer.layer_collection.children["Away"].exclude = True


def empty_subject(scene: Scene, subject: Object) -> None:
    """Curves, texts, empties, hair, point clouds and volumes around the subject."""
    for name, data in (
        ("Empty", None),
        ("Hair", bpy.data.hair_curves.new("Hair")),
        ("Cloud", bpy.data.pointclouds.new("Cloud") if hasattr(bpy.data.pointclouds, "new") else None),
        ("Smoke", bpy.data.volumes.new("Smoke")),
        ("Words", bpy.data.curves.new("Words", "FONT")),
        ("Blob", bpy.data.metaballs.new("Blob")),
    ):
        scene.collection.objects.link(bpy.data.objects.new(name, data))


# --- materials --------------------------------------------------------------------------------------


def _linked_image(material: Material, image: bpy.types.Image | None, *sockets: str) -> Node:
    tree = material.node_tree
    texture = tree.nodes.new("ShaderNodeTexImage")
    texture.image = image
    for name in sockets or ("Base Color",):
        tree.links.new(texture.outputs["Color"], shader(material).inputs[name])
    return texture


def missing_texture(scene: Scene, subject: Object) -> None:
    """The image's file is gone."""
    image = bpy.data.images.new("Gone", 4, 4)
    image.source, image.filepath = "FILE", "//nowhere/gone.png"
    _linked_image(subject.data.materials[0], image, "Base Color", "Roughness")


def broken_texture(scene: Scene, subject: Object) -> None:
    """A packed image whose bytes are no image."""
    image = bpy.data.images.new("Broken", 4, 4)
    image.pack(data=b"not a picture", data_len=13)
    image.source = "FILE"
    _linked_image(subject.data.materials[0], image)


def empty_texture(scene: Scene, subject: Object) -> None:
    """An image texture without an image."""
    _linked_image(subject.data.materials[0], None, "Base Color", "Metallic")


def nan_texture(scene: Scene, subject: Object) -> None:
    """An image with pixels that are no numbers, infinite and negative."""
    image = bpy.data.images.new("Wild", 2, 2, float_buffer=True)
    image.pixels.foreach_set(np.array([math.nan, math.inf, -5.0, 1.0] * 4, np.float32))
    image.pack()
    _linked_image(subject.data.materials[0], image, "Base Color", "Roughness", "Alpha")


def odd_shaders(scene: Scene, subject: Object) -> None:
    """An EEVEE-only shader, a script, a toon, and an output without anything."""
    for number, kind in enumerate(("ShaderNodeEeveeSpecular", "ShaderNodeScript", "ShaderNodeBsdfToon", "")):
        other = cube(scene, f"Odd {number}", (number * 0.5 - 0.8, -0.8, 0.2), 0.3)
        tree = principled(f"Odd {number}", other).node_tree
        tree.nodes.remove(shader(other.data.materials[0]))
        if kind and hasattr(bpy.types, kind):
            node = tree.nodes.new(kind)
            if node.outputs:
                tree.links.new(node.outputs[0], tree.nodes["Material Output"].inputs["Surface"])


def script_color(scene: Scene, subject: Object) -> None:
    """A base color from a script whose text is missing, and from an attribute that no mesh has."""
    tree = subject.data.materials[0].node_tree
    attribute = tree.nodes.new("ShaderNodeAttribute")
    attribute.attribute_name = "nowhere"
    tree.links.new(attribute.outputs["Color"], shader(subject.data.materials[0]).inputs["Base Color"])
    tree.nodes.new("ShaderNodeScript")


def wild_values(scene: Scene, subject: Object) -> None:
    """Sockets beyond what makes sense: Blender does not clamp them."""
    inputs = shader(subject.data.materials[0]).inputs
    wild = {
        "Base Color": (-1.0, 5.0, 0.0, 1.0),
        "Roughness": -3.0,
        "Metallic": 7.0,
        "IOR": 0.0,
        "Alpha": 4.0,
        "Coat Weight": 9.0,
        "Coat IOR": 0.5,
        "Sheen Weight": 5.0,
        "Sheen Roughness": 0.0,
        "Transmission Weight": 3.0,
        "Emission Strength": 1e6,
        "Specular IOR Level": 40.0,
    }
    for name, value in wild.items():
        inputs[name].default_value = value


def infinite_values(scene: Scene, subject: Object) -> None:
    """Sockets and lamps that are infinite or not numbers, as scripts and drivers leave them."""
    inputs = shader(subject.data.materials[0]).inputs
    inputs["Roughness"].default_value = math.nan
    inputs["Base Color"].default_value = (math.nan, math.inf, 0.5, 1.0)
    inputs["Coat IOR"].default_value = math.nan
    inputs["Alpha"].default_value = math.nan
    bpy.data.lights["Sun"].energy = math.inf
    scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value = math.nan
    scene.view_settings.exposure = math.nan


# --- lights and world -------------------------------------------------------------------------------


def zero_area_lights(scene: Scene, subject: Object) -> None:
    """Lamps of no size, of no scale, of no width, of no opening, upon the subject."""
    for number, (kind, values) in enumerate(
        (
            ("AREA", {"size": 0.0}),
            ("AREA", {"shape": "RECTANGLE", "size": 0.0, "size_y": 2.0}),
            ("AREA", {"shape": "ELLIPSE", "size": 1.0, "size_y": 0.0, "spread": 0.0}),
            ("POINT", {"shadow_soft_size": 0.0}),
            ("SPOT", {"shadow_soft_size": 0.0, "spot_size": 0.01, "spot_blend": 0.0}),
            ("SUN", {"angle": 0.0}),
        )
    ):
        lamp = light(scene, kind, (number - 2.0, -2.0, 3.0))
        for name, value in values.items():
            setattr(lamp.data, name, value)
        lamp.scale = (0.0, 0.0, 0.0) if number == 1 else (1.0, 1.0, 1.0)


def lamps_inside(scene: Scene, subject: Object) -> None:
    """Lamps exactly at what the camera and they turn around, and one on a surface."""
    for kind in ("POINT", "AREA", "SPOT"):
        light(scene, kind, AIM)
    light(scene, "POINT", (0.0, -1.0, 0.0))


def no_lights(scene: Scene, subject: Object) -> None:
    """The world alone."""
    bpy.data.objects.remove(bpy.data.objects["Sun"])


def darkness(scene: Scene, subject: Object) -> None:
    """Nothing shines."""
    no_lights(scene, subject)
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.0, 0.0, 0.0, 1.0)


def no_world(scene: Scene, subject: Object) -> None:
    """A scene without a world."""
    scene.world = None


def empty_world(scene: Scene, subject: Object) -> None:
    """A world whose tree has no output."""
    scene.world.node_tree.nodes.clear()


def missing_environment(scene: Scene, subject: Object) -> None:
    """The world's picture is gone."""
    tree = scene.world.node_tree
    texture = tree.nodes.new("ShaderNodeTexEnvironment")
    texture.image = bpy.data.images.new("Gone", 4, 4)
    texture.image.source, texture.image.filepath = "FILE", "//nowhere/gone.exr"
    tree.links.new(texture.outputs["Color"], tree.nodes["Background"].inputs["Color"])


def environment_without_image(scene: Scene, subject: Object) -> None:
    """An environment texture that no picture was ever given."""
    tree = scene.world.node_tree
    texture = tree.nodes.new("ShaderNodeTexEnvironment")
    tree.links.new(texture.outputs["Color"], tree.nodes["Background"].inputs["Color"])


def wild_environment(scene: Scene, subject: Object) -> None:
    """A world's picture with a very bright pixel, one infinite, one not a number."""
    image = bpy.data.images.new("Wild sky", 16, 8, float_buffer=True)
    pixels = np.full(16 * 8 * 4, 0.3, np.float32)
    pixels[[40, 80, 4 * 16 * 6 + 20]] = math.nan, math.inf, 3e4
    image.pixels.foreach_set(pixels)
    image.pack()
    tree = scene.world.node_tree
    texture = tree.nodes.new("ShaderNodeTexEnvironment")
    texture.image = image
    tree.links.new(texture.outputs["Color"], tree.nodes["Background"].inputs["Color"])


def lamp_nodes(scene: Scene, subject: Object) -> None:
    """Lamps with nodes: an Emission of some strength and color, and a network that nobody can foresee."""
    for number, (strength, network) in enumerate(((20.0, False), (1.0, True))):
        lamp = light(scene, "POINT", (1.5 - number * 3.0, -1.0, 1.0)).data
        compat.enable_nodes(lamp)
        glow = next(n for n in lamp.node_tree.nodes if n.type == "EMISSION")
        glow.inputs["Strength"].default_value, glow.inputs["Color"].default_value = (strength, (0.2, 0.3, 1.0, 1.0))
        if network:
            lamp.node_tree.links.new(lamp.node_tree.nodes.new("ShaderNodeTexNoise").outputs[0], glow.inputs[1])


def scaled_lamps(scene: Scene, subject: Object) -> None:
    """Lamps scaled as objects, not by their size."""
    no_lights(scene, subject)
    for number, kind in enumerate(("AREA", "SPOT")):
        lamp = light(scene, kind)
        lamp.data.energy = 200.0
        aim(lamp, (2.0 - 4.0 * number, -1.5, 2.0))
        lamp.scale = (4.0, 2.0, 1.0)


def negative_light(scene: Scene, subject: Object) -> None:
    """A lamp that takes light away, and one of a color beyond what there is."""
    light(scene, "POINT", (1.0, -1.0, 1.0)).data.energy = -20.0
    light(scene, "AREA", (-1.0, -1.0, 2.0)).data.color = (3.0, 0.0, 0.0)


def lost_lamp(scene: Scene, subject: Object) -> None:
    """A lamp whose place is not a number."""
    light(scene, "POINT", (math.nan, 0.0, 0.0))


def a_hundred_lights(scene: Scene, subject: Object) -> None:
    """Ten by ten lamps."""
    for number in range(100):
        light(scene, ("POINT", "AREA", "SPOT", "SUN")[number % 4], (number % 10 - 5.0, number // 10 - 5.0, 4.0))


# --- sizes ------------------------------------------------------------------------------------------


def _resize(scene: Scene, factor: float) -> None:
    bpy.context.view_layer.update()
    for thing in scene.objects:
        thing.matrix_world = Matrix.Scale(factor, 4) @ thing.matrix_world
    for thing in scene.objects:
        if thing.type in ("CAMERA", "LIGHT"):
            thing.scale = (1.0, 1.0, 1.0)
    lens = scene.camera.data
    lens.clip_start, lens.clip_end = lens.clip_start * factor, max(lens.clip_end * factor, lens.clip_end)


def tiny(scene: Scene, subject: Object) -> None:
    """A scene of a millimeter."""
    lamp = light(scene, "AREA", (1.0, -1.0, 2.0)).data
    lamp.size, lamp.energy = 0.001, 1e-5
    _resize(scene, 1e-3)


def enormous(scene: Scene, subject: Object) -> None:
    """A scene of a hundred kilometers."""
    light(scene, "AREA", (1.0, -1.0, 2.0))
    _resize(scene, 1e5)


def wide_ground(scene: Scene, subject: Object) -> None:
    """A ground of ten kilometers below a subject of one meter."""
    bpy.data.objects["Floor"].scale = (1000.0, 1000.0, 0.1)
    bpy.data.objects["Floor"].location.z = -0.5


def far_from_the_origin(scene: Scene, subject: Object) -> None:
    """Everything ten kilometers away, where 32-bit floats are a millimeter apart."""
    for thing in scene.objects:
        thing.location += Vector((1e4, -1e4, 0.0))


# --- cameras ----------------------------------------------------------------------------------------


def inside(scene: Scene, subject: Object) -> None:
    """The camera is in the middle of the subject."""
    aim(scene.camera, (0.0, 0.05, 0.5), AIM + Vector((0.0, 1.0, 0.0)))


def at_the_pivot(scene: Scene, subject: Object) -> None:
    """The camera exactly where it turns around."""
    scene.camera.location = AIM


def top_view(scene: Scene, subject: Object) -> None:
    """Straight down, where an orbit has no azimuth."""
    aim(scene.camera, (0.0, 0.0, 6.0))


def scaled_camera(scene: Scene, subject: Object) -> None:
    """A camera and a lamp below a scaled, mirrored parent."""
    parent = bpy.data.objects.new("Parent", None)
    scene.collection.objects.link(parent)
    parent.scale = (-2.0, 0.5, 1.0)
    for thing in (scene.camera, bpy.data.objects["Sun"]):
        thing.parent, thing.matrix_parent_inverse = parent, parent.matrix_world.inverted()


def orthographic(scene: Scene, subject: Object) -> None:
    """Parallel rays."""
    scene.camera.data.type, scene.camera.data.ortho_scale = "ORTHO", 3.0


def clipped(scene: Scene, subject: Object) -> None:
    """The camera's near plane cuts the subject, its far plane the floor."""
    scene.camera.data.clip_start, scene.camera.data.clip_end = 3.6, 5.0


def clipped_orthographic(scene: Scene, subject: Object) -> None:
    """The same with parallel rays."""
    orthographic(scene, subject)
    clipped(scene, subject)


def shifted(scene: Scene, subject: Object) -> None:
    """Lens shift, in a picture that is taller than wide."""
    scene.camera.data.shift_x, scene.camera.data.shift_y = 0.1, -0.15
    scene.render.resolution_x, scene.render.resolution_y = 32, 48


def fit_vertical(scene: Scene, subject: Object) -> None:
    """The lens angle spans the height, on a sensor that is not as wide as usual."""
    lens = scene.camera.data
    lens.sensor_fit, lens.sensor_height, lens.shift_y = "VERTICAL", 20.0, 0.1


def fit_horizontal(scene: Scene, subject: Object) -> None:
    """The lens angle spans the width of a picture that is taller than wide."""
    scene.camera.data.sensor_fit = "HORIZONTAL"
    scene.render.resolution_x, scene.render.resolution_y = 32, 48


def wide_pixels(scene: Scene, subject: Object) -> None:
    """Pixels twice as wide as tall, so that the picture is wider than its numbers say."""
    scene.render.pixel_aspect_x, scene.render.resolution_x, scene.render.resolution_y = 2.0, 32, 48
    scene.camera.data.shift_x = 0.1


def tall_pixels(scene: Scene, subject: Object) -> None:
    """Pixels that are taller than wide, with parallel rays."""
    orthographic(scene, subject)
    scene.render.pixel_aspect_y = 1.7


def border(scene: Scene, subject: Object) -> None:
    """A render border that is cropped to: the vibe is about the whole picture all the same."""
    scene.render.use_border = scene.render.use_crop_to_border = True
    scene.render.border_min_x, scene.render.border_max_x = 0.4, 0.6
    scene.render.border_min_y, scene.render.border_max_y = 0.1, 0.3


def empty_border(scene: Scene, subject: Object) -> None:
    """A border around nothing."""
    border(scene, subject)
    scene.render.border_max_x, scene.render.border_max_y = 0.4, 0.1


def percentage(scene: Scene, subject: Object) -> None:
    """A tenth of the resolution."""
    scene.render.resolution_percentage = 10


def freestyle(scene: Scene, subject: Object) -> None:
    """Lines drawn over the picture."""
    scene.render.use_freestyle = True


def telephoto(scene: Scene, subject: Object) -> None:
    """The longest lens there is, and a wide one for the sensor's size."""
    scene.camera.data.lens = 5000.0


def shortest_lens(scene: Scene, subject: Object) -> None:
    """The shortest lens there is."""
    scene.camera.data.lens = 1.0


@dataclass(frozen=True)
class Fault:
    """A scene that must be exported, rendered and differentiated.

    Attributes:
        build: Breaks the plain scene.
        warns: Words that one of the warnings must hold; "" where nothing is left out.
        near: Most mean CIEDE2000 between the proxy and a small Cycles render; None where they may differ.
    """

    build: Callable[[Scene, Object], None]
    warns: str = ""
    near: float | None = None


_NEAR = 1.6
"""A little above what the plain scene has at this size, where most pixels are edges."""

# fmt: off
FAULTS = {
    row.build.__name__: row
    for row in (
        Fault(degenerate_triangles, near=_NEAR),
        Fault(all_degenerate, near=_NEAR),
        Fault(nan_vertices, "Subject has corners without a usable place", _NEAR),
        Fault(all_nan, "Lost has corners without a usable place", _NEAR),
        Fault(huge_vertices, "Far has corners without a usable place"),
        Fault(zero_scale, near=_NEAR),
        Fault(flat_scale),
        Fault(zero_scale_subject, near=_NEAR),
        Fault(non_manifold),
        Fault(no_faces, near=_NEAR),
        Fault(mirrored, near=_NEAR),
        Fault(bad_material_index, near=_NEAR),
        Fault(shape_keys, near=_NEAR),
        Fault(geometry_nodes, near=_NEAR),
        Fault(hidden_things, "Catcher is a shadow catcher"),
        Fault(empty_subject, "Hair is hair"),
        Fault(missing_texture, "'Gone' is missing in Body"),
        Fault(broken_texture, "'Broken' is missing in Body"),
        Fault(empty_texture, near=2.5),
        Fault(nan_texture),
        Fault(odd_shaders, "Odd 0", 2.5),
        Fault(script_color, near=_NEAR),
        Fault(wild_values),
        Fault(infinite_values, "Sun: Strength is not a number"),
        Fault(zero_area_lights, near=_NEAR),
        Fault(lamps_inside),
        Fault(no_lights, near=_NEAR),
        Fault(darkness),
        Fault(no_world, near=_NEAR),
        Fault(empty_world, near=2.0),
        Fault(missing_environment, "the world's image is missing", _NEAR),
        Fault(environment_without_image, "the world's image is missing", _NEAR),
        Fault(wild_environment),
        Fault(lamp_nodes, "The nodes of Point.001 are shown as their average"),
        Fault(scaled_lamps, "Spot is scaled unevenly"),
        Fault(negative_light),
        Fault(lost_lamp, "Point has no usable place", _NEAR),
        Fault(a_hundred_lights),
        Fault(tiny, near=_NEAR),
        Fault(enormous, near=_NEAR),
        Fault(wide_ground, near=_NEAR),
        Fault(far_from_the_origin, near=_NEAR),
        Fault(inside, 'inside "Subject"', 0.5),
        Fault(at_the_pivot, 'inside "Subject"', 0.5),
        Fault(top_view, near=_NEAR),
        Fault(scaled_camera, near=_NEAR),
        Fault(orthographic, near=_NEAR),
        Fault(clipped, near=3.0),
        Fault(clipped_orthographic, near=3.0),
        Fault(shifted, near=_NEAR),
        Fault(fit_vertical, near=_NEAR),
        Fault(fit_horizontal, near=_NEAR),
        Fault(wide_pixels, near=_NEAR),
        Fault(tall_pixels, near=_NEAR),
        Fault(border, "render border", _NEAR),
        Fault(empty_border, "render border", _NEAR),
        Fault(freestyle, "Freestyle lines are in the pictures"),
        Fault(percentage, near=_NEAR),
        Fault(telephoto, near=_NEAR),
        Fault(shortest_lens, near=_NEAR),
    )
}
# fmt: on
