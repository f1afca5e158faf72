# SPDX-License-Identifier: GPL-3.0-or-later
"""Vibe Fog: a box of fog that Vibe Render adds around the camera, the subject and objects near them.

A world volume in Cycles would absorb all light of the world and of suns, which comes from infinitely far
away. Inside the box, with z the height above the box's origin (the height of the subject's lowest point):

    extinction = Density · exp(−Height Falloff · max(0, z − Height Offset)), scattering = Color · extinction
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from bpy.types import NodeTree, Object, Scene
from mathutils import Vector

from ..core import compat, locks, rendered
from ..core.journal import Journal
from ..core.value_slots import LazySlot, PropertySlot, ValueSlot, socket_slot
from . import scene_context
from .nodes import owned

NAME = owned.FOG
_INPUTS: owned.GroupInputs = {
    "Density": (0.0, 0.0, 1000.0),
    "Color": ((0.8, 0.8, 0.8),),
    "Anisotropy": (0.0, -0.99, 0.99),
    "Height Falloff": (0.0, 0.0, 1000.0),
    "Height Offset": (0.0, -1000.0, 1000.0),
}


@dataclass(frozen=True)
class FogDomain:
    """The fog's box: center, half side lengths, and `base`, the height of the subject's lowest point; world, meters."""

    center: Vector
    half_size: Vector
    base: float


def find_fog(scene: Scene) -> Object | None:
    """The scene's fog box; None if no fog has been added."""
    return owned.find_owned(scene.objects, NAME)


_PLANNED: dict[int, FogDomain] = {}
"""Session ID of a scene -> the box that its fog will get; set for scenes with several cameras or frames."""


def plan_fog_box(scene: Scene, shape: FogDomain) -> None:
    """Sets the box that the scene's fog will get when it is added, whatever the camera and the frame are then."""
    _PLANNED[scene.session_uid] = shape


def planned_fog_box(scene: Scene) -> FogDomain | None:
    """The box that `plan_fog_box` has set for a scene; None if it has set none."""
    return _PLANNED.get(scene.session_uid)


def fog_domain(context: scene_context.SceneContext, eyes: Sequence[Vector] = ()) -> FogDomain:
    """The box of the scene's fog; without fog, the planned box (`plan_fog_box`), or else a new one.

    A new box contains the camera, the positions `eyes` of other cameras, and the part of the scene within four camera
    distances of the pivot. Fog would hide objects beyond, and a larger box would absorb the world's light.
    """
    box = find_fog(context.scene)
    if box is not None:
        low, high = (box.matrix_world @ Vector(box.bound_box[i]) for i in (0, 6))
        return FogDomain((low + high) / 2.0, (high - low) / 2.0, box.matrix_world.translation.z)
    if shape := planned_fog_box(context.scene):
        return shape
    view = scene_context.scene_lengths(context)["view_distance"]
    low, high = scene_context.bounds(context.scene, scene_context.meshes(context.scene))
    base = scene_context.bounds(context.scene, context.subject or scene_context.meshes(context.scene))[0].z
    reach, least = Vector((4.0, 4.0, 4.0)) * view, Vector((1.5, 1.5, 0.0)) * view
    camera = context.scene.camera.matrix_world.translation if context.scene.camera else context.pivot
    margin = Vector((0.25, 0.25, 0.25)) * view

    def each(pick: Callable, *vectors: Vector) -> Vector:
        return Vector(map(pick, *vectors))

    low = each(min, each(max, low, context.pivot - reach), context.pivot - least, camera, *eyes) - margin
    high = each(max, each(min, high, context.pivot + reach), context.pivot + least, camera, *eyes) + margin
    return FogDomain((low + high) / 2.0, (high - low) / 2.0, base)


@dataclass
class _FogDensitySlot:
    """Value slot: the fog's extinction at its base, 1/m. A value of 0 hides the box in renders, which saves time."""

    box: Object
    input: ValueSlot

    @property
    def locked(self) -> str:
        return self.input.locked

    def get(self) -> float:
        return 0.0 if self.box.hide_render else self.input.get()

    def set(self, journal: Journal, raw: float) -> None:
        self.input.set(journal, raw)
        PropertySlot(self.box, "hide_render").set(journal, raw <= 0.0)


def fog_slot(context: scene_context.SceneContext, name: str) -> ValueSlot:
    """The slot of the fog's input `name` ("Density", …). Only writing a density above 0 adds a missing fog box."""

    def find_input() -> ValueSlot | None:
        box = find_fog(context.scene)
        nodes = owned.group_nodes(compat.node_tree(box.data.materials[0]), NAME) if box else []
        if box is None or not nodes:
            return None
        socket = nodes[0].inputs[name]
        density = socket_slot(socket, locks.of_socket(socket, None))
        return _FogDensitySlot(box, density) if name == "Density" else density

    # Measured now: the box must equal the exported one even if the camera moves before it is made.
    shape = fog_domain(context) if name == "Density" else None

    def make(journal: Journal) -> ValueSlot | None:
        if shape:
            _box(journal, context.scene, shape)
        return find_input()

    return find_input() or LazySlot(find_input, make, _INPUTS[name][0])


def _box(journal: Journal, scene: Scene, shape: FogDomain) -> None:
    """Adds the box with the fog's material, shown as a wire and not selectable."""
    origin = Vector((shape.center.x, shape.center.y, shape.base))
    mesh = owned.new(journal, "meshes", NAME)
    box = owned.new(journal, "objects", NAME, mesh)
    low, high = shape.center - shape.half_size - origin, shape.center + shape.half_size - origin
    corners = [(x, y, z) for x in (low.x, high.x) for y in (low.y, high.y) for z in (low.z, high.z)]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    mesh.from_pydata(corners, [], faces)
    material = owned.new(journal, "materials", NAME)
    tree = compat.enable_nodes(material)
    tree.nodes.clear()
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    node = tree.nodes.new("ShaderNodeGroup")
    node.node_tree = owned.owned_group(journal, NAME, "ShaderNodeTree", _fill)
    node.name = node.label = NAME
    node.use_custom_color, node.color = True, owned.COLOR
    node.location = (output.location.x - 200.0, output.location.y)
    tree.links.new(node.outputs["Volume"], output.inputs["Volume"])
    mesh.materials.append(material)
    box.location = origin
    box.display_type, box.hide_select = "WIRE", True
    scene.collection.objects.link(box)
    compat.march_volumes(journal, scene)
    rendered.layer(scene).update()


def _fill(tree: NodeTree) -> None:
    owned.declare(tree, _INPUTS, "Volume", "NodeSocketShader")
    build = owned.Builder(tree)
    density, color, anisotropy, falloff, offset = build.inputs(*_INPUTS)
    position = build.node("ShaderNodeTexCoord").outputs["Object"]
    height = build.node("ShaderNodeSeparateXYZ", Vector=position).outputs["Z"]
    above = build.math("MAXIMUM", build.math("SUBTRACT", height, offset), 0.0)
    # With a falloff of 0, Cycles folds these nodes to the density and treats the fog as homogeneous.
    thinning = build.math("EXPONENT", build.math("MULTIPLY", above, build.math("MULTIPLY", falloff, -1.0)))
    extinction = build.math("MULTIPLY", density, thinning)
    fog = build.node("ShaderNodeVolumePrincipled", Color=color, Density=extinction, Anisotropy=anisotropy)
    build.output(fog.outputs["Volume"])
