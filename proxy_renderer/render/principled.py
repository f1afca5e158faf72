# SPDX-License-Identifier: Apache-2.0
"""The Principled BSDF, layer by layer as Cycles weighs them (kernel/svm/closure.h).

All samples of one material are shaded together, so its parameters are scalars and small vectors that
broadcast; lobes whose weight is a constant zero are skipped.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import torch
from torch import Tensor

from ..scene import Material
from . import albedo
from .color import luma
from .highlight import Highlight
from .settings import Settings, wanted
from .vectors import within


@dataclass(frozen=True)
class Paint:
    """A material's values in one render: scalars () and colors (3,)."""

    base: Tensor
    metallic: Tensor
    roughness: Tensor
    ior: Tensor
    specular: Tensor
    specular_tint: Tensor
    coat: Tensor
    coat_roughness: Tensor
    coat_ior: float
    coat_tint: tuple[float, ...]
    sheen: Tensor
    sheen_tint: tuple[float, ...]
    sheen_roughness: float
    transmission: Tensor
    emission: Tensor
    recolor: Tensor | None

    def colored(self, texture: Tensor | None) -> Tensor:
        """Base color (3, 1), or (3, N) where a texture (3, N) is linked."""
        if texture is None:
            return self.base[:, None]
        if self.recolor is not None and used(self.recolor):
            grey = luma(texture.T).T
            texture = texture + (grey - texture) * self.recolor
        return texture * self.base[:, None]


def paint_of(material: Material, settings: Settings) -> Paint:
    """The values of one material."""
    key = f"material/{material.name}/"
    constants = material.constants
    textured = material.texture is not None
    base = settings.color(key + ("tint" if textured else "base_color"), 1.0 if textured else 0.8)
    glow = settings.color(key + "emission_color", 1.0) * settings.scalar(key + "emission")

    def unit(name: str, default: float) -> Tensor:
        return within(settings.scalar(key + name, default), 0.0, 1.0)

    return Paint(
        base=within(base, 0.0, math.inf),
        metallic=unit("metallic", 0.0),
        roughness=unit("roughness", 0.5),
        ior=within(settings.scalar(key + "ior", 1.5), 1.0, 10.0),
        specular=within(settings.scalar(key + "specular", 0.5), 0.0, math.inf),
        specular_tint=within(settings.color(key + "specular_tint", 1.0), 0.0, math.inf),
        coat=unit("coat", 0.0),
        coat_roughness=unit("coat_roughness", 0.03),
        coat_ior=max(float(constants.get("coat_ior", 1.5)), 1.0),
        coat_tint=tuple(constants.get("coat_tint", (1.0, 1.0, 1.0))),
        sheen=unit("sheen", 0.0),
        sheen_tint=tuple(constants.get("sheen_tint", (1.0, 1.0, 1.0))),
        sheen_roughness=float(constants.get("sheen_roughness", 0.5)),
        transmission=unit("transmission", 0.0),
        emission=glow,
        recolor=settings.scalar(key + "recolor") if textured else None,
    )


def used(weight: Tensor) -> bool:
    """Whether a lobe can matter: its weight is not zero, or somebody wants its gradient."""
    return wanted(weight) or bool((weight != 0).any())


@dataclass(frozen=True)
class Light:
    """Everything that arrives at N samples of one material.

    Attributes:
        irradiance: (3, N) shadowed, direct and bounced.
        lamps: (L, 3) colors of the lamps in `highlights`.
        highlights: One per lamp, shadowed.
        view: (7, N) albedo basis at the viewing cosine.
        mirror: (3, N) radiance of the mirror image.
        glossy: (3, N) radiance around the mirror direction, blurred.
        behind: (3, N) radiance seen through the surface, None where nothing is transparent.
    """

    irradiance: Tensor
    lamps: Tensor
    highlights: Sequence[Highlight]
    view: Tensor
    reflected: Reflected
    behind: Tensor | None


@dataclass(frozen=True)
class Reflected:
    """Radiance around the mirror direction for any roughness.

    Attributes:
        knots: Increasing roughness.
        images: For every knot the radiance (3, N) that a surface so rough reflects.
    """

    knots: tuple[float, ...]
    images: Sequence[Tensor]

    def at(self, roughness: Tensor) -> Tensor:
        """Radiance (3, N) between the two nearest knots."""
        r = float(roughness.detach())
        i = max(k for k, knot in enumerate(self.knots[:-1]) if knot <= r or k == 0)
        t = (roughness - self.knots[i]) / (self.knots[i + 1] - self.knots[i])
        return torch.lerp(self.images[i], self.images[i + 1], t)


