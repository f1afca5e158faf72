# SPDX-License-Identifier: Apache-2.0
"""Whether the world is to be parted from its light: a background in a color whose light would spoil the picture."""

from __future__ import annotations

from ...color.floats import chroma, lab_from_srgb
from ...prompt.lexicon.vocabulary import Vocabulary
from ...prompt.types import Parsed, PlanContext
from ...schema import Instance, Values
from ..owners import Owners
from ..wishes import Wishes

_VIVID = 20.0  # chroma from which a world tints what it lights
_DARK = 40.0  # L* below which it hardly lights anything


def asks_for_backdrop(
    parsed: Parsed, instances: dict[str, Instance], context: PlanContext, vocabulary: Vocabulary
) -> bool:
    """Whether words color what is seen of the world, and light of that color would tint or darken the scene.

    A white or pale background is a light too, as in a photographer's studio.

    Args:
        parsed: The prompt, understood.
        instances: The scene's parameters by key.
        context: The scene.
        vocabulary: What words mean.
    """
    owners = Owners(parsed, instances, context, vocabulary)
    return any(
        effect.owner == "world"
        and effect.mode == "shown"
        and attribute.kind == "surroundings"
        and attribute.color is not None
        and _spoils(attribute.color)
        and bool(owners.of(effect, attribute))
        for attribute, effect in Wishes(parsed, vocabulary, owners).all()
    )


def _spoils(srgb: Values) -> bool:
    lab = lab_from_srgb(srgb)
    return chroma(lab) > _VIVID or lab[0] < _DARK
