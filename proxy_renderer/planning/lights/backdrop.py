# SPDX-License-Identifier: Apache-2.0
"""Whether what is seen of the world is to be parted from its light: where the one would spoil the other."""

from __future__ import annotations

from ...color.floats import chroma, lab_from_srgb
from ...goals.resolve import Goals
from ...prompt.lexicon.vocabulary import Vocabulary
from ...prompt.types import SceneDescription
from ...schema import Instance
from ..acting import Act, acts, is_usual
from ..owners import Owners

_VIVID = 20.0  # chroma from which a world tints what it lights


def asks_for_backdrop(
    goals: Goals, instances: dict[str, Instance], scene: SceneDescription, vocabulary: Vocabulary
) -> bool:
    """Whether words give the background a color that is not to tint the scene, or a lightness that its light cannot have.

    A white or pale background is a light too, as in a photographer's studio, if no other word wants less light. What a
    place usually has is no such wish: the sky of a garden at night is the night's.

    Args:
        instances: The scene's parameters by key.
    """
    owners = Owners(goals.parsed, instances, scene, vocabulary)
    of_world = [
        (wish, effect)
        for wish, effect in acts(goals, vocabulary, owners)
        if effect.family == "world/strength" and owners.of(effect, wish.attribute)
    ]
    seen = [act for act in of_world if act[0].attribute.kind == "surroundings" and not is_usual(*act)]
    shed = [act for act in of_world if act[0].attribute.kind not in ("surroundings", "sky")]
    return any(map(_tints, seen)) or any(_apart(one, other) for one in seen for other in shed)


def _tints(act: Act) -> bool:
    color = act[0].attribute.color
    return color is not None and act[1].mode == "shown" and chroma(lab_from_srgb(color)) > _VIVID


def _apart(one: Act, other: Act) -> bool:
    """Whether no strength of the world serves both."""
    a, b = _lightness(one), _lightness(other)
    return a is not None and b is not None and (a[1] < b[0] or b[1] < a[0])


def _lightness(act: Act) -> tuple[float, float] | None:
    """The L* that the world is to have, from and to; None where a wish says nothing of it."""
    wish, effect = act
    if effect.mode == "shown" and wish.attribute.color:
        return (lab_from_srgb(wish.attribute.color)[0],) * 2
    return (effect.lower[0], effect.upper[0]) if effect.mode == "lightness" else None
