# SPDX-License-Identifier: Apache-2.0
"""What the camera sees of the fog: light that scatters once towards it, and what the fog takes away.

The rays of a coarse picture are cut into segments. In each, the light that a lamp sends is averaged analytically
(so a lamp's glow needs no dense samples), and the share that the segment scatters is exact: the transmittance lost
in it. The running sums stand on a small grid over picture and depth, which pixels look up by their own depth: the
fog in front of a near subject does not mix with the fog in front of what is behind it.
Cycles with its default of no volume bounces scatters once, too.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import torch
from torch import Tensor
from torch.nn import functional

from .fog import Fog

SEGMENTS = 16
COARSE = 8  # pixels of the picture per ray of the coarse one
_WORLD_COARSE = 4  # rays of the coarse picture per ray along which the world's light is summed

_DIAGONAL = 3**-0.5
DIRECTIONS = torch.tensor(
    [[x, 0, 0] for x in (1.0, -1.0)] + [[0, x, 0] for x in (1.0, -1.0)] + [[0, 0, x] for x in (1.0, -1.0)]
    + [[x, y, z] for x in (_DIAGONAL, -_DIAGONAL) for y in (_DIAGONAL, -_DIAGONAL) for z in (_DIAGONAL, -_DIAGONAL)]
)  # fmt: skip
"""(14, 3) directions over which the world's light is summed: Lebedev's rule, exact to the fifth degree."""
_WEIGHTS = torch.tensor([4 * math.pi / 15] * 6 + [4 * math.pi * 3 / 40] * 8)

Occluded = Callable[[Tensor, Tensor], Tensor]
"""(starts (N, 3), ends (N, 3)) to (N,) floats, 1 where something opaque stands between."""


@dataclass(frozen=True)
class FogLight:
    """A lamp as the fog sees it.

    Attributes:
        kind: POINT, SPOT, AREA or SUN.
        strength: (3,) linear color times the radiant intensity along its axis, W/sr; for SUN the irradiance, W/m².
        position: (3,) metres; ignored for SUN.
        axis: (3,) unit vector that it shines along.
        radius: About half its size, metres.
        spot_size: Full angle of the cone, radians. spot_blend: softness of its edge, 0 to 1.
        shadow: Whether things cast shadows in its light.
    """

    kind: str
    strength: Tensor
    position: Tensor
    axis: Tensor
    radius: float = 0.0
    spot_size: float = math.pi
    spot_blend: float = 0.0
    shadow: bool = True


@dataclass(frozen=True)
class Haze:
    """Running sums along the coarse rays, to be looked up by picture position and distance."""

    _sums: Tensor  # (1, 4, SEGMENTS + 1, rows, columns): scattered light, and optical depth
    _near: float
    _growth: float

    def over(self, radiance: Tensor, distance: Tensor) -> Tensor:
        """The picture through the fog.

        Args:
            radiance: (H, W, 3) linear light of surfaces and background.
            distance: (H, W) metres along the ray to what is seen; inf for the background.
        """
        light, transmittance = self.look_up(distance)
        return radiance * transmittance + light

    def look_up(self, distance: Tensor) -> tuple[Tensor, Tensor]:
        """Scattered light (H, W, 3) in front of `distance` (H, W), and the transmittance (H, W, 1) up to there."""
        height, width = distance.shape
        segments, rows, columns = (n - 1 for n in self._sums.shape[2:])
        place = torch.log1p(distance / self._near) / math.log(self._growth)
        place = place.clamp(0, segments)
        whole = place.detach().floor().clamp_max(segments - 1)
        z = whole + (self._growth ** (place - whole) - 1) / (
            self._growth - 1
        )  # linear in metres between the planes
        y = _centers(height, rows + 1, distance.device)[:, None].expand(height, width)
        x = _centers(width, columns + 1, distance.device)[None, :].expand(height, width)
        at = torch.stack((x, y, z * (2 / segments) - 1), -1)[None, None]
        found = functional.grid_sample(self._sums, at, padding_mode="border", align_corners=True)[0, :, 0]
        return found[:3].permute(1, 2, 0), torch.exp(-found[3])[..., None]


def _centers(pixels: int, cells: int, device: torch.device) -> Tensor:
    """Pixel centres in the coordinates of `grid_sample`, whose corners are the centres of the outer cells."""
    cell = (torch.arange(pixels, device=device) + 0.5) * (cells / pixels) - 0.5
    return cell * (2 / max(cells - 1, 1)) - 1


class Volume:
    """Scatters light in the fog of one scene; keeps the shadows in it until something has moved.

    Args:
        occluded: Answers whether things stand between points; None for fog without shadows.
    """

    def __init__(self, occluded: Occluded | None = None) -> None:
        self._occluded = occluded
        self._kept: dict[object, tuple[Tensor, Tensor]] = {}

    def scatter(
        self,
        fog: Fog,
        origins: Tensor,
        directions: Tensor,
        near: float,
        lights: Sequence[FogLight],
        world: Tensor,
    ) -> Haze:
        """The haze in front of a camera.

        Args:
            fog: The medium, active.
            origins: (H, W, 3) or (3,) where the rays start, metres.
            directions: (H, W, 3) unit vectors of the picture's rays.
            near: A typical distance of what is seen, metres: near it the segments are finest.
            lights: The lamps.
            world: (14, 3) blurred radiance of the world from `DIRECTIONS`, or (1, 3) for an even one.
        """
        rays = functional.normalize(_shrink(directions, COARSE), dim=-1)
        starts = _shrink(origins, COARSE) if origins.dim() > 1 else origins.expand_as(rays)
        end = fog.reach(starts.detach().mean((0, 1)))
        growth = (1 + end / near) ** (1 / SEGMENTS)
        cuts = near * (growth ** torch.arange(SEGMENTS + 1, dtype=rays.dtype, device=rays.device) - 1)
        cuts = cuts[:, None, None]  # (SEGMENTS + 1, 1, 1); below: (SEGMENTS, rows, columns, …)
        depth = fog.density * fog.thickness(starts.expand(SEGMENTS + 1, *rays.shape), cuts[..., None] * rays)
        lost = torch.exp(-depth[:-1]) - torch.exp(-depth[1:])
        light = self._world_light(fog, starts, rays, cuts, world)
        for index, lamp in enumerate(lights):
            light = light + self._lamp_light(fog, starts, rays, cuts, lamp, index)
        scattered = functional.pad((fog.albedo * light * lost[..., None]).cumsum(0), (0, 0, 0, 0, 0, 0, 1, 0))
        sums = torch.cat((scattered, depth[..., None]), -1).permute(3, 0, 1, 2)[None]
        return Haze(sums, near, growth)

    def _lamp_light(
        self, fog: Fog, starts: Tensor, rays: Tensor, cuts: Tensor, lamp: FogLight, index: int
    ) -> Tensor:
        """Light of a lamp that each segment would scatter to the camera, were its albedo 1: (S, rows, columns, 3)."""
        if lamp.kind == "SUN":
            points = starts + rays * ((cuts[:-1] + cuts[1:]) / 2)[..., None]
            towards = -lamp.axis.expand_as(points)
            arriving = fog.escape(points, towards) * lamp.strength
        else:
            to_lamp = lamp.position - starts
            closest = (to_lamp * rays).sum(-1)
            aside = ((to_lamp * to_lamp).sum(-1) - closest**2).clamp_min(0) + lamp.radius**2 + 1e-8
            aside = aside.sqrt()
            angle = torch.atan((cuts - closest) / aside)
            mean_inverse_square = (angle[1:] - angle[:-1]) / (aside * (cuts[1:] - cuts[:-1]))
            middle = closest + aside * torch.tan((angle[1:] + angle[:-1]) / 2)
            points = starts + rays * middle[..., None]
            towards = functional.normalize(lamp.position - points, dim=-1)
            shape = mean_inverse_square * _emission(lamp, -(towards * lamp.axis).sum(-1))
            arriving = (
                fog.transmittance(points, lamp.position.expand_as(points)) * shape[..., None] * lamp.strength
            )
        if lamp.shadow and self._occluded is not None:
            targets = (
                points + towards * (2 * fog.extent) if lamp.kind == "SUN" else lamp.position.expand_as(points)
            )
            arriving = arriving * self._shadow(index, points, targets)
        return arriving * _phase((towards * rays).sum(-1, keepdim=True), fog.anisotropy)

    def _world_light(self, fog: Fog, starts: Tensor, rays: Tensor, cuts: Tensor, world: Tensor) -> Tensor:
        """The same for the world, computed on an even coarser grid: it has no edges."""
        size, coarser = rays.shape[:2], functional.normalize(_shrink(rays, _WORLD_COARSE), dim=-1)
        points = _shrink(starts, _WORLD_COARSE) + coarser * ((cuts[:-1] + cuts[1:]) / 2)[..., None]
        directions, weights = DIRECTIONS.to(rays), _WEIGHTS.to(rays)
        points = points[..., None, :].expand(*points.shape[:-1], len(directions), 3)
        reaching = fog.escape(points, directions.expand_as(points))
        if self._occluded is not None:
            reaching = reaching * self._shadow("world", points, points + directions * (2 * fog.extent))
        phase = _phase(coarser @ directions.T, fog.anisotropy) * weights
        phase = phase / phase.sum(-1, keepdim=True)  # a few directions miss a narrow lobe: keep its energy
        light = (reaching * phase[..., None] * world).sum(-2)
        return functional.interpolate(light.permute(0, 3, 1, 2), size=size, mode="bilinear").permute(
            0, 2, 3, 1
        )

    def _shadow(self, name: object, points: Tensor, targets: Tensor) -> Tensor:
        """Unoccluded share (..., 1) of the way from points to targets, kept while neither has moved noticeably."""
        assert self._occluded is not None
        points, targets = points.detach(), targets.detach()
        where = torch.cat((points.reshape(-1, 3), targets.reshape(-1, 3)))
        kept = self._kept.get(name)
        if (
            kept is None
            or kept[0].shape != where.shape
            or not torch.allclose(kept[0], where, rtol=1e-3, atol=1e-4)
        ):
            open_ = 1 - self._occluded(points.reshape(-1, 3), targets.reshape(-1, 3))
            kept = self._kept[name] = (where, open_.reshape(*points.shape[:-1], 1))
        return kept[1]


def _shrink(field: Tensor, factor: int) -> Tensor:
    """Means of (H, W, C) over blocks of factor × factor pixels."""
    return functional.avg_pool2d(field.permute(2, 0, 1)[None], factor, ceil_mode=True)[0].permute(1, 2, 0)


def _emission(lamp: FogLight, cosine: Tensor) -> Tensor:
    """Emission at an angle to the axis, relative to that along it."""
    if lamp.kind == "AREA":
        return cosine.clamp_min(0)
    if lamp.kind == "SPOT":  # Cycles: kernel/light/spot.h
        edge = math.cos(lamp.spot_size / 2)
        t = ((cosine - edge) / max((1 - edge) * lamp.spot_blend, 1e-3)).clamp(0, 1)
        return t * t * (3 - 2 * t)
    return torch.ones_like(cosine)


def _phase(cosine: Tensor, g: Tensor) -> Tensor:
    """Henyey-Greenstein, 1/sr; `cosine` 1 is light that goes straight on."""
    return (1 - g * g) / (4 * math.pi) * (1 + g * g - 2 * g * cosine).clamp_min(1e-4) ** -1.5


def ambient_transmittance(fog: Fog, points: Tensor, normals: Tensor) -> Tensor:
    """Share (N, 1) of the world's light that fog lets through to surfaces at `points` (N, 3) facing `normals`.

    It takes 14 rays a point: call it for few points, and interpolate.
    """
    directions, weights = DIRECTIONS.to(points), _WEIGHTS.to(points)
    facing = (normals @ directions.T).clamp_min(0) * weights
    start = points[:, None, :].expand(-1, len(directions), 3)
    reaching = fog.escape(start, directions.expand_as(start))[..., 0]
    return ((reaching * facing).sum(-1) / facing.sum(-1).clamp_min(1e-6))[:, None]
