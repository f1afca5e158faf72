# SPDX-License-Identifier: GPL-3.0-or-later
"""How the words of a prompt were understood, in lines for people. No bpy here."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any


def word_notes(report: Mapping[str, Any]) -> list[str]:
    """Words that were left out or guessed, and contradictions.

    Args:
        report: The engine's report of a vibe.
    """
    understood = report.get("understood", {})
    ignored = ", ".join(dict.fromkeys(understood.get("ignored", [])))
    guesses = [f"“{word}” was taken for “{near}”" for word, near in understood.get("guesses", {}).items()]
    return [*([f"Left out: {ignored}"] if ignored else []), *guesses, *understood.get("notes", [])]
