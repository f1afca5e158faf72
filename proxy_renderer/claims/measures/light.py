# SPDX-License-Identifier: Apache-2.0
"""Measures of shading: where light comes from, shadows, highlights, what surfaces do with light, and how much the air hides."""

import math
from collections.abc import Callable

import torch
import torch.nn.functional as F
from torch import Tensor

from ...render.geometry.vectors import overlap
from .picture import FEW, GRAIN, MeasuredPicture, largest_around

_FLOOR = 0.004  # linear luminance below which differences are not seen on a display in a lit room
_HIGHLIGHTS = (0.03, 0.06)  # how far the sides of a highlight are, in roots of a region's area
_BEND = 0.5  # cosine between normals beyond which two places lie on both sides of an edge
_EVEN = 0.15  # stops per pixel by which a texture may change: the edges of a pattern are no shadows
_SPOT = 0.002  # the share of a region that the sharpest highlight fills at least
_CLEAR = 1e-3  # weight of what no fog hides
_END = 0.2  # share of a thing that is its foot, or its head
_EVEN_FIT = 0.02  # share of the mean light by which grain makes light differ
_STEADY = 1e-4  # of a fit: keeps it solvable where normals hardly turn
_STEEPEST = (0.97, 0.995)  # shares of a region's slopes, in order, that its sharpest edges lie between
_GRAZING = 3.0  # power with which sheen grows towards the edge: it is no matter of the last pixel alone
_OBLIQUE = 0.5  # cosine between normal and view where sheen is given: 60 degrees
_MIRROR_HIGHLIGHTS = 0.99  # share of a region that is no highlight


def light_along(axis: int) -> Callable[[MeasuredPicture, Tensor], Tensor]:
    """The measure of the share of light from the camera's right (0), from above (1), or from its side (2): (1,) in [-1, 1]."""
    return lambda picture, where: _shading(picture, where)[axis : axis + 1]


