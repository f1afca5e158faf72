# SPDX-License-Identifier: Apache-2.0
"""The quantities that words are about, "finish" or "brightness" (`quantities.toml`), with claims on them as text.

A claim is "PART MEASURE [#RRGGBB] LOWER..UPPER [or [any] CHANGE]": "picture warmth 8.. or +4". The color is the direction of measures
that need one, as `tint` and `accent` do. A change is enough near the interval only, or, with "any", wherever it ends: "paler" is so
of black, too.
"""

from __future__ import annotations

import math
import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

from ...schema import VibeError

COLORS = (
    "black", "grey", "white", "brown", "red", "orange", "yellow", "green", "teal", "blue", "purple", "pink",
)  # fmt: skip

ATTRIBUTES: dict[str, tuple[str, ...]] = {
    "subject_color": COLORS,
    "surroundings_color": COLORS,
    "subject_finish": ("matte", "satin", "glossy"),
    "subject_metal": ("dielectric", "metal"),
    "light_side": ("left", "front", "right", "back", "top"),
    "light_softness": ("hard", "soft"),
    "light_temperature": ("warm", "neutral", "cool"),
    "fog": ("none", "light", "thick"),
    "brightness": ("dark", "medium", "bright"),
    "contrast": ("low", "medium", "high"),
    "saturation": ("muted", "natural", "vivid"),
    "vignette": ("none", "vignette"),
}
"""Attribute name -> its classes; an ordered scale where there is one. The trained heads have this order."""
PARTS = ("thing", "subject", "surroundings", "picture", "sky")
_TINTS = ("tint", "accent")
"""Measures of which only what lies in the direction of a color counts."""
_CLAIM = re.compile(
    r"(?P<part>\w+) (?P<measure>\w+)(?: (?P<color>#[0-9a-fA-F]{6}))? (?P<lower>-?[\d.]*\d)?\.\.(?P<upper>-?[\d.]*\d)?"
    r"(?: or (?P<any>any )?(?P<change>[+-][\d.]+))?"
)


@dataclass(frozen=True)
class ClaimText:
    """A claim that is bound to no word yet."""

    part: str  # one of `PARTS`; "thing" is what the word describes
    measure: str  # a key of `claims.measures.registry.MEASURES`
    lower: float = -math.inf  # of the interval
    upper: float = math.inf  # of the interval
    # what is enough of a change since the artist's picture; None if only the interval counts
    change: float | None = None
    near: bool = True  # whether a change is enough near the interval only
    color: str = ""  # "#rrggbb" in whose direction a tint counts; "" for measures that need none

    def __str__(self) -> str:
        """As `read_claim` reads it."""
        lower, upper = (f"{end:.6g}" if math.isfinite(end) else "" for end in (self.lower, self.upper))
        color = f" {self.color}" if self.color else ""
        change = "" if self.change is None else f" or {'' if self.near else 'any '}{self.change:+.6g}"
        return f"{self.part} {self.measure}{color} {lower}..{upper}{change}"


def warmth_asked(measure: str, lower: float, upper: float) -> int:
    """1 for an interval that asks for warmth, -1 for one that asks for coolness, 0 for others and for other measures."""
    if measure != "warmth":
        return 0
    return 1 if lower > 0.0 else -1 if upper < 0.0 else 0


