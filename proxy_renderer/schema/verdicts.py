# SPDX-License-Identifier: Apache-2.0
"""Verdicts on claims, as `report.json` has them: read alike in both processes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

ClaimVerdict = Mapping[str, Any]
"""A row of the report's `claims`; `proxy_renderer.claims.claim` says what is in it."""


def missing_by_word(rows: Sequence[ClaimVerdict]) -> dict[str, list[ClaimVerdict]]:
    """Word -> its claims that do not hold; none where the picture shows the word.

    Words that claim nothing that can be measured are left out.
    """
    words: dict[str, list[ClaimVerdict]] = {}
    for row in rows:
        if row["word"] and row["holds"] is not None:
            words.setdefault(row["word"], []).extend([] if row["holds"] else [row])
    return words
