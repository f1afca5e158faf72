# SPDX-License-Identifier: Apache-2.0
"""Which head reads what the words wish for."""

from __future__ import annotations

from proxy_renderer.words.lexicon.entries import VocabularyEntry

HEADS = {
    "color": "subject_color",
    "surroundings_color": "surroundings_color",
    "finish": "subject_finish",
    "substance": "subject_metal",
    "direction": "light_side",
    "hardness": "light_softness",
    "light_color": "light_temperature",
    "haze": "fog",
    "brightness": "brightness",
    "contrast": "contrast",
    "saturation": "saturation",
    "vignette": "vignette",
}
"""Quantity of words -> the head that reads it off pictures."""


def classes_of(entry: VocabularyEntry) -> dict[str, str]:
    """Head -> the class that a look word asks for."""
    return {HEADS[quantity]: named for quantity, named in entry.classes.items() if quantity in HEADS}
