# SPDX-License-Identifier: Apache-2.0
"""Measures of shading: direction of light, shadows, highlights, finish of surfaces, and how much the air hides."""

import math
from collections.abc import Callable

import torch
import torch.nn.functional as F
from torch import Tensor

from ...render.geometry.vectors import overlap
from .color import MeasureFunction
from .picture import FEW, GRAIN, MeasuredPicture, largest_around

_FLOOR = 0.004  # linear luminance below which differences are not seen on a display in a lit room
_BEND = 0.5  # cosine between two normals below which there is an edge between their places
_END = 0.2  # share of a target's pixels, in order of height, that are its foot, or its head
_GRAZING = 3.0  # exponent of 1 - cosine in sheen: it grows toward the edge, over more than the last pixel
_MIRROR_HIGHLIGHTS = 0.99  # share of a region's pixels, the darkest, that are no highlights


def light_along(axis: int) -> MeasureFunction:
    """A measure: amount of light from the right (axis 0), from above (1) or from the camera (2): (1,) in [-1, 1]."""

    def take(picture: MeasuredPicture, where: Tensor) -> Tensor:
        # Direction from which a region is lit, by a fit of a + b · n to luminance; shorter than 1 if that is unclear
        normal = picture.seen.normal
        where = where & (normal.norm(dim=-1) > 0.5)
        light, normals = picture.luminance[where], normal[where]
        if len(light) < FEW:
            return light.new_zeros(1)
        keep = light <= torch.quantile(light.detach(), 0.99)
        light, normals = light[keep], normals[keep]
        if normals.std(0).max() < 0.1:
            return light.new_zeros(1)
        light = light / light.mean().clamp_min(1e-6)
        matrix = torch.cat((normals, torch.ones_like(light)[:, None]), 1)
        scale = 1e-2 * len(light) * torch.diag(light.new_tensor([1.0, 1.0, 1.0, 0.0]))
        slope = torch.linalg.solve(matrix.T @ matrix + scale, matrix.T @ light)[:3]
        length = (slope.square().sum() + 1e-8).sqrt()
        return (slope / length * (length / 0.3).clamp_max(1.0))[axis : axis + 1]

    return take


