# SPDX-License-Identifier: Apache-2.0
"""Plans for a picture in the place of words, and for words beside it."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace
from typing import Any

from ..claims.from_goals import claims_of
from ..goals.resolve import Goals
from ..planning.advice import Advice, Advisor
from ..planning.captions import Prompts
from ..planning.types import Plan, PlanEntry
from ..schema import Instance, VibeError
from ..words.lexicon.user_words import default_vocabulary
from ..words.types import LightDescription, Parsed, SceneDescription
from . import light_probe, ranges
from .like import Reference
from .ranges import light_colors

_UNTOUCHED = "the picture does not speak of it: keeps the artist's value"


class LikeAdvisor:
    """Plans for a picture and, where there is an advisor for them, for words."""

    def __init__(self, reference: Reference, words: Advisor | None, keys: Collection[str]) -> None:
        self._reference, self._words, self._keys = reference, words, keys

    def advise(self, display: Any, instances: Mapping[str, Instance], scene: SceneDescription) -> Advice:
        """As `Advisor.advise`: what words name is theirs, what the picture needs is its own.

        Raises:
            VibeError: No word of the prompt is known, or the picture can change nothing.
        """
        if self._words is None:  # beside words it is no goal, but where they start from
            self._reference.compare(display)
        advice = self._words.advise(display, instances, scene) if self._words else None
        own = self._own(instances, advice)
        if advice is None:
            if not own:
                raise VibeError(
                    "Nothing that the picture speaks of may change in this scene.",
                    "Unlock something, allow more groups, or name more in --like-only.",
                )
            plan = Plan({key: own.get(key) or _untouched(i) for key, i in instances.items()})
            advice = Advice(Goals(Parsed("")), Prompts("", "", ""), plan, source="the picture")
        else:
            named = {key: entry for key, entry in advice.plan.items() if entry.is_named}
            plan = Plan({key: own.get(key) or _alone(e) for key, e in advice.plan.items()} | named)
        notes = (*advice.plan.notes, self._found(), *ranges.kept_values(instances, own))
        return replace(advice, plan=Plan(dict(plan), notes))

    def _own(self, instances: Mapping[str, Instance], advice: Advice | None) -> dict[str, PlanEntry]:
        reference = self._reference
        if reference.probe:
            return light_probe.probe_entries(reference.probe, instances, self._keys, reference.name)
        words = claims_of(advice.goals, default_vocabulary()) if advice else ()
        said = reference.of_any_scene(words)
        measures = {claim.measure for claim in said}
        colors, same = light_colors(said), bool(reference.same)
        return ranges.entries_of(instances, reference.traits, measures, same, reference.name, colors)

    def _found(self) -> str:
        name, same = self._reference.name, self._reference.same
        if self._reference.probe:
            return light_probe.summary_of(self._reference.probe, name)
        if same:
            return f"{name} shows this very scene: it is compared place by place."
        return f"{name} shows something else: its look is taken over, not its content."


def advisor_with_picture(
    reference: Reference | None,
    words: Advisor,
    has_words: bool,
    shots: int,
    lights: Mapping[str, LightDescription],
) -> Advisor:
    """The advisor for words (there are some where `has_words`) and a picture together; a picture shows one of several shots at most."""
    if reference is None:
        return words
    reference.same = False if shots > 1 else reference.same
    keys = [name for name, light in lights.items() if light.role == "key"]
    return LikeAdvisor(reference, words if has_words else None, keys)


def _alone(entry: PlanEntry) -> PlanEntry:
    """What words do not name: what only supports them, as a material that is to stand out, is the picture's to say."""
    return entry if entry.priority is None else replace(entry, priority=None, reason=_UNTOUCHED)


def _untouched(instance: Instance) -> PlanEntry:
    if instance.locked:
        return PlanEntry(instance.value, instance.value, None, f"locked: {instance.locked}")
    return PlanEntry(instance.lower, instance.upper, None, _UNTOUCHED)
