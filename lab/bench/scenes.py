# SPDX-License-Identifier: Apache-2.0
"""Scenes for measurements, made from spheres: as many materials, lamps and triangles as are wanted."""

from __future__ import annotations

import importlib.util
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import trimesh

from proxy_renderer.render.lights.light_types import LIGHT_TYPES
from proxy_renderer.scene import (
    Camera,
    FilmSettings,
    FogBounds,
    Light,
    Material,
    MeshObject,
    SceneData,
    SceneMesh,
    WorldData,
)
from proxy_renderer.schema import PARAMETERS, Instance, VibeError, orbit

_IDENTITY = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
_PIVOT = (0.0, 0.0, 1.0)
_LENGTHS = {"light_distance": 4.0, "light_distance_squared": 16.0, "view_distance": 6.0}
_KINDS = tuple(LIGHT_TYPES)


def balls(materials: int, lamps: int, subdivisions: int = 4) -> SceneData:
    """Balls side by side on a floor; the last material is the floor's, unless it is the only one.

    Args:
        materials: How many; one ball each, and the floor.
        lamps: How many, in turn of each type.
        subdivisions: Each ball has 20 * 4^subdivisions triangles.
    """
    count = max(1, materials - 1)
    names = [f"Ball {i}" for i in range(count)] + (["Floor"] if materials > 1 else [])
    return SceneData(
        folder=Path(),
        resolution=(512, 512),
        pixel_aspect=1.0,
        pivot=_PIVOT,
        references=dict(_LENGTHS),
        camera=Camera("Camera", "PERSP", _IDENTITY, 6.0, (0.0, 0.0), "AUTO", (0.01, 1000.0)),
        lights=tuple(_light(i) for i in range(lamps)),
        materials=tuple(Material(n, "subject" if n != "Floor" else "surroundings") for n in names),
        objects=tuple(MeshObject(n, n != "Floor") for n in (*names[:count], "Floor")),
        world=WorldData("color"),
        volume=FogBounds("none", (0.0, 0.0, 3.0), (8.0, 8.0, 4.0), 0.0),
        film=FilmSettings(blender_colors(), "sRGB", "AgX", "", False, "Linear Rec.709"),
        mesh=_mesh(count, materials > 1, subdivisions),
        instances={i.key: i for i in _instances(names, lamps)},
    )


def outdoors(materials: int, lamps: int, density: float = 0.04) -> SceneData:
    """The same under a picture of the sky with a sun in it, in fog.

    Args:
        materials: As for `balls`.
        lamps: As for `balls`.
        density: Extinction of the fog, 1/m.
    """
    scene = balls(materials, lamps)
    values = {"world/strength": 1.0, "world/rotation": 0.0, "world/tint": 1.0, "volume/density": density}
    kept = {key: i for key, i in scene.instances.items() if key not in values and key != "world/color"}
    changed = (Instance(p, "", (values[p.family],) * p.components) for p in PARAMETERS if p.family in values)
    return replace(
        scene,
        world=WorldData("environment", sky_picture()),
        volume=FogBounds("box", (0.0, 0.0, 3.0), (9.0, 9.0, 4.0), 0.0),
        instances={**kept, **{i.key: i for i in changed}},
    )


def sky_picture(height: int = 256) -> np.ndarray:
    """(height, 2 * height, 3) radiance of a blue sky over dark ground, with a sun; bottom row first."""
    elevation = (np.arange(height) + 0.5) / height * math.pi - math.pi / 2
    azimuth = (np.arange(2 * height) + 0.5) / height * math.pi - math.pi
    up = np.sin(elevation)[:, None, None]
    sky = np.array([0.25, 0.4, 0.8]) * up + np.array([0.8, 0.8, 0.7]) * (1 - up)
    picture = np.where(up > 0, sky, [0.12, 0.1, 0.08]) * np.ones((1, 2 * height, 1))
    to_sun = np.sin(0.7) * np.sin(elevation)[:, None] + np.cos(0.7) * np.outer(np.cos(elevation), np.cos(azimuth))
    picture += 400.0 * (to_sun > math.cos(math.radians(2.0)))[..., None]
    return picture.astype(np.float32)


