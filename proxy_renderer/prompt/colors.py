# SPDX-License-Identifier: Apache-2.0
"""What the colors that words name come to: on the display, in the air, and in the regions of the picture."""

from __future__ import annotations

from ..color.constants import Lab
from ..color.floats import chroma, lab_from_srgb
from ..color.shades import basic, shade
from ..schema import Values
from ..schema.spec import Region
from .lexicon.attributes import COLORS
from .types import Attribute, Parsed

_BLACK = 12.0  # L* of a black thing whose form can be seen
_DARKEST, _LIGHTEST = 14.0, 78.0  # L* of lit things of a strong color, navy and yellow
_STRONG, _KEPT = 30.0, 0.7  # C* that lit things show in full, and the share of what a color has beyond it
COLOR_REGIONS: dict[str, Region] = {
    "subject": "subject", "surroundings": "surroundings", "sky": "surroundings", "fog": "surroundings",
}  # fmt: skip
"""Kind of thing -> the region that has its color, fog last."""


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


def color_regions(parsed: Parsed, attributes: list[Attribute]) -> None:
    """Lab targets: from the color words of the subject and of what lies around it.

    Args:
        parsed: Gets the colors, and what contradicts them.
        attributes: Those that count.
    """
    parsed.colors = {}
    for kind, region in COLOR_REGIONS.items():
        named = [(a, a.color) for a in attributes if a.kind == kind and a.color and not a.negated]
        named.sort(key=lambda each: (bool(each[0].cause), bool(each[0].owners) and kind == "subject"))
        for attribute, color in named:
            first = named[0][0]
            if region not in parsed.colors:
                parsed.colors[region] = display_color(fog_color(color) if kind == "fog" else color, region)
                parsed.targets[f"{region}_color"] = color_class(attribute)
            elif first.entry != attribute.entry and not (attribute.cause or attribute.owners):
                parsed.conflicts.append(
                    f"'{attribute.word}' gives way to '{first.word}', which was named first."
                )
