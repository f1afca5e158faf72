# SPDX-License-Identifier: GPL-3.0-or-later
"""The steps of a look: a first prompt and further sentences, kept in the .blend with the values that each has changed.

Any step may be switched off or removed: the values then follow from the other steps, without another search.
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
Known = Mapping[str, Sequence[float]]  # key of a parameter -> its components


@dataclass
class LookStep:
    """A sentence with the values that it has changed, by key."""

    sentence: str
    before: dict[str, list[float]]
    after: dict[str, list[float]]  # same keys as `before`
    reasons: dict[str, str] = field(default_factory=dict)
    goals: dict[str, Any] = field(default_factory=dict)  # the requests of its words, as in goals.json; empty for none
    on: bool = True

    @property
    def is_relative(self) -> bool:
        """True if all of the step's words compare ("warmer"): its change then adds to the values of earlier steps."""
        words = self.goals.get("words", [])
        return bool(words and self.goals.get("holds")) and not any(word.get("look") for word in words)

    def keys_of(self, noun: str, by_word: bool = True) -> dict[str, list[str]]:
        """Word of the step -> keys that the word has changed, for words whose target is called `noun`.

        With `by_word`, also for words that are `noun` themselves, or whose look is called so.
        """
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
                    key for key, group, owner, _ in parts if not owners or owner in owners or group not in _OWNED
                ]
        return found


@dataclass
class Change:
    """The effect of a further sentence on the steps of a scene."""

    steps: Steps
    values: dict[str, list[float]] = field(default_factory=dict)  # to write before the search
    sentence: str = ""  # to search for; "" for no search
    title: str = ""  # the sentence as the list has it
    shown: int | None = None  # how many steps to show, if the sentence only goes to another step
    place: int | None = None  # index of the step to replace; None to add a step
    first: bool = False  # whether the search is for the first prompt


@dataclass
class Steps:
    """All steps of a scene."""

    base: dict[str, list[float]] = field(default_factory=dict)  # key -> value before any step has changed it
    steps: list[LookStep] = field(default_factory=list)
    shown: int = 0  # how many of the steps the scene shows, from the first
    pivot: list[float] = field(default_factory=lambda: [0.0, 0.0, 0.0])  # the subject's center at export

    @classmethod
    def of(cls, scene: Scene) -> Steps:
        """The steps that are stored in a scene; empty without any. Raises VibeError if they cannot be read."""
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
        """Stores the steps in a custom property of the scene."""
        scene[KEY] = json.dumps({"version": VERSION, **asdict(self)}, ensure_ascii=False)

    def values(self, shown: int | None = None) -> dict[str, list[float]]:
        """Key -> value after the first `shown` steps (default: `self.shown`), for every key that any step changes."""
        found = {key: list(value) for key, value in self.base.items()}
        for step in self.steps[: self.shown if shown is None else shown]:
            for key, after in step.after.items() if step.on else ():
                before, now = step.before[key], found[key]
                moves = step.is_relative and not same(key, now, before)
                found[key] = along(key, now, (before, after)) if moves else list(after)
        return found

    def take_hand_made(self, current: Known) -> None:
        """Adds a step with the artist's own changes: values in `current` that differ from those of the shown steps."""
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
        """Adds a step after the shown ones or replaces a step; if the change only shows other steps, sets `shown`.

        Args:
            change: The result of `change` or `again`.
            before: The scene's values when the search began, without lights and copies that the search has added.
            after: The values that the search has changed.
            reasons: Key -> why the value has changed; each reason quotes the words.
            goals: The requests of the sentence's words, see `LookStep`.
        """
        if change.shown is not None:
            self.shown = change.shown
            return
        if change.place is None:  # values that the change takes back are a part of the step
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
        """A dictionary for each step, as in report.json."""
        return [
            {"sentence": s.sentence, "on": s.on, "shown": n < self.shown, "values": s.after, "goals": s.goals}
            for n, s in enumerate(self.steps)
        ]

    def insert(self, step: LookStep) -> None:
        """Inserts a step after the shown ones, and shows it."""
        self.steps.insert(self.shown, step)
        self.shown += 1

    def change(self, sentence: str) -> Change:
        """The change that a sentence asks for; raises VibeError for an empty one, or for a step that does not exist."""
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
        """The change that replaces the step at index `place` by the result of a search for another sentence."""
        return Change(self, self.values(place), sentence, sentence, place=place, first=place == 0)

    def _taken_back(self, title: str, said: sentences.AboutSteps) -> Change:
        """The change that restores the values that the words about `said.what` have changed.

        If `said.new` names another target, the words are searched for it. If no step has them, `title` is searched.
        """
        removes = said.kind == "without"
        rows = [(n, s.keys_of(said.what, by_word=removes)) for n, s in enumerate(self.steps[: self.shown]) if s.on]
        rows = [(number, words) for number, words in rows if words]
        if rows:
            number, words = rows[0 if removes else -1]  # a removal goes back to before the first of the steps
            before = self.values(number)
            mine = (words for _, words in rows) if removes else (words,)
            taken = {key: before[key] for each in mine for keys in each.values() for key in keys}
            new = ", ".join(f"{word} {said.new}" for word in words) if said.new else ""
            return Change(self, taken, new, title)
        return Change(self, {}, title, title)  # the scene had it before, or a look: "peachy, not pink"

    def _last(self) -> int:
        places = [n for n, step in enumerate(self.steps[: self.shown]) if step.on and step.sentence not in WORDLESS]
        if not places:
            raise schema.VibeError("There is no step before this one.", 'Say what is to change: "warmer".')
        return places[-1]

    def _mixed(self, first: Known, other: Known, share: float) -> dict[str, list[float]]:
        """Key -> value at a share of the way from `first` to `other` (above 1: beyond), where the two differ."""
        return {
            key: along(key, first[key], (first[key], other[key]), share)
            for key in first
            if key in other and not same(key, first[key], other[key])
        }


