# SPDX-License-Identifier: Apache-2.0
"""The quantities that words are about, "finish" or "brightness" (`quantities.toml`), with claims on them as text.

A claim is "PART MEASURE [#RRGGBB] [in BOX] [by] LOWER..UPPER [or [any] CHANGE] [xWEIGHT] [(REASON)]", for example
"picture warmth 8.. or +4". The color is the direction of `tint` and `accent`. Ends of several numbers have commas. A
value outside the interval is enough if it has changed by CHANGE since the artist's image and is near the interval, or
anywhere with "any". "or +0" accepts an excess that the artist's image has already. With "by", both ends are noticeable
steps from the value of the artist's image: "picture warmth by 2..4".
"""

from __future__ import annotations

import math
import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from operator import gt
from pathlib import Path

from ...schema import Values, VibeError

COLORS = (
    "black", "grey", "white", "brown", "red", "orange", "yellow", "green", "teal", "blue", "purple", "pink",
)  # fmt: skip
PARTS = ("thing", "subject", "surroundings", "picture", "sky")
_TINTS = ("tint", "accent")  # measures that need a color, in whose direction they measure
_IN_TWO = ("off_hue", "cast", "shadow_cast", "midtone_cast", "highlight_cast", "chromaticity")
_NUMBERS = {"color": 3, "mean": 3, **dict.fromkeys(_IN_TWO, 2)}  # measure -> how many, if several
_NUMBER = r"-?\d*\.?\d+"
_END = rf"{_NUMBER}(?:,{_NUMBER})*"
_CLAIM = re.compile(
    rf"(?P<part>\w+) (?P<measure>\w+)(?: (?P<color>#[0-9a-fA-F]{{6}}))?(?: in (?P<box>{_END}))?"
    rf"(?P<by> by)? (?P<lower>{_END})?\.\.(?P<upper>{_END})?(?: or (?P<any>any )?(?P<change>[+-]\d*\.?\d+))?"
    rf"(?: x(?P<weight>\d*\.?\d+))?(?: \((?P<reason>(?s:.+))\))?"
)
_LESS = 2.0  # multiple of a claim's change by which a mild claim asks for less at strength 0


@dataclass(frozen=True)
class ClaimText:
    """A claim that is bound to no word yet."""

    part: str  # one of `PARTS`; "thing" is what the word describes
    measure: str  # a key of `claims.measures.MEASURES`
    lower: Values = (-math.inf,)  # of the interval, a number for each that the measure gives
    upper: Values = (math.inf,)  # likewise
    # change since the artist's image that is enough, too; None if only the interval counts
    change: float | None = None
    near: bool = True  # whether a change is enough near the interval only
    color: str = ""  # "#rrggbb" in whose direction a tint counts; "" for measures that need none
    box: Values = ()  # left, upper, right and lower end, as shares of the frame's width and height; () for all of it
    weight: float = 1.0  # of a missed step in the search; 0 if it only states a fact, for "colder"
    reason: str = ""  # why it is claimed; "" where the word says it
    by: bool = False  # whether both ends are noticeable steps from the value of the artist's image

    def __str__(self) -> str:
        """The claim as a text that `read_claim` reads."""
        lower, upper = (_joined(end) if math.isfinite(end[0]) else "" for end in (self.lower, self.upper))
        color = f" {self.color}" if self.color else ""
        box = f" in {_joined(self.box)}" if self.box else ""
        change = "" if self.change is None else f" or {'' if self.near else 'any '}{self.change:+.6g}"
        weight = "" if self.weight == 1.0 else f" x{self.weight:.6g}"
        reason = f" ({self.reason})" if self.reason else ""
        by = " by" if self.by else ""
        return f"{self.part} {self.measure}{color}{box}{by} {lower}..{upper}{change}{weight}{reason}"

    def of_strength(self, strength: float, mild: bool) -> ClaimText:
        """The claim with its change times `strength`; if `mild`, also with its ends nearer to no change."""
        lower, upper, change = self.lower, self.upper, self.change
        if not change:
            return self
        if mild:
            less, middle = (1.0 - min(strength, 1.0)) * _LESS * change, (lower[0] + upper[0]) / 2
            ends = (lower[0] - less, upper[0]) if change > 0 else (lower[0], upper[0] - less)
            if math.isfinite(middle):
                ends = (ends[0], middle) if change > 0 else (middle, ends[1])
            lower, upper = (ends[0],), (ends[1],)
        return replace(self, lower=lower, upper=upper, change=change * strength)


def _joined(numbers: Values) -> str:
    return ",".join(f"{round(v, 4):.9g}" for v in numbers)


def warmth_asked(measure: str, lower: float, upper: float) -> int:
    """1 for an interval of warmth that asks for warm light, -1 for cool; 0 for neither, and for other measures."""
    if measure != "warmth":
        return 0
    return 1 if lower > 0.0 else -1 if upper < 0.0 else 0


