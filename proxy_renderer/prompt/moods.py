# SPDX-License-Identifier: Apache-2.0
"""Moods give way: what a mood usually stands for is not meant where the prompt says something else itself."""

from __future__ import annotations

from collections.abc import Sequence

from ..color.constants import Lab
from ..color.floats import chroma, lab_from_srgb
from ..color.shades import warm
from .lexicon.vocabulary import Vocabulary
from .types import Attribute

_DARK, _LIGHT = 38.0, 72.0  # L* of surroundings that leave no bright picture, and no dark one
_COLORED, _VIVID, _GRAY = 12.0, 35.0, 8.0
"""C* from which light has a color, and a color is vivid, and below which it is none."""
_OPPOSED = 0.3  # cosine with warm or cool light from which a color is of the other kind
_AIR = ("light", "fog", "tone", "ambience", "sky")
"""Kinds of things whose color all that is seen takes on."""


def overruled(attributes: Sequence[Attribute], vocabulary: Vocabulary) -> list[Attribute]:
    """What moods stand for and the prompt's own colors rule out: "energetic" is bright, but not "on dark blue".

    Args:
        attributes: Of the prompt, bound.
        vocabulary: What words mean.
    """
    named = [a for a in attributes if a.color and not a.cause and not a.negated]
    around = [lab_from_srgb(a.color) for a in named if a.color and a.kind == "surroundings" and not a.owners]
    air = [lab_from_srgb(a.color) for a in named if a.color and a.kind in _AIR]
    things = [lab_from_srgb(a.color) for a in named if a.color]
    kinds = {a.kind for a in named}

    def gives_way(mood: Attribute) -> bool:
        if mood.color:
            return mood.kind in kinds
        asked = vocabulary.entries[mood.entry].heads
        return (
            _too_light(asked.get("brightness", ""), around)
            or _too_colored(asked.get("saturation", ""), around, things)
            or _too_warm(asked.get("light_temperature", ""), around, air)
        )

    return [a for a in attributes if a.cause and gives_way(a)]


def _too_light(brightness: str, around: Sequence[Lab]) -> bool:
    lights = [lab[0] for lab in around]
    return (brightness == "bright" and any(v < _DARK for v in lights)) or (
        brightness == "dark" and any(v > _LIGHT for v in lights)
    )


def _too_colored(saturation: str, around: Sequence[Lab], things: Sequence[Lab]) -> bool:
    """Whether colors that are named are more vivid than a muted picture's, or have none that a vivid one could show."""
    if saturation == "muted":
        return any(chroma(lab) > _VIVID for lab in things)
    return saturation == "vivid" and any(chroma(lab) < _GRAY for lab in around)


def _too_warm(temperature: str, around: Sequence[Lab], air: Sequence[Lab]) -> bool:
    """Whether light or air has a color by name, or what is all around one of the other kind."""
    if temperature not in ("warm", "cool"):
        return False
    sign = 1.0 if temperature == "warm" else -1.0
    opposed = (sign * warm(*lab[1:]) < -_OPPOSED for lab in around if chroma(lab) > _VIVID)
    return any(chroma(lab) > _COLORED for lab in air) or any(opposed)
