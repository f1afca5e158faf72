# SPDX-License-Identifier: Apache-2.0
"""Words and a picture together: words count more."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from ..claims.claim import Claim

_TONES = ("black_point", "lower_quartile", "median", "upper_quartile", "white_point", "lightness")
_TINTS = ("shadow_tint", "midtone_tint", "highlight_tint", "tint")
_WARMTH = 1
"""Of a tint, the component that warm and cold are told by: b*."""

_OPENED = {
    "lightness": (_TONES, 0),
    "burnt": (("white_point",), 0),
    "warmth": (_TINTS, _WARMTH),
    "shadow_warmth": (("shadow_tint",), _WARMTH),
    "highlight_warmth": (("highlight_tint",), _WARMTH),
    "contrast": (("black_point", "lower_quartile"), 0),
}
"""What words measure -> what a picture measures of the same, and its component. "Colder" lets tints be bluer than the
picture's, and leaves how green or red they are."""

_SETTLED = {
    "tint": _TINTS,
    "accent": _TINTS,
    "color": ("tint", "lightness", "mean"),
    "brown_distance": _TINTS,
}
"""What words measure -> what they settle of the same part, whatever the picture has."""


def together(words: Sequence[Claim], picture: Sequence[Claim]) -> tuple[Claim, ...]:
    """The words' claims, and those of a picture that they leave.

    Of one measure and part the picture's is dropped; where words ask for more or less of something, the picture's interval
    is open on that side.

    Args:
        words: Claims of a prompt.
        picture: Claims of a picture.
    """
    said = [claim for claim in words if claim.word]
    left: list[Claim] = []
    for claim in picture:
        if any(_settles(word, claim) for word in said):
            continue
        for word in said:
            claim = _opened(word, claim)
        left.append(claim)
    return (*words, *left)


def _settles(word: Claim, claim: Claim) -> bool:
    same = word.part == claim.part or word.part == "picture"
    return same and (word.measure == claim.measure or claim.measure in _SETTLED.get(word.measure, ()))


def _opened(word: Claim, claim: Claim) -> Claim:
    measures, component = _OPENED.get(word.measure, ((), 0))
    if claim.measure not in measures or word.part not in ("picture", claim.part):
        return claim
    lower, upper = list(claim.lower), list(claim.upper)
    if math.isinf(word.lower[0]) or word.measure == "contrast":
        lower[component] = -math.inf
    if math.isinf(word.upper[0]) and word.measure != "contrast":
        upper[component] = math.inf
    return replace(claim, lower=tuple(lower), upper=tuple(upper))
