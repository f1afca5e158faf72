# SPDX-License-Identifier: Apache-2.0
"""A picture of this very scene: found by its edges, and compared place by place and material by material."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import torch
import torch.nn.functional as F
from torch import Tensor

from ..claims.claim import Claim
from ..claims.measures.picture import MeasuredPicture
from ..claims.measures.registry import MEASURES
from ..color.tensors import lab_from_srgb
from ..render.gbuffer import GBuffer
from .statements import Statement

_WORDS = ("upper", "middle", "lower")
_SIDES = ("left", "middle", "right")
_ASPECT = 0.02  # share by which proportions may differ
_ALIKE = 0.4
"""Correlation of edges from where two pictures show one scene. Of 19 scenes before and after a vibe it is .51 to .98, of
240 pairs of two scenes .26 at most."""
_EDGES = 128  # longer side at which edges are compared, pixels
_SEEN = 0.99  # alpha from where a pixel is compared
_FLAT = 1.0  # L* per pixel: what is below is hardly an edge
_LONGER = 12  # cells along the longer side
_EXACT = 0.5  # noticeable steps that a cell may be off on either side


def is_same(reference: Tensor, rendered: Tensor) -> bool:
    """Whether two pictures show the same things in the same places, however lit."""
    one, other = (picture.shape[1] / picture.shape[0] for picture in (reference, rendered))
    return abs(one / other - 1) < _ASPECT and likeness(reference, rendered) > _ALIKE


def likeness(reference: Tensor, rendered: Tensor) -> float:
    """Correlation of where two pictures (H, W, 3) have edges; compressed, as light changes their strengths, not places."""
    height, width = rendered.shape[:2]
    factor = min(_EDGES / max(height, width), 1.0)
    shape = max(round(height * factor), 1), max(round(width * factor), 1)
    maps = torch.stack([_edges(picture, shape).flatten() for picture in (reference, rendered)])
    return float(torch.nan_to_num(torch.corrcoef(maps)[0, 1]))


def _edges(picture: Tensor, shape: tuple[int, int]) -> Tensor:
    """(h, w) log strength of edges in Lab, relative to those around: in a dim corner they count as much."""
    planes = F.interpolate(picture.detach().cpu().float().permute(2, 0, 1)[None], shape, mode="area")
    lab = lab_from_srgb(planes[0].permute(1, 2, 0))
    slopes = torch.stack(torch.gradient(lab, dim=(0, 1))).square().sum((0, -1)).sqrt()
    around = F.avg_pool2d(slopes[None, None], 31, 1, 15, count_include_pad=False)[0, 0]
    return (1 + slopes / (around + 0.2 * _FLAT)).log()


def statements_of(picture: Tensor, alpha: np.ndarray | None, seen: GBuffer, name: str) -> list[Statement]:
    """What a picture of this scene says of every place in the frame, and of every material, where all of it is seen."""
    measured = MeasuredPicture.of(picture, seen)
    hidden = None
    if alpha is not None:
        planes = torch.from_numpy(alpha)[None, None]
        hidden = F.interpolate(planes, seen.subject.shape, mode="area")[0, 0] < _SEEN
    said = [*_cells(measured, name), *_materials(measured, name)]
    if hidden is None:
        return said
    regions = ((each, each.claim.region(seen)) for each in said)
    return [each for each, where in regions if where is None or not (where & hidden).any()]


def _cells(picture: MeasuredPicture, name: str) -> Iterator[Statement]:
    height, width = picture.seen.subject.shape
    step = max(height, width) / _LONGER
    rows, columns = max(round(height / step), 1), max(round(width / step), 1)
    for row in range(rows):
        for column in range(columns):
            box = column / columns, row / rows, (column + 1) / columns, (row + 1) / rows
            place = f"{_WORDS[3 * row // rows]} {_SIDES[3 * column // columns]}"
            claim = Claim(f"{name}: {place}", "picture", "mean", "picture", (), (), box=box)
            yield from _exact("light", claim, picture, f"{name}: as it is at the {place} of the picture")


def _materials(picture: MeasuredPicture, name: str) -> Iterator[Statement]:
    for material in sorted(set(picture.seen.materials)):
        claim = Claim(f"{name}: {material}", material, "mean", "picture", (), (), materials=(material,))
        yield from _exact("materials", claim, picture, f"{name}: as {material} looks in it")


def _exact(trait: str, claim: Claim, picture: MeasuredPicture, reason: str) -> Iterator[Statement]:
    where = claim.region(picture.seen)
    if where is None:
        return
    value, reach = claim.value(picture, where).tolist(), _EXACT * MEASURES[claim.measure].notice
    lower, upper = tuple(v - reach for v in value), tuple(v + reach for v in value)
    yield Statement(trait, replace(claim, lower=lower, upper=upper, reason=reason))
