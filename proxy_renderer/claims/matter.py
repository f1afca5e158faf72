# SPDX-License-Identifier: Apache-2.0
"""Materials as claims: gold is golden, snow is white, and coal is black."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import replace

from ..color.floats import chroma, lab_from_srgb, srgb_from_hex
from ..schema import Values
from ..words.lexicon.vocabulary import Vocabulary, VocabularyEntry
from ..words.types import Attribute
from .claim import Claim
from .colored import COLORED, part_of, tinted

_DARKEST, _LIGHTEST, _REPAINTED = 0.65, 22.0, 20.0
"""Share of a gray material's lightness that it has at least, for white things have shades; L* that it may have beyond its own,
for black ones have highlights; and what is enough of a change."""
_WHITE_MATTER, _GRAY_MATTER = 75.0, 40.0
"""L* from where a material cannot be too light, and up to which it cannot be too dark."""
_REFLECTING = {"material/metallic": 0.5, "material/transmission": 0.5}
"""Components -> the value from where a thing shows its surroundings, and is as light as they are."""


def of_matter(attribute: Attribute, beside: Iterable[Attribute], vocabulary: Vocabulary) -> Iterator[Claim]:
    """A material with a color of its own: gold tints the thing, coal is as dark as coal is.

    Args:
        beside: All of the prompt: a color that is named for the same thing is the color of what may have any, as leather.
    """
    entry, part = vocabulary.entries.get(attribute.entry), part_of(attribute)
    if entry is None or entry.slot != "material" or part == "picture":
        return
    painted = any(_paints(other, attribute) for other in beside)
    for effect in entry.effects:
        own = effect.family == "material/tint" and effect.mode == "color" and effect.color[0] == "#"
        if own and not (effect.weak and painted):
            srgb = srgb_from_hex(effect.color)
            claims = tinted(attribute.word, attribute.thing or part, part, srgb, attribute.owners)
            # Gold that is blue is none, however much less blue than before.
            yield from (replace(claim, change=None) for claim in claims)
            if not _reflects(entry):
                yield from _as_light(attribute, srgb)


def _reflects(entry: VocabularyEntry) -> bool:
    """Whether a material mirrors its surroundings or lets them be seen, as metals and glass do."""
    return any(
        max(effect.upper, default=0.0) > _REFLECTING.get(effect.family, math.inf) for effect in entry.effects
    )


def _as_light(attribute: Attribute, srgb: Values) -> Iterator[Claim]:
    """That a thing of a gray material is about as light as that: snow is white, and asphalt is not."""
    light, strength = lab_from_srgb(srgb)[0], chroma(lab_from_srgb(srgb))
    if strength >= COLORED:
        return
    lower = -math.inf if light < _GRAY_MATTER else _DARKEST * light
    upper = math.inf if light > _WHITE_MATTER else light + _LIGHTEST
    change = _REPAINTED if upper == math.inf else -_REPAINTED if lower == -math.inf else None
    part = part_of(attribute)
    thing, ends = attribute.thing or part, ((lower,), (upper,))
    yield Claim(attribute.word, thing, "lightness", part, *ends, attribute.owners, change, color=srgb)


def _paints(color: Attribute, matter: Attribute) -> bool:
    """Whether one of two attributes is the color of what the other says is the material."""
    same = not (color.owners and matter.owners) or not {*color.owners}.isdisjoint(matter.owners)
    return color.color is not None and not color.negated and color.region == matter.region and same
