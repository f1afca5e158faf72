# SPDX-License-Identifier: Apache-2.0
"""What is seen through glass: rays refracted in and out once, then shaded where they end."""

from __future__ import annotations

import torch
from torch import Tensor

from .directions import above, reflect
from .far import Far
from .vectors import dot, unit
from .visibility import Geometry, Surface


def refract(toward: Tensor, normal: Tensor, ratio: float) -> tuple[Tensor, Tensor]:
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


def through(
    geometry: Geometry, surface: Surface, toward: Tensor, ior: float, metals: Tensor, lamps: int
) -> tuple[Far, Tensor]:
    """Follows rays (3, N) that enter a surface: the far hits, and their final directions (3, N).

    A ray leaves at the next surface if that is seen from behind; total reflection is followed once.
    """
    inward, _ = refract(toward, surface.normal, 1.0 / ior)
    inward = -above(-inward, surface.facet)
    below = surface.position - surface.facet * (geometry.lifted(surface) - surface.position).abs().amax(0)
    hits = geometry.nearest(below, inward)
    exit_ = geometry.surface(hits, inward)
    outward, total = refract(inward, exit_.normal, ior)
    outward = torch.where(total, above(outward, exit_.facet), above(outward, -exit_.facet))
    leaves = hits.hit & (exit_.material == surface.material) & geometry.from_behind(hits, inward)
    shift = (geometry.lifted(exit_) - exit_.position) * torch.where(total, 1.0, -1.0)
    origin = torch.where(leaves, exit_.position + shift, below)
    direction = torch.where(leaves, outward, inward)
    return Far(geometry, origin, direction, 1, metals, lamps), direction
