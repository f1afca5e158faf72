# SPDX-License-Identifier: Apache-2.0
"""All radiances that secondary rays can meet, as one small table: light scattered once, and more often, emission, the world."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import torch
from torch import Tensor


@dataclass(frozen=True)
class RadianceTable:
    """Radiance of all that secondary rays can meet, in one render.

    There are S = 2 (L + 2) sources: the L lights, the upper and the lower hemisphere of the world, and the same for light that
    is scattered twice and more.
    """

    scattered: Tensor  # (S, M, 3) what each material scatters of each source
    emission: Tensor  # (M, 3)
    sky: Tensor  # (9, 3) spherical harmonics of the world
    albedo: Tensor  # (M, 3) share of light that each material scatters

    @staticmethod
    def of(
        albedo: Tensor,
        metallic: Tensor,
        emission: Tensor,
        lamp_colors: Tensor,
        hemispheres: Tensor,
        sky: Tensor,
    ) -> RadianceTable:
        """Builds the table.

        Args:
            albedo: (M, 3) share of light that each material scatters, or reflects if it is a metal.
            metallic: (M,) share of each material that is metal.
            emission: (M, 3) emitted radiance.
            lamp_colors: (L, 3).
            hemispheres: (2, 3) light of the world on what faces up and down.
            sky: (9, 3) its spherical harmonics.
        """
        sources = torch.cat((lamp_colors / math.pi, hemispheres))
        again = albedo * albedo / (1 - albedo / 2)  # third and later bounces follow the second
        # A metal shows things of other colors than its own: of the mean color of those that are none.
        plain = (1 - metallic)[:, None] + 1e-6
        common = (albedo * plain).sum(0) / plain.sum(0)
        again = torch.lerp(again, albedo * common / (1 - common / 2), metallic[:, None])
        scattered = torch.cat((sources[:, None] * albedo, sources[:, None] * again))
        return RadianceTable(scattered, emission, sky, albedo)

    def without_emission(self) -> RadianceTable:
        """The table of surfaces that do not glow."""
        return replace(self, emission=torch.zeros_like(self.emission))

    def dimmed(self, shares: Tensor) -> RadianceTable:
        """The table behind fog that lets shares (S,) of the sources through."""
        return replace(self, scattered=self.scattered * shares[:, None, None])


def hit_radiance(
    table: RadianceTable,
    ambient: Tensor,
    incoming: Tensor,
    members: Sequence[Tensor],
    relative_base_color: Tensor | None,
) -> Tensor:
    """Radiance (3, N) of single hits; 0 where they leave the scene.

    `ambient` (3, N) is irradiance that is not the table's, `incoming` (S, N) how much of each source a hit gets; `members` has the hits of each material, whose mean color textures (3, N) are relative to.
    """
    given = table.scattered, table.emission, table.albedo / math.pi
    radiance: Tensor = _HitRadiance.apply(*given, ambient, incoming, members, relative_base_color)
    return radiance


class _HitRadiance(torch.autograd.Function):
    """Radiance (3, N) of single hits: a product with a mostly empty matrix, without that matrix."""

    @staticmethod
    def forward(ctx, scattered, emission, albedo, ambient, incoming, members, relative_base_color):
        ctx.save_for_backward(albedo, ambient)
        ctx.relative_base_color = relative_base_color
        ctx.members, ctx.incoming = members, incoming
        out = torch.zeros((3, incoming.shape[1]), device=incoming.device)
        for m, chosen in enumerate(members):
            if len(chosen):
                light = scattered[:, m].T @ incoming.index_select(1, chosen)
                light += ambient.index_select(1, chosen) * albedo[m][:, None]
                if relative_base_color is not None:
                    light *= relative_base_color.index_select(1, chosen)
                out.index_copy_(1, chosen, light + emission[m][:, None])
        return out

    @staticmethod
    def backward(ctx, gradient):
        albedo, ambient = ctx.saved_tensors
        scattered = gradient.new_zeros((len(ctx.incoming), len(albedo), 3))
        emission, albedos, ambients = (torch.zeros_like(each) for each in (albedo, albedo, ambient))
        for m, chosen in enumerate(ctx.members):
            if len(chosen):
                part = gradient.index_select(1, chosen)
                emission[m] = part.sum(1)
                if ctx.relative_base_color is not None:
                    part = part * ctx.relative_base_color.index_select(1, chosen)
                scattered[:, m] = ctx.incoming.index_select(1, chosen) @ part.T
                albedos[m] = (part * ambient.index_select(1, chosen)).sum(1)
                ambients.index_copy_(1, chosen, part * albedo[m][:, None])
        return scattered, emission, albedos, ambients, None, None, None
