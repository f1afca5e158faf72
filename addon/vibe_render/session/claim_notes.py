# SPDX-License-Identifier: GPL-3.0-or-later
"""Which words a picture shows, and which not, in lines for people. No bpy here."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

_FIELDS = ("word", "thing", "says", "wanted", "after", "unit")


def words_shown(claims: Sequence[Mapping[str, Any]]) -> dict[str, str]:
    """Word -> "" if the picture shows all that it claims, else what is missing.

    Args:
        claims: Rows of the report's `claims`.

    Returns:
        Words in their order; those that claim nothing measurable are left out.
    """
    shown: dict[str, str] = {}
    for row in claims:
        if row["word"] and row["holds"] is not None:
            shown[row["word"]] = shown.get(row["word"], "") or ("" if row["holds"] else _missing(row))
    return shown


def claim_lines(claims: Sequence[Mapping[str, Any]]) -> list[str]:
    """What the picture shows of the words, a line for all that hold and one for each that does not.

    Args:
        claims: Rows of the report's `claims`.
    """
    shown = words_shown(claims)
    lines = [
        f"The picture shows: {', '.join(held)}."
        if (held := [w for w, why in shown.items() if not why])
        else ""
    ]
    lines += [f"It does not show '{word}': {why}." for word, why in shown.items() if why]
    lost = [_missing(row) for row in claims if not row["word"] and row["holds"] is False]
    return [line for line in [*lines, *(f"Look at the subject: {why}." for why in lost)] if line]


def _missing(row: Mapping[str, Any]) -> str:
    """What a claim misses: "color of the wall is #b09080, wanted #cceede"."""
    _, thing, says, wanted, after, unit = (row[field] for field in _FIELDS)
    of = "" if thing in ("picture", "") else f" of the {thing}"
    unit = "" if says == "color" or not unit else f" {unit}"
    return f"{says}{of} is {after}{unit}, wanted {wanted}"
