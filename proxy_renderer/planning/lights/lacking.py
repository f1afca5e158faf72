# SPDX-License-Identifier: Apache-2.0
"""The lights that words ask for and a scene lacks: a rim light, or a second one for "warm lamp, cold window light"."""

from __future__ import annotations

from collections.abc import Mapping

from ...goals.resolve import Goals
from ...prompt.lexicon.entries import OWNERS, Effect
from ...prompt.lexicon.vocabulary import Vocabulary
from ...prompt.lights import side
from ...prompt.types import Attribute, SceneDescription
from ...schema import Instance
from ..acting import acts
from ..owners import Owners
from .choice import SceneLights
from .meant import role_of

_BEHIND = 110.0  # degrees from the camera beyond which a light stands behind the subject


def lacking(
    goals: Goals,
    instances: dict[str, Instance],
    scene: SceneDescription,
    standby: Mapping[str, str],
    vocabulary: Vocabulary,
) -> list[str]:
    """The lights on standby that the words ask for.

    Args:
        instances: The scene's parameters by key.
        standby: Names of the lights on standby, with their roles.
    """
    parsed = goals.parsed
    owners = Owners(parsed, instances, scene, vocabulary)
    missing = [number for number, names in owners.lights.numbered.items() if not names]
    said = ([a for a in parsed.attributes if a.lamp == number] for number in missing)
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
