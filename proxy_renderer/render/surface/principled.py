# SPDX-License-Identifier: Apache-2.0
"""The Principled BSDF, layer by layer as Cycles weighs them (kernel/svm/closure.h).

All samples of one material are shaded together, so its parameters are scalars and small vectors that
broadcast; lobes whose weight is a constant zero are skipped.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import torch
from jaxtyping import Float
from torch import Tensor

from ...scene.values import wanted
from ..geometry.vectors import within
from ..material import albedo
from ..material.shading_inputs import ShadingInputs, used
from .coat_sheen import coat, sheen
from .lobes import IncidentLight, multiple_scattering, single_scattering, specular, summed

_FAINT = 1e-4
"""Reflectance seen head on below which the dielectric layer fades out."""


def shade(
    inputs: ShadingInputs, light: IncidentLight, texture: Float[Tensor, "3 n"] | None
) -> Float[Tensor, "3 n"]:
    """Outgoing radiance (3, N) towards the viewer."""
    base = inputs.colored(texture)
    clamped = within(base, 0.0, 1.0)
    result, weight = torch.zeros_like(light.irradiance), torch.ones((), device=base.device)
    if used(inputs.sheen):
        fuzz, weight = sheen(inputs, light)
        result = result + fuzz
    if used(inputs.coat):
        gloss, left = coat(inputs, light)
        result, weight = result + gloss * weight, weight * left
    emission = inputs.emission
    if used(emission):
        result = result + (emission if emission.dim() > 1 else emission[:, None]) * weight
    reflections = light.reflected.at(inputs.roughness)
    lobes = [h.lobe(inputs.roughness) for h in light.highlights]
    single = single_scattering(inputs.roughness, light.view)
    if used(inputs.metallic):
        metal = _metal(inputs, light, clamped, lobes, reflections, single)
        result, weight = result + metal * (weight * inputs.metallic), weight * (1 - inputs.metallic)
    if wanted(inputs.metallic) or bool((inputs.metallic < 1).any()):
        if used(inputs.transmission):
            glass = _glass(inputs, light, clamped, lobes, reflections, single)
            result, weight = (
                result + glass * (weight * inputs.transmission),
                weight * (1 - inputs.transmission),
            )
        dielectric, left = _dielectric(inputs, light, lobes, reflections, single)
        diffuse = base * light.irradiance * (left / math.pi)
        result = result + (dielectric + diffuse) * weight
    return result


def _metal(
    inputs: ShadingInputs,
    light: IncidentLight,
    base: Tensor,
    lobes: Sequence[Tensor],
    reflections: Tensor,
    single: tuple[Tensor, Tensor],
) -> Tensor:
    """F82-tint metal with multiple scattering (Kutz et al. 2021)."""
    e, mean = single
    f5 = (6 / 7) ** 5
    tint = within(inputs.specular_tint, 0.0, 1.0)[:, None]
    b = (base + (1 - base) * f5) * (7 / (f5 * 6 / 7)) * (1 - tint)
    fss = base + (1 - base) / 21 - b / 126
    many = multiple_scattering(fss, mean)
    curve = torch.tensor(albedo.SCHLICK_CURVE, device=e.device)
    share = albedo.weigh(albedo.schlick_share(inputs.roughness), light.view)
    direct = specular(light.lamps, light.highlights, lobes, curve, base, 1.0)
    if used(1 - tint):
        edge = albedo.edge_curve().to(e.device)
        bent = [lobe * (edge @ h.curve) for lobe, h in zip(lobes, light.highlights, strict=True)]
        direct = direct - b * summed(light.lamps, bent)
    reflectance = base + (1 - base) * share
    if used(1 - tint):
        reflectance = reflectance - b * albedo.weigh(albedo.edge_share(inputs.roughness), light.view)
    around = reflections * reflectance.clamp_min(0.0)
    return (around * e + direct) * (1 + many * ((1 - e) / e))


def _dielectric(
    inputs: ShadingInputs,
    light: IncidentLight,
    lobes: Sequence[Tensor],
    reflections: Tensor,
    single: tuple[Tensor, Tensor],
) -> tuple[Tensor, Tensor]:
    """Reflection (3, N) of the dielectric layer, and the share (N,) that it leaves to the diffuse base."""
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
    share = albedo.weigh(albedo.dielectric_share(inputs.roughness, ior), light.view).clamp(0.0, 1.0) * present
    curve = albedo.dielectric_curve(ior) * present
    direct = specular(light.lamps, light.highlights, lobes, curve, tinted, 1.0)
    strongest = tinted.amax()
    around = reflections * (tinted + (1 - tinted) * share)
    boost = 1 + many.amax() * ((1 - e) / e)
    left = 1 - (strongest + (1 - strongest) * share) * (e * boost)
    return (around * e + direct) * boost, left


def _glass(
    inputs: ShadingInputs,
    light: IncidentLight,
    base: Tensor,
    lobes: Sequence[Tensor],
    reflections: Tensor,
    single: tuple[Tensor, Tensor],
) -> Tensor:
    """Solid glass, approximately: Fresnel reflection, and the radiance along the ray refracted through it."""
    ior = inputs.ior.clamp_min(1.0001)
    f0 = albedo.f0_of(ior) * within(inputs.specular_tint, 0.0, 1.0)[:, None]
    share = albedo.weigh(albedo.dielectric_share(inputs.roughness, ior), light.view).clamp(0.0, 1.0)
    reflectance = f0 + (1 - f0) * share
    curve = albedo.dielectric_curve(ior)
    direct = specular(light.lamps, light.highlights, lobes, curve, f0, 1.0)
    behind = light.behind if light.behind is not None else reflections
    # Rough glass blurs what is behind it. One ray shows no blur: mix towards the diffuse light instead.
    behind = torch.lerp(behind, light.reflected.images[-1], inputs.roughness)
    return reflections * reflectance + direct / single[0] + behind * base * (1 - reflectance)
