# SPDX-License-Identifier: Apache-2.0
"""What lights that stand somewhere have in common, whatever their shape."""

from __future__ import annotations

import math
from collections.abc import Callable

import torch
from torch import Tensor

from ...geometry.segments import RaySegments
from ...geometry.vectors import dot, tangents
from .light_source import SegmentLight


def offsets(position: Tensor, points: Tensor) -> tuple[Tensor, Tensor, Tensor]:
    """From points (3, N) to a place (3,): unit vectors (3, N), distances (N,) in meters, and their squares (N,)."""
    offset = position[:, None] - points
    squared = dot(offset, offset).clamp_min(1e-8)
    distance = squared.sqrt()
    return offset / distance, distance, squared


def disc_offsets(toward: Tensor, solid_angle: Tensor, uv: Tensor) -> Tensor:
    """Offsets (3, N) over a disc of a solid angle (N,) at distance 1 that faces a point, from its middle."""
    radius, angle = uv[0].sqrt(), 2 * math.pi * uv[1]
    x, y = radius * angle.cos(), radius * angle.sin()
    across, up = tangents(toward)
    return (across * x + up * y) * (solid_angle / math.pi).sqrt()


def clipped_sphere(cosine: Tensor, share: Tensor) -> Tensor:
    """Cosine-weighted part of a sphere above the horizon, relative to the unclipped vector flux.

    Args:
        cosine: (N,) of the angle between the normal and the sphere's middle.
        share: (N,) squared sine of the sphere's angular radius.

    Returns:
        (N,) the cosine where the sphere is fully above the horizon, 0 where it is below, in between a smooth blend
        that meets both ends with the right slope (Hill and Heitz, "Real-Time Area Lighting", 2016).
    """
    sine = share.clamp_min(1e-8).sqrt()
    t = (cosine / sine).clamp(-1.0, 1.0)
    partial = sine * (1 + t) * (1 + t) / 4
    return torch.where(cosine > sine, cosine, partial)


def equiangular(
    segments: RaySegments,
    position: Tensor,
    softness: Tensor,
    back: Tensor | None,
    parts: int,
    intensity: Callable[[Tensor], Tensor],
) -> SegmentLight:
    """Light of a place along rays, analytically (equiangular sampling: Kulla and Fajardo 2012).

    Parts of a segment subtend the same angle at the light, and so count the same.

    Args:
        position: (3,) of the light.
        softness: () meters by which the light is at least off the ray: about what averaging over its size does.
        back: (3,) unit vector away from where a flat light shines; None for one that shines to all sides.
        parts: In how many parts each segment is looked at.
        intensity: Radiant intensity (n,) back along unit vectors (3, n) to the light.
    """
    to_light = position.view(3, 1, 1) - segments.start
    closest = (to_light * segments.toward).sum(0)
    aside = (to_light * to_light).sum(0) - closest * closest
    aside = (aside.clamp_min(0) + softness * softness + 1e-6).sqrt()
    cuts = segments.cuts if back is None else _lit_cuts(segments, position, back)
    angle = torch.atan((cuts - closest) / aside)[:, None]
    step = angle[1:] - angle[:-1]
    part = (torch.arange(parts, device=aside.device) + 0.5).view(-1, 1, 1) / parts
    middle = closest + aside * torch.tan(angle[:-1] + step * part)
    spans = (segments.cuts[1:] - segments.cuts[:-1])[:, None]
    mean_inverse_square = (step / (aside * spans).clamp_min(1e-12)).expand_as(middle).flatten(0, 1)
    points = segments.start[:, None] + segments.toward[:, None] * middle.flatten(0, 1)
    offset = position.view(3, 1, 1, 1) - points
    distance = (offset * offset).sum(0).clamp_min(1e-8).sqrt()
    toward = offset / distance
    strength = intensity(toward.flatten(1)).view(distance.shape) * mean_inverse_square
    return SegmentLight(points, toward, distance, strength)


def _lit_cuts(segments: RaySegments, position: Tensor, back: Tensor) -> Tensor:
    """The segments' ends (S + 1, …), those behind a flat light moved to its plane: it shines to one side only."""
    z = back.view(3, 1, 1)
    before = (z * (position.view(3, 1, 1) - segments.start)).sum(0)
    slope = (z * segments.toward).sum(0)
    plane = before / torch.where(slope.abs() < 1e-6, 1e-6, slope)
    leaving = slope > 0  # from the lit side to the dark one
    return torch.where(leaving, torch.minimum(segments.cuts, plane), torch.maximum(segments.cuts, plane))
