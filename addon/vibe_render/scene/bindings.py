# SPDX-License-Identifier: GPL-3.0-or-later
"""Bindings: for each parameter of the schema, where Blender stores its value and in which unit; one row each."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from typing import Any

from bpy.types import Object, Scene
from mathutils import Vector

from ..core import rendered
from ..core.journal import Journal
from ..core.schema_import import labels, schema
from ..core.value_slots import ValueSlot
from . import light_links, prepare, scene_context, snapshot
from . import locators as at
from .light_types import type_of
from .nodes import backgrounds
from .nodes.backgrounds import BACKDROP, LIGHT
from .nodes.grade import graded

_ByKey = Mapping[str, Sequence[float]]  # key of a parameter ("material/Glaze/roughness") -> its components


@dataclass(frozen=True)
class Codec:
    """Two inverse functions: `decode` turns the value that Blender stores into the schema's components."""

    decode: Callable[[Any], schema.Values]
    encode: Callable[[schema.Values], Any]


NUMBER = Codec(lambda raw: (float(raw),), lambda values: values[0])

COLOR = Codec(lambda raw: tuple(map(float, raw[:3])), lambda values: tuple(values))
"""Linear RGB. An alpha component that Blender stores is not read and keeps its value."""

DEGREES = Codec(lambda raw: (math.degrees(raw),), lambda values: math.radians(values[0]))

LENS = Codec(
    lambda per_sensor: (math.degrees(2.0 * math.atan(0.5 / per_sensor)),),
    lambda values: 0.5 / math.tan(math.radians(values[0]) / 2.0),
)
"""Decodes a focal length, as a multiple of the sensor's size, to the field of view in degrees."""


@dataclass(frozen=True)
class ParameterBinding:
    """A row: a parameter, the locator that finds its value slot in a scene, and the codec that converts its value."""

    parameter: schema.Parameter
    locator: at.Locator
    codec: Codec = NUMBER


def _row(family: str, locator: at.Locator, codec: Codec = NUMBER) -> ParameterBinding:
    return ParameterBinding(schema.FAMILIES[family], locator, codec)


# fmt: off
BINDINGS: tuple[ParameterBinding, ...] = (
    _row("camera/azimuth",          partial(at.orbit, "azimuth")),
    _row("camera/elevation",        partial(at.orbit, "elevation")),
    _row("camera/distance",         partial(at.orbit, "distance")),
    _row("camera/fov",              at.lens,                                      LENS),

    _row("light/power",             partial(at.light_property, "energy")),
    _row("light/strength",          partial(at.light_property, "energy")),
    _row("light/color",             partial(at.light_property, "color"),          COLOR),
    _row("light/temperature",       at.light_temperature),
    _row("light/size",              at.light_extent),
    _row("light/angle",             at.light_extent,                              DEGREES),
    _row("light/cone",              partial(at.light_property, "spot_size"),      DEGREES),
    _row("light/azimuth",           partial(at.orbit, "azimuth")),
    _row("light/elevation",         partial(at.orbit, "elevation")),
    _row("light/distance",          partial(at.orbit, "distance")),

    _row("world/color",             partial(at.background, "Color", LIGHT),       COLOR),
    _row("world/tint",              partial(at.world_tint, LIGHT),                COLOR),
    _row("world/strength",          partial(at.background, "Strength", LIGHT)),
    _row("world/rotation",          lambda _, world: backgrounds.rotation_slot(world), DEGREES),
    _row("world/backdrop_color",    partial(at.background, "Color", BACKDROP),    COLOR),
    _row("world/backdrop_tint",     partial(at.world_tint, BACKDROP),             COLOR),
    _row("world/backdrop_strength", partial(at.background, "Strength", BACKDROP)),
    _row("world/backdrop_horizon",  at.horizon,                                   COLOR),

    _row("material/base_color",     at.surface_color,                             COLOR),
    _row("material/tint",           partial(at.material_tint, "Tint"),            COLOR),
    _row("material/recolor",        at.recolor),
    _row("material/metallic",       partial(at.shader, "Metallic")),
    _row("material/roughness",      partial(at.shader, "Roughness")),
    _row("material/ior",            partial(at.shader, "IOR")),
    _row("material/specular",       partial(at.shader, "Specular IOR Level")),
    _row("material/specular_tint",  partial(at.shader, "Specular Tint"),          COLOR),
    _row("material/coat",           at.coat_weight),
    _row("material/coat_roughness", at.coat_roughness),
    _row("material/sheen",          partial(at.shader, "Sheen Weight")),
    _row("material/transmission",   partial(at.shader, "Transmission Weight")),
    _row("material/emission_color", partial(at.glow, "Color"),                    COLOR),
    _row("material/emission",       partial(at.glow, "Strength")),

    _row("volume/density",          partial(at.volume, "Density")),
    _row("volume/color",            partial(at.volume, "Color"),                  COLOR),
    _row("volume/anisotropy",       partial(at.volume, "Anisotropy")),
    _row("volume/falloff",          partial(at.volume, "Height Falloff")),
    _row("volume/offset",           partial(at.volume, "Height Offset")),

    _row("film/exposure",           partial(at.view, "exposure")),
    _row("film/gamma",              partial(at.view, "gamma")),
    _row("film/grade_exposure",     partial(graded, "Exposure")),
    _row("film/lift",               partial(graded, "Lift"),                      COLOR),
    _row("film/midtone",            partial(graded, "Midtone"),                   COLOR),
    _row("film/gain",               partial(graded, "Gain"),                      COLOR),
    _row("film/contrast",           partial(graded, "Contrast")),
    _row("film/saturation",         partial(graded, "Saturation")),
    _row("film/hue",                partial(graded, "Hue"),                       DEGREES),
    _row("film/grade_gamma",        partial(graded, "Gamma")),
    _row("film/vignette",           partial(graded, "Vignette")),
    _row("film/glare",              partial(graded, "Glare")),
)
# fmt: on


