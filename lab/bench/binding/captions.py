# SPDX-License-Identifier: Apache-2.0
"""Binding of look words in captions that other people wrote."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rich.console import Console

from lab.bench.binding import caption_files, prompts, table
from lab.bench.binding.judge import SentenceVerdict, judge
from lab.bench.binding.reading import read
from lab.bench.sealed.table import share
from proxy_renderer.schema import atomic
from proxy_renderer.words.lexicon.vocabulary import shipped_vocabulary


def measure(out: Path, captions: str, misses: bool = False) -> dict[str, Any]:
    """Measures one file of captions, prints the figures, and writes OUT/results.json.

    Args:
        captions: T2I-CompBench's .txt, GenEval's evaluation_metadata.jsonl, or PartiPrompts' .tsv, which has no labels.
        misses: Print each mistaken caption, and write it into results.json.

    Returns:
        The content of results.json, see `summary`; of a .tsv, see `prompts.measured`.

    Raises:
        VibeError: The file cannot be read, or has no caption with labels.
    """
    path = Path(captions)
    if path.suffix == ".tsv":
        results = prompts.measured(caption_files.unlabeled(path), misses)
        closing = prompts.lines(results)
    else:
        results = _measured(path, misses)
        closing = _lines(results)
    atomic.write_text(out / "results.json", json.dumps(results, indent=1, ensure_ascii=False))
    for line in closing:
        Console(soft_wrap=True).print(line, markup=False, highlight=False)
    return results


def _measured(path: Path, misses: bool) -> dict[str, Any]:
    labeled, skipped = caption_files.labeled(path)
    vocabulary = shipped_vocabulary()
    verdicts = [judge(s, read(s.text, s.scene, vocabulary), vocabulary) for s in labeled]
    return summary(verdicts, skipped) | ({"misses": table.missed(verdicts)} if misses else {})


def summary(verdicts: Sequence[SentenceVerdict], skipped: int) -> dict[str, Any]:
    """The figures of captions with labels.

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


def _lines(results: dict[str, Any]) -> list[str]:
    """The figures, and the mistaken captions where they are asked for."""
    words, whole = results["words"], results["captions"]
    figures = (
        f"Words bound right: {table.told(words)}; {results['left_out']} left out, {results['wrong']} bound wrong. "
        f"Captions without a mistake: {table.told(whole)}. Attributes that no label covers: {results['extra']}. "
        f"Captions that were refused: {results['refused']}; of another form, and skipped: {results['skipped']}."
    )
    return [*map(table.mistaken, results.get("misses", ())), figures]
