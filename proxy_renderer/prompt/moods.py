# SPDX-License-Identifier: Apache-2.0
"""Moods give way: what a mood usually stands for is not meant where the prompt says something else itself."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

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
    kinds = {a.kind for a in named}
    ruled_out = {pair for a in named for pair in _ruled_out(a)}

    def gives_way(mood: Attribute) -> bool:
        if mood.color:
            return mood.kind in kinds
        return not ruled_out.isdisjoint(vocabulary.entries[mood.entry].heads.items())

    return [a for a in attributes if a.cause and gives_way(a)]


def _ruled_out(named: Attribute) -> Iterator[tuple[str, str]]:
    """What a picture cannot be where something has a color by name: head, and its class."""
    light, a, b = lab_from_srgb(named.color or ())
    around, strong = named.kind == "surroundings" and not named.owners, chroma((light, a, b))
    tinted = named.kind in _AIR and strong > _COLORED
    warmth = warm(a, b) if around and strong > _VIVID else 0.0
    rules = (
        (around and light < _DARK, "brightness", "bright"),
        (around and light > _LIGHT, "brightness", "dark"),
        (around and strong < _GRAY, "saturation", "vivid"),
        (strong > _VIVID, "saturation", "muted"),
        (tinted or warmth < -_OPPOSED, "light_temperature", "warm"),
        (tinted or warmth > _OPPOSED, "light_temperature", "cool"),
    )
    return ((head, value) for holds, head, value in rules if holds)
