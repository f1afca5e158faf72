# SPDX-License-Identifier: GPL-3.0-or-later
"""Which words a picture shows, and which not, in lines for people. No bpy here."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from ...core.schema_import import verdicts


def words_shown(claims: Sequence[Mapping[str, Any]]) -> dict[str, str]:
    """Word -> "" if the picture shows all that it claims, else what is missing.

    Args:
        claims: Rows of the report's `claims`.

    Returns:
        Words in their order; those that claim nothing measurable are left out.
    """
    return {
        word: _missing(rows[0]) if rows else "" for word, rows in verdicts.missing_by_word(claims).items()
    }


def claim_lines(claims: Sequence[Mapping[str, Any]]) -> list[str]:
    """What the picture shows of the words, a line for all that hold and one for each that does not.

    Args:
        claims: Rows of the report's `claims`.
    """
    shown = words_shown(claims)
    held = ", ".join(word for word, missing in shown.items() if not missing)
    lost = [_missing(row) for row in claims if not row["word"] and row["holds"] is False]
    return [
        *([f"The picture shows: {held}."] if held else []),
        *(f"It does not show '{word}': {missing}." for word, missing in shown.items() if missing),
        *(f"Look at the subject: {missing}." for missing in lost),
    ]


def _missing(row: Mapping[str, Any]) -> str:
    """What a claim misses: "color of the wall is #b09080, wanted #cceede"."""
    of = "" if row["thing"] == "picture" else f" of the {row['thing']}"
    unit = f" {row['unit']}" if row["unit"] and row["measure"] != "color" else ""
    return f"{row['says']}{of} is {row['after']}{unit}, wanted {row['wanted']}"
