# SPDX-License-Identifier: Apache-2.0
"""Which colors light may have for the casts of a picture: from a weaker one to a stronger one of theirs, and no other hue.

Lamps whose colors are free find casts by canceling each other: a green one beside a pink one lights gray things gray, and
everything else in two colors that no picture has.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from ..claims.claim import Claim
from ..color.floats import linear_from_srgb, srgb_from_lab
from ..schema import Values

CASTS = ("shadow_cast", "midtone_cast", "highlight_cast", "cast")

_LIGHTNESS = 65.0  # L* at which a cast is taken for a color
_STRONGER, _WEAKER = 1.6, 0.5
"""How much stronger than the strongest cast a light's color may be, since other light lies over it, and how much weaker than
any. A range up to white would hold hues that are in no cast: pink and yellow beside orange."""
_FEW_HUES = 0.0  # cosine between the hues of two casts from where light may be of either, and of any between
_PALE, _COLORFUL = 6.0, 16.0
"""Mean C* up to which a picture is as good as gray, and how much more it has where all paint keeps its saturation."""
_STRONG = 6.0  # C* of a cast whose hue counts


@dataclass(frozen=True)
class LightColors:
    """The box of colors that a light may have.

    Attributes:
        lower: Linear, in [0, 1].
        upper: Likewise.
        any_hue: Whether they may be of any hue within, which is so where casts have several; else all are on the line
            between the two ends.
        paint: Saturation that is left to paint at least: a picture with colors in it takes nobody's away.
    """

    lower: Values
    upper: Values
    any_hue: bool
    paint: float


def light_colors(claims: Sequence[Claim]) -> LightColors:
    """The colors that the casts among some claims ask for.

    Args:
        claims: Of a picture, and of the words beside it.
    """
    casts = [_middle(claim) for claim in claims if claim.measure in CASTS]
    strong = [(a, b) for a, b in casts if math.hypot(a, b) > _STRONG]
    any_hue = any(_cosine(one, other) < _FEW_HUES for one in strong for other in strong)
    strongest = max(casts, key=lambda cast: math.hypot(*cast), default=(0.0, 0.0))
    colors = [_color(a, b) for a, b in (strong if any_hue else [strongest])]
    vivid = max((claim.upper[0] for claim in claims if claim.measure == "chroma"), default=0.0)
    paint = min(max(vivid - _PALE, 0.0) / _COLORFUL, 1.0)
    weak = [(0.0, 0.0)] if any_hue or not casts else casts
    ends = [*colors, *(_color(a, b, _WEAKER) for a, b in weak)]
    return LightColors(
        lower=tuple(map(min, zip(*colors, strict=True))),
        upper=tuple(map(max, zip(*ends, strict=True))),
        any_hue=any_hue,
        paint=paint,
    )


def _middle(claim: Claim) -> tuple[float, float]:
    a, b = ((low + high) / 2 for low, high in zip(claim.lower, claim.upper, strict=True))
    return a, b


def _color(a: float, b: float, times: float = _STRONGER) -> Values:
    """Linear color of light for so many times a cast, its greatest component 1."""
    linear = linear_from_srgb(srgb_from_lab((_LIGHTNESS, times * a, times * b)))
    return tuple(v / max(linear) for v in linear)


def _cosine(one: tuple[float, float], other: tuple[float, float]) -> float:
    return (one[0] * other[0] + one[1] * other[1]) / (math.hypot(*one) * math.hypot(*other))
