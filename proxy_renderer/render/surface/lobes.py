# SPDX-License-Identifier: Apache-2.0
"""Incident light, and the GGX reflection that all layers of a surface share."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import torch
from jaxtyping import Float
from torch import Tensor

from ..lights.area_specular import AreaSpecular
from ..material import albedo


@dataclass(frozen=True)
class IncidentLight:
    """Everything that arrives at N samples of one material.

    Attributes:
        irradiance: (3, N) shadowed, direct and bounced.
        lamps: (L, 3) colors of the lamps in `highlights`.
        highlights: One per lamp, shadowed.
        view: (7, N) albedo basis at the viewing cosine.
        reflected: Radiance around the mirror direction.
        behind: (3, N) radiance seen through the surface, None where nothing is transparent.
    """

    irradiance: Float[Tensor, "3 n"]
    lamps: Float[Tensor, "lamps 3"]
    highlights: Sequence[AreaSpecular]
    view: Float[Tensor, "7 n"]
    reflected: ReflectedRadiance
    behind: Float[Tensor, "3 n"] | None


@dataclass(frozen=True)
class ReflectedRadiance:
    """Radiance around the mirror direction for any roughness.

    Attributes:
        knots: Increasing roughness.
        images: Radiance (3, N) that a surface of each knot's roughness reflects.
        glow: What is added to it, with knots of its own; None for nothing.
    """

    knots: tuple[float, ...]
    images: Sequence[Float[Tensor, "3 n"]]
    glow: ReflectedRadiance | None = None

    def at(self, roughness: Float[Tensor, "*varying"]) -> Float[Tensor, "3 n"]:
        """Radiance (3, N) between the two nearest knots of one roughness () or of many (N,)."""
        radiance = self._varying(roughness) if roughness.dim() else self._even(roughness)
        return radiance if self.glow is None else radiance + self.glow.at(roughness)

    def _even(self, roughness: Tensor) -> Tensor:
        r = float(roughness.detach())
        i = max(k for k, knot in enumerate(self.knots[:-1]) if knot <= r or k == 0)
        t = (roughness - self.knots[i]) / (self.knots[i + 1] - self.knots[i])
        return torch.lerp(self.images[i], self.images[i + 1], t)

    def _varying(self, roughness: Tensor) -> Tensor:
        result = self.images[0]
        for low, high, image in zip(self.knots, self.knots[1:], self.images[1:], strict=False):
            result = torch.lerp(result, image, ((roughness - low) / (high - low)).clamp(0.0, 1.0))
        return result


def single_scattering(
    roughness: Float[Tensor, "*varying"], view: Float[Tensor, "7 n"]
) -> tuple[Float[Tensor, " n"], Float[Tensor, "*varying"]]:
    """Single-scattering albedo (N,) without Fresnel, and its mean ()."""
    coefficients, mean = albedo.energy(roughness)
    return albedo.weigh(coefficients, view).clamp(0.05, 1.0), mean.clamp(0.05, 1.0)


def multiple_scattering(fss: Float[Tensor, "*#n"], mean: Float[Tensor, "*#n"]) -> Float[Tensor, "*n"]:
    """Fresnel factor of light that bounces between microfacets (Kulla and Conty 2017, appendix)."""
    return fss * mean / (1 - fss * (1 - mean))


def summed(lamps: Float[Tensor, "lamps 3"], lobes: Sequence[Float[Tensor, " n"]]) -> Float[Tensor, "*light"]:
    """Lobes (N,) of all lamps times their colors (L, 3): (3, N), or 0 without lamps."""
    if not lobes:
        return lamps.new_zeros(())
    if len(lobes) == 1:
        return lamps[0][:, None] * lobes[0]
    return lamps.T @ torch.stack(list(lobes))


def specular(
    lamps: Float[Tensor, "lamps 3"],
    highlights: Sequence[AreaSpecular],
    lobes: Sequence[Float[Tensor, " n"]],
    curve: Float[Tensor, " 7"],
    f0: Float[Tensor, "3 f0"],
    f90: Tensor | float,
) -> Float[Tensor, "3 n"]:
    """Highlights (3, N) with Fresnel mix(f0, f90, curve at the half vector); f0 is (3, 1) or (3, N)."""
    plain = summed(lamps, lobes)
    bent = summed(
        lamps, [lobe * (curve @ h.curve).clamp_min(0.0) for lobe, h in zip(lobes, highlights, strict=True)]
    )
    return f0 * plain + (f90 - f0) * bent
