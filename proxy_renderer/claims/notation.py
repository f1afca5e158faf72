# SPDX-License-Identifier: Apache-2.0
"""Claims as text: "picture warmth 8.. or +4" in `heads.toml` and in the vocabulary."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

from ..schema import VibeError
from .measures.registry import MEASURES

PARTS = ("thing", "subject", "surroundings", "picture", "sky")
_CLAIM = re.compile(
    r"(?P<part>\w+) (?P<measure>\w+) (?P<lower>-?[\d.]*\d)?\.\.(?P<upper>-?[\d.]*\d)?(?: or (?P<change>[+-][\d.]+))?"
)


@dataclass(frozen=True)
class ClaimText:
    """A claim that is bound to no word yet.

    Attributes:
        part: One of `PARTS`; "thing" is what the word describes.
        measure: A key of `MEASURES`.
        lower: Of the interval.
        upper: Of the interval.
        change: What is enough of a change since the artist's picture; None if only the interval counts.
    """

    part: str
    measure: str
    lower: float = -math.inf
    upper: float = math.inf
    change: float | None = None


def read_claim(text: str) -> ClaimText:
    """Reads "PART MEASURE LOWER..UPPER [or CHANGE]"; an end that is left out is open.

    Example:
        >>> read_claim("picture warmth 8.. or +4")
        ClaimText(part='picture', measure='warmth', lower=8.0, upper=inf, change=4.0)

    Raises:
        VibeError: It is not of that form, or names a part or a measure that does not exist.
    """
    match = _CLAIM.fullmatch(text.strip())
    if not match or (match["lower"] is None and match["upper"] is None):
        raise VibeError(
            f"'{text}' is not a claim.",
            "Write 'PART MEASURE LOWER..UPPER', then 'or CHANGE' if a change is enough.",
        )
    for name, kinds, kind in ((match["part"], PARTS, "part"), (match["measure"], tuple(MEASURES), "measure")):
        if name not in kinds:
            raise VibeError(f"'{text}' names no {kind} of the picture.", f"Choose from: {', '.join(kinds)}.")
    lower = float(match["lower"]) if match["lower"] else -math.inf
    upper = float(match["upper"]) if match["upper"] else math.inf
    if lower > upper:
        raise VibeError(f"'{text}' has a lower end above the upper one.", "Swap them.")
    change = float(match["change"]) if match["change"] else None
    if change is not None and not math.isfinite(lower if change > 0 else upper):
        raise VibeError(f"'{text}' asks for a change away from its interval.", "Turn the sign of the change.")
    return ClaimText(match["part"], match["measure"], lower, upper, change)
