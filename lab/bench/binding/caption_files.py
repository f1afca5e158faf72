# SPDX-License-Identifier: Apache-2.0
"""Files of captions that other people wrote: "a green bench and a blue bowl", each thing of one material.

Labels come from the form of a caption, or from the metadata beside it. A caption without them is left out and counted.
"""

from __future__ import annotations

import csv
import json
import re
from collections.abc import Sequence
from pathlib import Path

from lab.bench.binding.prompts import BACKDROP, LAMP
from lab.train.sentences.labels import LabeledScene, LabeledSentence, LabelTarget, LookWord
from proxy_renderer.schema import VibeError

NounLook = tuple[str, int, str]
"""A look word, its place in the caption, and the noun that it describes."""

_THING = r"(?:an? |the )?([a-z-]+) ([a-z-]+(?: [a-z-]+){0,2})"
_PAIR = re.compile(rf"{_THING} and {_THING}\.?", re.IGNORECASE)
_SMALL = frozenset((
    "a", "an", "and", "are", "as", "at", "beside", "by", "for", "from", "has", "have",
    "in", "into", "is", "near", "next", "of", "on", "over", "the", "to", "under", "with",
))  # fmt: skip
"""Words that no noun has: a caption with one of them says more than two things with a look each."""


def labeled(path: Path) -> tuple[list[LabeledSentence], int]:
    """The captions of a file that have labels, and how many have none.

    Args:
        path: T2I-CompBench's .txt, or GenEval's evaluation_metadata.jsonl.

    Raises:
        VibeError: The file cannot be read, or has no caption with labels.
    """
    every = _listed(path)
    found = [labels for text, parts in every if (labels := sentence(text, parts))]
    if not found:
        raise VibeError(f"No caption of {path} has labels.", "Write lines like 'a green bench and a blue bowl'.")
    return found, len(every) - len(found)


def unlabeled(path: Path) -> list[str]:
    """The prompts of PartiPrompts' .tsv, which have no labels.

    Raises:
        VibeError: The file cannot be read, or has no column of prompts.
    """
    rows = csv.DictReader(_text(path).splitlines(), delimiter="\t")
    texts = [row["Prompt"] for row in rows if row.get("Prompt")]
    if not texts:
        raise VibeError(f"{path} has no prompt in a column 'Prompt'.", "Use PartiPrompts.tsv.")
    return texts


def sentence(text: str, parts: Sequence[NounLook]) -> LabeledSentence | None:
    """A caption with labels, in a scene of its things, a backdrop and a lamp that no caption names.

    Args:
        parts: Its look words. Things are called by their nouns, and so are their materials.

    Returns:
        The sentence; None if there are no parts, or one noun for two things, which no name tells apart.
    """
    nouns = [noun for _, _, noun in parts]
    if not nouns or len(set(nouns)) < len(nouns):
        return None
    objects: dict[str, tuple[str, ...]] = {name: (name,) for name in (*nouns, BACKDROP)}
    scene = LabeledScene("caption", "product", tuple(nouns), objects, lights=(LAMP,))
    words = (LookWord(word, at, (LabelTarget("materials", frozenset({noun})),)) for word, at, noun in parts)
    return LabeledSentence(scene, "things", text, tuple(words))


def pair(text: str) -> list[NounLook]:
    """The looks and things of "a LOOK THING and a LOOK THING"; none of a caption that says more, or says it otherwise.

    Args:
        text: The caption. A thing has three words at most.
    """
    found = _PAIR.fullmatch(text)
    if not found or _SMALL & {word.lower() for group in found.groups() for word in group.split()}:
        return []
    return [(found[i], found.start(i), found[i + 1].lower()) for i in (1, 3)]


def _listed(path: Path) -> list[tuple[str, list[NounLook]]]:
    """The captions of a file, with what is known of their words."""
    lines = [line.strip() for line in _text(path).splitlines() if line.strip()]
    return [_told(path, line) for line in lines] if path.suffix == ".jsonl" else [(t, pair(t)) for t in lines]


def _told(path: Path, line: str) -> tuple[str, list[NounLook]]:
    """A caption of GenEval, with the colors that its metadata tells."""
    try:
        row = json.loads(line)
        text = row["prompt"]
        things = [(t["color"], t["class"]) for t in row["include"] if "color" in t]
    except (ValueError, KeyError, TypeError) as error:
        raise VibeError(f"{path} has a line that is not GenEval's: {line[:60]}", "Use its metadata.") from error
    places = ((color, text.find(f"{color} {noun}"), noun) for color, noun in things)
    return text, [part for part in places if part[1] >= 0]


def _text(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise VibeError(f"{path} cannot be read: {error}", "Give a text file of captions.") from error
