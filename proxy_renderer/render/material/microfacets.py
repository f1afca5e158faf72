# SPDX-License-Identifier: Apache-2.0
"""GGX microfacets as a viewer sees them (Heitz, "Sampling the GGX Distribution of Visible Normals", 2018).

Vectors are in the frame of the surface, which the viewer sees along the x-z plane.
"""

from __future__ import annotations

import math

import torch
from torch import Tensor


def visible_normals(cosine: Tensor, alpha: Tensor | float, uv: Tensor) -> Tensor:
    """Unit normals (3, ...) of microfacets, distributed as a viewer sees them.

    Args:
        cosine: (...) of the viewer's angle to the surface's normal, above 0.
        alpha: () or (...) width of the distribution: the roughness squared.
        uv: (2, ...) in [0, 1).
    """
    sine = (1 - cosine * cosine).clamp_min(0.0).sqrt()
    length = ((alpha * sine) ** 2 + cosine * cosine).sqrt()
    x, z = alpha * sine / length, cosine / length
    radius, angle = uv[0].sqrt(), 2 * math.pi * uv[1]
    t1, t2 = radius * angle.cos(), radius * angle.sin()
    t2 = (1 - (1 + z) / 2) * (1 - t1 * t1).clamp_min(0.0).sqrt() + (1 + z) / 2 * t2
    t3 = (1 - t1 * t1 - t2 * t2).clamp_min(0.0).sqrt()
    # The frame of the stretched view is (0, 1, 0), (-z, 0, x) and itself.
    sides = alpha * (t3 * x - t2 * z), alpha * t1, (t3 * z + t2 * x).clamp_min(1e-6)
    normal = torch.stack(torch.broadcast_tensors(*sides))
    return normal / normal.square().sum(0).sqrt()


def mirrored(cosine: Tensor, normal: Tensor) -> tuple[Tensor, Tensor]:
    """Where visible microfacets send the light of the viewer's ray.

    Args:
        cosine: (...) of the viewer's angle to the surface's normal.
        normal: (3, ...) of the microfacets.

    Returns:
        Directions (3, ...), and the cosine (...) of the viewer's angle to the microfacets.
    """
    sine = (1 - cosine * cosine).clamp_min(0.0).sqrt()
    at_half = (sine * normal[0] + cosine * normal[2]).clamp(0.0, 1.0)
    x, y, z = 2 * at_half * normal
    return torch.stack((x - sine, y, z - cosine)), at_half


def unshadowed(cosine: Tensor, alpha: Tensor | float, leaving: Tensor) -> Tensor:
    """Share (...) of the light from visible microfacets that no other facet blocks; 0 below the horizon.

    Args:
        cosine: (...) of the viewer's angle to the surface's normal.
        alpha: () or (...) width of the distribution.
        leaving: (...) cosine of the angle of the light to it.
    """
    masking = (1 + alpha**2 * (1 / (cosine * cosine) - 1)).sqrt()
    shadowing = (1 + alpha**2 * (1 / leaving.clamp(1e-4, 1.0) ** 2 - 1)).sqrt()
    return torch.where(leaving > 0, (1 + masking) / (masking + shadowing), 0.0)
