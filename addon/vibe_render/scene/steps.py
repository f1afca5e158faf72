# SPDX-License-Identifier: GPL-3.0-or-later
"""The steps of a look: a first prompt and further sentences, kept in the .blend with the values that each has changed.

Any of them may be switched off or removed: the values of the others follow without another search.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

from bpy.types import Scene

from ..core.schema_import import labels, schema, sentences
from .nodes import backgrounds

KEY = "vibe_steps"
VERSION = 1
BY_HAND = "changed by hand"
LIGHT_MIX = "light mix"
WORDLESS = (BY_HAND, LIGHT_MIX)
"""The sentences of steps that the artist has made without words."""
_OWNED = ("material", "light")
Known = Mapping[str, Sequence[float]]


@dataclass
class LookStep:
    """A sentence with the values that it has changed, by key."""

    sentence: str
    before: dict[str, list[float]]
    after: dict[str, list[float]]
    reasons: dict[str, str] = field(default_factory=dict)
    goals: dict[str, Any] = field(default_factory=dict)  # what its words wish for; empty for none
    on: bool = True

    @property
    def is_relative(self) -> bool:
        """True if all of its words compare: then it changes whatever is there before it."""
        words = self.goals.get("words", [])
        return bool(words and self.goals.get("holds")) and not any(word.get("look") for word in words)

    def keys_of(self, noun: str, by_word: bool = True) -> dict[str, list[str]]:
        """The words that describe something of that name, or are called so `by_word`, each with the keys that it has changed."""
        wanted, found = set(noun.lower().split()), {}
        for word in self.goals.get("words", ()):
            target = word.get("target", {})
            owners = (*target.get("materials", ()), *target.get("lights", ()))
            called = (word["word"], word.get("look", "")) if by_word else ()
            names = " ".join((*called, target.get("thing", ""), *owners))
            if wanted <= set(names.lower().split()):
                quote = f"'{word.get('implied_by') or word['word']}'"
                keys = [key for key, reason in self.reasons.items() if quote in reason]
                parts = ((key, *schema.split_key(key)) for key in keys)
                found[word["word"]] = [
                    key
                    for key, group, owner, _ in parts
                    if not owners or owner in owners or group not in _OWNED
                ]
        return found


@dataclass
class Change:
    """A further sentence as changes to the steps of a scene."""

    steps: Steps
    values: dict[str, list[float]] = field(default_factory=dict)  # to write first
    sentence: str = ""  # to search for then; "" for nothing
    title: str = ""  # the sentence as the list has it
    shown: int | None = None  # the number of steps that are shown then, if the sentence is no step itself
    place: int | None = None  # of the step that it replaces; None for another step
    first: bool = False  # whether the search is for the first prompt


@dataclass
class Steps:
    """All steps of a scene."""

    base: dict[str, list[float]] = field(default_factory=dict)  # values before a first step changes them
    steps: list[LookStep] = field(default_factory=list)
    shown: int = 0  # how many of the steps the scene shows, from the first
    pivot: list[float] = field(default_factory=lambda: [0.0, 0.0, 0.0])  # the subject's center at export

    @classmethod
    def of(cls, scene: Scene) -> Steps:
        """The steps of a scene; none where it has no vibe. Raises VibeError if they cannot be read."""
        if KEY not in scene:
            return cls()
        try:
            raw = json.loads(scene[KEY])
            if raw.pop("version") > VERSION:
                raise schema.VibeError("Its steps are of a newer version.", "Update Vibe Render.")
            found = cls(steps=[LookStep(**row) for row in raw.pop("steps")], **raw)
            for values in (found.base, *(each for s in found.steps for each in (s.before, s.after))):
                check_values(values)
            found.values()
            return found
        except (ValueError, TypeError, KeyError, AttributeError) as error:
            remedy = "Keep the look, or revert it: the next prompt starts a new list."
            raise schema.VibeError("The list of steps in this file is damaged.", remedy) from error

    def store(self, scene: Scene) -> None:
        """Keeps the steps in the scene."""
        scene[KEY] = json.dumps({"version": VERSION, **asdict(self)}, ensure_ascii=False)

    def values(self, shown: int | None = None) -> dict[str, list[float]]:
        """The values of everything that steps change, after the first `shown` of them."""
        found = {key: list(value) for key, value in self.base.items()}
        for step in self.steps[: self.shown if shown is None else shown]:
            for key, after in step.after.items() if step.on else ():
                before, now = step.before[key], found[key]
                moves = step.is_relative and not same(key, now, before)
                found[key] = along(key, now, (before, after)) if moves else list(after)
        return found

    def take_hand_made(self, current: Known) -> None:
        """Makes a step of what the artist has changed since the last one."""
        expected = self.values()
        mine = {k: v for k, v in expected.items() if k in current and not same(k, v, current[k])}
        if mine:
            self.insert(LookStep(BY_HAND, mine, {key: list(current[key]) for key in mine}))

    def add(
        self,
        change: Change,
        before: Known,
        after: Known,
        reasons: Mapping[str, str] | None = None,
        goals: dict[str, Any] | None = None,
    ) -> None:
        """Adds a step behind those that are shown, or in the place of another; or shows earlier ones.

        Args:
            before: The scene's values when the search began; what it adds to the scene is not there yet.
            after: What the search for it has changed.
            reasons: By key, quoting its words.
        """
        if change.shown is not None:
            self.shown = change.shown
            return
        if change.place is None:  # what it takes back is a part of it
            before, after = {**before, **self.values()}, {**change.values, **after}
        old = {key: list(old_value(key, before, after[key])) for key in after}
        self.base = {**old, **self.base}
        new = {key: list(value) for key, value in after.items()}
        why = {key: reason for key, reason in (reasons or {}).items() if key in new}
        step = LookStep(change.title, old, new, why, goals or {})
        if change.place is None:
            self.insert(step)
        else:
            self.steps[change.place] = step

    def rows(self) -> list[dict[str, Any]]:
        """The steps as report.json has them."""
        return [
            {"sentence": s.sentence, "on": s.on, "shown": n < self.shown, "values": s.after, "goals": s.goals}
            for n, s in enumerate(self.steps)
        ]

    def insert(self, step: LookStep) -> None:
        """Puts a step behind those that are shown, and shows it."""
        self.steps.insert(self.shown, step)
        self.shown += 1

    def change(self, sentence: str) -> Change:
        """The change that a sentence asks for; a VibeError if it is empty, or its step is not there."""
        if not sentence.strip():
            raise schema.VibeError("The step is empty.", 'Say what is to change: "a bit warmer".')
        said, title = sentences.about_steps(sentence), " ".join(sentence.split())
        if said is None:
            return Change(self, {}, sentence, title)
        if said.kind in ("show", "between"):
            number = said.number if said.number >= 0 else max(self.shown - 1, 0)
            if said.what:
                named = [n for n, s in enumerate(self.steps, 1) if said.what.lower() in s.sentence.lower()]
                if not named:
                    return Change(self, {}, sentence, title)
                number = named[-1]
            if number > len(self.steps):
                raise schema.VibeError(f"There is no step {number}.", f"There are 0 to {len(self.steps)}.")
            if said.kind == "between":
                return Change(self, self._mixed(self.values(), self.values(number), 0.5), said.rest, title)
            if said.rest:
                return Change(self, self.values(number), said.rest, title)
            return Change(self, self.values(number), shown=number)
        if said.kind == "strength":
            last = self.steps[self._last()]
            return Change(self, self._mixed(last.before, last.after, said.factor), title=title)
        if said.kind == "except":
            place = self._last()
            return self.again(place, f"{self.steps[place].sentence}, but leave the {said.what}")
        return self._taken_back(title, said)

    def again(self, place: int, sentence: str) -> Change:
        """The search for another sentence in the place of a step."""
        return Change(self, self.values(place), sentence, sentence, place=place, first=place == 0)

    def _taken_back(self, title: str, said: sentences.AboutSteps) -> Change:
        """The values that a word has changed, as they were before, and the word for another target."""
        for number, step in reversed([*enumerate(self.steps[: self.shown])]):
            if step.on and (words := step.keys_of(said.what, by_word=said.kind == "without")):
                before = self.values(number)
                taken = {key: before[key] for keys in words.values() for key in keys}
                new = ", ".join(f"{word} {said.new}" for word in words) if said.new else ""
                return Change(self, taken, new, title)
        return Change(self, {}, title, title)  # what the scene has had before; "peachy, not pink"

    def _last(self) -> int:
        """The place of the last step that is shown and has words. Raises VibeError where there is none."""
        places = [
            n for n, step in enumerate(self.steps[: self.shown]) if step.on and step.sentence not in WORDLESS
        ]
        if not places:
            raise schema.VibeError("There is no step before this one.", 'Say what is to change: "warmer".')
        return places[-1]

    def _mixed(self, first: Known, other: Known, share: float) -> dict[str, list[float]]:
        """Values on the way from the first to the other ones, or beyond."""
        return {
            key: along(key, first[key], (first[key], other[key]), share)
            for key in first
            if key in other and not same(key, first[key], other[key])
        }


def same(key: str, first: Sequence[float], other: Sequence[float]) -> bool:
    """True if two values read the same; a light that has been turned once around stands where it was."""
    if labels.parameter(key).kind == "angle":
        first = [other[0] + (first[0] - other[0] + 180.0) % 360.0 - 180.0]
    return labels.same(key, tuple(first), tuple(other))


def check_values(values: Known) -> None:
    """Raises ValueError for values, by key, that no parameter can have."""
    for key, value in values.items():
        if len(value) != labels.parameter(key).components or not all(map(math.isfinite, value)):
            raise ValueError(key)


def origins(key: str) -> tuple[str, ...]:
    """The keys of the values that one may have without a look: a copy of a material its original's, a backdrop the world's."""
    return key, schema.material_copies.copied_key(key), backgrounds.WORLD_OF_BACKDROP.get(key, key)


def old_value(key: str, before: Known, new: Sequence[float]) -> Sequence[float]:
    """The value that a change replaces. A light or a link that was not there was off, a backdrop the world's."""
    known = next((before[origin] for origin in origins(key) if origin in before), None)
    if known:
        return known
    if key == backgrounds.HORIZON_KEY:
        return backgrounds.NO_HORIZON
    return (0.0,) if schema.split_key(key)[2] in ("power", "strength", "linked") else new


def along(
    key: str, start: Sequence[float], way: tuple[Sequence[float], Sequence[float]], share: float = 1.0
) -> list[float]:
    """Values, moved by a share of the way between two others, in steps that look even: along the parameter's scale.

    At both ends of the way the result is exact.
    """
    first, last = way
    if list(start) == list(first) and share in (0.0, 1.0):
        return list(last if share else first)
    parameter, every = labels.parameter(key), (*start, *first, *last)
    scale = parameter.scale if min(every) > 0.0 or parameter.scale.name != "log" else schema.Scale()
    bounds = min(parameter.lower, *every), max(parameter.upper, *every)
    rows = ([scale.to_unit(v, *bounds) for v in row] for row in zip(start, first, last, strict=True))
    return [scale.from_unit(s + share * (b - a), *bounds) for s, a, b in rows]