def hardness(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """The steepest slope of light on smooth and even surfaces, as at edges of shadows: (1,) stops per pixel of an image of 192."""
    seen = picture.seen
    material = seen.material.float()
    same = largest_around(material, 5) == -largest_around(-material, 5)
    outline = largest_around(seen.subject, 5) + largest_around(-seen.subject, 5) > 0.1
    turn = torch.stack(torch.gradient(seen.normal, dim=(0, 1))).square().sum((0, -1)).sqrt()
    fade = torch.stack(torch.gradient(seen.pattern.clamp_min(_FLOOR).log2())).square().sum(0).sqrt()
    even = (largest_around(turn, 3) < 0.15) & (largest_around(fade, 3) < _EVEN)
    smooth = where & same & ~outline & even & (seen.material >= 0)
    if smooth.sum() < FEW:
        return picture.luminance.new_zeros(1)
    rows, columns = torch.gradient((picture.shading.clamp_min(0) + _FLOOR).log2())
    slope = (rows.square() + columns.square() + 1e-8).sqrt()[smooth].sort().values
    steepest = slope[round(0.985 * len(slope)) : max(round(0.995 * len(slope)), 1)]
    return steepest.mean()[None] * (max(smooth.shape) / GRAIN)


def key_to_fill(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """Contrast of light and shade within each material, so that dark paint is no shade, without highlights: (1,) stops."""
    light, material = (picture.shading.clamp_min(0) + _FLOOR).log2()[where], picture.seen.material[where]
    spans, counts = [], []
    for number in material.unique():
        mine = light[material == number].sort().values
        if len(mine) >= FEW:
            tenth, most = len(mine) // 10, round(0.99 * len(mine))
            spans.append(mine[most - tenth : most].mean() - mine[:tenth].mean())
            counts.append(float(len(mine)))
    if not spans:
        return light.new_zeros(1)
    return (torch.stack(spans) @ light.new_tensor(counts) / sum(counts))[None]


def rim(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """Lightness of the lightest fifth of a region's outline less that of its inside: (1,) L*."""
    light, band = picture.lab[..., 0], 2 * max(min(where.shape) // 96, 1) + 1
    inside = -largest_around(-where.float(), band) > 0
    edge = where & ~inside
    if edge.sum() < FEW or inside.sum() < FEW:
        return light.new_zeros(1)
    brightest = light[edge].topk(max(int(edge.sum()) // 5, 1)).values.mean()
    return (brightest - light[inside].mean())[None]


def gloss(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """Contrast of highlights: (1,) L* by which the brightest small spots and streaks rise above both of their sides.

    What people call glossy has highlights of high contrast and sharpness (Marlow, Kim and Anderson 2012); both
    raise it, for the sides are near. Light that only grows towards an outline has one side, and is none.
    """
    count = int(where.sum())
    if count < FEW:
        return picture.display.new_zeros(1)
    rows, columns = where.any(1).nonzero()[:, 0], where.any(0).nonzero()[:, 0]
    box = slice(int(rows[0]), int(rows[-1]) + 1), slice(int(columns[0]), int(columns[-1]) + 1)
    light, where = _blurred(picture.lab[..., 0][box]), where[box]
    seen = picture.seen.material[box], picture.seen.normal[box]
    rise = torch.zeros_like(light)
    for share in _HIGHLIGHTS:
        away = max(1, round(share * math.sqrt(count)))
        for row, column in ((0, away), (away, 0), (away, away), (away, -away)):
            sides = [_beside(light, where, *seen, step) for step in ((row, column), (-row, -column))]
            rise = torch.maximum(rise, light - torch.maximum(*sides))
    return rise[where].topk(max(4, round(_SPOT * count))).values.mean()[None]


def _shading(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """(3,) direction from which a region is lit, in the camera's space, by a fit of a + b · n to luminance; short if unclear."""
    normal = picture.seen.normal
    where = where & (normal.norm(dim=-1) > 0.5)
    light, normals = picture.luminance[where], normal[where]
    if len(light) < FEW:
        return light.new_zeros(3)
    keep = light <= torch.quantile(light.detach(), 0.99)
    light, normals = light[keep], normals[keep]
    if normals.std(0).max() < 0.1:
        return light.new_zeros(3)
    light = light / light.mean().clamp_min(1e-6)
    matrix = torch.cat((normals, torch.ones_like(light)[:, None]), 1)
    scale = 1e-2 * len(light) * torch.diag(light.new_tensor([1.0, 1.0, 1.0, 0.0]))
    slope = torch.linalg.solve(matrix.T @ matrix + scale, matrix.T @ light)[:3]
    length = (slope.square().sum() + 1e-8).sqrt()
    return slope / length * (length / 0.3).clamp_max(1.0)


def _beside(light: Tensor, where: Tensor, material: Tensor, normal: Tensor, step: tuple[int, int]) -> Tensor:
    """The light (H, W) a step away; infinite where that is out of the region, of another material, or around a corner."""
    same = _moved(material, step, -2) == material
    bent = (_moved(normal, step, 0.0) * normal).sum(-1) < _BEND
    return torch.where(_moved(where, step, False) & same & ~bent, _moved(light, step, torch.inf), torch.inf)


def _moved(field: Tensor, step: tuple[int, int], outside: float) -> Tensor:
    """A field (H, W, …) as it is a step away."""
    moved = torch.full_like(field, outside)
    (rows, from_rows), (columns, from_columns) = map(overlap, step, field.shape[:2])
    moved[rows, columns] = field[from_rows, from_columns]
    return moved


def _blurred(field: Tensor) -> Tensor:
    """A field (H, W), blurred by a Gaussian of half a pixel, as grain is."""
    tap = math.exp(-2.0)
    kernel = field.new_tensor([tap, 1.0, tap]) / (1 + 2 * tap)
    padded = F.pad(field[None, None], (1, 1, 1, 1), mode="replicate")
    return F.conv2d(padded, torch.outer(kernel, kernel)[None, None])[0, 0]


def haze(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """Share of the light of what is seen there that fog takes away: (1,) in [0, 1].

    Of the half that it takes most from, as fog fades the distance. The world counts where there is little else.
    """
    surfaces = where & (picture.seen.material >= 0)
    passing = picture.seen.transmittance[surfaces if surfaces.sum() > 0.1 * where.sum() else where]
    return 1.0 - passing.topk(-(-len(passing) // 2), largest=False).values.mean()[None]


def mist_below(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """Share of light that the air takes from the lowest fifth of a target, less that of its highest, as ground mist does: (1,)."""
    row = where.nonzero()[:, 0].to(picture.seen.transmittance)
    high, low = torch.quantile(row, row.new_tensor([_END, 1 - _END]))
    passing = picture.seen.transmittance[where]
    return (passing[row <= high].mean() - passing[row >= low].mean())[None]


def air_lightness(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """Lightness of a region, weighted by how much the air hides it: (1,) L*. It does not grow with the amount of air."""
    veil = (1.0 - picture.seen.transmittance.detach())[where] + _CLEAR
    return (picture.lab[..., 0][where] @ veil / veil.sum())[None]


def unscattered(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """Share of the differences of light on a surface that are images of other objects, mirrored or from behind: (1,).

    Scattered light changes slowly with a surface's direction and place (Ramamoorthi and Hanrahan 2001): what is linear in
    the one and quadratic in the other has nearly all of it. Metal and glass scatter none. Shadows and creases change
    quickly too, so that intricate objects have some of it in any case.
    """

    def share(light: Tensor, normal: Tensor, place: Tensor) -> Tensor:
        kept = light <= torch.quantile(light.detach(), _MIRROR_HIGHLIGHTS)
        light, normal, place = light[kept], normal[kept], place[kept]
        basis = torch.cat((normal, place, place.square(), place[:, :1] * place[:, 1:]), 1)
        left = light - _fitted(basis, light)[1]
        grain = (_EVEN_FIT * light.mean()).square() + 1e-10
        return left.square().mean() / ((light - light.mean()).square().mean() + grain)

    return _by_material(picture, where, share)


def sheen(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """Glow of a surface along its edges, as of velvet, seen from 60 degrees, as a share of the mean without highlights: (1,)."""

    def rise(light: Tensor, normal: Tensor, place: Tensor) -> Tensor:
        kept = light <= torch.quantile(light.detach(), _MIRROR_HIGHLIGHTS)
        light, normal = light[kept], normal[kept]
        edge = (1.0 - normal[:, 2:]).clamp(0.0, 1.0) ** _GRAZING
        slope = _fitted(torch.cat((edge, normal), 1), light)[0][0]
        return slope * (1.0 - _OBLIQUE) ** _GRAZING / light.mean().clamp_min(1e-4)

    return _by_material(picture, where, rise)


def sharpness(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """Sharpness of reflections: the steepest slopes of lightness inside of surfaces, (1,) L* per pixel of an image of 192."""
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
    """(1,) mean of what is taken off each material's light (n,), normals (n, 3) and places (n, 2); 0 where they are few."""
    seen, found = picture.seen, []
    where = where & (seen.normal.norm(dim=-1) > 0.5)
    for number in seen.material[where].unique():
        mine = where & (seen.material == number)
        if (count := int(mine.sum())) >= FEW:
            place = mine.nonzero().to(picture.luminance) / max(where.shape)
            taken = take(picture.shading[mine], seen.normal[mine].to(place), place - place.mean(0))
            found.append((taken, count))
    if not found:
        return picture.luminance.new_zeros(1)
    total = sum(count for _, count in found)
    return torch.stack([value * (count / total) for value, count in found]).sum()[None]


def _fitted(basis: Tensor, light: Tensor) -> tuple[Tensor, Tensor]:
    """The least-squares fit of light (n,) by columns (n, k) and a constant: the weights (k + 1,), and what it makes (n,)."""
    columns = torch.cat((basis, torch.ones_like(basis[:, :1])), 1)
    scale = columns.norm(dim=0).clamp_min(1e-6)
    even = columns / scale
    steady = _STEADY * torch.eye(even.shape[1], dtype=even.dtype, device=even.device)
    weights = torch.linalg.solve(even.T @ even + steady, even.T @ light)
    return weights / scale, even @ weights