def blender_colors() -> str:
    """Blender's OCIO configuration, as it comes with the bpy package.

    Raises:
        VibeError: If bpy is not installed.
    """
    spec = importlib.util.find_spec("bpy")
    for place in (spec.submodule_search_locations or []) if spec else []:
        for config in Path(place).glob("*/datafiles/colormanagement/config.ocio"):
            return str(config)
    raise VibeError("Blender's color management was not found.", "Install it with `pip install bpy`.")


def _light(index: int) -> Light:
    azimuth, elevation = _angles(index)
    toward = orbit.direction(azimuth, elevation)
    x, y, z = (p + 4.0 * t for p, t in zip(_PIVOT, toward, strict=True))
    return Light(f"Lamp {index}", _KINDS[index % len(_KINDS)], _IDENTITY, (x, y, z))


def _angles(index: int) -> tuple[float, float]:
    return -40.0 + 95.0 * index, 45.0


def _mesh(count: int, own_floor: bool, subdivisions: int) -> SceneMesh:
    ball = trimesh.creation.icosphere(subdivisions)
    radius = 1.0 if count == 1 else 2.2 / count
    places = [((2 * i + 1 - count) * radius, 0.0, radius) for i in range(count)]
    vertices = [np.asarray(ball.vertices) * radius + p for p in places]
    size = len(ball.vertices)
    faces = [np.asarray(ball.faces) + i * size for i in range(count)]
    normals = [np.asarray(ball.vertices)[ball.faces]] * count
    floor = np.array([[-9, -9, 0], [9, -9, 0], [9, 9, 0], [-9, 9, 0]], np.float64)
    vertices.append(floor)
    faces.append(np.array([[0, 1, 2], [0, 2, 3]]) + count * size)
    normals.append(np.tile([0.0, 0.0, 1.0], (2, 3, 1)))
    objects = np.repeat(np.arange(count + 1), [len(f) for f in faces])
    total = len(objects)
    return SceneMesh(
        vertices=np.concatenate(vertices).astype(np.float32),
        faces=np.concatenate(faces).astype(np.int32),
        normals=np.concatenate(normals).astype(np.float32),
        uvs=np.zeros((total, 3, 2), np.float32),
        material=(objects if own_floor else objects * 0).astype(np.int32),
        object=objects.astype(np.int32),
    )


def _instances(materials: list[str], lamps: int) -> list[Instance]:
    owners = {
        "light": [(f"Lamp {i}", _KINDS[i % len(_KINDS)]) for i in range(lamps)],
        "material": [(name, "") for name in materials],
    }
    rows = []
    for p in PARAMETERS:
        if p.name in ("tint", "recolor", "rotation") or p.name.startswith("backdrop"):
            continue
        for i, (owner, kind) in enumerate(owners.get(p.group, [("", "")])):
            if not p.only or kind in p.only:
                rows.append(Instance(p, owner, _value(p, i), _LENGTHS.get(p.reference, 1.0)))
    return rows


def _value(p, index: int) -> tuple[float, ...]:
    azimuth, elevation = _angles(index)
    values = {
        "camera/distance": 6.0,
        "camera/elevation": 12.0,
        "light/azimuth": azimuth,
        "light/elevation": elevation,
        "light/distance": 4.0,
        "light/power": 200.0,
        "light/size": 0.5,
        "world/strength": 0.3,
        "world/color": 0.5,
    }
    if p.family == "material/base_color":
        return tuple(0.5 + 0.4 * math.sin(1.0 + index + 2.0 * c) for c in range(3))
    if p.family == "material/roughness":
        return (0.25 + 0.5 * (index % 4) / 3,)
    return (values.get(p.family, p.default),) * p.components
