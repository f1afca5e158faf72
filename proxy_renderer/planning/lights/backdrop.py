# SPDX-License-Identifier: Apache-2.0
"""Whether what is seen of the world is to be parted from its light: where the one would spoil the other."""

from __future__ import annotations

from ...color.floats import chroma, lab_from_srgb
from ...prompt.lexicon.entries import Effect
from ...prompt.lexicon.vocabulary import Vocabulary
from ...prompt.types import Attribute, Parsed
from ...schema import Instance
from ..owners import Owners
from ..types import PlanContext
from ..wishes import Wishes, is_usual

_VIVID = 20.0  # chroma from which a world tints what it lights
Wish = tuple[Attribute, Effect]


def asks_for_backdrop(
    parsed: Parsed, instances: dict[str, Instance], context: PlanContext, vocabulary: Vocabulary
) -> bool:
    """Whether words give the background a color that is not to tint the scene, or a lightness that its light cannot have.

    A white or pale background is a light too, as in a photographer's studio, if no other word wants less light. What a
    place usually has is no such wish: the sky of a garden at night is the night's.

    Args:
        parsed: The prompt, understood.
        instances: The scene's parameters by key.
        context: The scene.
        vocabulary: What words mean.
    """
    owners = Owners(parsed, instances, context, vocabulary)
    wishes = Wishes(parsed, vocabulary, owners).all()
    of_world = [(a, e) for a, e in wishes if e.family == "world/strength" and owners.of(e, a)]
    seen = [wish for wish in of_world if wish[0].kind == "surroundings" and not is_usual(*wish)]
    shed = [wish for wish in of_world if wish[0].kind not in ("surroundings", "sky")]
    return any(map(_tints, seen)) or any(_apart(one, other) for one in seen for other in shed)


def _tints(wish: Wish) -> bool:
    color = wish[0].color
    return color is not None and wish[1].mode == "shown" and chroma(lab_from_srgb(color)) > _VIVID


def _apart(one: Wish, other: Wish) -> bool:
    """Whether no strength of the world serves both."""
    a, b = _lightness(one), _lightness(other)
    return a is not None and b is not None and (a[1] < b[0] or b[1] < a[0])


def _lightness(wish: Wish) -> tuple[float, float] | None:
    """The L* that the world is to have, from and to; None where a wish says nothing of it."""
    attribute, effect = wish
    if effect.mode == "shown" and attribute.color:
        return (lab_from_srgb(attribute.color)[0],) * 2
    return (effect.lower[0], effect.upper[0]) if effect.mode == "lightness" else None
