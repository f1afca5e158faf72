# SPDX-License-Identifier: Apache-2.0
"""`vibe explain`: what the words of a prompt mean to Vibe Render."""

from __future__ import annotations

from .language import compose, parse
from .language.types import Parsed, Prompts, SceneWords


def explain(prompt: str) -> str:
    """Readable lines: what was understood, what the encoder will be asked, and what was ignored."""
    parsed = parse(prompt, SceneWords())
    prompts = compose(parsed)
    sections = [*_understood(parsed), *_asked(prompts), *_left_out(parsed)]
    return "\n".join(f"{title}\n" + "\n".join(f"  {row}" for row in rows) for title, rows in sections if rows)


def _understood(parsed: Parsed) -> list[tuple[str, list[str]]]:
    objects = [
        f"{o.name} ({o.region}): "
        + ("; ".join(f"{slot} {words}" for slot, words in o.attributes.items()) or "-")
        for o in parsed.objects
    ]
    measured = [f"{name.replace('_', ' ')}: {value}" for name, value in parsed.targets.items()]
    return [("What the words describe", objects), ("What will be measured", measured)]


def _asked(prompts: Prompts) -> list[tuple[str, list[str]]]:
    asked = [("subject", prompts.subject), ("surroundings", prompts.surroundings), ("picture", prompts.whole)]
    avoided = (*prompts.subject_negatives, *prompts.surroundings_negatives, *prompts.whole_negatives)
    return [
        ("What the encoder is asked", [f"{name}: {text}" for name, text in asked if text]),
        ("What it must not look like", list(avoided)),
    ]


def _left_out(parsed: Parsed) -> list[tuple[str, list[str]]]:
    return [
        ("Guessed", [f"{word} -> {entry}" for word, entry in parsed.guesses.items()]),
        ("Contradictions", parsed.conflicts),
        ("Not understood", [", ".join(parsed.ignored)] if parsed.ignored else []),
    ]