def same(key: str, first: Sequence[float], other: Sequence[float]) -> bool:
    """True if two values read the same, see `labels.same`; an angle may differ by full turns."""
    if labels.parameter(key).kind == "angle":
        first = [other[0] + (first[0] - other[0] + 180.0) % 360.0 - 180.0]
    return labels.same(key, tuple(first), tuple(other))


def check_values(values: Known) -> None:
    """Raises ValueError for a wrong number of components, NaN or infinity; KeyError for the key of no parameter."""
    for key, value in values.items():
        if len(value) != labels.parameter(key).components or not all(map(math.isfinite, value)):
            raise ValueError(key)


def origins(key: str) -> tuple[str, ...]:
    """A key and the keys that its value may start from: the original's for a copy, the world's for a backdrop."""
    return key, schema.material_copies.copied_key(key), backgrounds.WORLD_OF_BACKDROP.get(key, key)


def old_value(key: str, before: Known, new: Sequence[float]) -> Sequence[float]:
    """The value that `new` replaces: the one in `before` for the key or one of its `origins`, else a neutral value.

    Neutral is 0 for a light's power and a link, no tint for a horizon, and `new` itself for all others.
    """
    known = next((before[origin] for origin in origins(key) if origin in before), None)
    if known:
        return known
    if key == backgrounds.HORIZON_KEY:
        return backgrounds.NO_HORIZON
    return (0.0,) if schema.split_key(key)[2] in ("power", "strength", "linked") else new


def along(
    key: str, start: Sequence[float], way: tuple[Sequence[float], Sequence[float]], share: float = 1.0
) -> list[float]:
    """The value `start`, moved by a share of the `way` from one value to another, on the parameter's perceptual scale.

    If `start` is the first value of the way, the result is exact for shares of 0 and 1.
    """
    first, last = way
    if list(start) == list(first) and share in (0.0, 1.0):
        return list(last if share else first)
    parameter, every = labels.parameter(key), (*start, *first, *last)
    scale = parameter.scale if min(every) > 0.0 or parameter.scale.name != "log" else schema.Scale()
    bounds = min(parameter.lower, *every), max(parameter.upper, *every)
    rows = ([scale.to_unit(v, *bounds) for v in row] for row in zip(start, first, last, strict=True))
    return [scale.from_unit(s + share * (b - a), *bounds) for s, a, b in rows]
