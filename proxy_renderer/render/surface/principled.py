# SPDX-License-Identifier: Apache-2.0
"""The Principled BSDF in layers, weighted as in Cycles (kernel/svm/closure.h): sheen, coat, metal, glass, dielectric.

All samples of one material are shaded together, so the material's inputs are scalars and small vectors that broadcast.
Lobes whose weight is a constant zero are skipped.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import torch
from jaxtyping import Float
from torch import Tensor

from ..geometry.vectors import within
from ..lights.area_specular import AreaSpecular
from ..material import albedo
from ..material.inputs import ShadingInputs, used

_FAINT = 1e-4  # reflectance seen head on below which the dielectric layer fades out


def shade(inputs: ShadingInputs, light: IncidentLight, texture: Float[Tensor, "3 n"] | None) -> Float[Tensor, "3 n"]:
    """Radiance (3, N) that the material sends to the viewer; `texture` is its linked base color, None for none."""
    base = inputs.colored(texture)
    clamped = within(base, 0.0, 1.0)
    result, weight = torch.zeros_like(light.irradiance), torch.ones((), device=base.device)
    if inputs.uses("sheen", light.view):
        fuzz, weight = sheen(inputs, light)
        result = result + fuzz
    if inputs.uses("coat", light.view):
        gloss, left = coat(inputs, light)
        result, weight = result + gloss * weight, weight * left
    emission = inputs.emission
    if inputs.uses("emission", light.view):
        result = result + (emission if emission.dim() > 1 else emission[:, None]) * weight
    reflections = light.reflected.at(inputs.roughness)
    lobes = [h.lobe(inputs.roughness) for h in light.highlights]
    single = inputs.seen("single", light.view, lambda: single_scattering(inputs.roughness, light.view))
    if inputs.uses("metallic", light.view):
        layer = inputs.seen("metal", light.view, lambda: _metal(inputs, light.view, clamped, single))
        metal = layer.reflected(light, lobes, reflections)
        result, weight = result + metal * (weight * inputs.metallic), weight * (1 - inputs.metallic)
    if inputs.seen("is no metal", light.view, lambda: used(1 - inputs.metallic)):
        if inputs.uses("transmission", light.view):
            glass = _glass(inputs, light, clamped, lobes, reflections, single[0])
            result = result + glass * (weight * inputs.transmission)
            weight = weight * (1 - inputs.transmission)
        layer = inputs.seen("dielectric", light.view, lambda: _dielectric(inputs, light.view, single))
        diffuse = base * light.irradiance * (layer.left / math.pi)
        result = result + (layer.reflected(light, lobes, reflections) + diffuse) * weight
    return result


class _Layer(NamedTuple):
    """The terms of a reflecting layer that depend on the view, not on light."""

    e: Tensor  # (N,) single-scattering albedo without Fresnel
    f0: Tensor  # (3, 1 or N) reflectance seen head on
    curve: Tensor  # (7,) coefficients of (F - f0) / (1 - f0), Fresnel's rise over the cosine at the half vector
    reflectance: Tensor  # (3, N) or (N,) for light from the surroundings
    boost: Tensor  # (3, N) or (N,) factor for light that bounces between microfacets
    left: Tensor  # (3, N) or (N,) share of light that reaches the layers below; 1 for a metal, which has none
    edge: Tensor | None = None  # (3, 1 or N) weight of the F82 term that tints a metal's edge

    def reflected(self, light: IncidentLight, lobes: Sequence[Tensor], reflections: Tensor) -> Tensor:
        """Reflected radiance (3, N): of lights, one lobe (N,) each, and of the surroundings, from `reflections`."""
        direct = specular(light, lobes, self.curve, self.f0)
        if self.edge is not None:
            curve = albedo.edge_curve().to(self.e.device)
            bent = [lobe * (curve @ h.curve) for lobe, h in zip(lobes, light.highlights, strict=True)]
            direct = direct - self.edge * summed(light.lamps, bent)
        return (reflections * self.reflectance * self.e + direct) * self.boost


def _metal(inputs: ShadingInputs, view: Tensor, base: Tensor, single: tuple[Tensor, Tensor]) -> _Layer:
    """F82-tint metal with multiple scattering (Kutz et al. 2021); `single` is from `single_scattering`."""
    e, mean = single
    f5 = (6 / 7) ** 5
    tint = within(inputs.specular_tint, 0.0, 1.0)[:, None]
    b = (base + (1 - base) * f5) * (7 / (f5 * 6 / 7)) * (1 - tint)
    fss = base + (1 - base) / 21 - b / 126
    many = multiple_scattering(fss, mean)
    curve = torch.tensor(albedo.SCHLICK_CURVE, device=e.device)
    reflectance, edge = base + (1 - base) * albedo.weigh(albedo.over_roughness("schlick", inputs.roughness), view), None
    if used(1 - tint):
        edge = b
        reflectance = reflectance - b * albedo.weigh(albedo.over_roughness("edge", inputs.roughness), view)
    boost = 1 + many * ((1 - e) / e)
    return _Layer(e, base, curve, reflectance.clamp_min(0.0), boost, torch.ones_like(mean), edge)


def _dielectric(inputs: ShadingInputs, view: Tensor, single: tuple[Tensor, Tensor]) -> _Layer:
    e, mean = single
    f0 = albedo.f0_of(inputs.ior) * 2 * inputs.specular
    root = f0.clamp(1e-5, 0.95).sqrt()
    ior = (1 + root) / (1 - root)
    tinted = within(f0 * inputs.specular_tint, 0.0, 1.0)[:, None]
    straight = ((ior - 1) / (ior + 1)) ** 2
    average = (ior - 1) / (4.08567 + 1.00071 * ior)
    s = ((average - straight) / (1 - straight)).clamp(0.0, 1.0)
    many = multiple_scattering(tinted + (1 - tinted) * s, mean)
    # An IOR of 1 reflects nothing; next to it the curves are too steep for their tables.
    present = (f0.detach() / _FAINT).clamp_max(1.0)
    share = albedo.weigh(albedo.dielectric_share(inputs.roughness, ior), view).clamp(0.0, 1.0) * present
    curve = albedo.over_ior("curve", ior) * present
    strongest = tinted.amax()
    boost = 1 + many.amax() * ((1 - e) / e)
    left = 1 - (strongest + (1 - strongest) * share) * (e * boost)
    return _Layer(e, tinted, curve, tinted + (1 - tinted) * share, boost, left)


def _glass(
    inputs: ShadingInputs, light: IncidentLight, base: Tensor, lobes: Sequence[Tensor], reflections: Tensor, e: Tensor
) -> Tensor:
    """Radiance (3, N) of solid glass, approximated by Fresnel reflection and the light along one refracted ray."""
    ior = inputs.ior.clamp_min(1.0001)
    f0 = albedo.f0_of(ior) * within(inputs.specular_tint, 0.0, 1.0)[:, None]
    share = albedo.weigh(albedo.dielectric_share(inputs.roughness, ior), light.view).clamp(0.0, 1.0)
    reflectance = f0 + (1 - f0) * share
    direct = specular(light, lobes, albedo.over_ior("curve", ior), f0)
    behind = light.behind if light.behind is not None else reflections
    # Rough glass blurs what is behind it. One ray shows no blur: mix towards the diffuse light instead.
    behind = torch.lerp(behind, light.reflected.images[-1], inputs.roughness)
    return reflections * reflectance + direct / e + behind * base * (1 - reflectance)


def coat(inputs: ShadingInputs, light: IncidentLight) -> tuple[Float[Tensor, "3 n"], Float[Tensor, "*tinted n"]]:
    """Reflected radiance (3, N) of the coat, and the share (N,) or (3, N) of light that reaches the layers below."""
    layer = inputs.seen("coat", light.view, lambda: _coat(inputs, light))
    lobes = [h.lobe(inputs.coat_roughness) for h in light.highlights]
    return layer.reflected(light, lobes, light.reflected.at(inputs.coat_roughness)), layer.left


def _coat(inputs: ShadingInputs, light: IncidentLight) -> _Layer:
    e, mean = single_scattering(inputs.coat_roughness, light.view)
    ior = torch.tensor(inputs.coat_ior, device=e.device).clamp_min(1.0001)
    f0 = albedo.f0_of(ior)
    many = multiple_scattering((ior - 1) / (4.08567 + 1.00071 * ior), mean)
    share = albedo.weigh(albedo.dielectric_share(inputs.coat_roughness, ior), light.view).clamp(0.0, 1.0)
    reflectance = f0 + (1 - f0) * share
    boost = (1 + many * ((1 - e) / e)) * inputs.coat
    left = 1 - reflectance * e * boost
    if any(t != 1.0 for t in inputs.coat_tint):
        # Transmittance (3, N) of a colored coat: Beer's law along the refracted ray.
        tint, cosine = light.view.new_tensor(inputs.coat_tint).clamp_min(1e-4)[:, None], 1 - light.view[1]
        depth = (1 - (1 - cosine * cosine) / inputs.coat_ior**2).clamp_min(1e-4).rsqrt()
        left = left * (1 - inputs.coat * (1 - tint**depth))
    return _Layer(e, f0.expand(3, 1), albedo.over_ior("curve", ior), reflectance, boost, left)


_SHEEN = (
    (0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000),
    (0.6327, 0.0591, 0.0020, 0.0002, 0.0001, 0.0000, 0.0000, 0.0000, 0.0000),
    (0.6979, 0.3177, 0.1022, 0.0268, 0.0073, 0.0025, 0.0010, 0.0005, 0.0003),
    (0.6964, 0.4489, 0.2573, 0.1307, 0.0621, 0.0284, 0.0134, 0.0064, 0.0039),
    (0.6937, 0.5210, 0.3715, 0.2469, 0.1572, 0.0969, 0.0582, 0.0340, 0.0221),
    (0.6977, 0.5711, 0.4552, 0.3480, 0.2590, 0.1895, 0.1356, 0.0954, 0.0718),
    (0.7098, 0.6141, 0.5221, 0.4335, 0.3542, 0.2871, 0.2315, 0.1853, 0.1559),
    (0.7311, 0.6541, 0.5787, 0.5044, 0.4373, 0.3795, 0.3300, 0.2882, 0.2604),
    (0.7497, 0.6829, 0.6155, 0.5503, 0.4919, 0.4421, 0.4000, 0.3652, 0.3419),
)
"""Albedo of Cycles' microfiber sheen: 9 rows for roughness from 0 to 1, 9 columns for the cosine from 0 to 1."""


