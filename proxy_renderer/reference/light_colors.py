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
_FEW_HUES = 0.0  # cosine between the hues of two casts from where each has a light of its own
_PALE, _COLORFUL = 6.0, 16.0
"""Mean C* up to which a picture is as good as gray, and how much more it has where all paint keeps its saturation."""
_STRONG = 6.0  # C* of a cast whose hue counts


@dataclass(frozen=True)
class LightColors:
    """The colors that light may have: on the line between the two ends of a range, for more than one line has more hues.

    Attributes:
        key: Of key lights: lower and upper end, linear, in [0, 1].
        fill: Of all other light, that of the world included.
        paint: Saturation that is left to paint at least: a picture with colors in it takes nobody's away.
    """

    key: tuple[Values, Values]
    fill: tuple[Values, Values]
    paint: float


def light_colors(claims: Sequence[Claim]) -> LightColors:
    """The colors that the casts among some claims ask for.

    All light takes the hue of the strongest cast. Where there is another one more than 90 degrees of hue apart, as teal
    beside orange, each has its own light: the key that of the picture's lights, all other light the opposite one.

    Args:
        claims: Of a picture, and of the words beside it.
    """
    casts = [_middle(claim) for claim in claims if claim.measure in CASTS] or [(0.0, 0.0)]
    lights = [_middle(claim) for claim in claims if claim.measure == "highlight_cast"]
    strong = [cast for cast in casts if math.hypot(*cast) > _STRONG]
    strongest = max(casts, key=lambda cast: math.hypot(*cast))
    key = next((cast for cast in lights if cast in strong), strongest)
    fill = min(strong, key=lambda cast: _cosine(cast, key), default=key)
    if _cosine(key, fill) >= _FEW_HUES:
        key = fill = strongest
    vivid = max((claim.upper[0] for claim in claims if claim.measure == "chroma"), default=0.0)
    paint = min(max(vivid - _PALE, 0.0) / _COLORFUL, 1.0)
    return LightColors(_line(key, casts), _line(fill, casts), paint)


def _line(cast: tuple[float, float], casts: Sequence[tuple[float, float]]) -> tuple[Values, Values]:
    """From a stronger one than a cast to a weaker one than any of its hue."""
    alike = [each for each in casts if _cosine(each, cast) >= _FEW_HUES]
    ends = [_color(*cast), *(_color(a, b, _WEAKER) for a, b in alike)]
    return ends[0], tuple(map(max, zip(*ends, strict=True)))


def _middle(claim: Claim) -> tuple[float, float]:
    a, b = ((low + high) / 2 for low, high in zip(claim.lower, claim.upper, strict=True))
    return a, b


def _color(a: float, b: float, times: float = _STRONGER) -> Values:
    """Linear color of light for so many times a cast, its greatest component 1."""
    linear = linear_from_srgb(srgb_from_lab((_LIGHTNESS, times * a, times * b)))
    return tuple(v / max(linear) for v in linear)


def _cosine(one: tuple[float, float], other: tuple[float, float]) -> float:
    """Between two hues; 1 if one of them is gray."""
    lengths = math.hypot(*one) * math.hypot(*other)
    return (one[0] * other[0] + one[1] * other[1]) / lengths if lengths > 1e-9 else 1.0
