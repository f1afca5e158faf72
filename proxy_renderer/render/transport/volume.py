# SPDX-License-Identifier: Apache-2.0
"""Fog as the camera sees it: in-scattering (single scattering) and transmittance.

The rays of a coarse picture are cut into segments. In each, a light's irradiance is averaged analytically, so that its
glow needs no dense samples, and the scattered share is exact: the transmittance lost in the segment. The running sums
are kept on a grid over picture and depth (froxels), which samples look up by their own depth: fog in front of a near
subject does not mix with fog in front of the background. Cycles, too, scatters once with its default of no volume
bounces. Vectors are planar, (3, …).
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass

import torch
from torch import Tensor
from torch.nn import functional

from ...color.tensors import trilinear
from ..geometry.camera import View
from ..geometry.segments import RaySegments
from ..geometry.vectors import length
from ..lights.types.light_source import LightSource
from .fog import FogMedium

SEGMENTS = 16
COARSE = 8  # pixels of the picture per ray of the coarse one
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

VisibilityTest = Callable[..., Tensor]
"""(origins (3, N), unit directions (3, N), distances (N,)) to (N,): 1 where nothing is in the way (`Geometry.clear`)."""


@dataclass(frozen=True)
class FroxelGrid:
    """In-scattered light and optical depth between the camera and any point, on a grid over picture and depth."""

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
        sums = trilinear(self._sums, at)
        return sums[:3], torch.exp(-sums[3])


class SingleScattering:
    """Single scattering in the fog of one scene; its shadows are cached until something moves.

    Args:
        clear: Visibility between points; None for fog without shadows.
    """

    def __init__(self, clear: VisibilityTest | None = None) -> None:
        self._clear = clear
        self._kept: dict[str, tuple[Hashable, Tensor]] = {}

    def scatter(
        self, fog: FogMedium, view: View, near: float, lamps: Sequence[LightSource], world: Tensor
    ) -> FroxelGrid:
        """The fog in front of a camera.

        Args:
            near: A typical distance of what is seen, meters: up to there the segments are finest.
            world: (3, 14) blurred radiance of the world from `DIRECTIONS`, or (3, 1) for an even one.
        """
        eye = view.position.detach()
        away = [length(lamp.position.detach() - eye, 0.0) for lamp in lamps if not lamp.at_infinity]
        end = fog.reach(eye)
        bulk = min(0.9 * end, _BULK * max([near, *map(float, away)]))
        growth = (1 + bulk / near) ** (1 / (SEGMENTS - 1))
        cuts = near * (growth ** torch.arange(SEGMENTS + 1, device=eye.device) - 1).view(-1, 1, 1)
        cuts[-1] = end
        rays = RaySegments.of(view, COARSE, cuts)
        depth = fog.density * fog.thickness(rays.start[:, None], rays.toward[:, None], cuts)
        passing = torch.exp(-depth)  # (SEGMENTS + 1, rows, columns)
        light = self._world_light(fog, RaySegments.of(view, COARSE * _WORLD_COARSE, cuts), world)
        light = functional.interpolate(light, size=passing.shape[1:], mode="bilinear")
        for lamp in lamps:
            light = light + self.lamp_light(fog, rays, lamp, lamp.segment_parts)
        scattered = (light * fog.albedo.view(3, 1, 1, 1) * (passing[:-1] - passing[1:])).cumsum(1)
        sums = torch.cat((functional.pad(scattered, (0, 0, 0, 0, 1, 0)), depth[None]))[None]
        return FroxelGrid(sums, view.size, near, growth, bulk, end)

    def lamp_light(self, fog: FogMedium, rays: RaySegments, lamp: LightSource, parts: int) -> Tensor:
        """In-scattered light (3, S, rows, columns) of one light in S segments, for an albedo of 1.

        Args:
            parts: In how many parts each segment is looked at, where the type of light needs it.
        """
        direct = lamp.in_scattering(rays, parts)
        strength = direct.irradiance
        if lamp.light.shadow:
            signature = rays.signature, lamp.signature()
            clear = self._clear
            if clear and lamp.shadowless >= 0:
                clear = functools.partial(clear, without=lamp.shadowless)
            ways = direct.points, direct.toward, direct.distance
            strength = strength * self._shadow(lamp.light.name, signature, *ways, clear)
        strength = strength * fog.transmittance(direct.points, direct.toward, direct.distance)
        strength = strength * phase((direct.toward * rays.toward[:, None]).sum(0), fog.anisotropy)
        return strength.unflatten(0, (len(rays.cuts) - 1, -1)).mean(1) * lamp.color.view(3, 1, 1, 1)

    def _world_light(self, fog: FogMedium, rays: RaySegments, world: Tensor) -> Tensor:
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
        clear: VisibilityTest | None,
    ) -> Tensor:
        """Visibility (0 to 1), shaped like `distance`; traced again when the signature changes."""
        if clear is None:
            return torch.ones_like(distance)
        kept = self._kept.get(name)
        if kept is None or kept[0] != signature:
            ways = points.detach().flatten(1), toward.detach().flatten(1), distance.detach().flatten()
            kept = self._kept[name] = (signature, clear(*ways).view(distance.shape))
        return kept[1]


def phase(cosine: Tensor, g: Tensor) -> Tensor:
    """Henyey-Greenstein, 1/sr; `cosine` is 1 where light goes straight on."""
    return (1 - g * g) / (4 * math.pi) * (1 + g * g - 2 * g * cosine).clamp_min(1e-4) ** -1.5
