# SPDX-License-Identifier: Apache-2.0
"""Directions of secondary rays."""

from __future__ import annotations

import math

import torch
from torch import Tensor

from .vectors import dot, tangents, unit


def reflect(toward: Tensor, normal: Tensor) -> Tensor:
    """Mirror directions (3, N) of rays (3, N) at unit normals (3, N)."""
    return toward - normal * (2 * dot(toward, normal))


def above(toward: Tensor, facet: Tensor) -> Tensor:
    """Lifts directions (3, N) that would enter the surface to just above it."""
    cosine = dot(toward, facet)
    return unit(toward + facet * (0.01 - cosine).clamp_min(0.0))


def cosine_directions(normal: Tensor, uv: Tensor) -> Tensor:
    """Cosine-distributed directions (3, N) around unit normals (3, N) from points (2, N) in [0, 1)^2."""
    radius, angle = uv[0].sqrt(), 2 * math.pi * uv[1]
    across, up = tangents(normal)
    return across * (radius * angle.cos()) + up * (radius * angle.sin()) + normal * (1 - uv[0]).sqrt()


def texels(height: int, width: int, device: torch.device) -> tuple[Tensor, Tensor]:
    """Directions (3, T) of an equirectangular picture's texels, bottom row first, and solid angles (T,)."""
    v = (torch.arange(height, device=device) + 0.5) / height
    u = (torch.arange(width, device=device) + 0.5) / width
    elevation, angle = torch.meshgrid((v - 0.5) * math.pi, (0.5 - u) * 2 * math.pi, indexing="ij")
    flat = elevation.cos()
    toward = torch.stack((flat * angle.cos(), flat * angle.sin(), elevation.sin())).flatten(1)
    return toward, flat.flatten() * (math.pi / height) * (2 * math.pi / width)
