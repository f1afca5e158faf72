# SPDX-License-Identifier: Apache-2.0
"""The fog as a participating medium, with analytic transmittance.

Extinction σ(x) = density · exp(−falloff · max(0, z − base − offset)), gray, inside an axis-aligned box or everywhere.
Vectors are planar, (3, …), as in all shading code.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import torch
from jaxtyping import Float
from torch import Tensor

from ...scene import SceneData
from ...scene.values import RenderValues, wanted

_EVERYWHERE = 1.0e3
"""Diameter of an infinite fog in sizes of the box: farther away it counts no more."""


class FogMedium:
    """The scene's fog with one set of values.

    Attributes:
        density: () extinction below the height where it thins, 1/m.
        albedo: (3,) share of the extinguished light that is scattered.
        anisotropy: () Henyey-Greenstein g.
        extent: Length that crosses all of it, meters.
    """

    def __init__(self, scene: SceneData, settings: RenderValues) -> None:
        spec = scene.volume
        self.density = settings.scalar("volume/density")
        self.albedo = settings.color("volume/color", 0.8)
        self.anisotropy = settings.scalar("volume/anisotropy")
        self._falloff = settings.scalar("volume/falloff")
        self._top = spec.base + settings.scalar("volume/offset")
        self._thins = self._falloff.requires_grad or bool(self._falloff > 0)
        center, half = (torch.tensor(v, device=settings.device) for v in (spec.center, spec.half_size))
        self._box = None if spec.kind == "world" else (center - half, center + half)
        self.extent = float(2 * half.norm()) * (1 if self._box else _EVERYWHERE)

    @property
    def active(self) -> bool:
        """Whether there is fog, or its density is being learned."""
        return self.density.requires_grad or bool(self.density > 0)

    @property
    def shape(self) -> tuple[float, ...] | None:
        """Numbers that `thickness` depends on; None while they are learned."""
        if not self._thins:
            return ()
        return None if wanted(self._falloff, self._top) else (float(self._falloff), float(self._top))

    def reach(self, origin: Tensor) -> float:
        """Distance in meters from `origin` (3,) beyond which fog is ignored."""
        if self._box is None:
            return self.extent
        low, high = self._box
        return float(torch.maximum((origin - low).abs(), (origin - high).abs()).norm())

    def transmittance(
        self,
        start: Float[Tensor, "3 *#n"],
        toward: Float[Tensor, "3 *#n"],
        distance: Float[Tensor, "*#n"] | float,
    ) -> Float[Tensor, "*n"]:
        """Share of light (…) that gets through.

        Args:
            start: (3, …) meters.
            toward: (3, …) unit vectors.
            distance: (…) meters; infinite for suns and the world.
        """
        return torch.exp(-self.density * self.thickness(start, toward, distance))

    def thickness(
        self,
        start: Float[Tensor, "3 *#n"],
        toward: Float[Tensor, "3 *#n"],
        distance: Float[Tensor, "*#n"] | float,
    ) -> Float[Tensor, "*n"]:
        """Optical depth over density, in meters (…); arguments as for `transmittance`."""
        first, last = self._inside(start, toward, distance)
        length = last - first
        if not self._thins:
            return length
        height = start[2] - self._top
        return length * self._mean_dilution(height + toward[2] * first, height + toward[2] * last)

    def _inside(self, start: Tensor, toward: Tensor, distance: Tensor | float) -> tuple[Tensor, Tensor]:
        """The part of the way that is in the fog: distances (…) of its ends, first ≤ last."""
        limit = torch.as_tensor(distance, dtype=start.dtype, device=start.device)
        limit = torch.broadcast_tensors(limit, start[0], toward[0])[0]
        if self._box is None:
            return torch.zeros_like(limit), limit.clamp_max(self.extent)
        near, far = torch.zeros_like(limit), limit
        for axis in range(3):
            slope = torch.where(toward[axis].abs() < 1e-9, 1e-9, toward[axis])
            one = (self._box[0][axis] - start[axis]) / slope
            two = (self._box[1][axis] - start[axis]) / slope
            near = torch.maximum(near, torch.minimum(one, two))
            far = torch.minimum(far, torch.maximum(one, two))
        far = far.clamp_min(0)
        return torch.minimum(near, far), far

    def _mean_dilution(self, a: Tensor, b: Tensor) -> Tensor:
        """Mean of exp(−falloff · max(0, h)) for heights h from `a` to `b`."""
        rise = b - a
        level = rise.abs() <= 1e-3 * (a.abs() + b.abs())
        slope = (self._below(b) - self._below(a)) / torch.where(level, 1.0, rise)
        return torch.where(level, torch.exp(-self._falloff * ((a + b) / 2).clamp_min(0)), slope)

    def _below(self, height: Tensor) -> Tensor:
        """∫ exp(−falloff · max(0, h)) dh up to `height`, from the height where the fog starts to thin."""
        x = self._falloff * height.clamp_min(0)
        thin = x < 1e-3
        safe = torch.where(thin, 1.0, x)
        share = torch.where(thin, 1 - x / 2, -torch.expm1(-safe) / safe)
        return torch.where(height > 0, height * share, height)


@dataclass(frozen=True)
class LightPaths:
    """Segments through one scene's fog, as `FogMedium.transmittance` takes them; their thickness is cached."""

    start: Float[Tensor, "3 *#n"]
    toward: Float[Tensor, "3 *#n"]
    distance: Float[Tensor, "*#n"]
    _measured: dict[tuple[float, ...], Tensor] = field(default_factory=dict, repr=False, compare=False)

    def transmittance(self, fog: FogMedium) -> Float[Tensor, "*n"]:
        """Share of light (…) that gets through."""
        shape = fog.shape
        if shape is None or wanted(self.start, self.toward, self.distance):
            return fog.transmittance(self.start, self.toward, self.distance)
        if shape not in self._measured:
            self._measured.clear()
            self._measured[shape] = fog.thickness(self.start, self.toward, self.distance)
        return torch.exp(-fog.density * self._measured[shape])
