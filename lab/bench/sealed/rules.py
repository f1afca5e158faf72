# SPDX-License-Identifier: Apache-2.0
"""The rules of `rules.toml`: what has to be measured for a word to hold."""

from __future__ import annotations

import math
import tomllib
from dataclasses import dataclass
from functools import cache
from pathlib import Path


@dataclass(frozen=True)
class Rule:
    """A rule; `rules.toml` says what its fields are.

    Attributes:
        name: Of the rule.
        measure: A measure of pictures; "" for a value of the report.
        value: A parameter of materials; "" for a measure.
        part: Of the picture.
        least: Of the interval.
        most: Of the interval.
        change: Enough of a change since the artist's picture; None where only the interval counts.
        bound: What has to be reached for a change to count; None where any change counts that is large enough.
        clashes: Measures that no other ask of the prompt may have a rule of.
    """

    name: str
    measure: str = ""
    value: str = ""
    part: str = "picture"
    least: float = -math.inf
    most: float = math.inf
    change: float | None = None
    bound: float | None = None
    clashes: tuple[str, ...] = ()

    @property
    def takes(self) -> str:
        """Its measure, or the parameter that it reads."""
        return self.measure or self.value

    def holds(self, after: float, before: float | None) -> bool:
        """True if an amount is what is wanted.

        Args:
            before: Of the artist's; None where it cannot be measured.
        """
        if self.least <= after <= self.most:
            return True
        if self.change is None or before is None:
            return False
        way = math.copysign(1.0, self.change)
        far_enough = self.bound is None or way * after >= way * self.bound
        return far_enough and way * (after - before) >= way * self.change

    @property
    def wanted(self) -> str:
        """As in "at least 8, or +4 to beyond 0"."""
        ends = [f"at least {self.least:g}"] if math.isfinite(self.least) else []
        ends += [f"at most {self.most:g}"] if math.isfinite(self.most) else []
        return " and ".join(ends) + ("" if self.change is None else f", or {self.change:+g}{self._beyond}")

    @property
    def _beyond(self) -> str:
        return "" if self.bound is None else f" to beyond {self.bound:g}"


def rule(name: str) -> Rule:
    """The rule of a name.

    Raises:
        KeyError: There is none.
    """
    return rules()[name]


@cache
def rules() -> dict[str, Rule]:
    """All rules by name."""
    rows = tomllib.loads((Path(__file__).parent / "rules.toml").read_text("utf-8"))
    return {name: Rule(name, **{**row, "clashes": tuple(row.get("clashes", ()))}) for name, row in rows.items()}