def sheen(inputs: ShadingInputs, light: IncidentLight) -> tuple[Float[Tensor, "3 n"], Float[Tensor, " n"]]:
    """Radiance (3, N) of microfiber sheen, lit as if diffuse, and the share (N,) of light that reaches layers below."""
    table = light.view.new_tensor(_SHEEN)
    place = inputs.sheen_roughness * 8
    low = min(int(place), 7)
    row = torch.lerp(table[low], table[low + 1], place - low)
    nodes = albedo.basis(torch.linspace(0, 1, 9, dtype=row.dtype, device=row.device)[1:])
    amount = (torch.linalg.pinv(nodes.T) @ row[1:] @ light.view).clamp(0.0, 1.0) * inputs.sheen
    tint = light.view.new_tensor(inputs.sheen_tint)[:, None]
    return tint * (light.irradiance * (amount / math.pi)), 1 - amount * float(tint.max())


@dataclass(frozen=True)
class IncidentLight:
    """All light that arrives at N samples of one material."""

    irradiance: Float[Tensor, "3 n"]  # (3, N) shadowed, direct and bounced
    lamps: Float[Tensor, "lamps 3"]  # (L, 3) colors of the lights in `highlights`
    highlights: Sequence[AreaSpecular]  # one per light, shadowed
    view: Float[Tensor, "7 n"]  # (7, N) albedo basis at the viewing cosine
    reflected: ReflectedRadiance  # radiance around the mirror direction
    behind: Float[Tensor, "3 n"] | None  # (3, N) radiance seen through the surface; None if it is opaque


