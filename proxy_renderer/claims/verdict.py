# SPDX-License-Identifier: Apache-2.0
"""Verdicts: whether claims hold, on the artist's picture, on the prediction and on the finished one."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import torch
from torch import Tensor

from ..color.floats import hex_from_srgb, srgb_from_oklab
from ..render.gbuffer import GBuffer
from .claim import HOLDS, Claim, ClaimSet
from .measures.picture import MeasuredPicture
from .measures.registry import MEASURES

_COLORS = ("color", "mean")
"""Measures in OKLab."""

_BLACK = 0.02
"""Of white, as a picture is stored: what is darker everywhere shows nothing."""


@dataclass(frozen=True)
class ShotClaims:
    """The claims about one shot, ready to be judged on its pictures.

    Attributes:
        claims: Of the prompt.
        before: What the camera sees at the artist's values.
        after: What it sees at the result's.
    """

    claims: tuple[Claim, ...]
    before: GBuffer
    after: GBuffer

    def verdicts(self, before: Tensor, predicted: Tensor, after: Tensor) -> list[dict[str, Any]]:
        """What `report.json` says of every claim.

        Args:
            before: (H, W, 3) the artist's picture, of any size like the others.

        Returns:
            For each claim: word, thing, measure, says, unit, wanted, before, predicted, after, holds, miss, and the
            `reason` where there is one. `holds` is
            None where the thing is hardly seen; `miss` is how many noticeable steps the picture lies outside of what
            is wanted.
        """
        with torch.no_grad():
            judged = ClaimSet.about(self.claims, MeasuredPicture.of(before, self.before)).in_view(self.after)
            guesses, values = (self._values(judged, picture) for picture in (predicted, after))
        rows = zip(judged.claims, judged.before, guesses, values, strict=True)
        return [_verdict(*row) for row in rows]

    def _values(self, judged: ClaimSet, picture: Tensor) -> list[Tensor | None]:
        """What a picture has of each claim: nothing, where all of it is black."""
        if picture.max() < _BLACK:
            return [None] * len(judged.claims)
        return judged.values(MeasuredPicture.of(picture, self.after))


def _verdict(
    claim: Claim, before: Tensor | None, predicted: Tensor | None, after: Tensor | None
) -> dict[str, Any]:
    miss = None if after is None else claim.miss(after, before)
    return {
        "word": claim.word,
        "thing": claim.thing,
        "measure": claim.measure,
        "says": MEASURES[claim.measure].says,
        "unit": MEASURES[claim.measure].unit,
        "wanted": wanted(claim, before),
        "before": _shown(claim, before),
        "predicted": _shown(claim, predicted),
        "after": _shown(claim, after),
        "holds": None if miss is None else miss <= HOLDS,
        "miss": None if miss is None else round(miss, 2),
        **({"reason": claim.reason} if claim.reason else {}),
    }


def wanted(claim: Claim, before: Tensor | None) -> str:
    """What a claim asks for, in a few words: "at least 8", "#1fb5b5"."""
    if claim.measure in _COLORS:
        return _hex(claim.oklab(tuple((a + b) / 2 for a, b in zip(claim.lower, claim.upper, strict=True))))
    if len(claim.lower) > 1:
        return ", ".join(_range(*ends) for ends in zip(claim.lower, claim.upper, strict=True))
    return _range(*(end[0] for end in claim.interval(before)))


def _range(lower: float, upper: float) -> str:
    if math.isinf(upper):
        return f"at least {lower:.3g}"
    return f"at most {upper:.3g}" if math.isinf(lower) else f"{lower:.3g} to {upper:.3g}"


def _shown(claim: Claim, value: Tensor | None) -> float | str | None:
    if value is None:
        return None
    if claim.measure in _COLORS:
        return _hex(claim.oklab(tuple(value.tolist())))
    return round(float(value[0]), 3) if len(value) == 1 else ", ".join(f"{v:.3g}" for v in value.tolist())


def _hex(oklab: Sequence[float]) -> str:
    return hex_from_srgb(srgb_from_oklab((oklab[0] / 100, oklab[1] / 100, oklab[2] / 100)))
