# SPDX-License-Identifier: Apache-2.0
"""Who parses, composes and confines in a round of Algorithm 1 (steps 3 to 5): the offline planner, or a model."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol

from ..prompt.lexicon.user_words import default_vocabulary
from ..prompt.meaning import forget_parts, forget_sky
from ..prompt.prompts import compose
from ..prompt.types import Parsed, Prompts
from ..prompt.understood import Understood
from ..schema import Instance
from .owners import SLIVER
from .planner import plan
from .types import LightPlan, Plan, PlanContext


@dataclass(frozen=True)
class Advice:
    """A round's understanding of the prompt, and its plan.

    Attributes:
        parsed: The objects list O.
        prompts: Captions and negatives by region.
        plan: Bounds and priority of every parameter.
        placed: Keys of what a rig has placed already.
        source: Who gave it: "offline planner", or the model; with the reason if it was not the one asked for.
    """

    parsed: Parsed
    prompts: Prompts
    plan: Plan
    source: str = "offline planner"
    placed: frozenset[str] = frozenset()


class Advisor(Protocol):
    """Fills the typed structures of a round."""

    def advise(self, display: Any, instances: Mapping[str, Instance], context: PlanContext) -> Advice:
        """Parse, compose, confine.

        Args:
            display: The current rendering, (H, W, 3) in [0, 1].
            instances: The scene's parameters by key, locks included.
            context: What is known about the scene and its current picture.
        """


class OfflineAdvisor:
    """The vocabulary and its planner.

    Args:
        understood: The prompt, read against the scene.
        light: What a rig plans; None where the words ask for none.
    """

    def __init__(self, understood: Understood, light: LightPlan | None = None) -> None:
        self.understood, self.light = understood, light

    def advise(self, display: Any, instances: Mapping[str, Instance], context: PlanContext) -> Advice:
        """Raises VibeError if no word of the prompt is known."""
        parsed = seen(self.understood, context)
        prompts = compose(parsed)
        decided = plan(parsed, prompts, dict(instances), context, light=self.light)
        return Advice(parsed, prompts, decided, placed=frozenset(self.light.entries if self.light else ()))


def seen(understood: Understood, context: PlanContext) -> Parsed:
    """What the words mean where the camera sees this much of the sky, and of each material.

    Args:
        understood: The prompt, read against the scene.
        context: What is known about the scene and its picture.

    Raises:
        VibeError: No word of the prompt is known.
    """
    vocabulary, parsed = default_vocabulary(), understood.parsed
    if context.world_share is not None and context.world_share < SLIVER:
        forget_sky(parsed, vocabulary)
    forget_parts(parsed, context.material_share, vocabulary)
    return parsed
