# SPDX-License-Identifier: Apache-2.0
"""A picture in the place of words, for one vibe: its claims, and its plan. Nothing of it is sent anywhere."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import Any

import torch
from torch import Tensor

from ..claims.claim import Claim
from ..planning.advice import Advice, Advisor
from ..prompt.types import LightWords, Parsed, Plan, PlanContext, PlanEntry, Prompts
from ..render.gbuffer import GBuffer
from ..schema import Instance, VibeError
from ..schema.options.table import TRAITS, Options
from . import light_probe, ranges, same_scene, statements
from .merge import together
from .picture import ReferencePicture, read_reference
from .regions import tell

_UNTOUCHED = "the picture does not speak of it: keeps the artist's value"
_DIM = 22.0  # L* of the median from where a picture's subject may drown in black
_OWN = ("burnt", "drowned", "separation")
"""What is claimed of every subject: a picture of this very scene says more of it."""


class Reference:
    """The picture that a look is taken from.

    Args:
        picture: As it was read.
        name: Its file's name.
        options: `like_only`, `like_same`, and whether there are words is for the others to say.

    Attributes:
        name: Its file's name.
        same: Whether it shows this very scene; None before the artist's own picture was seen.
    """

    def __init__(self, picture: ReferencePicture, name: str, options: Options) -> None:
        self.picture, self.name, self._only = picture, name, options.like_only
        self.same: bool | None = True if options.like_same else None

    @classmethod
    def of(cls, options: Options) -> Reference | None:
        """The picture that the options name; None if they name none.

        Raises:
            VibeError: It cannot be read.
        """
        if not options.like:
            return None
        path = Path(options.like)
        return cls(read_reference(path), path.name, options)

    @cached_property
    def display(self) -> Tensor:
        """(H, W, 3) as shown, sRGB-encoded."""
        return torch.from_numpy(self.picture.display)

    @property
    def traits(self) -> tuple[str, ...]:
        """What is taken over: what was asked for, else all but materials, which only a picture of this scene tells."""
        return self._only or (TRAITS if self.same else TRAITS[:-1])

    def compare(self, rendered: Tensor) -> None:
        """Finds out whether it shows this very scene, once.

        Args:
            rendered: (H, W, 3) the artist's own picture.
        """
        if self.same is None and not self.probe:
            self.same = same_scene.is_same(self.display, rendered)

    def claims(self, words: tuple[Claim, ...], seen: GBuffer) -> tuple[Claim, ...]:
        """The claims of words and picture together.

        Args:
            words: Those of the words, and of every picture.
            seen: What the camera sees at the artist's values.
        """
        if self.same:
            said = same_scene.statements_of(self.display, seen, self.name)
            return together([claim for claim in words if claim.measure not in _OWN], [s.claim for s in said])
        said = [s for s in self.statements if s.trait in self.traits]
        return together([claim for claim in words if not self._denies(claim)], [s.claim for s in said])

    @cached_property
    def probe(self) -> light_probe.LightProbe | None:
        """What a panorama says of light; None for a picture that has a frame."""
        linear = self.picture.linear
        return light_probe.probe(linear) if self.picture.panorama and linear is not None else None

    @cached_property
    def statements(self) -> list[statements.Statement]:
        """What it says of any scene; nothing of one whose light alone is wanted."""
        if self.probe:
            return []
        return statements.statements_of(tell(self.picture.display), self.name)

    def _denies(self, claim: Claim) -> bool:
        """Whether a claim of every picture is not this one's: in a dark one much may drown."""
        medians = [s.claim for s in self.statements if s.claim.measure == "median"]
        return claim.measure == "drowned" and any(median.lower[0] < _DIM for median in medians)


class LikeAdvisor:
    """Plans for a picture, and for the words beside it.

    Args:
        reference: The picture.
        words: Plans for the words; None where there are none.
        keys: Names of the key lights.
    """

    def __init__(self, reference: Reference, words: Advisor | None, keys: Collection[str]) -> None:
        self._reference, self._words, self._keys = reference, words, keys

    def advise(self, display: Any, instances: Mapping[str, Instance], context: PlanContext) -> Advice:
        """As `Advisor.advise`: what words name is theirs, what the picture needs is its own.

        Raises:
            VibeError: No word of the prompt is known, or the picture can change nothing.
        """
        reference = self._reference
        if self._words is None:  # beside words it is no goal, but where they start from
            reference.compare(display)
        asked = {s.claim.measure for s in reference.statements if s.trait in reference.traits}
        own = ranges.entries_of(instances, reference.traits, asked, bool(reference.same), reference.name)
        if reference.probe:
            own = light_probe.entries_of(reference.probe, instances, self._keys, reference.name)
        if self._words is None:
            if not own:
                raise VibeError(
                    "Nothing that the picture speaks of may change in this scene.",
                    "Unlock something, allow more groups, or name more in --like-only.",
                )
            plan = Plan({key: own.get(key) or _untouched(i) for key, i in instances.items()})
            advice = Advice(Parsed(""), Prompts("", "", ""), plan, "the picture")
        else:
            advice = self._words.advise(display, instances, context)
            plan = Plan(
                {
                    k: own[k] if k in own and (e.priority is None or e.prior > 0.0) else e
                    for k, e in advice.plan.items()
                }
            )
        notes = (*advice.plan.notes, self._found(), *ranges.kept(instances, own))
        return replace(advice, plan=Plan(dict(plan), notes))

    def _found(self) -> str:
        name, same = self._reference.name, self._reference.same
        if self._reference.probe:
            return light_probe.told(self._reference.probe, name)
        return (
            f"{name} shows this very scene: it is compared place by place."
            if same
            else f"{name} shows something else: its look is taken over, not its content."
        )


def beside(
    reference: Reference | None, words: Advisor, prompt: str, shots: int, lights: Mapping[str, LightWords]
) -> Advisor:
    """Who plans for words and a picture together.

    Args:
        reference: The picture; None for words alone.
        words: Plans for the words.
        prompt: The words; "" for none.
        shots: How many there are: a picture shows one of several at most.
        lights: The scene's, by name.
    """
    if reference is None:
        return words
    reference.same = False if shots > 1 else reference.same
    keys = [name for name, light in lights.items() if light.role == "key"]
    return LikeAdvisor(reference, words if prompt.strip() else None, keys)


def _untouched(instance: Instance) -> PlanEntry:
    if instance.locked:
        return PlanEntry(instance.value, instance.value, None, f"locked: {instance.locked}")
    return PlanEntry(instance.lower, instance.upper, None, _UNTOUCHED)
