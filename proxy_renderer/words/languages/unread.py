# SPDX-License-Identifier: Apache-2.0
"""Tells languages that have no lexicon, so that nobody wonders why a good prompt does nothing."""

from __future__ import annotations

import unicodedata
from functools import cache
from pathlib import Path
from typing import Literal

from ..lexicon.languages import lexicons


def understood() -> str:
    """What to write instead, in one line."""
    *first, last = ("English", *(lexicon.name for lexicon in lexicons()))
    names = f"{', '.join(first)} and {last}"
    return f"{names} are understood: write for example 'glossy teal, soft warm light, slight vignette'."


def other_language(text: str) -> Literal["", "some", "all"]:
    """How much of a prompt is in another script than the Latin one, or has small words of unread languages."""
    letters = [c for c in text if c.isalpha()]
    latin = sum("LATIN" in unicodedata.name(c, "") for c in letters)
    if letters and latin < 0.5 * len(letters):
        return "all"
    if latin < len(letters):
        return "some"
    words = text.lower().split()
    small = sum(word.strip(".,;:!?") in _small_words() for word in words)
    return "some" if small >= 2 or (small and small >= 0.15 * len(words)) else ""


@cache
def _small_words() -> frozenset[str]:
    lines = Path(__file__).with_name("unread.txt").read_text("utf-8").splitlines()
    return frozenset(word for line in lines if not line.startswith("#") for word in line.split())
