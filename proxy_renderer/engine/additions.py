# SPDX-License-Identifier: Apache-2.0
"""Gives a scene what the words ask for and it lacks: a rig, single lights, a backdrop of its own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ..claims.claim import Claim
from ..claims.wanted import claims_of
from ..goals.resolve import Goals, goals_or_why
from ..goals.written import WrittenGoals
from ..optimize.context import described
from ..planning.acting import goals_without_rig
from ..planning.missing import asks_for_backdrop, missing_lights
from ..planning.types import LightPlan
from ..prompt.lexicon.rigs import rig_table
from ..prompt.lexicon.user_words import default_vocabulary
from ..prompt.types import SceneDescription
from ..prompt.understood import Understood
from ..rigs.chosen import chosen_rig
from ..rigs.lighting import Lighting, lighting
from ..scene import SceneData
from ..schema import VibeError
from ..schema.added_lights import ADDED_LIGHTS, light_name

_SPARE = {light_name(part, "AREA") for part in ("key", "fill", "rim")}
"""Lights that single words may need, as "rim light" does where no rig is asked for."""


@dataclass(frozen=True)
class Addition:
    """A scene with what the words ask for and it lacks.

    Attributes:
        scenes: The shots.
        understood: The words, read against the scene.
        goals: What the words wish for; why there are none where nothing is understood.
        lighting: The rig that the words ask for, set up; None where they ask for none.
    """

    scenes: list[SceneData]
    understood: Understood
    goals: Goals | VibeError
    lighting: Lighting | None = None

    @property
    def plan(self) -> LightPlan | None:
        """Of the rig."""
        return self.lighting.plan if self.lighting else None

    def claims(self, goals: Goals) -> tuple[Claim, ...]:
        """What the words claim of the image, the rig's structure among it."""
        vocabulary = default_vocabulary()
        if self.lighting is None:
            return claims_of(goals, vocabulary)
        return (*self.lighting.claims, *claims_of(goals_without_rig(goals, self.lighting.plan), vocabulary))


def with_additions(
    scenes: Sequence[SceneData],
    prompt: str,
    new_lights: bool = True,
    told: Sequence[str] = (),
    written: WrittenGoals | None = None,
) -> Addition:
    """The shots, lit by the rig that the words ask for; or with what is on standby for them, where they ask for no rig.

    Args:
        scenes: One or several shots. The first decides on lights for all; a backdrop is for all of them or for none.
        prompt: What the artist typed; where nothing in it is understood offline, nothing is added.
        new_lights: Whether the scene may get lights.
        told: "copper=Cup": what the artist says that words describe.
        written: Goals in the place of those that the prompt asks for; None for its own.

    Raises:
        VibeError: The scene has nothing that a word is told to describe.
    """
    understood = Understood(prompt, described(*scenes), told)
    goals = written.within(understood.scene) if written else goals_or_why(understood)
    if isinstance(goals, VibeError):
        return Addition(list(scenes), understood, goals)
    if chosen := chosen_rig(goals, rig_table(), default_vocabulary()):
        lit = lighting(scenes, goals.parsed, chosen, new_lights)
        return Addition(lit.scenes, understood, goals, lit)
    return Addition(_with_standby(scenes, understood.scene, goals, new_lights), understood, goals)


def _with_standby(
    scenes: Sequence[SceneData], known: SceneDescription, goals: Goals, new_lights: bool
) -> list[SceneData]:
    """The shots with lights and a backdrop on standby that single words need."""
    first, vocabulary = scenes[0], default_vocabulary()
    spare = [ADDED_LIGHTS[light.name] for light in first.standby.lights if light.name in _SPARE]
    roles = {light.name: light.role for light in spare}
    instances = dict(first.instances)
    names = missing_lights(goals, instances, known, roles, vocabulary) if new_lights else []
    parts = asks_for_backdrop(goals, instances, known, vocabulary)
    if parts and all(scene.may_be_parted for scene in scenes):
        scenes = [scene.parted() for scene in scenes]
    return [scene.with_lights(names) for scene in scenes] if names else list(scenes)
