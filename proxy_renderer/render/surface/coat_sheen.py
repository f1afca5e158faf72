# SPDX-License-Identifier: Apache-2.0
"""The thin layers on top of the Principled BSDF: lacquer and sheen."""

from __future__ import annotations

import math

import torch
from jaxtyping import Float
from torch import Tensor

from ..material import albedo
from ..material.shading_inputs import ShadingInputs
from .lobes import IncidentLight, multiple_scattering, single_scattering, specular


def coat(
    inputs: ShadingInputs, light: IncidentLight
) -> tuple[Float[Tensor, "3 n"], Float[Tensor, "*tinted n"]]:
    """Reflection (3, N) of the lacquer, and the share that reaches what is below."""
    e, mean = single_scattering(inputs.coat_roughness, light.view)
    ior = torch.tensor(inputs.coat_ior, device=e.device).clamp_min(1.0001)
    f0 = albedo.f0_of(ior)
    many = multiple_scattering((ior - 1) / (4.08567 + 1.00071 * ior), mean)
    share = albedo.weigh(albedo.dielectric_share(inputs.coat_roughness, ior), light.view).clamp(0.0, 1.0)
    lobes = [h.lobe(inputs.coat_roughness) for h in light.highlights]
    curve = albedo.dielectric_curve(ior)
    direct = specular(light.lamps, light.highlights, lobes, curve, f0.expand(3, 1), 1.0)
    reflectance = f0 + (1 - f0) * share
    boost = (1 + many * ((1 - e) / e)) * inputs.coat
    around = light.reflected.at(inputs.coat_roughness) * reflectance * e
    left = 1 - reflectance * e * boost
    if any(t != 1.0 for t in inputs.coat_tint):
        left = left * (1 - inputs.coat * (1 - _coat_tint(inputs, light)))
    return (around + direct) * boost, left


def _coat_tint(inputs: ShadingInputs, light: IncidentLight) -> Tensor:
    """Beer's law along the refracted ray through a colored lacquer (3, N)."""
    tint = light.view.new_tensor(inputs.coat_tint).clamp_min(1e-4)[:, None]
    cosine = 1 - light.view[1]
    depth = (1 - (1 - cosine * cosine) / inputs.coat_ior**2).clamp_min(1e-4).rsqrt()
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


def sheen(inputs: ShadingInputs, light: IncidentLight) -> tuple[Float[Tensor, "3 n"], Float[Tensor, " n"]]:
    """Microfiber sheen (3, N), lit as if diffuse, and the share (N,) left to the layers below."""
    table = light.view.new_tensor(_SHEEN)
    place = inputs.sheen_roughness * 8
    low = min(int(place), 7)
    row = torch.lerp(table[low], table[low + 1], place - low)
    nodes = albedo.basis(torch.linspace(0, 1, 9, dtype=row.dtype, device=row.device)[1:])
    amount = (torch.linalg.pinv(nodes.T) @ row[1:] @ light.view).clamp(0.0, 1.0) * inputs.sheen
    tint = light.view.new_tensor(inputs.sheen_tint)[:, None]
    return tint * (light.irradiance * (amount / math.pi)), 1 - amount * float(tint.max())