def hardness(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """Mean of the steepest slopes of light on smooth and even surfaces, as at shadow edges: (1,) stops per pixel.

    A pixel is here 1 / 192 of the image's longer side.
    """
    seen = picture.seen
    material = seen.material.float()
    same = largest_around(material, 5) == -largest_around(-material, 5)
    outline = largest_around(seen.subject, 5) + largest_around(-seen.subject, 5) > 0.1
    turn = torch.stack(torch.gradient(seen.normal, dim=(0, 1))).square().sum((0, -1)).sqrt()
    fade = torch.stack(torch.gradient(seen.pattern.clamp_min(_FLOOR).log2())).square().sum(0).sqrt()
    # The edges of a pattern, where the texture changes by more stops per pixel, are no shadows.
    even = (largest_around(turn, 3) < 0.15) & (largest_around(fade, 3) < 0.15)
    smooth = where & same & ~outline & even & (seen.material >= 0)
    return _steepest((picture.shading.clamp_min(0) + _FLOOR).log2(), smooth, 0.985, 0.995)


def _steepest(field: Tensor, where: Tensor, low: float, high: float) -> Tensor:
    """Mean slope (1,) of a field (H, W) over a region's pixels between two ranks in slope, from 0 (flattest) to 1.

    It is per pixel, which is here 1 / 192 of the image's longer side.
    """
    if where.sum() < FEW:
        return field.new_zeros(1)
    rows, columns = torch.gradient(field)
    slope = (rows.square() + columns.square() + 1e-8).sqrt()[where].sort().values
    first, last = round(low * len(slope)), round(high * len(slope))
    return slope[first : max(last, first + 1)].mean()[None] * (max(where.shape) / GRAIN)


def key_to_fill(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """Contrast of light and shade without highlights: (1,) stops. It is a mean over materials, for dark paint is no shade."""
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
    """Mean lightness of the lightest fifth of a region's outline minus that of its inside: (1,) L*."""
    light, band = picture.lab[..., 0], 2 * max(min(where.shape) // 96, 1) + 1
    inside = -largest_around(-where.float(), band) > 0
    edge = where & ~inside
    if edge.sum() < FEW or inside.sum() < FEW:
        return light.new_zeros(1)
    brightest = light[edge].topk(max(int(edge.sum()) // 5, 1)).values.mean()
    return (brightest - light[inside].mean())[None]


def gloss(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """Contrast of highlights: (1,) L* by which the brightest small spots and streaks rise above both of their sides.

    What people call glossy has highlights of high contrast and sharpness (Marlow, Kim and Anderson 2012). Both raise this
    measure, for the sides are near. Light that only grows toward an outline rises above one side, and does not count.
    """
    count = int(where.sum())
    if count < FEW:
        return picture.display.new_zeros(1)
    rows, columns = where.any(1).nonzero()[:, 0], where.any(0).nonzero()[:, 0]
    box = slice(int(rows[0]), int(rows[-1]) + 1), slice(int(columns[0]), int(columns[-1]) + 1)
    # Blurred by a Gaussian with a standard deviation of half a pixel, which reduces grain
    tap, light = math.exp(-2.0), picture.lab[..., 0][box]
    kernel = light.new_tensor([tap, 1.0, tap]) / (1 + 2 * tap)
    padded = F.pad(light[None, None], (1, 1, 1, 1), mode="replicate")
    light, where = F.conv2d(padded, torch.outer(kernel, kernel)[None, None])[0, 0], where[box]
    seen = picture.seen.material[box], picture.seen.normal[box]
    rise = torch.zeros_like(light)
    for share in (0.03, 0.06):
        away = max(1, round(share * math.sqrt(count)))  # from a highlight to its sides
        for row, column in ((0, away), (away, 0), (away, away), (away, -away)):
            sides = [_beside(light, where, *seen, step) for step in ((row, column), (-row, -column))]
            rise = torch.maximum(rise, light - torch.maximum(*sides))
    return rise[where].topk(max(4, round(0.002 * count))).values.mean()[None]


def _beside(light: Tensor, where: Tensor, material: Tensor, normal: Tensor, step: tuple[int, int]) -> Tensor:
    """Light (H, W) of the pixel a step away; infinite outside of the region, on another material or past an edge."""
    same = _moved(material, step, -2) == material
    bent = (_moved(normal, step, 0.0) * normal).sum(-1) < _BEND
    return torch.where(_moved(where, step, False) & same & ~bent, _moved(light, step, torch.inf), torch.inf)


def _moved(field: Tensor, step: tuple[int, int], outside: float) -> Tensor:
    """A field (H, W, …) with the value of the pixel a step (rows, columns) away; `outside` beyond the image."""
    moved = torch.full_like(field, outside)
    (rows, from_rows), (columns, from_columns) = map(overlap, step, field.shape[:2])
    moved[rows, columns] = field[from_rows, from_columns]
    return moved


def haze(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """Share of the light of a region that fog takes away: (1,) in [0, 1].

    It is the mean of the half of the pixels that lose most, because fog fades the distance. Pixels of the world count only if
    surfaces cover less than a tenth of the region.
    """
    surfaces = where & (picture.seen.material >= 0)
    passing = picture.seen.transmittance[surfaces if surfaces.sum() > 0.1 * where.sum() else where]
    return 1.0 - passing.topk(-(-len(passing) // 2), largest=False).values.mean()[None]


def mist_below(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """Share of light that the air takes from the lowest fifth of a target minus that from the highest fifth: (1,)."""
    row = where.nonzero()[:, 0].to(picture.seen.transmittance)
    high, low = torch.quantile(row, row.new_tensor([_END, 1 - _END]))
    passing = picture.seen.transmittance[where]
    return (passing[row <= high].mean() - passing[row >= low].mean())[None]


def air_lightness(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """Mean lightness of a region, its pixels weighted by how much the air hides them: (1,) L*, whatever the amount of air."""
    veil = (1.0 - picture.seen.transmittance.detach())[where] + 1e-3
    return (picture.lab[..., 0][where] @ veil / veil.sum())[None]


def unscattered(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """Share of the variance of light on a surface that comes from mirrored or transmitted images of other objects: (1,).

    Scattered light changes slowly with a surface's direction and place (Ramamoorthi and Hanrahan 2001). A fit that is
    linear in the normal and quadratic in the place has nearly all of it; the rest is counted. Metal and glass scatter
    nothing. Shadows and creases change quickly too, so that intricate objects always have some of this share.
    """

    def share(light: Tensor, normal: Tensor, place: Tensor) -> Tensor:
        kept = light <= torch.quantile(light.detach(), _MIRROR_HIGHLIGHTS)
        light, normal, place = light[kept], normal[kept], place[kept]
        basis = torch.cat((normal, place, place.square(), place[:, :1] * place[:, 1:]), 1)
        left = light - _fitted(basis, light)[1]
        grain = (0.02 * light.mean()).square() + 1e-10
        return left.square().mean() / ((light - light.mean()).square().mean() + grain)

    return _by_material(picture, where, share)


def sheen(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """Glow of a surface toward its edges, as on velvet: (1,) at 60° from the normal, relative to the mean light."""

    def rise(light: Tensor, normal: Tensor, place: Tensor) -> Tensor:
        kept = light <= torch.quantile(light.detach(), _MIRROR_HIGHLIGHTS)
        light, normal = light[kept], normal[kept]
        edge = (1.0 - normal[:, 2:]).clamp(0.0, 1.0) ** _GRAZING
        slope = _fitted(torch.cat((edge, normal), 1), light)[0][0]
        return slope * 0.5**_GRAZING / light.mean().clamp_min(1e-4)

    return _by_material(picture, where, rise)


def sharpness(picture: MeasuredPicture, where: Tensor) -> Tensor:
    """Sharpness of reflections: mean of the steepest slopes of lightness inside of surfaces, (1,) L* per pixel.

    A pixel is here 1 / 192 of the image's longer side.
    """
    material = picture.seen.material.float()
    same = largest_around(material, 3) == -largest_around(-material, 3)
    inside = where & same & ~(largest_around(~where, 5) > 0)
    return _steepest(picture.lab[..., 0], inside, 0.97, 0.995)


def _by_material(picture: MeasuredPicture, where: Tensor, take: Callable[[Tensor, Tensor, Tensor], Tensor]) -> Tensor:
    """Mean (1,) over materials, weighted by their n pixels, of `take`(light (n,), normals (n, 3), places (n, 2)).

    It is 0 if all materials are small.
    """
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
    """(weights (k + 1,), fitted light (n,)) of the least-squares fit of light (n,) by a basis (n, k) and a constant."""
    columns = torch.cat((basis, torch.ones_like(basis[:, :1])), 1)
    scale = columns.norm(dim=0).clamp_min(1e-6)
    even = columns / scale
    # solvable where normals hardly turn
    steady = 1e-4 * torch.eye(even.shape[1], dtype=even.dtype, device=even.device)
    weights = torch.linalg.solve(even.T @ even + steady, even.T @ light)
    return weights / scale, even @ weights