def slots(
    context: scene_context.SceneContext, groups: Sequence[str] = schema.GROUPS
) -> Iterator[tuple[ParameterBinding, scene_context.Owner, ValueSlot]]:
    """Yields (row, owner, value slot) for every value in the scene, ordered by group, owner and row of `BINDINGS`."""
    for group in groups:
        rows = [b for b in BINDINGS if b.parameter.group == group]
        for owner in scene_context.owners(context, group):
            for row in rows:
                kinds = row.parameter.only
                if kinds and type_of(owner.thing).name not in kinds:
                    continue
                if slot := row.locator(context, owner.thing):
                    yield row, owner, slot


def instances(
    scene: Scene,
    subject: Sequence[Object],
    pivot: Sequence[float],
    groups: Sequence[str] = schema.GROUPS,
    everything: bool = False,
) -> dict[str, schema.Instance]:
    """Key ("film/gamma") -> parameter of the scene, with its value, its owner's role and lock reason ("" if unlocked).

    `pivot` is the center of the subject's bounding box, world space: cameras and lights orbit it. `groups` names the
    schema's groups to read. With `everything`, materials that the camera does not see are included.
    """
    context = scene_context.SceneContext(scene, tuple(subject), Vector(pivot), everything)
    lengths = scene_context.scene_lengths(context)
    by_key = {}
    for row, owner, slot in slots(context, groups):
        reference = {"": 1.0, **lengths, **owner.lengths}[row.parameter.reference]
        value = row.codec.decode(slot.get())
        locked = owner.locked or slot.locked
        instance = schema.Instance(row.parameter, owner.name, value, reference, owner.role, locked)
        by_key[instance.key] = instance
    return by_key


def read(scene: Scene, subject: Sequence[Object], pivot: Sequence[float]) -> dict[str, schema.Values]:
    """Key -> value of each parameter, and of each light link that Vibe Render added; arguments as for `instances`."""
    found = {key: instance.value for key, instance in instances(scene, subject, pivot).items()}
    return found | light_links.read(scene)


def write(scene: Scene, values: _ByKey, subject: Sequence[Object], pivot: Sequence[float]) -> dict[str, str]:
    """Writes values (by key, in the schema's units), recorded in the snapshot; returns key -> reason if not written.

    A missing light of `schema.added_lights` or material copy (`schema.material_copies`) is added if a key names it.
    A backdrop (background for the camera only) is added if its values differ from the world's. An error undoes all.
    Raises VibeError if a value has the wrong number of components, or is NaN or infinite.
    """
    with snapshot.transaction(scene) as journal:
        rest = put(journal, scene, values, subject, pivot)
    rendered.layer(scene).update()
    return rest


@contextmanager
def trial(scene: Scene, values: _ByKey, subject: Sequence[Object], pivot: Sequence[float]) -> Iterator[dict[str, str]]:
    """Writes values as `write` does and yields its result; after the block, the scene is exactly as it was."""
    with snapshot.undone(scene) as journal:
        rest = put(journal, scene, values, subject, pivot)
        rendered.layer(scene).update()
        yield rest


def put(
    journal: Journal, scene: Scene, values: _ByKey, subject: Sequence[Object], pivot: Sequence[float]
) -> dict[str, str]:
    """Writes values and returns the same as `write`, but records in a journal that the caller keeps or undoes."""
    for key, value in values.items():
        group, _, name = schema.split_key(key)
        parameter = schema.FAMILIES.get(f"{group}/{name}")
        fault = "" if all(map(math.isfinite, value)) else f"is not a finite number: {tuple(value)}"
        if parameter and len(value) != parameter.components:
            fault = f"needs {parameter.components} numbers, not {len(value)}"
        if fault:
            raise schema.VibeError(f"{labels.title(key)} {fault}.", "Correct the value.")
    if any(key in backgrounds.WORLD_OF_BACKDROP for key in values):
        world = instances(scene, subject, pivot, ("world",))
        values = backgrounds.with_backdrop(journal, rendered.world(scene), world, values)
    rest = dict.fromkeys(values, "there is nothing of that name in this scene")
    owners = [schema.split_key(key)[:2] for key in values]
    add_lights(journal, scene, {name for group, name in owners if group == "light"}, subject)
    prepare.add_copies(journal, scene, {name for group, name in owners if group == "material"})
    context = scene_context.SceneContext(scene, tuple(subject), Vector(pivot), everything=True)
    for row, owner, slot in list(slots(context)):
        key = row.parameter.key(owner.name)
        if key not in values:
            continue
        rest[key] = owner.locked or slot.locked
        if not rest[key]:
            slot.set(journal, row.codec.encode(tuple(map(float, values[key]))))
    rest |= dict.fromkeys(filter(schema.light_links.link_of, values), "") | light_links.put(journal, scene, values)
    return {key: reason for key, reason in rest.items() if reason}


def add_lights(journal: Journal, scene: Scene, names: Collection[str], subject: Sequence[Object]) -> list[Object]:
    """Adds and returns the missing lights of `ADDED_LIGHTS` in `names`, around the subject (if empty, all meshes)."""
    known = schema.added_lights.ADDED_LIGHTS
    missing = [name for name in known if name in names and name not in scene.objects]
    corners = scene_context.bounds(scene, subject or scene_context.meshes(scene)) if missing else ()
    return [prepare.add_light(journal, scene, name, *corners) for name in missing]
