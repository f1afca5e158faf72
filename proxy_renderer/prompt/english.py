# SPDX-License-Identifier: Apache-2.0
"""Tells other languages from English, so that nobody wonders why a good prompt does nothing."""

from __future__ import annotations

import unicodedata
from typing import Literal

ONLY_ENGLISH = (
    "Only English is understood: write for example 'glossy teal, soft warm light, slight vignette'."
)

_FOREIGN = frozenset(
    [
        "der",
        "das",
        "und",
        "mit",
        "ein",
        "eine",
        "einen",
        "einem",
        "eines",
        "auf",
        "vor",
        "ist",
        "im",
        "am",
        "zum",
        "sehr",
        "ohne",
        "bei",
        "aus",
        "le",
        "les",
        "un",
        "une",
        "des",
        "du",
        "et",
        "avec",
        "dans",
        "sur",
        "sans",
        "très",
        "au",
        "aux",
        "est",
        "sous",
        "el",
        "los",
        "las",
        "con",
        "sobre",
        "muy",
        "sin",
        "del",
        "y",
        "o",
        "en",
        "por",
        "il",
        "lo",
        "gli",
        "della",
        "con",
        "su",
        "molto",
        "senza",
        "che",
        "nel",
        "nella",
        "og",
        "med",
        "et",
        "het",
        "een",
        "van",
        "met",
        "zonder",
        "op",
        "jest",
        "na",
        "bez",
        "i",
        "um",
        "uma",
        "com",
        "sem",
        "em",
        "no",
        "da",
        "do",
        "das",
        "dos",
        "muito",
        "och",
        "på",
        "med",
        "utan",
        "ve",
        "ile",
        "bir",
        "için",
    ]
) - {
    "no",
    "do",
    "i",
    "en",
    "am",
    "on",
    "in",
    "a",
    "o",
    "y",
    "met",
    "van",
    "bei",
    "et",
    "as",
    "na",
    "su",
    "un",
    "aux",
}
"""Small words of German, French, Spanish, Italian, Portuguese, Dutch, Swedish, Turkish ... that English does not have."""


def other_language(text: str) -> Literal["", "some", "all"]:
    """How much of a prompt is not English: another script, or another language's small words."""
    letters = [c for c in text if c.isalpha()]
    latin = sum("LATIN" in unicodedata.name(c, "") for c in letters)
    if letters and latin < 0.5 * len(letters):
        return "all"
    if latin < len(letters):
        return "some"
    words = text.lower().split()
    small = sum(word.strip(".,;:!?") in _FOREIGN for word in words)
    return "some" if small >= 2 or (small and small >= 0.15 * len(words)) else ""
