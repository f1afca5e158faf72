# SPDX-License-Identifier: GPL-3.0-or-later
"""Locators: functions that find the slot of one value of an object, material, world or scene; None if it has none.

A value slot reads and writes one stored value. For a value that nodes compute, it is an input of a Vibe Tint or Vibe
Factor: a node group that Vibe Render adds behind these nodes, to multiply their result.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

from bpy.types import Material, Object, Scene, World

from ..core import compat, locks, rendered
from ..core.journal import Journal
from ..core.value_slots import DerivedSlot, PropertySlot, ValueSlot, same, together
from . import fog
from .light_types import type_of
from .nodes import backgrounds, inputs, layers, light_nodes, trails
from .nodes.backgrounds import BACKDROP, LIGHT
from .nodes.inputs import FACTOR, HORIZON, TINT, Inset
from .nodes.trails import NodeEntry
from .orbits import Pose
from .scene_context import SceneContext

Locator = Callable[[SceneContext, Any], ValueSlot | None]


@dataclass
class _OrbitSlot:
    """Value slot: the azimuth, elevation (degrees) or distance (meters) of a pose, which an object's slots share."""

    pose: Pose
    name: str

    @property
    def locked(self) -> str:
        return locks.of_pose(self.pose.obj)

    def get(self) -> float:
        return getattr(self.pose, self.name)

    def set(self, journal: Journal, raw: float) -> None:
        if not same(raw, self.get()):
            setattr(self.pose, self.name, raw)
            self.pose.apply(journal)


def orbit(name: str, context: SceneContext, obj: Object) -> ValueSlot | None:
    """The slot of orbit coordinate `name` of a camera or light; None for a light of instances or background sets."""
    if obj.type == "LIGHT" and context.scene not in obj.users_scene:
        return None
    if obj not in context.poses:
        context.poses[obj] = Pose.of(obj, context.pivot)
    return _OrbitSlot(context.poses[obj], name)


def lens(context: SceneContext, obj: Object) -> ValueSlot | None:
    """The slot of a perspective camera's focal length, as a multiple of its sensor's size; None for other cameras."""
    camera = obj.data
    if camera.type != "PERSP":
        return None
    sensor = camera.sensor_height if camera.sensor_fit == "VERTICAL" else camera.sensor_width
    millimeters = PropertySlot(camera, "lens", locks.of_property(camera, "lens"))
    return DerivedSlot(millimeters, lambda length: length / sensor, lambda _, multiple: multiple * sensor)


def light_property(name: str, context: SceneContext, obj: Object) -> ValueSlot | None:
    """The slot of a property of a light's data, or None. Of lights that share data, only the first is unlocked."""
    if name not in obj.data.bl_rna.properties:
        return None
    return PropertySlot(obj.data, name, _light_lock(context, obj, name))


def _light_lock(context: SceneContext, obj: Object, name: str) -> str:
    """The reason why a property of a light's data is locked; "" if it is not."""
    first = context.first_lights.get(obj.data, obj)
    if first != obj:
        return f'"{obj.name}" shares its light data with "{first.name}"'
    return locks.of_property(obj.data, name)


def light_extent(context: SceneContext, obj: Object) -> ValueSlot:
    """The slot of a light's radius or size (meters) or angle (radians), whichever its type has."""
    light_type = type_of(obj)
    return light_type.extent_slot(obj.data, _light_lock(context, obj, light_type.extent_property))


class _TemperatureSlot(PropertySlot):
    """Value slot: a light's own color temperature in kelvins; 6500 if it is switched off. Writing switches it on."""

    def get(self) -> float:
        return self.owner.temperature if self.owner.use_temperature else 6500.0

    def set(self, journal: Journal, raw: float) -> None:
        if raw == self.get():
            return
        PropertySlot(self.owner, "use_temperature").set(journal, True)
        super().set(journal, raw)


def light_temperature(context: SceneContext, obj: Object) -> ValueSlot | None:
    """The slot of a light's temperature, K: its own, or its Blackbody node's if it has one and its own is off."""
    if light_nodes.kelvin(obj.data) and not obj.data.use_temperature:
        return inputs.input_slot(lambda: light_nodes.kelvin(obj.data))
    return _TemperatureSlot(obj.data, "temperature", _light_lock(context, obj, "temperature"))


def shader(name: str, context: SceneContext, material: Material) -> ValueSlot | None:
    """The slot of a shader input, by its name on the Principled BSDF, or None. A value that nodes compute is locked."""
    return inputs.input_slot(lambda: layers.entry(material, name))


def coat_weight(context: SceneContext, material: Material) -> ValueSlot | None:
    """The slot of a coat's weight: the shader's input, else the greatest color component of a metal's lacquer, or None.

    A lacquer is a glossy shader that is mixed over a metal (`layers.lacquer_over`).
    """

    def scaled(color: tuple[float, ...], strongest: float) -> tuple[float, ...]:
        before = max(color[:3])
        return tuple(strongest * c / before if before else strongest for c in color[:3])  # black becomes gray

    color = inputs.input_slot(partial(layers.lacquer_entry, material, "Base Color"))
    own = shader("Coat Weight", context, material)
    return own or (DerivedSlot(color, lambda rgb: min(max(rgb[:3]), 1.0), scaled) if color else None)