def read_claim(text: str) -> ClaimText:
    """The claim of a text, see the head of this file; an end that is left out is open. Raises VibeError if it is wrong.

    Example:
        >>> read_claim("picture warmth 8.. or +4").lower
        (8.0,)
    """
    match = _CLAIM.fullmatch(text.strip())
    if not match or (match["lower"] is None and match["upper"] is None):
        remedy = "Write 'PART MEASURE LOWER..UPPER', then 'or CHANGE' if a change is enough."
        raise VibeError(f"'{text}' is not a claim.", remedy)
    measure, color, by = match["measure"], match["color"] or "", bool(match["by"])
    box, count = _numbers(match["box"]), _NUMBERS.get(measure, 1)
    lower = _numbers(match["lower"]) or (-math.inf,) * count
    upper = _numbers(match["upper"]) or (math.inf,) * count
    change = float(match["change"]) if match["change"] else None
    away = change and (count > 1 or not math.isfinite((lower if change > 0 else upper)[0]))
    framed = not box or (len(box) == 4 and 0.0 <= box[0] < box[2] <= 1.0 and 0.0 <= box[1] < box[3] <= 1.0)
    numbers = "one number" if count == 1 else f"{count} numbers, joined by commas,"
    for wrong, problem, remedy in (
        (match["part"] not in PARTS, "names no part of the picture", f"Choose from: {', '.join(PARTS)}."),
        (bool(color) != (measure in _TINTS), "needs a color, or has one too many", "Write '#rrggbb' after a measure of tints, and after no other."),
        ({len(lower), len(upper)} != {count}, "has another count of numbers than its measure", f"Write {numbers} at each end."),
        (any(map(gt, lower, upper)), "has a lower end above the upper one", "Swap them."),
        (away, "asks for a change away from its interval", "Turn the sign of the change."),
        (not framed, "has no part of the frame after 'in'", "Write its ends as shares of the frame: 'in 0,0,0.5,1'."),
        (by and change is not None, "has two changes", "Leave out 'by' or 'or'."),
    ):  # fmt: skip
        if wrong:
            raise VibeError(f"'{text}' {problem}.", remedy)
    weight, reason = float(match["weight"] or 1.0), match["reason"] or ""
    return ClaimText(match["part"], measure, lower, upper, change, not match["any"], color, box, weight, reason, by)


def _numbers(text: str | None) -> Values:
    return tuple(map(float, text.split(","))) if text else ()


@dataclass(frozen=True)
class Quantity:
    """A property that words ask for, parameters change and measures read: "finish", "haze"."""

    name: str  # its key in the table
    says: str  # what it is called in sentences
    exclusive: bool = False  # whether only one of two words wins, even if they name different parameters
    softly: bool = False  # whether its classes are meant under "slightly" too
    classes: Mapping[str, tuple[ClaimText, ...]] = field(default_factory=dict)  # class -> what it claims
    softer: Mapping[str, str] = field(default_factory=dict)  # class -> class under "slightly"


@dataclass(frozen=True)
class QuantityTable:
    """All quantities, with their parameters and measures."""

    by_name: Mapping[str, Quantity]  # name -> quantity, in the order of the table
    parameters: Mapping[str, str]  # "OWNER/PARAMETER MODE", "OWNER/PARAMETER" or a family -> its quantity
    measures: Mapping[str, str]  # "PART MEASURE" or "MEASURE" -> name of its quantity
    seen: Mapping[str, float]  # MEASURE -> noticeable steps from which judges saw a change; inf: from none

    def of_parameter(self, owner: str, family: str, mode: str) -> str:
        """Name of the quantity of an effect: of owner "key" on family "light/power", say. Raises VibeError without one.

        The most specific row of the table counts.
        """
        name = family.partition("/")[2]
        rows = (f"{owner}/{name} {mode}", f"{owner}/{name}", f"{family} {mode}", family)
        found = next((self.parameters[row] for row in rows if row in self.parameters), "")
        if not found:
            raise VibeError(f"No quantity has the parameter '{family}'.", "Add it to one in quantities.toml.")
        return found

    def of_claim(self, claim: ClaimText) -> str:
        """Name of the quantity that a claim measures. Raises VibeError if there is no such measure."""
        for row in (f"{claim.part} {claim.measure}", claim.measure):
            if row in self.measures:
                return self.measures[row]
        known = sorted({row.rpartition(" ")[2] for row in self.measures})
        remedy = f"Choose from: {', '.join(known)}."
        raise VibeError(f"'{claim.part} {claim.measure}' is no measure of the picture.", remedy)


@cache
def quantities() -> QuantityTable:
    """The table that is shipped."""
    rows = tomllib.loads(Path(__file__).with_name("quantities.toml").read_text("utf-8"))
    by_name, seen = {}, dict[str, float]()
    for name, row in rows.items():
        classes = {each: tuple(map(read_claim, texts)) for each, texts in row.get("classes", {}).items()}
        ways = row.get("exclusive", False), row.get("softly", False)
        by_name[name] = Quantity(name, row["says"], *ways, classes, row.get("softer", {}))
        seen |= {measure: steps or math.inf for measure, steps in row.get("seen", {}).items()}
    parameters, measures = (
        {each: name for name, row in rows.items() for each in row.get(key, ())} for key in ("parameters", "measures")
    )
    return QuantityTable(by_name, parameters, measures, seen)