def read_claim(text: str) -> ClaimText:
    """Reads "PART MEASURE [#RRGGBB] LOWER..UPPER [or [any] CHANGE]"; an end that is left out is open.

    Example:
        >>> read_claim("picture warmth 8.. or +4")
        ClaimText(part='picture', measure='warmth', lower=8.0, upper=inf, change=4.0, near=True, color='')

    Raises:
        VibeError: It is not of that form, or names a part or a measure that does not exist.
    """
    match = _CLAIM.fullmatch(text.strip())
    if not match or (match["lower"] is None and match["upper"] is None):
        raise VibeError(
            f"'{text}' is not a claim.",
            "Write 'PART MEASURE LOWER..UPPER', then 'or CHANGE' if a change is enough.",
        )
    if match["part"] not in PARTS:
        raise VibeError(f"'{text}' names no part of the picture.", f"Choose from: {', '.join(PARTS)}.")
    if bool(match["color"]) != (match["measure"] in _TINTS):
        raise VibeError(
            f"'{text}' needs a color, or has one too many.",
            "Write '#rrggbb' after a measure of tints, and after no other.",
        )
    lower = float(match["lower"]) if match["lower"] else -math.inf
    upper = float(match["upper"]) if match["upper"] else math.inf
    if lower > upper:
        raise VibeError(f"'{text}' has a lower end above the upper one.", "Swap them.")
    change = float(match["change"]) if match["change"] else None
    if change is not None and not math.isfinite(lower if change > 0 else upper):
        raise VibeError(f"'{text}' asks for a change away from its interval.", "Turn the sign of the change.")
    near, color = not match["any"], match["color"] or ""
    return ClaimText(match["part"], match["measure"], lower, upper, change, near, color)


@dataclass(frozen=True)
class Quantity:
    """What parameters serve, measures measure, and words wish for."""

    name: str  # its key in the table
    says: str  # what it is called in sentences
    # whether of two words one has its way, though they name it by different parameters or measures
    exclusive: bool = False
    softly: bool = False  # whether its classes are meant under "slightly" too
    # name of a class -> what it claims of the image
    classes: Mapping[str, tuple[ClaimText, ...]] = field(default_factory=dict)
    softer: Mapping[str, str] = field(default_factory=dict)  # class -> class under "slightly"


@dataclass(frozen=True)
class QuantityTable:
    """All quantities, and what belongs to each."""

    by_name: Mapping[str, Quantity]  # name -> quantity, in the order of the table
    # "OWNER/PARAMETER MODE", "OWNER/PARAMETER" or a family of parameters -> name of its quantity
    parameters: Mapping[str, str]
    measures: Mapping[str, str]  # "PART MEASURE" or "MEASURE" -> name of its quantity

    def of_parameter(self, owner: str, family: str, mode: str) -> str:
        """The quantity that an effect serves: the name of the most specific row.

        Args:
            owner: As an effect names it: "key", "others", "material".
            family: Of the parameter: "light/power".

        Raises:
            VibeError: No row has it.
        """
        name = family.partition("/")[2]
        rows = (f"{owner}/{name} {mode}", f"{owner}/{name}", f"{family} {mode}", family)
        found = next((self.parameters[row] for row in rows if row in self.parameters), "")
        if not found:
            raise VibeError(f"No quantity has the parameter '{family}'.", "Add it to one in quantities.toml.")
        return found

    def of_claim(self, claim: ClaimText) -> str:
        """The quantity that a claim measures. Raises VibeError if there is no such measure."""
        for row in (f"{claim.part} {claim.measure}", claim.measure):
            if row in self.measures:
                return self.measures[row]
        known = sorted({row.rpartition(" ")[2] for row in self.measures})
        raise VibeError(
            f"'{claim.part} {claim.measure}' is no measure of the picture.",
            f"Choose from: {', '.join(known)}.",
        )


@cache
def quantities() -> QuantityTable:
    """The table that is shipped."""
    rows = tomllib.loads(Path(__file__).with_name("quantities.toml").read_text("utf-8"))
    return QuantityTable(
        {name: _quantity(name, row) for name, row in rows.items()},
        {parameter: name for name, row in rows.items() for parameter in row.get("parameters", ())},
        {measure: name for name, row in rows.items() for measure in row.get("measures", ())},
    )


def _quantity(name: str, row: Mapping[str, Any]) -> Quantity:
    classes = {each: tuple(map(read_claim, texts)) for each, texts in row.get("classes", {}).items()}
    return Quantity(
        name,
        row["says"],
        row.get("exclusive", False),
        row.get("softly", False),
        classes,
        row.get("softer", {}),
    )
