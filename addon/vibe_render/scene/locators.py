# SPDX-License-Identifier: GPL-3.0-or-later
"""Locators: from a thing in the scene to the place of one of its values; None where it has no such value."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from bpy.types import Camera, Light, Material, Object, Scene, World

from ..core import compat, locks
from ..core.journal import Journal
from ..core.value_slots import Lazy, Place, Property, value
from . import fog, scene_context
from .nodes import environment_rotation, grade, shaders, tint
from .orbits import Coordinate, Pose
from .scene_context import Cast

Locator = Callable[[Cast, Any], Place | None]


def orbit(name: str) -> Locator:
    """A coordinate of a camera or light on its orbit."""

    def locate(cast: Cast, obj: Object) -> Place:
        if obj not in cast.poses:
            cast.poses[obj] = Pose.of(obj, cast.pivot)
        return Coordinate(cast.poses[obj], name)

    return locate


@dataclass
class Lens:
    """A place: the focal length of a camera in multiples of its sensor's size."""

    camera: Camera
    locked: str

    @property
    def _sensor(self) -> float:
        return self.camera.sensor_height if self.camera.sensor_fit == "VERTICAL" else self.camera.sensor_width

    def get(self) -> float:
        """Millimeters per millimeter."""
        return self.camera.lens / self._sensor

    def set(self, journal: Journal, raw: float) -> None:
        """Changes the focal length."""
        Property(self.camera, "lens").set(journal, raw * self._sensor)


def lens(cast: Cast, obj: Object) -> Place | None:
    """The focal length of a perspective camera."""
    return Lens(obj.data, locks.of_property(obj.data, "lens")) if obj.data.type == "PERSP" else None


def lamp(name: str) -> Locator:
    """A property of a light's data. Lights that share it have it once, with the first of them."""

    def locate(cast: Cast, obj: Object) -> Place | None:
        if name not in obj.data.bl_rna.properties:
            return None
        return Property(obj.data, name, _lamp_lock(cast.scene, obj, name))

    return locate


def _lamp_lock(scene: Scene, obj: Object, name: str) -> str:
    first = next((o for o in scene_context.lights(scene) if o.data == obj.data), obj)
    if first != obj:
        return f'"{obj.name}" shares its light data with "{first.name}"'
    return locks.of_property(obj.data, name)


@dataclass
class AreaSize:
    """A place: the size of an area light; its two sides keep their proportion."""

    light: Light
    locked: str

    def get(self) -> float:
        """The first side, meters."""
        return self.light.size

    def set(self, journal: Journal, raw: float) -> None:
        """Scales both sides."""
        ratio = raw / max(self.light.size, 1e-9)
        both = self.light.shape in {"RECTANGLE", "ELLIPSE"}
        if both and ratio != 1.0:
            Property(self.light, "size_y").set(journal, self.light.size_y * ratio)
        Property(self.light, "size").set(journal, raw)


def lamp_size(cast: Cast, obj: Object) -> Place | None:
    """The radius of a point or spot light, the size of an area light."""
    if obj.data.type == "AREA":
        return AreaSize(obj.data, _lamp_lock(cast.scene, obj, "size"))
    return lamp("shadow_soft_size")(cast, obj)


@dataclass
class Temperature:
    """A place: the temperature of a light, where 6500 K is also what a light without one has."""

    light: Light
    locked: str

    def get(self) -> float:
        """Kelvin."""
        return self.light.temperature if self.light.use_temperature else 6500.0

    def set(self, journal: Journal, raw: float) -> None:
        """Changes the temperature, and turns its use on if that is needed."""
        if raw == self.get():
            return
        Property(self.light, "use_temperature").set(journal, True)
        Property(self.light, "temperature").set(journal, raw)


def lamp_temperature(cast: Cast, obj: Object) -> Place | None:
    """The temperature of a light, where Blender has it."""
    if not compat.HAS_TEMPERATURE:
        return None
    return Temperature(obj.data, _lamp_lock(cast.scene, obj, "temperature"))


def shader(name: str) -> Locator:
    """An input of the shader of a material's surface, in the words of the Principled BSDF.

    A color that is computed has no such place but a tint; anything else that is computed is locked.
    """

    def locate(cast: Cast, material: Material) -> Place | None:
        found = shaders.surface(material)
        entry = found.input(name) if found else None
        if not found or not entry:
            return None
        socket, source = shaders.resolve(entry, found.inside)
        if source and name == "Base Color":
            return None
        return value(socket, locks.of_socket(socket, source))

    return locate


def surface_color(cast: Cast, material: Material) -> Place | None:
    """The base color, or the plain color of a material without nodes."""
    if compat.node_tree(material) is None:
        return Property(material, "diffuse_color", locks.of_property(material, "diffuse_color"))
    return shader("Base Color")(cast, material)


def material_tint(name: str) -> Locator:
    """An input of the owned tint on a computed base color."""

    def locate(cast: Cast, material: Material) -> Place | None:
        found = shaders.surface(material)
        entry = found and found.input("Base Color")
        return tint.place(entry, found.inside, name) if found and entry else None

    return locate


def background(name: str) -> Locator:
    """An input of a world's background; a computed color has a tint instead."""

    def locate(cast: Cast, world: World) -> Place | None:
        found = shaders.background(world)
        if found is None:
            plain = name == "Color" and compat.node_tree(world) is None
            return Property(world, "color", locks.of_property(world, "color")) if plain else None
        socket, source = shaders.resolve(found.node.inputs[name], found.inside)
        if source and name == "Color":
            return None
        return value(socket, locks.of_socket(socket, source))

    return locate


def world_tint(cast: Cast, world: World) -> Place | None:
    """The owned tint on a computed background."""
    found = shaders.background(world)
    return tint.place(found.node.inputs["Color"], found.inside, "Tint") if found else None


def world_rotation(cast: Cast, world: World) -> Place | None:
    """The turn of an environment texture around the vertical axis."""
    return environment_rotation.place(world)


def volume(name: str) -> Locator:
    """A value of the fog: of the artist's world volume if there is one, else of the owned box."""

    def locate(cast: Cast, scene: Scene) -> Place | None:
        found = shaders.world_volume(scene.world) if scene.world else None
        if found is None:
            return fog.place(cast, name)
        if name not in found.node.inputs:
            return None
        socket, source = shaders.resolve(found.node.inputs[name], found.inside)
        return value(socket, locks.of_socket(socket, source))

    return locate


def view(name: str) -> Locator:
    """A property of the scene's view transform."""

    def locate(cast: Cast, scene: Scene) -> Place:
        settings = scene.view_settings
        return Property(settings, name, locks.of_property(settings, name))

    return locate


def graded(name: str) -> Locator:
    """An input of the owned compositor group."""

    def locate(cast: Cast, scene: Scene) -> Lazy | None:
        return grade.place(scene, name)

    return locate
