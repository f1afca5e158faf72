# SPDX-License-Identifier: Apache-2.0
"""What the colors that words name come to: on the display, and in the air."""

from __future__ import annotations

from ..color.constants import Lab
from ..color.floats import chroma, lab_from_srgb
from ..color.shades import basic, shade
from ..schema import Values
from ..schema.spec import Region
from .lexicon.attributes import COLORS
from .types import Attribute

_BLACK = 12.0  # L* of a black thing whose form can be seen
_DARKEST, _LIGHTEST = 14.0, 78.0  # L* of lit things of a strong color, navy and yellow
_STRONG, _KEPT = 30.0, 0.7  # C* that lit things show in full, and the share of what a color has beyond it


def color_class(attribute: Attribute) -> str:
    """The basic color of a color word: its own last word where that is one ("light blue")."""
    last = attribute.entry.rpartition(" ")[2].replace("gray", "grey")
    return last if last in COLORS else basic(attribute.color or (0.5, 0.5, 0.5))


def display_color(color: tuple[float, ...], region: Region) -> Lab:
    """A Lab value that a lit region of a color can reach on the display.

    Shading and the view transform's shoulder keep saturated colors from the gamut's corners, and
    nothing lit is as black as its name.
    """
    light, a, b = lab_from_srgb(color)
    if (own := chroma((light, a, b))) > _STRONG:
        kept = (_STRONG + _KEPT * (own - _STRONG)) / own
        return min(max(light, _DARKEST), _LIGHTEST), kept * a, kept * b
    ceiling = 95.0 if region == "surroundings" else 86.0
    return min(max(light, _BLACK), ceiling), a, b


def fog_color(srgb: Values) -> Values:
    """The display color of fog that is called this: scattering makes it paler, and neither dark nor white."""
    return shade(srgb, lightness=0.4, chroma=0.6, towards=70.0)
