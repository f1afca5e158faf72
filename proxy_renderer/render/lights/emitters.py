# SPDX-License-Identifier: Apache-2.0
"""Small glowing surfaces as lights: few random rays would hit them, and fog would not scatter their light.

The surface of a material is cut into compact clusters. Each shines like a point with an intensity that depends on the direction:
the area that faces a direction w. It is the sum of a |n.w| / 2 and of a n.w / 2 over areas `a` with normals n that emit to one
side. The second sum is linear in w. The first is approximated by the root of a quadratic form with the same mean, which is exact
for planes, spheres and cylinders.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import ClassVar

import torch
from torch import Tensor

from ...color.tensors import luminance
from ...scene import Light
from ...schema.orbit import IDENTITY
from ..geometry.vectors import cosine_directions, cross, dot, unit
from ..geometry.visibility import RayGeometry, sphere_points
from ..material.inputs import ShadingInputs
from .light_types import PointLight
from .shadows import k_means

_LEAST = 0.25  # luminance from which a surface becomes a light; darker ones are no brighter than lit surfaces
_POINTS = 4096
_COUNTS, _MORE = tuple(range(1, 13)), (16, 24, 32, 48, 64)  # numbers of clusters to try: more for fairy lights
_FINE, _COARSE = 1 / 30, 1 / 10  # cluster's radius over viewing distance: smaller needs no cut; larger is no point
_ROUND = 0.6  # least ratio of a round cluster's smallest variance to its largest


@dataclass(frozen=True)
class EmitterLight(PointLight):
    """A part of a glowing surface, as a point light."""

    form: Tensor  # (3, 3) symmetric: the root of w.form.w is the intensity that unit vectors w and -w share
    lean: Tensor  # (3,) lean.w is added to that intensity along w, and subtracted along -w
    clipped: ClassVar[bool] = True

    def directivity(self, toward: Tensor, radius: Tensor | None = None) -> Tensor:
        """Intensity (N,), 1 on average, in the directions -`toward`; `toward` (3, N) are unit vectors to the light."""
        way = -toward
        even = dot(way, self.form @ way).clamp_min(1e-12).sqrt()
        return (even + self.lean @ way).clamp_min(0.0)


EmitterCluster = tuple[EmitterLight, float]  # light of color 1, and its power if the surface has radiance 1


class Emitters:
    """Point lights that stand for small glowing surfaces, and stay when the emission fades.

    `near` is a typical viewing distance in meters. `clusters`: index of each material that glows or has glowed -> its
    lights; empty if its surface is too large for point lights.
    """

    def __init__(self, geometry: RayGeometry, near: float) -> None:
        self._geometry, self._near = geometry, near
        self.clusters: dict[int, list[EmitterCluster]] = {}

    def notice(self, shading_inputs: Sequence[ShadingInputs]) -> bool:
        """Makes lights for materials that glow for the first time; returns True if there are such materials."""
        others = [m for m in range(len(shading_inputs)) if m not in self.clusters]
        new = {m for m in others if float(luminance(shading_inputs[m].emission.detach())) > _LEAST}
        self._geometry.set_apart(new)
        for material in sorted(new):
            with torch.no_grad():
                self.clusters[material] = clusters_of(self._geometry, material, self._near)
        return bool(new)

    def lamps(self, shading_inputs: Sequence[ShadingInputs]) -> list[EmitterLight]:
        """The lights of all clusters, in the color of their material's emission, differentiable in it."""
        return [
            replace(lamp, color=shading_inputs[material].emission * power)
            for material, clusters in self.clusters.items()
            for lamp, power in clusters
        ]


def clusters_of(geometry: RayGeometry, material: int, near: float) -> list[EmitterCluster]:
    """Cuts a material's surface into clusters; empty if it is too large for points at a distance of `near` meters."""
    triangles = ((geometry.material == material) & geometry.visible_to("diffuse")).nonzero()[:, 0]
    if not len(triangles):
        return []
    place, normal, area = _points(geometry, triangles)
    if not area > 0:
        return []
    outside, inside = (_open(geometry, material, place, side) for side in (normal, -normal))
    scattered = area < float(_radius(place)) ** 2
    for count in _COUNTS + _MORE * scattered:
        label = k_means(place, count)
        groups = [label == k for k in range(count) if bool((label == k).any())]
        size = torch.stack([_radius(place[:, group]) for group in groups])
        blob = torch.stack([_blob(place[:, g], (outside + inside)[g]) for g in groups])
        if bool((blob | (size < _FINE * near)).all()):
            break
    else:
        if float(size.max()) > _COARSE * near:
            return []
    point_area = area / place.shape[1]
    parts = [(place[:, g], normal[:, g], outside[g], inside[g]) for g in groups]
    clusters = [_cluster(*p, point_area, material, k) for k, p in enumerate(parts)]
    return [(lamp, power) for lamp, power in clusters if power > 0]


