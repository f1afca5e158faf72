# SPDX-License-Identifier: Apache-2.0
"""The Principled BSDF, layer by layer as Cycles weighs them (kernel/svm/closure.h).

All samples of one material are shaded together, so its parameters are scalars and small vectors that
broadcast; lobes whose weight is a constant zero are skipped.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import torch
from torch import Tensor

from ...scene.values import wanted
from ..geometry.vectors import within
from ..material import albedo
from ..material.shading_inputs import Paint, used
from .coat_sheen import coat, sheen
from .lobes import Light, multiple_scattering, single_scattering, specular, summed

_FAINT = 1e-4
"""Reflectance seen head on below which the dielectric layer fades out."""


def shade(paint: Paint, light: Light, texture: Tensor | None) -> Tensor:
    """Outgoing radiance (3, N) towards the viewer."""
    base = paint.colored(texture)
    clamped = within(base, 0.0, 1.0)
    result, weight = torch.zeros_like(light.irradiance), torch.ones((), device=base.device)
    if used(paint.sheen):
        fuzz, weight = sheen(paint, light)
        result = result + fuzz
    if used(paint.coat):
        gloss, left = coat(paint, light)
        result, weight = result + gloss * weight, weight * left
    glow = paint.emission
    if used(glow):
        result = result + (glow if glow.dim() > 1 else glow[:, None]) * weight
    reflections = light.reflected.at(paint.roughness)
    lobes = [h.lobe(paint.roughness) for h in light.highlights]
    missing = single_scattering(paint.roughness, light.view)
    if used(paint.metallic):
        metal = _metal(paint, light, clamped, lobes, reflections, missing)
        result, weight = result + metal * (weight * paint.metallic), weight * (1 - paint.metallic)
    if wanted(paint.metallic) or bool((paint.metallic < 1).any()):
        if used(paint.transmission):
            glass = _glass(paint, light, clamped, lobes, reflections, missing)
            result, weight = result + glass * (weight * paint.transmission), weight * (1 - paint.transmission)
        plastic, left = _dielectric(paint, light, lobes, reflections, missing)
        diffuse = base * light.irradiance * (left / math.pi)
        result = result + (plastic + diffuse) * weight
    return result


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
    many = multiple_scattering(fss, mean)
    curve = torch.tensor(albedo.SCHLICK_CURVE, device=e.device)
    share = albedo.weigh(albedo.schlick_share(paint.roughness), light.view)
    direct = specular(light.lamps, light.highlights, lobes, curve, base, 1.0)
    if used(1 - tint):
        edge = albedo.edge_curve().to(e.device)
        bent = [lobe * (edge @ h.curve) for lobe, h in zip(lobes, light.highlights, strict=True)]
        direct = direct - b * summed(light.lamps, bent)
    reflectance = base + (1 - base) * share
    if used(1 - tint):
        reflectance = reflectance - b * albedo.weigh(albedo.edge_share(paint.roughness), light.view)
    around = reflections * reflectance.clamp_min(0.0)
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
    many = multiple_scattering(tinted + (1 - tinted) * s, mean)
    # An IOR of 1 reflects nothing; next to it the curves are too steep for their tables.
    present = (f0.detach() / _FAINT).clamp_max(1.0)
    share = albedo.weigh(albedo.dielectric_share(paint.roughness, ior), light.view).clamp(0.0, 1.0) * present
    curve = albedo.dielectric_curve(ior) * present
    direct = specular(light.lamps, light.highlights, lobes, curve, tinted, 1.0)
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
    share = albedo.weigh(albedo.dielectric_share(paint.roughness, ior), light.view).clamp(0.0, 1.0)
    reflectance = f0 + (1 - f0) * share
    curve = albedo.dielectric_curve(ior)
    direct = specular(light.lamps, light.highlights, lobes, curve, f0, 1.0)
    behind = light.behind if light.behind is not None else reflections
    # Rough glass blurs what is behind it: towards the light that lies about, for want of more rays.
    behind = torch.lerp(behind, light.reflected.images[-1], paint.roughness)
    return reflections * reflectance + direct / missing[0] + behind * base * (1 - reflectance)
