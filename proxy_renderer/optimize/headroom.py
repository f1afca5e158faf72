# SPDX-License-Identifier: Apache-2.0
"""How far lamps may go, and how large they may get, before they stand in a floor, a ceiling or a wall."""

from __future__ import annotations

import math

import numpy as np
import torch
from torch import Tensor

from ..render.geometry.visibility import RayGeometry
from ..render.lights.types import light_sources, light_type
from ..render.lights.types.area import AreaLight
from ..render.lights.types.light_source import LightSource
from ..scene import Light, SceneData
from ..scene.values import RenderValues

_KEPT = 0.8  # share of the way to a floor or ceiling that a lamp may go: it has a size
_FLAT = 1e-12  # twice the area, seen from above, below which a triangle is a wall


def elevations(scene: SceneData) -> dict[str, tuple[float, float]]:
    """Light -> lowest and highest elevation in degrees; a lamp that is beyond already is the artist's affair."""
    below, above = _heights(scene)
    ranges = {}
    for light in (light for light in scene.lights if not light.fixed):
        limits = _limits(light, scene.pivot, below, above)
        if limits != (-90.0, 90.0):
            ranges[light.name] = limits
    return ranges


@torch.no_grad()
def sizes(scene: SceneData, geometry: RayGeometry) -> dict[str, float]:
    """Key of a lamp's size -> the size at which it meets a surface, meters; no less than it has.

    Args:
        scene: Its lamps are looked at where they stand.
        geometry: The surfaces.
    """
    widest: dict[str, float] = {}
    for lamp in light_sources(scene, RenderValues(scene, {}, geometry.device)):
        key = f"light/{lamp.light.name}/size"
        if lamp.at_infinity or key not in scene.instances:
            continue
        arms = _arms(lamp)
        length = arms.norm(dim=0)
        origin = lamp.position[:, None].expand_as(arms)
        free = geometry.nearest(origin, arms / length, "shadow").distance
        growth = max(float((_KEPT * free / length).min()), 1.0)
        widest[key] = min(widest.get(key, math.inf), growth * scene.value(key)[0])
    return widest


def _arms(lamp: LightSource) -> Tensor:
    """(3, n) from the middle of a lamp to its outline."""
    if isinstance(lamp, AreaLight):
        u, v = lamp.half_axes()
        half = torch.cat((u, v, u + v, u - v), 1)
    else:
        half = torch.eye(3, device=lamp.position.device) * lamp.size
    return torch.cat((half, -half), 1)


def _limits(
    light: Light, pivot: tuple[float, float, float], below: float, above: float
) -> tuple[float, float]:
    offset = np.subtract(light.position, pivot)
    distance = float(np.linalg.norm(offset))
    if light_type(light.type).at_infinity:
        return (0.0 if math.isfinite(below) else -90.0), 90.0
    if distance == 0:
        return -90.0, 90.0
    low, high = (math.degrees(math.asin(min(_KEPT * h / distance, 1.0))) for h in (below, above))
    return -low if -below < offset[2] else -90.0, high if offset[2] < above else 90.0


def _heights(scene: SceneData) -> tuple[float, float]:
    """Distances from the pivot straight down and up to the surroundings; infinite where there are none."""
    mesh, pivot = scene.mesh, np.array(scene.pivot)
    around = ~np.array([o.subject for o in scene.objects])[mesh.object]
    corners = mesh.vertices[mesh.faces[around]].astype(float) - pivot
    a, b, c = corners[:, :, :2].transpose(1, 0, 2)
    areas = np.stack([_cross(b, c), _cross(c, a), _cross(a, b)], 1)
    total = areas.sum(1, keepdims=True)
    hit = (np.abs(total[:, 0]) > _FLAT) & ((areas * np.sign(total)).min(1) >= 0)
    heights = (areas[hit] / total[hit] * corners[hit, :, 2]).sum(1)
    below, above = -heights[heights < 0], heights[heights > 0]
    return float(below.min(initial=math.inf)), float(above.min(initial=math.inf))


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Twice the signed area of triangles (0, a, b) in the plane."""
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
