# SPDX-License-Identifier: Apache-2.0
"""All radiances that secondary rays can meet, as one small table: light scattered once, and more often, emission, the world."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import torch
from torch import Tensor


@dataclass(frozen=True)
class RadianceTable:
    """Radiance of all that secondary rays can meet, in one render.

    There are L + 2 sources of light: the lights, the upper and the lower hemisphere of the world. The rows are, for
    each of the M materials, the light of every source scattered once, then scattered twice and more; after those the
    M materials' emission, and the 9 spherical harmonics of the world.
    """

    radiances: Tensor  # (K, 3), K = 2 M (L + 2) + M + 9
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
        scattered = torch.cat((albedo[:, None] * sources, again[:, None] * sources), 1).flatten(0, 1)
        return RadianceTable(torch.cat((scattered, emission, sky)), albedo)

    def without(self, rows: slice) -> RadianceTable:
        """The table with some of its rows dark."""
        dark = torch.zeros_like(self.radiances[rows])
        rest = self.radiances[: rows.start], dark, self.radiances[rows.stop :]
        return RadianceTable(torch.cat(rest), self.albedo)

    def dimmed(self, shares: Tensor) -> RadianceTable:
        """The table behind fog: transmittance (S,) of the L + 2 sources, and again for light scattered twice."""
        split = len(self.albedo) * len(shares)
        scattered = self.radiances[:split].view(len(self.albedo), -1, 3) * shares[:, None]
        return RadianceTable(torch.cat((scattered.flatten(0, 1), self.radiances[split:])), self.albedo)


def hit_radiance(
    table: RadianceTable,
    ambient: Tensor,
    incoming: Tensor,
    members: Sequence[Tensor],
    relative_base_color: Tensor | None,
) -> Tensor:
    """Radiance (3, N) of single hits; 0 where they leave the scene.

    `ambient` (3, N) is irradiance that is not the table's, `incoming` (2 (L + 2), N) how much of each source a hit gets, once and
    twice scattered; `members` has the hits of each material, whose mean color textures (3, N) are relative to.
    """
    given = table.radiances, table.albedo / math.pi, ambient, incoming, members, relative_base_color
    radiance: Tensor = _HitRadiance.apply(*given)
    return radiance


class _HitRadiance(torch.autograd.Function):
    """Radiance (3, N) of single hits: `SecondaryHits.weights() @ radiances` without its mostly empty matrix."""

    @staticmethod
    def forward(ctx, radiances, albedo, ambient, sources, members, relative_base_color):
        ctx.save_for_backward(albedo, ambient)
        ctx.relative_base_color = relative_base_color
        ctx.members, ctx.sources, ctx.rows = members, sources, len(radiances)
        count, materials = len(sources), len(members)
        out = torch.zeros((3, sources.shape[1]), device=sources.device)
        for m, chosen in enumerate(members):
            if len(chosen):
                rows, emission = radiances[m * count : (m + 1) * count], radiances[materials * count + m]
                light = rows.T @ sources.index_select(1, chosen)
                light += ambient.index_select(1, chosen) * albedo[m][:, None]
                if relative_base_color is not None:
                    light *= relative_base_color.index_select(1, chosen)
                out.index_copy_(1, chosen, light + emission[:, None])
        return out

    @staticmethod
    def backward(ctx, gradient):
        albedo, ambient = ctx.saved_tensors
        count, materials = len(ctx.sources), len(ctx.members)
        radiances, albedos = gradient.new_zeros((ctx.rows, 3)), torch.zeros_like(albedo)
        ambients = torch.zeros_like(ambient)
        for m, chosen in enumerate(ctx.members):
            if len(chosen):
                part = gradient.index_select(1, chosen)
                radiances[materials * count + m] = part.sum(1)
                if ctx.relative_base_color is not None:
                    part = part * ctx.relative_base_color.index_select(1, chosen)
                radiances[m * count : (m + 1) * count] = ctx.sources.index_select(1, chosen) @ part.T
                albedos[m] = (part * ambient.index_select(1, chosen)).sum(1)
                ambients.index_copy_(1, chosen, part * albedo[m][:, None])
        return radiances, albedos, ambients, None, None, None