@dataclass(frozen=True)
class ReflectedRadiance:
    """Radiance around the mirror direction for any roughness."""

    knots: tuple[float, ...]  # roughness of each image, increasing
    images: Sequence[Float[Tensor, "3 n"]]  # for each knot, radiance (3, N) that a surface of this roughness reflects
    glow: ReflectedRadiance | None = None  # radiance of glowing surfaces, added, with its own knots

    def at(self, roughness: Float[Tensor, "*varying"]) -> Float[Tensor, "3 n"]:
        """Radiance (3, N) for one roughness () or many (N,), interpolated between the two nearest knots."""
        if roughness.dim():
            radiance = self.images[0]
            for low, high, image in zip(self.knots, self.knots[1:], self.images[1:], strict=False):
                radiance = torch.lerp(radiance, image, ((roughness - low) / (high - low)).clamp(0.0, 1.0))
        else:
            r = float(roughness.detach())
            i = max(k for k, knot in enumerate(self.knots[:-1]) if knot <= r or k == 0)
            t = (roughness - self.knots[i]) / (self.knots[i + 1] - self.knots[i])
            radiance = torch.lerp(self.images[i], self.images[i + 1], t)
        return radiance if self.glow is None else radiance + self.glow.at(roughness)


def single_scattering(
    roughness: Float[Tensor, "*varying"], view: Float[Tensor, "7 n"]
) -> tuple[Float[Tensor, " n"], Float[Tensor, "*varying"]]:
    """Single-scattering albedo (N,) without Fresnel, and its cosine-weighted mean, () or (N,) as the roughness."""
    energy, mean = (albedo.over_roughness(name, roughness) for name in ("energy", "mean"))
    return albedo.weigh(energy, view).clamp(0.05, 1.0), mean.clamp(0.05, 1.0)


