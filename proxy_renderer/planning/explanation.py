# SPDX-License-Identifier: Apache-2.0
"""What was understood and decided, for people (`vibe explain`) and for programs (`--json`)."""

from __future__ import annotations

from ..goals.resolve import Goals
from ..schema import Values, labels
from ..words.types import Parsed, PromptWord
from .captions import Prompts
from .types import Plan


def explain(goals: Goals, prompts: Prompts, plan: Plan) -> str:
    """A readable account of a prompt: what it says, what the encoder is told, what may change and why."""
    parsed = goals.parsed
    lines = [f"Prompt: {parsed.prompt}", "", "Understood"]
    for thing in parsed.objects:
        said = "; ".join(f"{slot}: {words}" for slot, words in thing.attributes.items()) or "as it is"
        materials = f" [{', '.join(thing.materials)}]" if thing.materials else ""
        where = "" if thing.name == thing.region else f" ({thing.region})"
        lines.append(f"  {thing.name}{where}{materials}: {said}")
    lines += [f"  '{mood}' stands for: {words}" for mood, words in _moods(parsed).items()]
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


def _moods(parsed: Parsed) -> dict[str, str]:
    moods: dict[str, dict[str, None]] = {}
    for attribute in parsed.attributes:
        if attribute.cause:
            moods.setdefault(attribute.cause, {})[attribute.word] = None
    return {mood: ", ".join(words) for mood, words in moods.items()}


def _range(key: str, lower: Values, upper: Values) -> str:
    last = labels.text(key, upper)
    return last if lower == upper else f"{labels.bare(key, lower)} .. {last}"
