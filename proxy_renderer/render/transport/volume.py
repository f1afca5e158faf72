# SPDX-License-Identifier: Apache-2.0
"""What the camera sees of the fog: light that scatters once towards it, and what the fog takes away.

The rays of a coarse picture are cut into segments. In each, the light that a lamp sends is averaged analytically
(so a lamp's glow needs no dense samples), and the share that the segment scatters is exact: the transmittance lost
in it. The running sums stand on a small grid over picture and depth, which samples look up by their own depth: the
fog in front of a near subject does not mix with the fog in front of what is behind it.
Cycles with its default of no volume bounces scatters once, too. Vectors are planar, (3, …).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass

import torch
from torch import Tensor
from torch.nn import functional

from ...color.lookup_table import trilinear
from ..geometry.camera import View
from ..geometry.vectors import length
from ..lights.cones import spot_cone, spread
from ..lights.lamps import Lamp
from .fog import Fog

SEGMENTS = 16
COARSE = 8  # pixels of the picture per ray of the coarse one
_SPOT_PARTS = 4  # pieces of a segment in a spot's light, whose cone has an edge
_BULK = 3.0
"""Distance up to which segments are fine, in distances of the subject or of the farthest lamp."""
_WORLD_COARSE = 4  # rays of the coarse picture per ray along which the world's light is summed


def _lebedev() -> Tensor:
    """Lebedev's 14 directions, turned so that their heights are evenly spread: none lies along a floor."""
    d = 3**-0.5
    corners = [[x, y, z] for x in (d, -d) for y in (d, -d) for z in (d, -d)]
    axes = torch.cat((torch.eye(3), -torch.eye(3), torch.tensor(corners))).T
    (c, s), (e, f) = ((math.cos(math.radians(a)), math.sin(math.radians(a))) for a in (21, 15))
    around_z = torch.tensor([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    around_x = torch.tensor([[1, 0, 0], [0, e, -f], [0, f, e]])
    return around_x @ around_z @ axes


DIRECTIONS = _lebedev()
"""(3, 14) unit vectors over which the world's light is summed; the rule is exact to the fifth degree."""
WEIGHTS = torch.tensor([1 / 15] * 6 + [3 / 40] * 8)

Clear = Callable[[Tensor, Tensor, Tensor], Tensor]
"""(origins (3, N), unit directions (3, N), distances (N,)) to (N,): 1 where nothing is in the way (`Geometry.clear`)."""


@dataclass(frozen=True)
class Haze:
    """The fog in front of a camera: running sums along coarse rays, looked up by picture position and distance."""

    _sums: Tensor  # (1, 4, SEGMENTS + 1, rows, columns): scattered light, and optical depth
    _size: tuple[int, int]
    _near: float
    _growth: float
    _bulk: float  # meters up to which the cuts grow; the last one lies at the end
    _end: float

    def look_up(self, place: Tensor, distance: Tensor) -> tuple[Tensor, Tensor]:
        """Fog between the camera and what samples see.

        Args:
            place: (2, N) picture positions in pixels.
            distance: (N,) meters along the ray; infinite for the background.

        Returns:
            Scattered light (3, N), to be added, and transmittance (N,), to be multiplied with before.
        """
        segments, rows, columns = self._sums.shape[2] - 1, *self._sums.shape[3:]
        cut = (torch.log1p(distance / self._near) / math.log(self._growth)).clamp(0, segments - 1)
        whole = cut.detach().floor().clamp_max(segments - 2)
        cut = whole + (self._growth ** (cut - whole) - 1) / (
            self._growth - 1
        )  # linear in meters between cuts
        cut = cut + ((distance - self._bulk) / (self._end - self._bulk)).clamp(0, 1)
        # grid_sample's corners are the centers of the outer cells
        cells = [
            (place[i] * (n / self._size[i]) - 0.5) * (2 / max(n - 1, 1)) - 1
            for i, n in enumerate((columns, rows))
        ]
        at = torch.stack((*cells, cut * (2 / segments) - 1), -1)
        found = trilinear(self._sums, at)
        return found[:3], torch.exp(-found[3])


class Volume:
    """Scatters light in the fog of one scene; keeps the shadows in it until something has moved.

    Args:
        clear: Answers whether nothing stands between points; None for fog without shadows.
    """

    def __init__(self, clear: Clear | None = None) -> None:
        self._clear = clear
        self._kept: dict[str, tuple[Hashable, Tensor]] = {}

    def scatter(self, fog: Fog, view: View, near: float, lamps: Sequence[Lamp], world: Tensor) -> Haze:
        """The haze in front of a camera.

        Args:
            fog: The medium, active.
            view: The camera.
            near: A typical distance of what is seen, meters: up to there the segments are finest.
            lamps: The lights.
            world: (3, 14) blurred radiance of the world from `DIRECTIONS`, or (3, 1) for an even one.
        """
        eye = view.position.detach()
        away = [length(lamp.position.detach() - eye, 0.0) for lamp in lamps if lamp.light.type != "SUN"]
        end = fog.reach(eye)
        bulk = min(0.9 * end, _BULK * max([near, *map(float, away)]))
        growth = (1 + bulk / near) ** (1 / (SEGMENTS - 1))
        cuts = near * (growth ** torch.arange(SEGMENTS + 1, device=eye.device) - 1).view(-1, 1, 1)
        cuts[-1] = end
        rays = Rays.of(view, COARSE, cuts)
        depth = fog.density * fog.thickness(rays.start[:, None], rays.toward[:, None], cuts)
        passing = torch.exp(-depth)  # (SEGMENTS + 1, rows, columns)
        light = self._world_light(fog, Rays.of(view, COARSE * _WORLD_COARSE, cuts), world)
        light = functional.interpolate(light, size=passing.shape[1:], mode="bilinear")
        for lamp in lamps:
            parts = _SPOT_PARTS if lamp.light.type == "SPOT" else 1
            light = light + self.lamp_light(fog, rays, lamp, parts)
        scattered = (light * fog.albedo.view(3, 1, 1, 1) * (passing[:-1] - passing[1:])).cumsum(1)
        sums = torch.cat((functional.pad(scattered, (0, 0, 0, 0, 1, 0)), depth[None]))[None]
        return Haze(sums, view.size, near, growth, bulk, end)

    def lamp_light(self, fog: Fog, rays: Rays, lamp: Lamp, parts: int) -> Tensor:
        """Light (3, S, rows, columns) of a lamp that the S segments would send back along the rays with albedo 1.

        Each segment is looked at in so many parts, suns aside.
        """
        if lamp.light.type == "SUN":
            points = rays.middles
            to_lamp = lamp.axes[:, 2].view(3, 1, 1, 1).expand_as(points)
            distance = torch.full_like(points[0], math.inf)
            strength = torch.ones_like(distance)
        else:
            points, mean_inverse_square = _toward_lamp(rays, lamp, parts)
            offset = lamp.position.view(3, 1, 1, 1) - points
            distance = (offset * offset).sum(0).clamp_min(1e-8).sqrt()
            to_lamp = offset / distance
            strength = _intensity(lamp, to_lamp) * mean_inverse_square
        if lamp.light.shadow:
            signature = rays.signature, lamp.signature()
            clear = lamp.glow.blockers.clear if self._clear and lamp.glow else self._clear
            strength = strength * self._shadow(lamp.light.name, signature, points, to_lamp, distance, clear)
        strength = strength * fog.transmittance(points, to_lamp, distance)
        strength = strength * phase((to_lamp * rays.toward[:, None]).sum(0), fog.anisotropy)
        return strength.unflatten(0, (len(rays.cuts) - 1, -1)).mean(1) * lamp.color.view(3, 1, 1, 1)

    def _world_light(self, fog: Fog, rays: Rays, world: Tensor) -> Tensor:
        """The same for the world."""
        points = rays.middles[:, None]
        directions = DIRECTIONS.to(points).view(3, -1, 1, 1, 1)  # (3, 14, SEGMENTS, rows, columns)
        everywhere = directions.expand(-1, -1, *points.shape[2:])
        far = torch.full_like(everywhere[0], math.inf)
        reaching = fog.transmittance(points, directions, far)
        reaching = reaching * self._shadow(
            "", rays.signature, points.expand_as(everywhere), everywhere, far, self._clear
        )
        lobe = phase((directions[:, :, 0] * rays.toward[:, None]).sum(0), fog.anisotropy)
        lobe = lobe * WEIGHTS.to(points).view(-1, 1, 1)
        lobe = lobe / lobe.sum(0)  # a few directions miss a narrow lobe: keep its energy
        return torch.einsum("cd,dsxy->csxy", world.expand(3, len(WEIGHTS)), reaching * lobe[:, None])

    def _shadow(
        self,
        name: str,
        signature: Hashable,
        points: Tensor,
        toward: Tensor,
        distance: Tensor,
        clear: Clear | None,
    ) -> Tensor:
        """1 where the way is clear, 0 where it is not, shaped like `distance`; traced when the signature changes."""
        if clear is None:
            return torch.ones_like(distance)
        kept = self._kept.get(name)
        if kept is None or kept[0] != signature:
            ways = points.detach().flatten(1), toward.detach().flatten(1), distance.detach().flatten()
            kept = self._kept[name] = (signature, clear(*ways).view(distance.shape))
        return kept[1]


@dataclass(frozen=True)
class Rays:
    """Coarse rays, cut into segments: start and toward (3, rows, columns), cuts (S + 1, …) in meters,
    which may differ from ray to ray."""

    start: Tensor
    toward: Tensor
    cuts: Tensor
    signature: Hashable

    @staticmethod
    def of(view: View, coarse: int, cuts: Tensor) -> Rays:
        """Rays through the centers of blocks of pixels."""
        columns, rows = (max(1, round(n / coarse)) for n in view.size)
        y, x = torch.meshgrid(torch.arange(rows) + 0.5, torch.arange(columns) + 0.5, indexing="ij")
        pixel = torch.stack((x * (view.size[0] / columns), y * (view.size[1] / rows))).flatten(1)
        start, toward = (part.view(3, rows, columns) for part in view.rays(pixel.to(view.position)))
        return Rays(start, toward, cuts, (view.signature(), float(cuts[-1])))

    @property
    def middles(self) -> Tensor:
        """Points (3, SEGMENTS, rows, columns) halfway between the cuts."""
        return self.start[:, None] + self.toward[:, None] * ((self.cuts[1:] + self.cuts[:-1]) / 2)


def _toward_lamp(rays: Rays, lamp: Lamp, parts: int) -> tuple[Tensor, Tensor]:
    """Where segments get the middle of their light (3, S · parts, rows, columns), and their mean of 1 / distance².

    Both are analytic along a straight ray (equiangular sampling: Kulla and Fajardo 2012); parts of a segment
    subtend the same angle at the lamp, and so count the same.
    """
    to_lamp = lamp.position.view(3, 1, 1) - rays.start
    closest = (to_lamp * rays.toward).sum(0)
    aside = (to_lamp * to_lamp).sum(0) - closest * closest
    soft = lamp.size * (0.25 if lamp.light.type == "AREA" else 0.5)  # about what averaging over the lamp does
    aside = (aside.clamp_min(0) + soft * soft + 1e-6).sqrt()
    angle = torch.atan((_lit(rays, lamp) - closest) / aside)[:, None]
    step = angle[1:] - angle[:-1]
    part = (torch.arange(parts, device=aside.device) + 0.5).view(-1, 1, 1) / parts
    middle = closest + aside * torch.tan(angle[:-1] + step * part)
    mean = (step / (aside * (rays.cuts[1:] - rays.cuts[:-1])[:, None]).clamp_min(1e-12)).expand_as(middle)
    return rays.start[:, None] + rays.toward[:, None] * middle.flatten(0, 1), mean.flatten(0, 1)


def _lit(rays: Rays, lamp: Lamp) -> Tensor:
    """The cuts (S + 1, …), those behind an area light moved to its plane: it shines to one side only."""
    if lamp.light.type != "AREA":
        return rays.cuts
    z = lamp.axes[:, 2].view(3, 1, 1)
    before = (z * (lamp.position.view(3, 1, 1) - rays.start)).sum(0)
    slope = (z * rays.toward).sum(0)
    plane = before / torch.where(slope.abs() < 1e-6, 1e-6, slope)
    leaving = slope > 0  # from the lit side to the dark one
    cuts = torch.where(leaving, torch.minimum(rays.cuts, plane), torch.maximum(rays.cuts, plane))
    return cuts


def _intensity(lamp: Lamp, to_lamp: Tensor) -> Tensor:
    """Radiant intensity (…), per unit of the lamp's color, back along unit vectors (3, …) to it."""
    size = lamp.size * lamp.size
    flat = to_lamp.flatten(1)
    if lamp.light.type == "AREA":
        facing = (lamp.axes[:, 2] @ flat).clamp_min(0)
        strength = facing * spread(lamp, facing) * ((1.0 if lamp.light.normalize else lamp.area) / math.pi)
    else:
        strength = (
            (1.0 if lamp.light.normalize else 4 * math.pi * size) / (4 * math.pi) * torch.ones_like(flat[0])
        )
        if lamp.light.type == "SPOT":
            strength = strength * spot_cone(lamp, flat)
        if lamp.glow:
            strength = strength * lamp.glow.toward(-flat)
    return strength.view(to_lamp.shape[1:])


def phase(cosine: Tensor, g: Tensor) -> Tensor:
    """Henyey-Greenstein, 1/sr; `cosine` is 1 where light goes straight on."""
    return (1 - g * g) / (4 * math.pi) * (1 + g * g - 2 * g * cosine).clamp_min(1e-4) ** -1.5
