# SPDX-License-Identifier: Apache-2.0
"""Claims as text: "picture warmth 8.. or +4" in `quantities.toml` and in the vocabulary.

"PART MEASURE [#RRGGBB] LOWER..UPPER [or [any] CHANGE]". The color is the direction of measures that need one, as `tint`
and `accent` do. A change is enough near the interval only, or, with "any", wherever it ends: "paler" is so of black, too.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

from ...schema import VibeError

PARTS = ("thing", "subject", "surroundings", "picture", "sky")
_TINTS = ("tint", "accent")
"""Measures of which only what lies in the direction of a color counts."""
_CLAIM = re.compile(
    r"(?P<part>\w+) (?P<measure>\w+)(?: (?P<color>#[0-9a-fA-F]{6}))? (?P<lower>-?[\d.]*\d)?\.\.(?P<upper>-?[\d.]*\d)?"
    r"(?: or (?P<any>any )?(?P<change>[+-][\d.]+))?"
)


@dataclass(frozen=True)
class ClaimText:
    """A claim that is bound to no word yet.

    Attributes:
        part: One of `PARTS`; "thing" is what the word describes.
        measure: A key of `claims.measures.MEASURES`.
        lower: Of the interval.
        upper: Of the interval.
        change: What is enough of a change since the artist's picture; None if only the interval counts.
        near: Whether a change is enough near the interval only.
        color: "#rrggbb" in whose direction a tint counts; "" for measures that need none.
    """

    part: str
    measure: str
    lower: float = -math.inf
    upper: float = math.inf
    change: float | None = None
    near: bool = True
    color: str = ""

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
