# SPDX-License-Identifier: Apache-2.0
"""An exported scene as Mitsuba 3 would have it: the same meshes, camera, lights and plain Principled materials.

Mitsuba's `principled` is the closest that it has: its diffuse lobe is Disney's, not Lambert's, and it has no
multiple scattering between microfacets. Textures, fog, glass and environment pictures are not carried over.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from torch import Tensor

from proxy_renderer.render.geometry.camera import view_of
from proxy_renderer.render.lights.light_source import LightSource
from proxy_renderer.render.lights.light_types import LIGHT_TYPES, AreaLight, PointLight, SunLight, light_sources
from proxy_renderer.scene import SceneData
from proxy_renderer.scene.values import RenderValues
from proxy_renderer.schema import VibeError

LEARNED = ("base_color", "roughness", "metallic")
"""Inputs of the subject's material that both renderers differentiate, besides every light and the world."""
DEPTH = 3


def twin(mi: Any, scene: SceneData, size: tuple[int, int]) -> Any:
    """Builds the scene.

    Args:
        mi: The `mitsuba` module, its variant set.
        size: Width and height in pixels.

    Raises:
        VibeError: Something in the scene has no equivalent.
    """
    _refuse(scene)
    settings = RenderValues(scene, {}, "cpu")
    parts: dict[str, Any] = {
        "type": "scene",
        "integrator": {"type": "prb", "max_depth": DEPTH},
        "sensor": _sensor(mi, scene, settings, size),
    }
    for number, lamp in enumerate(light_sources(scene, settings)):
        parts[f"lamp{number}"] = _EMITTERS[type(lamp)](mi, lamp)
    world = settings.color("world/color") * settings.scalar("world/strength", 1.0)
    parts["world"] = {"type": "constant", "radiance": _rgb(world)}
    for number, material in enumerate(scene.materials):
        faces = scene.mesh.material == number
        if faces.any():
            parts[f"mesh{number}"] = _mesh(mi, scene, faces, _surface(material.name, settings))
    return mi.load_dict(parts)


def learned(scene: SceneData) -> list[str]:
    """The keys of the values that both renderers differentiate, in this project's names."""
    subject = next(m.name for m in scene.materials if m.role == "subject")
    lights = [f"light/{light.name}/color" for light in scene.lights]
    return [*(f"material/{subject}/{name}" for name in LEARNED), *lights, "world/color"]


def same(scene: SceneData, parameters: Any) -> list[str]:
    """Mitsuba's names of the values that `learned` names.

    Args:
        parameters: `mi.traverse` of its twin.
    """
    number = next(i for i, m in enumerate(scene.materials) if m.role == "subject")
    wanted = [f"mesh{number}.bsdf.brdf_0.{name}.value" for name in LEARNED]
    ends = ("radiance.value", "irradiance.value", "intensity.value")
    lights = [k for k in parameters.keys() if k.startswith(("lamp", "world")) and k.endswith(ends)]  # noqa: SIM118
    return [*wanted, *lights]


def _refuse(scene: SceneData) -> None:
    odd = [
        *(f"{m.name} has a texture" for m in scene.materials if m.texture),
        *(f"{x.name} is a {x.type.lower()}" for x in scene.lights if LIGHT_TYPES[x.type] not in _EMITTERS),
        *(["the camera is orthographic"] if scene.camera.type != "PERSP" else []),
        *(["the lens is shifted"] if any(scene.camera.shift) else []),
        *(["the world is a picture"] if scene.world.kind != "color" else []),
        *(["there is fog"] if scene.volume.kind != "none" else []),
    ]
    if odd:
        raise VibeError(f"Mitsuba's twin of this scene would differ: {odd[0]}.", "Choose a plainer scene.")


def _sensor(mi: Any, scene: SceneData, settings: RenderValues, size: tuple[int, int]) -> dict[str, Any]:
    view = view_of(scene, settings, size)
    right, up, back = view.rotation.T
    pose = np.eye(4)
    pose[:3] = np.stack([-right, up, -back, view.position], 1)  # Mitsuba's x axis points to the left
    angle = 2 * math.degrees(math.atan(float(view.scale) * view.extent[0] / 2))
    return {
        "type": "perspective",
        "fov": angle,
        "fov_axis": "x",
        "near_clip": view.clip[0],
        "far_clip": view.clip[1],
        "to_world": mi.ScalarTransform4f(pose),
        "film": {
            "type": "hdrfilm",
            "width": size[0],
            "height": size[1],
            "pixel_format": "rgb",
            "component_format": "float32",
            "rfilter": {"type": "gaussian"},
        },
        "sampler": {"type": "independent"},
    }


def _sun(mi: Any, lamp: SunLight) -> dict[str, Any]:
    toward = (-lamp.axes[:, 2]).tolist()
    return {"type": "directional", "direction": toward, "irradiance": _rgb(lamp.color)}


def _sphere(mi: Any, lamp: PointLight) -> dict[str, Any]:
    radius = max(float(lamp.size), 1e-3)
    radiance = lamp.color / (4 * math.pi**2 * radius * radius)
    glow = {"type": "area", "radiance": _rgb(radiance)}
    return {"type": "sphere", "center": lamp.position.tolist(), "radius": radius, "emitter": glow}


def _rectangle(mi: Any, lamp: AreaLight) -> dict[str, Any]:
    across, along = (half[:, 0].numpy() for half in lamp.half_axes())
    pose = np.eye(4)
    # it shines along its normal
    pose[:3] = np.stack([-across, along, -lamp.axes[:, 2].numpy(), lamp.position.numpy()], 1)
    glow = {"type": "area", "radiance": _rgb(lamp.color / (math.pi * lamp.area))}
    return {"type": "rectangle", "to_world": mi.ScalarTransform4f(pose), "emitter": glow}


_EMITTERS: dict[type[LightSource], Callable[[Any, Any], dict[str, Any]]] = {
    SunLight: _sun,
    PointLight: _sphere,
    AreaLight: _rectangle,
}
"""Mitsuba's name of a type of light; scenes with others are refused."""


def _surface(name: str, settings: RenderValues) -> dict[str, Any]:
    def value(entry: str) -> float:
        return float(settings.scalar(f"material/{name}/{entry}"))

    return {
        "type": "twosided",
        "bsdf": {
            "type": "principled",
            "base_color": _rgb(settings.color(f"material/{name}/base_color")),
            "roughness": value("roughness"),
            "metallic": value("metallic"),
            "eta": max(value("ior"), 1.001),
        },
    }


def _mesh(mi: Any, scene: SceneData, faces: np.ndarray, surface: dict[str, Any]) -> Any:
    """The triangles of one material; no corners are shared, as their normals need not be."""
    mesh = scene.mesh
    corners = mesh.vertices[mesh.faces[faces]].reshape(-1, 3)
    properties = mi.Properties()
    properties["mesh_bsdf"] = mi.load_dict(surface)
    shape = mi.Mesh("mesh", len(corners), len(corners) // 3, has_vertex_normals=True, props=properties)
    parameters = mi.traverse(shape)
    parameters["vertex_positions"] = mi.Float(corners.ravel())
    parameters["vertex_normals"] = mi.Float(mesh.normals[faces].ravel())
    parameters["faces"] = mi.UInt32(np.arange(len(corners), dtype=np.uint32))
    parameters.update()
    return shape


def _rgb(color: Tensor) -> dict[str, Any]:
    return {"type": "rgb", "value": color.tolist()}
