# SPDX-License-Identifier: Apache-2.0
"""The quantities that words are about: "finish", "direction", "brightness"; from `quantities.toml`."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

from ...schema import VibeError
from .claim_text import ClaimText, read_claim


@dataclass(frozen=True)
class Quantity:
    """What parameters serve, measures measure, and words wish for.

    Attributes:
        name: Its key in the table.
        says: What it is called in sentences.
        exclusive: Whether of two words one has its way, though they name it by different parameters or measures.
        softly: Whether its classes are meant under "slightly" too.
        classes: Name of a class -> what it claims of the image.
        softer: Class -> class under "slightly".
    """

    name: str
    says: str
    exclusive: bool = False
    softly: bool = False
    classes: Mapping[str, tuple[ClaimText, ...]] = field(default_factory=dict)
    softer: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class QuantityTable:
    """All quantities, and what belongs to each.

    Attributes:
        by_name: Name -> quantity, in the order of the table.
        parameters: "OWNER/PARAMETER MODE", "OWNER/PARAMETER" or a family of parameters -> name of its quantity.
        measures: "PART MEASURE" or "MEASURE" -> name of its quantity.
    """

    by_name: Mapping[str, Quantity]
    parameters: Mapping[str, str]
    measures: Mapping[str, str]

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
        """The quantity that a claim measures.

        Raises:
            VibeError: There is no such measure.
        """
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
