# SPDX-License-Identifier: Apache-2.0
"""Soft shadows: a few rays per sample to points on the lamp, smoothed where the surface is smooth."""

from __future__ import annotations

import math

import torch
from torch import Tensor

from .lights import Arrival, Lamp, outline
from .samples import Samples
from .vectors import dot
from .visibility import Geometry, Surface, sphere_points

_MOST_RAYS = 4
_SHARP = 1e-3
"""Solid angle below which one ray is enough."""


def shadow(
    geometry: Geometry, samples: Samples, surface: Surface, lamp: Lamp, arriving: Arrival, moving: bool
) -> Tensor:
    """Share (N,) of a lamp that every surface sample sees.

    Args:
        geometry: The triangles.
        samples: The samples of the view.
        surface: Their surface.
        lamp: The lamp, detached.
        arriving: What it sends, unshadowed.
        moving: Whether the lamp is being moved by a gradient loop: fewer rays then, more smoothing.
    """
    count = len(surface.material)
    if not lamp.light.shadow:
        return torch.ones(count, device=surface.position.device)
    solid = float(arriving.solid_angle.max()) if count else 0.0
    rays = 1 if solid < _SHARP else (2 if moving else _MOST_RAYS)
    facing, reached = dot(surface.facet, arriving.toward) > 0, arriving.frontal > 0
    # Out of a spot's cone nothing is in shadow: smoothing would carry that over the cone's rim.
    seen, lit = (facing & ~reached).to(torch.float32), facing & reached
    index = lit.nonzero()[:, 0]
    origin = geometry.lifted(surface)[:, index]
    spots = sphere_points(rays, count, torch.Generator().manual_seed(11)).to(seen.device)[:, index]
    part = arriving.toward[:, index], arriving.distance[index], arriving.solid_angle[index]
    total = torch.zeros(len(index), device=seen.device)
    for k in range(rays):
        toward, distance = outline(lamp, *part, spots[:, :, k])
        total += geometry.clear(origin, toward, distance * (1 - 1e-4))
    seen[index] = total / rays
    return _smoothed(samples, surface, seen, radius=1 if rays == 1 else 2)


def _smoothed(samples: Samples, surface: Surface, seen: Tensor, radius: int) -> Tensor:
    """A cross-bilateral box filter over the picture: neighbors on the same smooth surface share rays."""
    width, height = samples.size
    first, n = samples.first, samples.surfaces
    grid = torch.zeros((5, width * height), device=seen.device)
    inside = first < n
    chosen = first[inside]
    fields = torch.cat((surface.normal, samples.hits.distance[None, :n], seen[None]))
    grid[:, inside] = fields[:, chosen]
    grid = grid.view(5, height, width)
    normal, depth, value = grid[:3], grid[3], grid[4]
    total, weight = value.clone(), torch.ones_like(value)
    for dy in range(-radius, radius + 1):
        for dx in range(-radius, radius + 1):
            if dx or dy:
                _add_neighbor(normal, depth, value, total, weight, dy, dx)
    flat = (total / weight).flatten()
    smooth = seen.clone()
    plain = chosen[samples.weight[chosen] > 0.999]
    smooth[plain] = flat[samples.pixel[plain]]
    return smooth


def _add_neighbor(
    normal: Tensor, depth: Tensor, value: Tensor, total: Tensor, weight: Tensor, dy: int, dx: int
) -> None:
    height, width = value.shape
    to = slice(max(0, -dy), min(height, height - dy)), slice(max(0, -dx), min(width, width - dx))
    of = slice(max(0, dy), min(height, height + dy)), slice(max(0, dx), min(width, width + dx))
    alike = dot(normal[:, to[0], to[1]], normal[:, of[0], of[1]]) > 0.95
    near = (depth[to] - depth[of]).abs() < depth[to] * (8.0 * math.hypot(dx, dy) / max(width, height))
    same = (alike & near).to(value.dtype)
    total[to] += value[of] * same
    weight[to] += same
