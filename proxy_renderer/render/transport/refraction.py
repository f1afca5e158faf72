# SPDX-License-Identifier: Apache-2.0
"""Rays refracted through glass, and the hits where they end."""

from __future__ import annotations

import torch
from jaxtyping import Float
from torch import Tensor

from ..geometry.directions import above, reflect
from ..geometry.vectors import dot, unit
from ..geometry.visibility import RayGeometry, Surface
from ..material.textures import MaterialTextures
from .secondary_hits import SecondaryHits


def refract(
    toward: Float[Tensor, "3 n"], normal: Float[Tensor, "3 n"], ratio: float
) -> tuple[Float[Tensor, "3 n"], Tensor]:
    """Snell's law.

    Args:
        toward: (3, N) unit directions.
        normal: (3, N) unit normals on the side that the rays come from.
        ratio: IOR before the surface over IOR behind it.

    Returns:
        Unit directions (3, N), reflected where all light is, and where (N,) bool that is.
    """
    cosine = -dot(toward, normal)
    squared = 1 - ratio * ratio * (1 - cosine * cosine)
    bent = unit(toward * ratio + normal * (ratio * cosine - squared.clamp_min(0.0).sqrt()))
    total = squared < 0
    return torch.where(total, reflect(toward, normal), bent), total


_MOST_WALLS = 8
"""Surfaces of glass that a ray is followed through; Cycles' default is twelve."""


def through(
    geometry: RayGeometry,
    surface: Surface,
    toward: Tensor,
    ior: float,
    metals: Tensor,
    lamps: int,
    maps: MaterialTextures,
) -> tuple[SecondaryHits, Tensor]:
    """Follows rays that enter a surface through all walls of the same glass.

    Args:
        toward: (3, N) their unit directions.
        metals: As for `SecondaryHits`.
        lamps: As for `SecondaryHits`.
        maps: As for `SecondaryHits`.

    Returns:
        The hits behind the glass, and the rays' final directions (3, N).
    """
    direction, _ = refract(toward, surface.normal, 1.0 / ior)
    direction = -above(-direction, surface.facet)
    origin = _across(geometry, surface)
    index = torch.arange(toward.shape[1], device=toward.device)
    for _ in range(_MOST_WALLS):
        way, start = direction[:, index], origin[:, index]
        hits = geometry.nearest(start, way, "transmission")
        wall = geometry.surface(hits, way)
        met = hits.hit & (wall.material == surface.material[index])
        if not bool(met.any()):
            break
        leaving = geometry.from_behind(hits, way)
        bent, total = refract(way, wall.normal, ior)
        entered, _ = refract(way, wall.normal, 1.0 / ior)
        bent = torch.where(leaving, bent, entered)
        total = total & leaving
        bent = torch.where(total, above(bent, wall.facet), -above(-bent, wall.facet))
        goes_on = torch.where(total, geometry.lifted(wall), _across(geometry, wall))
        index, bent, goes_on = index[met], bent[:, met], goes_on[:, met]
        direction = direction.index_copy(1, index, bent)
        origin = origin.index_copy(1, index, goes_on)
    return SecondaryHits(geometry, origin, direction, 1, metals, lamps, "transmission", maps), direction


def _across(geometry: RayGeometry, surface: Surface) -> Tensor:
    """Origins (3, N) just behind a surface."""
    return 2 * surface.position - geometry.lifted(surface)