def shade(paint: Paint, light: Light, texture: Tensor | None) -> Tensor:
    """Outgoing radiance (3, N) towards the viewer."""
    base = paint.colored(texture)
    clamped = within(base, 0.0, 1.0)
    result, weight = torch.zeros_like(light.irradiance), torch.ones((), device=base.device)
    if used(paint.sheen):
        glow, weight = _sheen(paint, light)
        result = result + glow
    if used(paint.coat):
        gloss, left = _coat(paint, light)
        result, weight = result + gloss * weight, weight * left
    if used(paint.emission):
        result = result + paint.emission[:, None] * weight
    reflections = light.reflected.at(paint.roughness)
    lobes = [h.lobe(paint.roughness) for h in light.highlights]
    missing = _missing(paint.roughness, light.view)
    if used(paint.metallic):
        metal = _metal(paint, light, clamped, lobes, reflections, missing)
        result, weight = result + metal * (weight * paint.metallic), weight * (1 - paint.metallic)
    if wanted(paint.metallic) or bool(paint.metallic < 1):
        if used(paint.transmission):
            glass = _glass(paint, light, clamped, lobes, reflections, missing)
            result, weight = result + glass * (weight * paint.transmission), weight * (1 - paint.transmission)
        plastic, left = _dielectric(paint, light, lobes, reflections, missing)
        diffuse = base * light.irradiance * (left / math.pi)
        result = result + (plastic + diffuse) * weight
    return result


def _missing(roughness: Tensor, view: Tensor) -> tuple[Tensor, Tensor]:
    """Single-scattering albedo (N,) without Fresnel, and its mean ()."""
    coefficients, mean = albedo.energy(roughness)
    return (coefficients @ view).clamp(0.05, 1.0), mean.clamp(0.05, 1.0)


def _multiple(fss: Tensor, mean: Tensor) -> Tensor:
    """Fresnel factor of light that bounces between microfacets (Kulla and Conty 2017, appendix)."""
    return fss * mean / (1 - fss * (1 - mean))


def _summed(lamps: Tensor, lobes: Sequence[Tensor]) -> Tensor | None:
    """Lobes (N,) of all lamps times their colors (L, 3): (3, N)."""
    if not lobes:
        return None
    if len(lobes) == 1:
        return lamps[0][:, None] * lobes[0]
    return lamps.T @ torch.stack(list(lobes))


def _specular(
    lamps: Tensor,
    highlights: Sequence[Highlight],
    lobes: Sequence[Tensor],
    curve: Tensor,
    f0: Tensor,
    f90: Tensor | float,
) -> Tensor:
    """Highlights (3, N) with Fresnel mix(f0, f90, curve at the half vector); f0 is (3, 1) or (3, N)."""
    plain = _summed(lamps, lobes)
    if plain is None:
        return torch.zeros((), device=f0.device)
    bent = _summed(lamps, [lobe * (curve @ h.curve).clamp_min(0.0) for lobe, h in zip(lobes, highlights, strict=True)])
    return f0 * plain + (f90 - f0) * bent


def _metal(
    paint: Paint,
    light: Light,
    base: Tensor,
    lobes: Sequence[Tensor],
    reflections: Tensor,
    missing: tuple[Tensor, Tensor],
) -> Tensor:
    """F82-tint metal with multiple scattering (Kutz et al. 2021)."""
    e, mean = missing
    f5 = (6 / 7) ** 5
    tint = within(paint.specular_tint, 0.0, 1.0)[:, None]
    b = (base + (1 - base) * f5) * (7 / (f5 * 6 / 7)) * (1 - tint)
    fss = base + (1 - base) / 21 - b / 126
    many = _multiple(fss, mean)
    curve = torch.tensor(albedo.SCHLICK_CURVE, device=e.device)
    share = albedo.schlick_share(paint.roughness) @ light.view
    direct = _specular(light.lamps, light.highlights, lobes, curve, base, 1.0)
    if used(1 - tint):
        edge = albedo.edge_curve().to(e.device)
        bent = [lobe * (edge @ h.curve) for lobe, h in zip(lobes, light.highlights, strict=True)]
        total = _summed(light.lamps, bent)
        direct = direct - b * total if total is not None else direct
    around = reflections * (base + (1 - base) * share)
    return (around * e + direct) * (1 + many * ((1 - e) / e))


