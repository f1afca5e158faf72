# SPDX-License-Identifier: Apache-2.0
"""A round's understanding of a prompt and its plan, and a readable account of both."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from typing import Any, Protocol

from ..goals.resolve import Goals
from ..schema import Instance, Values, VibeError, labels
from ..words.types import Attribute, PromptWord, SceneDescription
from .captions import Prompts, compose
from .planner import plan
from .types import LightPlan, Plan

NO_PROMPTS = Prompts("", "", "")  # nothing to ask an encoder


@dataclass(frozen=True)
class Advice:
    """A round's understanding of the prompt, and its plan."""

    goals: Goals  # what the words wish for; with the objects list O
    prompts: Prompts
    plan: Plan
    unmeasured: Prompts = NO_PROMPTS  # captions and negatives of the words alone that no measure covers
    # who gave it: "offline planner", or the model; with the reason if it was not the one asked for
    source: str = "offline planner"
    placed: frozenset[str] = frozenset()  # keys of what a rig has placed already


class Advisor(Protocol):
    """Fills the typed structures of a round."""

    def advise(self, display: Any, instances: Mapping[str, Instance], scene: SceneDescription) -> Advice:
        """Parse, compose, confine. `display` is the current image (H, W, 3) in [0, 1]; locks are in `instances`."""


class OfflineAdvisor:
    """The vocabulary and its planner; without goals, the reason why nothing is understood."""

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
    """Captions of the words that are sought and that claim nothing of the image; a rig measures those that it serves."""
    measured = [wish.attribute for wish in goals.wishes if wish.is_measured]
    left = [
        a
        for a in goals.parsed.attributes
        if not (a.negated or a.cause or a in measured or a in served or a in goals.overruled)
    ]
    return compose(replace(goals.parsed, attributes=left)) if left else NO_PROMPTS


def explain(goals: Goals, prompts: Prompts, plan: Plan) -> str:
    """A readable account of a prompt: what it says, what the encoder is told, what may change and why."""
    parsed = goals.parsed
    lines = [f"Prompt: {parsed.prompt}", "", "Understood"]
    for thing in parsed.objects:
        said = "; ".join(f"{slot}: {words}" for slot, words in thing.attributes.items()) or "as it is"
        materials = f" [{', '.join(thing.materials)}]" if thing.materials else ""
        where = "" if thing.name == thing.region else f" ({thing.region})"
        lines.append(f"  {thing.name}{where}{materials}: {said}")
    moods: dict[str, dict[str, None]] = {}
    for attribute in (a for a in parsed.attributes if a.cause):
        moods.setdefault(attribute.cause, {})[attribute.word] = None
    lines += [f"  '{mood}' stands for: {', '.join(words)}" for mood, words in moods.items()]
    lines += [f"  guessed: '{word}' as '{entry}'" for word, entry in parsed.guesses.items()]
    if parsed.ignored:
        lines.append(f"  not used: {', '.join(parsed.ignored)}")
    lines += ["", "Words (--target WORD=NAME says what a word describes)", *map(_word, parsed.words)]
    lines += ["", "Told to an encoder that is named (--encoder)", f"  subject: {prompts.subject}"]
    lines.append(f"  surroundings: {prompts.surroundings or '(left open)'}")
    lines.append(f"  picture: {prompts.whole}")
    unwanted = (*prompts.subject_negatives, *prompts.surroundings_negatives, *prompts.whole_negatives)
    lines += [f"  not: {text}" for text in unwanted]
    lines += ["", "Plan (the smaller the priority, the more important)"]
    moving = sorted((e.priority, key) for key, e in plan.items() if e.priority is not None)
    for priority, key in moving:
        entry = plan[key]
        lines.append(
            f"  {priority:3d}  {labels.title(key)}: {_range(key, entry.lower, entry.upper)}  {entry.reason}"
        )
    kept = len(plan) - len(moving)
    lines.append(f"  {kept} other parameters keep the artist's value.")
    lines += [f"  note: {note}" for note in plan.notes]
    return "\n".join(lines)


def _word(word: PromptWord) -> str:
    """A word with what it describes, how sure that is, and what else it may describe."""
    others = "".join(f"; {each.name} {each.probability:.0%}" for each in word.candidates[1:])
    sure = f" ({word.confidence:.0%}{others})" if word.candidates else ""
    return f"  {word.key}: {word.target}{sure}"


def as_dict(goals: Goals, prompts: Prompts, plan: Plan) -> dict:
    """The same for `--json`: objects, prompts, plan, and what was ignored or guessed."""
    parsed = goals.parsed
    return {
        "prompt": parsed.prompt,
        "objects": [
            {"name": o.name, "region": o.region, "attributes": o.attributes, "materials": list(o.materials)}
            for o in parsed.objects
        ],
        "prompts": {name: getattr(prompts, name) for name in prompts.__dataclass_fields__},
        "classes": goals.classes,
        "plan": {
            key: {"lower": list(e.lower), "upper": list(e.upper), "priority": e.priority, "reason": e.reason}
            for key, e in plan.items()
        },
        "words": [word.row() for word in parsed.words],
        "ignored": parsed.ignored,
        "guesses": parsed.guesses,
        "notes": list(plan.notes),
    }


def _range(key: str, lower: Values, upper: Values) -> str:
    last = labels.text(key, upper)
    return last if lower == upper else f"{labels.bare(key, lower)} .. {last}"