def multiple_scattering(fss: Float[Tensor, "*#n"], mean: Float[Tensor, "*#n"]) -> Float[Tensor, "*n"]:
    """Fresnel factor of light that bounces between microfacets (Kulla and Conty 2017, appendix).

    `fss` is the mean Fresnel reflectance, `mean` the mean single-scattering albedo.
    """
    return fss * mean / (1 - fss * (1 - mean))


def summed(lamps: Float[Tensor, "lamps 3"], lobes: Sequence[Float[Tensor, " n"]]) -> Float[Tensor, "*light"]:
    """Sum (3, N) over lights of lobe (N,) times color, a row of `lamps` (L, 3); 0 without lights."""
    if not lobes:
        return lamps.new_zeros(())
    if len(lobes) == 1:
        return lamps[0][:, None] * lobes[0]
    return lamps.T @ torch.stack(list(lobes))


def specular(
    light: IncidentLight, lobes: Sequence[Float[Tensor, " n"]], curve: Float[Tensor, " 7"], f0: Float[Tensor, "3 f0"]
) -> Float[Tensor, "3 n"]:
    """Sum (3, N) of highlights, one lobe (N,) per light, with Fresnel mix(f0, 1, curve at the half vector)."""
    plain, pairs = summed(light.lamps, lobes), zip(lobes, light.highlights, strict=True)
    bent = summed(light.lamps, [lobe * (curve @ h.curve).clamp_min(0.0) for lobe, h in pairs])
    return f0 * plain + (1.0 - f0) * bent