def _dielectric(
    paint: Paint, light: Light, lobes: Sequence[Tensor], reflections: Tensor, missing: tuple[Tensor, Tensor]
) -> tuple[Tensor, Tensor]:
    """Reflection (3, N) of the dielectric layer, and the share (N,) that it leaves to the diffuse base."""
    e, mean = missing
    f0 = albedo.f0_of(paint.ior) * 2 * paint.specular
    root = f0.clamp(1e-5, 0.95).sqrt()
    ior = (1 + root) / (1 - root)
    tinted = within(f0 * paint.specular_tint, 0.0, 1.0)[:, None]
    straight = ((ior - 1) / (ior + 1)) ** 2
    average = (ior - 1) / (4.08567 + 1.00071 * ior)
    s = ((average - straight) / (1 - straight)).clamp(0.0, 1.0)
    many = _multiple(tinted + (1 - tinted) * s, mean)
    share = (albedo.dielectric_share(paint.roughness, ior) @ light.view).clamp(0.0, 1.0)
    curve = albedo.dielectric_curve(ior)
    direct = _specular(light.lamps, light.highlights, lobes, curve, tinted, 1.0)
    strongest = tinted.amax()
    around = reflections * (tinted + (1 - tinted) * share)
    boost = 1 + many.amax() * ((1 - e) / e)
    left = 1 - (strongest + (1 - strongest) * share) * (e * boost)
    return (around * e + direct) * boost, left


def _glass(
    paint: Paint,
    light: Light,
    base: Tensor,
    lobes: Sequence[Tensor],
    reflections: Tensor,
    missing: tuple[Tensor, Tensor],
) -> Tensor:
    """Solid glass, approximately: the mirror image by Fresnel, the rest from the ray refracted through it."""
    ior = paint.ior.clamp_min(1.0001)
    f0 = albedo.f0_of(ior) * within(paint.specular_tint, 0.0, 1.0)[:, None]
    share = (albedo.dielectric_share(paint.roughness, ior) @ light.view).clamp(0.0, 1.0)
    reflectance = f0 + (1 - f0) * share
    curve = albedo.dielectric_curve(ior)
    direct = _specular(light.lamps, light.highlights, lobes, curve, f0, 1.0)
    behind = light.behind if light.behind is not None else reflections
    # Rough glass blurs what is behind it: towards the light that lies about, for want of more rays.
    behind = torch.lerp(behind, light.reflected.images[-1], paint.roughness)
    return reflections * reflectance + direct / missing[0] + behind * base * (1 - reflectance)


def _coat(paint: Paint, light: Light) -> tuple[Tensor, Tensor]:
    """Reflection (3, N) of the lacquer, and the share that reaches what is below."""
    e, mean = _missing(paint.coat_roughness, light.view)
    ior = torch.tensor(paint.coat_ior, device=e.device).clamp_min(1.0001)
    f0 = albedo.f0_of(ior)
    many = _multiple((ior - 1) / (4.08567 + 1.00071 * ior), mean)
    share = (albedo.dielectric_share(paint.coat_roughness, ior) @ light.view).clamp(0.0, 1.0)
    lobes = [h.lobe(paint.coat_roughness) for h in light.highlights]
    curve = albedo.dielectric_curve(ior)
    direct = _specular(light.lamps, light.highlights, lobes, curve, f0.expand(3, 1), 1.0)
    reflectance = f0 + (1 - f0) * share
    boost = (1 + many * ((1 - e) / e)) * paint.coat
    around = light.reflected.at(paint.coat_roughness) * reflectance * e
    left = 1 - reflectance * e * boost
    if any(t != 1.0 for t in paint.coat_tint):
        left = left * (1 - paint.coat * (1 - _coat_tint(paint, light)))
    return (around + direct) * boost, left


def _coat_tint(paint: Paint, light: Light) -> Tensor:
    """Beer's law along the refracted ray through a colored lacquer (3, N)."""
    tint = light.view.new_tensor(paint.coat_tint).clamp_min(1e-4)[:, None]
    cosine = 1 - light.view[1]
    depth = (1 - (1 - cosine * cosine) / paint.coat_ior**2).clamp_min(1e-4).rsqrt()
    return tint**depth


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
"""Albedo of Cycles' microfiber sheen: rows of rising roughness, columns of rising cosine, 0 to 1."""


def _sheen(paint: Paint, light: Light) -> tuple[Tensor, Tensor]:
    """Microfiber sheen (3, N), lit as if diffuse, and the share (N,) left to the layers below."""
    table = light.view.new_tensor(_SHEEN)
    place = paint.sheen_roughness * 8
    low = min(int(place), 7)
    row = torch.lerp(table[low], table[low + 1], place - low)
    nodes = albedo.basis(torch.linspace(0, 1, 9, device=row.device)[1:])
    amount = (torch.linalg.pinv(nodes.T) @ row[1:] @ light.view).clamp(0.0, 1.0) * paint.sheen
    tint = light.view.new_tensor(paint.sheen_tint)[:, None]
    return tint * (light.irradiance * (amount / math.pi)), 1 - amount * float(tint.max())
