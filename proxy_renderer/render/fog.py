# SPDX-License-Identifier: Apache-2.0
"""The fog as a medium: how much light gets through it, analytically.

Extinction σ(x) = density · exp(−falloff · max(0, z − base − offset)), grey, inside an axis-aligned box or everywhere.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Protocol

import torch
from torch import Tensor

from ..schema import FAMILIES

FAR = 1.0e3
"""How far away an infinite fog still counts, in scene sizes."""


class VolumeSpec(Protocol):
    """Where the fog is: `scene.volume` of an exported scene."""

    kind: str
    center: Sequence[float]
    half_size: Sequence[float]
    base: float


class Fog:
    """The scene's fog with one set of values.

    Args:
        spec: Its domain: kind "world" is infinite, "box" and "none" are the box (which "none" does not fill yet).
        values: "volume/…" to (1,) or (3,) in Blender's units; what is missing has the schema's default.
        device: Where points will be.

    Attributes:
        density: (1,) extinction below the height where it thins, 1/m.
        albedo: (3,) share of the extinguished light that is scattered.
        anisotropy: (1,) Henyey-Greenstein g.
        active: False when there is no fog and nothing learns its density: then skip it.
    """

    def __init__(self, spec: VolumeSpec, values: Mapping[str, Tensor], device: str = "cpu") -> None:
        def value(name: str) -> Tensor:
            key = f"volume/{name}"
            return values[key] if key in values else torch.full((1,), FAMILIES[key].default, device=device)

        self.density, self.albedo, self.anisotropy = value("density"), value("color"), value("anisotropy")
        self._falloff, self._top = value("falloff"), spec.base + value("offset")
        self._thins = self._falloff.requires_grad or bool(self._falloff > 0)
        center = torch.as_tensor(spec.center, dtype=torch.float32, device=device)
        half = torch.as_tensor(spec.half_size, dtype=torch.float32, device=device)
        self._box = None if spec.kind == "world" else (center - half, center + half)
        self.extent = float(2 * half.norm())
        self.active = self.density.requires_grad or bool(self.density > 0)

    def reach(self, origin: Tensor) -> float:
        """Distance from `origin` (3,) beyond which there is no fog (or none that counts), in metres."""
        if self._box is None:
            return FAR * self.extent
        low, high = self._box
        return float(torch.maximum((origin - low).abs(), (origin - high).abs()).norm())

    def transmittance(self, start: Tensor, end: Tensor) -> Tensor:
        """Share of light (..., 1) that gets from `start` (..., 3) to `end` (..., 3)."""
        return torch.exp(-self.density * self.thickness(start, end - start))[..., None]

    def escape(self, start: Tensor, direction: Tensor) -> Tensor:
        """Share of light (..., 1) that gets from `start` out of the fog along unit `direction`: suns and the world."""
        far = FAR * self.extent if self._box is None else self.extent
        return torch.exp(-self.density * self.thickness(start, direction * far))[..., None]

    def thickness(self, start: Tensor, delta: Tensor) -> Tensor:
        """Metres of undiluted fog (...) on the way from `start` (..., 3) to `start + delta`."""
        first, last = self._inside(start, delta)
        length = delta.norm(dim=-1) * (last - first)
        if not self._thins:
            return length
        low = start[..., 2] - self._top
        return length * self._mean_dilution(low + delta[..., 2] * first, low + delta[..., 2] * last)

    def _inside(self, start: Tensor, delta: Tensor) -> tuple[Tensor, Tensor]:
        """The part of the way that is in the box, as fractions (first, last) in [0, 1], first ≤ last."""
        if self._box is None:
            return delta.new_zeros(()), delta.new_ones(())
        safe = torch.where(delta.abs() < 1e-9, torch.full_like(delta, 1e-9), delta)
        one, two = (self._box[0] - start) / safe, (self._box[1] - start) / safe
        first = torch.minimum(one, two).amax(-1).clamp(0, 1)
        last = torch.maximum(one, two).amin(-1).clamp(0, 1)
        return first, torch.maximum(first, last)

    def _mean_dilution(self, a: Tensor, b: Tensor) -> Tensor:
        """Mean of exp(−falloff · max(0, h)) for heights h from `a` to `b`."""
        rise = b - a
        level = rise.abs() <= 1e-3 * (a.abs() + b.abs())
        slope = (self._below(b) - self._below(a)) / torch.where(level, torch.ones_like(rise), rise)
        return torch.where(level, torch.exp(-self._falloff * ((a + b) / 2).clamp_min(0)), slope)

    def _below(self, height: Tensor) -> Tensor:
        """∫ exp(−falloff · max(0, h)) dh up to `height`, from the height where the fog starts to thin."""
        x = self._falloff * height.clamp_min(0)
        thin = x < 1e-3
        safe = torch.where(thin, torch.ones_like(x), x)
        share = torch.where(thin, 1 - x / 2, -torch.expm1(-safe) / safe)
        return torch.where(height > 0, height * share, height)