def _points(geometry: RayGeometry, triangles: Tensor) -> tuple[Tensor, Tensor, float]:
    """Evenly spread points (3, P) on triangles with indices (F,), the triangles' normals (3, P) there, and their total area."""
    a, b, c = (geometry.corners[k, triangles].T for k in range(3))
    double = cross(b - a, c - a)
    areas = double.norm(dim=0) / 2
    step = (torch.arange(_POINTS, device=areas.device) + 0.5) / _POINTS * areas.sum()
    chosen = torch.searchsorted(areas.cumsum(0), step).clamp_max(len(areas) - 1)
    uv = sphere_points(_POINTS, 1, torch.Generator().manual_seed(3))[:, 0].to(areas.device)
    root = uv[0].sqrt()
    place = (1 - root) * a[:, chosen] + root * (1 - uv[1]) * b[:, chosen] + root * uv[1] * c[:, chosen]
    return place, unit(double, 1e-15)[:, chosen], float(areas.sum())


def _open(geometry: RayGeometry, material: int, place: Tensor, side: Tensor) -> Tensor:
    """(P,) 1 if a random ray from `place` towards the hemisphere of `side`, both (3, P), misses the material, or 0."""
    uv = torch.rand((2, place.shape[1]), generator=torch.Generator().manual_seed(4)).to(place.device)
    hits = geometry.nearest(place + side * (1e-5 * geometry.size), cosine_directions(side, uv), "diffuse")
    own = hits.hit & (geometry.material[hits.triangle.clamp_min(0)] == material)
    return (~own).to(place.dtype)


def _radius(place: Tensor) -> Tensor:
    """Root mean square distance () of points (3, n) from their middle."""
    return (place - place.mean(1, keepdim=True)).square().sum(0).mean().sqrt()


def _blob(place: Tensor, sides: Tensor) -> Tensor:
    """True if points (3, n) form a round, closed surface, as a sphere; `sides` (n,) counts each point's open sides."""
    if place.shape[1] < 4:
        return torch.tensor(False, device=place.device)
    spread = torch.linalg.eigvalsh(torch.cov(place))
    return (spread[0] > _ROUND * spread[2]) & (sides.mean() < 1.2)


def _cluster(
    place: Tensor, normal: Tensor, outside: Tensor, inside: Tensor, area: float, material: int, number: int
) -> EmitterCluster:
    """The cluster (light, power) of n points: `place` and `normal` are (3, n), `area` is the area in m² of each point.

    `outside` and `inside` (n,) are 1 where that side of a point is open, else 0; `number` makes the light's name.
    """
    even, odd = (outside + inside) / 2 * area, (outside - inside) / 2 * area
    whole = float(even.sum())
    form = (normal * even) @ normal.T / max(whole, 1e-20)
    # Evenly spread directions, a Fibonacci lattice: the root's mean over them becomes 1.
    index = torch.arange(2048) + 0.5
    z, angle = 1 - index / 1024, index * (math.pi * (3 - math.sqrt(5)))
    radius = (1 - z * z).sqrt()
    around = torch.stack((radius * angle.cos(), radius * angle.sin(), z)).to(place)
    root = (around * (form @ around)).sum(0).clamp_min(0.0).sqrt()
    form = form / root.mean().clamp_min(1e-6).square()
    lean = 2 * (normal * odd).sum(1) / max(whole, 1e-20)
    light = Light(f"emitter/{material}/{number}", "POINT", IDENTITY, (0.0, 0.0, 0.0), soft_falloff=False)
    ones, axes = torch.ones(3, device=place.device), torch.eye(3, device=place.device)
    place_and_form = place.mean(1), axes, _radius(place), form, lean
    return EmitterLight(light, ones, *place_and_form, pictured=True, shadowless=material), 2 * math.pi * whole
