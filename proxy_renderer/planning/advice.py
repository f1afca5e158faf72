# SPDX-License-Identifier: Apache-2.0
"""Who parses, composes and confines in a round of Algorithm 1 (steps 3 to 5): the offline planner, or a model."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from typing import Any, Protocol

from ..goals.resolve import Goals
from ..prompt.prompts import compose
from ..prompt.types import Attribute, Prompts, SceneDescription
from ..schema import Instance, VibeError
from .planner import plan
from .types import LightPlan, Plan

NO_PROMPTS = Prompts("", "", "")
"""Nothing to ask an encoder."""


@dataclass(frozen=True)
class Advice:
    """A round's understanding of the prompt, and its plan.

    Attributes:
        goals: What the words wish for; with the objects list O.
        prompts: Captions and negatives by region.
        unmeasured: The same of the words alone that no measure covers.
        plan: Bounds and priority of every parameter.
        placed: Keys of what a rig has placed already.
        source: Who gave it: "offline planner", or the model; with the reason if it was not the one asked for.
    """

    goals: Goals
    prompts: Prompts
    plan: Plan
    unmeasured: Prompts = NO_PROMPTS
    source: str = "offline planner"
    placed: frozenset[str] = frozenset()


class Advisor(Protocol):
    """Fills the typed structures of a round."""

    def advise(self, display: Any, instances: Mapping[str, Instance], scene: SceneDescription) -> Advice:
        """Parse, compose, confine.

        Args:
            display: The current rendering, (H, W, 3) in [0, 1].
            instances: The scene's parameters by key, locks included.
            scene: What is known about the scene and its current picture.
        """


class OfflineAdvisor:
    """The vocabulary and its planner.

    Args:
        goals: What the words wish for; why there are none where nothing is understood.
        light: What a rig plans; None where the words ask for none.
    """

    def __init__(self, goals: Goals | VibeError, light: LightPlan | None = None) -> None:
        self.goals, self.light = goals, light

    def advise(self, display: Any, instances: Mapping[str, Instance], scene: SceneDescription) -> Advice:
        """Raises VibeError if no word of the prompt is known."""
        if isinstance(self.goals, VibeError):
            raise self.goals
        prompts = compose(self.goals.parsed, self.goals.overruled)
        decided = plan(self.goals, dict(instances), scene, light=self.light)
        served = self.light.served if self.light else ()
        placed = frozenset(self.light.entries if self.light else ())
        return Advice(self.goals, prompts, decided, unmeasured(self.goals, served), placed=placed)


def unmeasured(goals: Goals, served: Collection[Attribute] = ()) -> Prompts:
    """Captions of the words that are sought and that claim nothing of the image.

    Args:
        served: Words that a rig stands for, which measures its light.
    """
    measured = [wish.attribute for wish in goals.wishes if wish.is_measured]
    left = [
        a
        for a in goals.parsed.attributes
        if not (a.negated or a.cause or a in measured or a in served or a in goals.overruled)
    ]
    return compose(replace(goals.parsed, attributes=left)) if left else NO_PROMPTS