def coat_roughness(context: SceneContext, material: Material) -> ValueSlot | None:
    """The slot of a coat's roughness, or None: the shader's input, else the roughness of a metal's lacquer."""
    lacquer = partial(layers.lacquer_entry, material, "Roughness")
    return shader("Coat Roughness", context, material) or inputs.input_slot(lacquer)


def surface_color(context: SceneContext, material: Material) -> ValueSlot | None:
    """The slot of a constant base color (`diffuse_color` without nodes); None if nodes compute or mix it."""
    if compat.node_tree(material) is None:
        return PropertySlot(material, "diffuse_color", locks.of_property(material, "diffuse_color"))
    colors = layers.colors(material)
    return inputs.input_slot(lambda: layers.colors(material)[0], tinted=True) if len(colors) == 1 else None


def glow(name: str, context: SceneContext, material: Material) -> ValueSlot | None:
    """The slot of a material's emission, its "Color" or "Strength"; None if it has none.

    If nodes compute the value, the slot is the Vibe Tint or Vibe Factor node that multiplies it.
    """
    find = partial(layers.entry, material, f"Emission {name}")
    inset, changed = (TINT, "Tint") if name == "Color" else (FACTOR, "Factor")
    return inputs.input_slot(find, tinted=True) or inset.slot(find, changed)


def material_tint(name: str, context: SceneContext, material: Material) -> ValueSlot | None:
    """The slot of a Vibe Tint's input `name`, for a base color that nodes compute or mix; None for a constant color."""
    return _of_all(partial(layers.colors, material), TINT, name, plain=len(layers.colors(material)) > 1)


def _of_all(find: Callable[[], list[NodeEntry]], inset: Inset, name: str, plain: bool = True) -> ValueSlot | None:
    """One slot for input `name` of the insets in front of all node inputs that `find` returns; see `Inset.slot`."""
    slots = [inset.slot(partial(lambda number: find()[number], n), name, plain) for n in range(len(find()))]
    return together([slot for slot in slots if slot])


def recolor(context: SceneContext, material: Material) -> ValueSlot | None:
    """The slot of a Vibe Tint's Recolor on a computed base color, else on a computed emission color; else None.

    Recolor is the share, 0 to 1, of the color that turns gray before it is tinted.
    """
    glow = partial(layers.entry, material, "Emission Color")
    return material_tint("Recolor", context, material) or TINT.slot(glow, "Recolor")


def background(name: str, part: str, context: SceneContext, world: World) -> ValueSlot | None:
    """The slot of "Color" or "Strength" of a world's LIGHT or BACKDROP part; None for a mixed or computed color."""
    if backgrounds.mixed_backgrounds(world, part):
        strengths = partial(backgrounds.mixed_entries, world, part, "Strength")
        return _of_all(strengths, FACTOR, "Factor") if name == "Strength" else None
    if backgrounds.single_background(world, part) is None:
        plain = part == LIGHT and name == "Color" and compat.node_tree(world) is None
        return PropertySlot(world, "color", locks.of_property(world, "color")) if plain else None
    return inputs.input_slot(partial(_single, world, part, name), tinted=name == "Color")


def world_tint(part: str, context: SceneContext, world: World) -> ValueSlot | None:
    """The slot of the Vibe Tint on a world's computed background color, or on all of several mixed ones; else None."""
    if backgrounds.mixed_backgrounds(world, part):
        return _of_all(partial(backgrounds.mixed_entries, world, part, "Color"), TINT, "Tint")
    return TINT.slot(partial(_single, world, part, "Color"), "Tint")


def horizon(context: SceneContext, world: World) -> ValueSlot | None:
    """The slot of the tint at the horizon of a backdrop that has one constant color; None for other backdrops."""
    color = _single(world, BACKDROP, "Color")
    if color is None or inputs.resolve(color).source is not None:
        return None
    height = {"Height": backgrounds.horizon_height(context.scene, world)}
    return HORIZON.slot(partial(_single, world, BACKDROP, "Color", inset=False), "Horizon", True, height)


def _single(world: World, part: str, name: str, inset: bool = True) -> NodeEntry | None:
    """Input `name` of the only Background of a world's part; None if there is not exactly one.

    With `inset`, the color input of a Vibe Horizon instead, if one feeds this input.
    """
    node = backgrounds.single_background(world, part)
    entry = node.entry(name) if node else None
    if entry is None or not inset:
        return entry
    origin = inputs.resolve(entry)
    group = HORIZON.of(origin.source)
    return NodeEntry(group.inputs[0], origin.inside) if group else entry


def volume(name: str, context: SceneContext, scene: Scene) -> ValueSlot | None:
    """The slot of the fog's value `name`: of the artist's world volume if there is one, else of the Vibe Fog box."""
    world = rendered.world(scene)
    if trails.world_volume(world) is None:
        return fog.fog_slot(context, name)

    def find() -> NodeEntry | None:
        node = trails.world_volume(world)
        return node.entry(name) if node else None

    return inputs.input_slot(find)


def view(name: str, context: SceneContext, scene: Scene) -> ValueSlot:
    """The slot of a property of the scene's view transform, such as "exposure"."""
    return PropertySlot(scene.view_settings, name, locks.of_property(scene.view_settings, name))
