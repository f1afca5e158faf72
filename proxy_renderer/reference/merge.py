# SPDX-License-Identifier: Apache-2.0
"""Words and a picture together: words count more, and move what the picture claims to where they hold."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

from ..claims.claim import Claim
from .light_colors import CASTS

_WARMER = (0.4, 0.8)
"""In a* and b*, one step of warmth, see `claims.measures.color.warmth`."""

_LIGHTER = {
    "black_point": (0.2,),
    "lower_quartile": (0.8,),
    "median": (1.0,),
    "upper_quartile": (0.8,),
    "white_point": (0.2,),
    "lightness": (1.0,),
}
"""The ends move less: a picture that is lighter has black in it all the same."""

MOVED: Mapping[str, Mapping[str, tuple[float, ...]]] = {
    "lightness": _LIGHTER,
    "warmth": dict.fromkeys(CASTS, _WARMER),
    "shadow_warmth": {"shadow_cast": _WARMER},
    "highlight_warmth": {"highlight_cast": _WARMER},
    "contrast": {
        "black_point": (-0.5,),
        "lower_quartile": (-0.25,),
        "upper_quartile": (0.25,),
        "white_point": (0.5,),
    },
}
"""What words measure -> what a picture measures of the same, and how far each of its numbers moves for one of the word's.
The picture's own pattern stays: lights that are warmer than shadows are so in a colder picture, too."""

_SETTLED = {
    "tint": CASTS,
    "accent": CASTS,
    "off_hue": CASTS,
    "color": ("cast", "lightness", "mean"),
    "brown_distance": CASTS,
    "burnt": ("white_point",),
}
"""What words measure -> what they settle of the same part, whatever the picture has."""

_SEEN = 2.5
"""Changes that are enough in words alone, from where "colder" is seen beside a picture."""
_HOLDS = 0.8
"""Share of the way from where a comparison holds."""


def together(
    words: Sequence[Claim], picture: Sequence[Claim], has: Callable[[Claim], float | None]
) -> tuple[Claim, ...]:
    """The words' claims, and those of a picture that they leave.

    Of one measure and part the picture's is dropped. Where words ask for more or less of something than the picture has, its
    claims of the same move along: to where the word holds, or, of a word that compares, as "colder" does, by what is clearly
    seen. Such a word is then measured against the picture, too.

    Args:
        has: What the picture itself has of a word's claim; None where that cannot be told.
    """
    said, left = [], list(picture)
    for word in words:
        if not word.word:  # it holds of every picture
            said.append(word)
            continue
        left = [claim for claim in left if not _settles(word, claim)]
        own = has(word) if word.measure in MOVED or word.compares else None
        if own is None:
            said.append(word)
            continue
        way = _way(word, own)
        left = [_moved(claim, word, way) for claim in left]
        said.append(_against(word, own, way) if word.compares else word)
    return (*said, *left)


def _settles(word: Claim, claim: Claim) -> bool:
    same = word.part == claim.part or word.part == "picture"
    return same and (word.measure == claim.measure or claim.measure in _SETTLED.get(word.measure, ()))


def _way(word: Claim, own: float) -> float:
    """How far a word moves what a picture has."""
    if word.change is not None and (word.compares or not word.near):
        return _SEEN * word.change
    return min(max(own, word.lower[0]), word.upper[0]) - own


def _moved(claim: Claim, word: Claim, way: float) -> Claim:
    along = MOVED.get(word.measure, {}).get(claim.measure)
    if along is None or word.part not in ("picture", claim.part):
        return claim
    lower, upper = (
        tuple(v + way * share for v, share in zip(end, along, strict=True))
        for end in (claim.lower, claim.upper)
    )
    return replace(claim, lower=lower, upper=upper)


def _against(word: Claim, own: float, way: float) -> Claim:
    """A word that compares, as a claim against what the picture has."""
    if word.change is None:
        return word
    border = own + _HOLDS * way
    lower, upper = (border, math.inf) if way > 0.0 else (-math.inf, border)
    return replace(word, lower=(lower,), upper=(upper,), change=None)
