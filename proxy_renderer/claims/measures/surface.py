# SPDX-License-Identifier: Apache-2.0
"""Measures of what a surface does with light: whether it scatters or mirrors it, how sharply, and its sheen."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import torch
from torch import Tensor

from .picture import FEW, GRAIN, MeasuredPicture, largest_around

_EVEN = 0.02
"""Share of the mean light by which grain makes light differ."""

_STEADY = 1e-4
"""Of a fit: keeps it solvable where normals hardly turn."""

_STEEPEST = (0.97, 0.995)
"""Shares of a region's slopes, in order, that its sharpest edges lie between."""

_GRAZING = 3.0
"""Power with which sheen grows towards the edge: it is no matter of the last pixel alone."""

_OBLIQUE = 0.5
"""Cosine between normal and view where sheen is given: 60 degrees."""

_HIGHLIGHTS = 0.99
"""Share of a region that is no highlight."""


def unscattered(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """How much of what is seen on a surface is an image of other things, mirrored or from behind, and no scattered light.

    Scattered light changes slowly with a surface's direction and place (Ramamoorthi and Hanrahan 2001): what is linear in
    the one and quadratic in the other has nearly all of it. Metal and glass scatter none. Shadows and creases change
    quickly too, so that intricate things have some of it in any case.

    Args:
        where: (H, W) bool, the region.

    Returns:
        (1,) share in [0, 1] of how much light differs within a material; 0 where none has 32 pixels.
    """

    def share(light: Tensor, normal: Tensor, place: Tensor) -> Tensor:
        kept = light <= torch.quantile(light.detach(), _HIGHLIGHTS)
        light, normal, place = light[kept], normal[kept], place[kept]
        basis = torch.cat((normal, place, place.square(), place[:, :1] * place[:, 1:]), 1)
        left = light - _fitted(basis, light)[1]
        grain = (_EVEN * light.mean()).square() + 1e-10
        return left.square().mean() / ((light - light.mean()).square().mean() + grain)

    return _by_material(picture, where, share)


def sheen(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """How much lighter a surface is where it is seen from 60 degrees than scattered light makes it, highlights left out.

    Velvet and dust glow along their edges, on the side of the lamp and on the other.

    Args:
        where: (H, W) bool, the region.

    Returns:
        (1,) share of a material's mean light; 0 where none has 32 pixels.
    """

    def rise(light: Tensor, normal: Tensor, place: Tensor) -> Tensor:
        kept = light <= torch.quantile(light.detach(), _HIGHLIGHTS)
        light, normal = light[kept], normal[kept]
        edge = (1.0 - normal[:, 2:]).clamp(0.0, 1.0) ** _GRAZING
        slope = _fitted(torch.cat((edge, normal), 1), light)[0][0]
        return slope * (1.0 - _OBLIQUE) ** _GRAZING / light.mean().clamp_min(1e-4)

    return _by_material(picture, where, rise)


def sharpness(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """How sharp reflections are: the steepest slopes of lightness inside of surfaces.

    Args:
        where: (H, W) bool, the region.

    Returns:
        (1,) L* per pixel of a picture of 192; 0 if fewer than 32 pixels can be measured.
    """
    material = picture.seen.material.float()
    same = largest_around(material, 3) == -largest_around(-material, 3)
    inside = where & same & ~(largest_around(~where, 5) > 0)
    if inside.sum() < FEW:
        return picture.luminance.new_zeros(1)
    rows, columns = torch.gradient(picture.lab[..., 0])
    slope = (rows.square() + columns.square() + 1e-8).sqrt()[inside].sort().values
    first, last = (round(share * len(slope)) for share in _STEEPEST)
    return slope[first : max(last, first + 1)].mean()[None] * (max(where.shape) / GRAIN)


def _by_material(
    picture: MeasuredPicture, where: Tensor, take: Callable[[Tensor, Tensor, Tensor], Tensor]
) -> Tensor:
    """(1,) mean over a region's pixels of what is taken off each of its materials; 0 where none has enough pixels."""
    found = [(take(*rest), count) for count, *rest in _materials(picture, where)]
    if not found:
        return picture.luminance.new_zeros(1)
    total = sum(count for _, count in found)
    return torch.stack([value * (count / total) for value, count in found]).sum()[None]


def _materials(picture: MeasuredPicture, where: Tensor) -> Iterator[tuple[int, Tensor, Tensor, Tensor]]:
    """Of each material: how many pixels n it has, its light (n,) without textures, its normals (n, 3), its places (n, 2)."""
    seen = picture.seen
    where = where & (seen.normal.norm(dim=-1) > 0.5)
    for number in seen.material[where].unique():
        mine = where & (seen.material == number)
        if (count := int(mine.sum())) >= FEW:
            place = mine.nonzero().to(picture.luminance) / max(where.shape)
            yield count, picture.shading[mine], seen.normal[mine].to(place), place - place.mean(0)


def _fitted(basis: Tensor, light: Tensor) -> tuple[Tensor, Tensor]:
    """The least-squares fit of light (n,) by columns (n, k) and a constant: the weights (k + 1,), and what it makes (n,)."""
    columns = torch.cat((basis, torch.ones_like(basis[:, :1])), 1)
    scale = columns.norm(dim=0).clamp_min(1e-6)
    even = columns / scale
    steady = _STEADY * torch.eye(even.shape[1], dtype=even.dtype, device=even.device)
    weights = torch.linalg.solve(even.T @ even + steady, even.T @ light)
    return weights / scale, even @ weights
