# SPDX-License-Identifier: Apache-2.0
"""Lights and a backdrop that words ask for and that the scene lacks."""

from collections.abc import Mapping

from ..color.floats import chroma, lab_from_srgb
from ..goals.resolve import Goals
from ..schema import Instance
from ..words.attributes import side
from ..words.lexicon.entries import OWNERS, Effect
from ..words.lexicon.vocabulary import Vocabulary
from ..words.types import Attribute, SceneDescription
from .acting import Act, acts, is_usual
from .owners import Owners
from .scene_lights import SceneLights, role_of

_BEHIND = 110.0  # degrees from the camera beyond which a light stands behind the subject


def missing_lights(
    goals: Goals,
    instances: dict[str, Instance],
    scene: SceneDescription,
    standby: Mapping[str, str],
    vocabulary: Vocabulary,
) -> list[str]:
    """The lights on standby, given with their roles, that the words ask for."""
    attributes = goals.parsed.attributes
    owners = Owners(goals.parsed, instances, scene, vocabulary)
    missing = [number for number, names in owners.lights.numbered.items() if not names]
    said = ([a for a in attributes if a.lamp == number] for number in missing)
    roles = [_described(group, owners.lights, vocabulary) for group in said]
    for wish, effect in acts(goals, vocabulary, owners):
        role = _asked(effect, wish.attribute, owners)
        roles += [role] if role and role not in roles else []
    found: list[str] = []
    for role in roles:
        free = [name for name in standby if name not in found]
        found += sorted(free, key=lambda name: standby[name] != role)[:1]
    return found


def _described(said: list[Attribute], lights: SceneLights, vocabulary: Vocabulary) -> str:
    """The role of a light that words tell apart and that is missing."""
    if given := role_of(said):
        return given
    ends = side(said, vocabulary)
    if ends and abs((sum(ends) / 2 + 180.0) % 360.0 - 180.0) > _BEHIND:
        return "rim"
    return "fill" if lights.lamps else "key"


def _asked(effect: Effect, attribute: Attribute, owners: Owners) -> str:
    """The role of the light that an effect needs and that nothing in the scene has; else ""."""
    if effect.weak or effect.mode == "times" or OWNERS[effect.owner] != "light" or attribute.told_apart:
        return ""
    owner = attribute.role if effect.owner in ("light", "lights") and attribute.role else effect.owner
    if owner in ("rim", "fill"):
        return "" if owners.lights.of_role(owner) else owner
    if owner == "others":
        return "" if owners.of(effect, attribute) else "fill"
    return "key" if effect.name in ("azimuth", "elevation") and not owners.lights.lamps else ""


_VIVID = 20.0  # chroma from which a world tints what it lights


def asks_for_backdrop(
    goals: Goals, instances: dict[str, Instance], scene: SceneDescription, vocabulary: Vocabulary
) -> bool:
    """Whether words give the background a color that is not to tint the scene, or a lightness that its light cannot have.

    A white or pale background is a light too, as in a photographer's studio, if no other word wants less light. What a
    place usually has is no such wish: the sky of a garden at night is the night's.
    """
    owners = Owners(goals.parsed, instances, scene, vocabulary)
    of_world = [
        (wish, effect)
        for wish, effect in acts(goals, vocabulary, owners)
        if effect.family == "world/strength" and owners.of(effect, wish.attribute)
    ]
    seen = [act for act in of_world if act[0].attribute.kind == "surroundings" and not is_usual(*act)]
    shed = [act for act in of_world if act[0].attribute.kind not in ("surroundings", "sky")]
    shown = [wish.attribute.color for wish, effect in seen if effect.mode == "shown"]
    tints = any(chroma(lab_from_srgb(color)) > _VIVID for color in shown if color)
    return tints or any(_apart(one, other) for one in seen for other in shed)


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
