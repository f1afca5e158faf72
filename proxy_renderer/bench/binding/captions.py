# SPDX-License-Identifier: Apache-2.0
"""Captions that other people wrote, as labeled sentences: "a green bench and a blue bowl", each thing of one material.

Labels come from the form of a caption, or from the metadata beside it. A caption without them is left out and counted.
"""

from __future__ import annotations

import csv
import json
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rich.console import Console

from ...prompt.lexicon.vocabulary import shipped_vocabulary
from ...schema import VibeError, atomic
from ...train.sentences.labels import LabeledScene, LabeledSentence, LabelTarget, LookWord
from ..sealed.table import share
from . import prompts, table
from .judge import SentenceVerdict, judge
from .reading import read

Part = tuple[str, int, str]
"""A look word, its place in the caption, and the noun that it describes."""

_THING = r"(?:an? |the )?([a-z-]+) ([a-z-]+(?: [a-z-]+){0,2})"
_PAIR = re.compile(rf"{_THING} and {_THING}\.?", re.IGNORECASE)
_SMALL = frozenset(
    [
        "a",
        "an",
        "and",
        "are",
        "as",
        "at",
        "beside",
        "by",
        "for",
        "from",
        "has",
        "have",
        "in",
        "into",
        "is",
        "near",
        "next",
        "of",
        "on",
        "over",
        "the",
        "to",
        "under",
        "with",
    ]
)
"""Words that no noun has: a caption with one of them says more than two things with a look each."""


def measure(out: Path, captions: str, misses: bool = False) -> dict[str, Any]:
    """Measures one file of captions, prints the figures, and writes OUT/results.json.

    Args:
        out: The folder.
        captions: T2I-CompBench's .txt, GenEval's evaluation_metadata.jsonl, or PartiPrompts' .tsv, which has no labels.
        misses: Print each mistaken caption, and write it into results.json.

    Returns:
        The content of results.json, see `summary`; of a .tsv, see `prompts.measured`.

    Raises:
        VibeError: The file cannot be read, or has no caption with labels.
    """
    path = Path(captions)
    if path.suffix == ".tsv":
        results = prompts.measured(_rows(path), misses)
        closing = prompts.lines(results)
    else:
        results = _measured(path, misses)
        closing = _lines(results)
    atomic.write_text(out / "results.json", json.dumps(results, indent=1, ensure_ascii=False))
    for line in closing:
        Console(soft_wrap=True).print(line, markup=False, highlight=False)
    return results


def _measured(path: Path, misses: bool) -> dict[str, Any]:
    every = _listed(path)
    labeled = [labels for text, parts in every if (labels := sentence(text, parts))]
    if not labeled:
        raise VibeError(
            f"No caption of {path} has labels.", "Write lines like 'a green bench and a blue bowl'."
        )
    vocabulary = shipped_vocabulary()
    verdicts = [judge(s, read(s.text, s.scene, vocabulary), vocabulary) for s in labeled]
    results = summary(verdicts, skipped=len(every) - len(labeled))
    return results | ({"misses": table.missed(verdicts)} if misses else {})


def summary(verdicts: Sequence[SentenceVerdict], skipped: int) -> dict[str, Any]:
    """The figures of captions with labels.

    Args:
        verdicts: Of these.
        skipped: How many captions have none.

    Returns:
        `words` and `captions`: how many are right, see `sealed.table.share`; `left_out`: words that became nothing;
        `wrong`: words that reach something else; `extra`: attributes that no label covers; `refused` and `skipped`: captions.
    """
    words = [word for verdict in verdicts for word in verdict.words]
    return {
        "words": share(word.right for word in words),
        "captions": share(verdict.right for verdict in verdicts),
        "left_out": sum(not word.found for word in words),
        "wrong": sum(bool(word.found) and not word.right for word in words),
        "extra": sum(len(verdict.extra) for verdict in verdicts),
        "refused": sum(bool(verdict.error) for verdict in verdicts),
        "skipped": skipped,
    }


def sentence(text: str, parts: Sequence[Part]) -> LabeledSentence | None:
    """A caption with labels, in a scene of its things, a backdrop and a lamp that no caption names.

    Args:
        text: The caption.
        parts: Its look words. Things are called by their nouns, and so are their materials.

    Returns:
        The sentence; None if there are no parts, or one noun for two things, which no name tells apart.
    """
    nouns = [noun for _, _, noun in parts]
    if not nouns or len(set(nouns)) < len(nouns):
        return None
    objects: dict[str, tuple[str, ...]] = {name: (name,) for name in (*nouns, prompts.BACKDROP)}
    scene = LabeledScene("caption", "product", tuple(nouns), objects, lights=(prompts.LAMP,))
    words = (LookWord(word, at, (LabelTarget("materials", frozenset({noun})),)) for word, at, noun in parts)
    return LabeledSentence(scene, "things", text, tuple(words))


def pair(text: str) -> list[Part]:
    """The looks and things of "a LOOK THING and a LOOK THING"; none of a caption that says more, or says it otherwise.

    Args:
        text: The caption. A thing has three words at most.
    """
    found = _PAIR.fullmatch(text)
    if not found or _SMALL & {word.lower() for group in found.groups() for word in group.split()}:
        return []
    return [(found[i], found.start(i), found[i + 1].lower()) for i in (1, 3)]


def _listed(path: Path) -> list[tuple[str, list[Part]]]:
    """The captions of a file, with what is known of their words."""
    lines = [line.strip() for line in _text(path).splitlines() if line.strip()]
    return [_told(path, line) for line in lines] if path.suffix == ".jsonl" else [(t, pair(t)) for t in lines]


def _told(path: Path, line: str) -> tuple[str, list[Part]]:
    """A caption of GenEval, with the colors that its metadata tells."""
    try:
        row = json.loads(line)
        text = row["prompt"]
        things = [(t["color"], t["class"]) for t in row["include"] if "color" in t]
    except (ValueError, KeyError, TypeError) as error:
        raise VibeError(
            f"{path} has a line that is not GenEval's: {line[:60]}", "Use its metadata."
        ) from error
    places = ((color, text.find(f"{color} {noun}"), noun) for color, noun in things)
    return text, [part for part in places if part[1] >= 0]


def _rows(path: Path) -> list[str]:
    rows = csv.DictReader(_text(path).splitlines(), delimiter="\t")
    texts = [row["Prompt"] for row in rows if row.get("Prompt")]
    if not texts:
        raise VibeError(f"{path} has no prompt in a column 'Prompt'.", "Use PartiPrompts.tsv.")
    return texts


def _text(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise VibeError(f"{path} cannot be read: {error}", "Give a text file of captions.") from error


def _lines(results: dict[str, Any]) -> list[str]:
    """The figures, and the mistaken captions where they are asked for."""
    words, whole = results["words"], results["captions"]
    figures = (
        f"Words bound right: {table.told(words)}; {results['left_out']} left out, {results['wrong']} bound wrong. "
        f"Captions without a mistake: {table.told(whole)}. Attributes that no label covers: {results['extra']}. "
        f"Captions that were refused: {results['refused']}; of another form, and skipped: {results['skipped']}."
    )
    return [*map(table.mistaken, results.get("misses", ())), figures]
