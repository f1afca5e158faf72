# SPDX-License-Identifier: Apache-2.0
"""The figures of a binding measurement: words bound right, sentences without a mistake, by kind; as data and tables."""

from __future__ import annotations

import statistics
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from rich.console import Console
from rich.table import Table

from lab.bench.binding.judge import SentenceVerdict, WordVerdict
from lab.bench.sealed.table import share

_KINDS = {"by_sentence": "kind of sentence", "by_scene": "kind of scene", "by_target": "what is described"}
_PERCENTILE = 90


def summary(verdicts: Sequence[SentenceVerdict]) -> dict[str, Any]:
    """The content of results.json.

    Returns:
        `words` and `sentences`: how many are right, each with `held`, `asked`, `share` and its 95 % `interval`; `overlap`:
        the mean Jaccard index where materials are described; `extra`: attributes that no label covers; `unread`: sentences
        that were refused; `by_sentence`, `by_scene` and `by_target`: `words` and `sentences` of each kind; `milliseconds`:
        `median` and `percentile_90` for a sentence.
    """
    groups = {
        "by_sentence": _grouped(verdicts, lambda v: v.sentence.kind),
        "by_scene": _grouped(verdicts, lambda v: v.sentence.scene.kind),
    }
    words = [word for verdict in verdicts for word in verdict.words]
    targets = sorted({_target(word) for word in words})
    return {
        **_figures(verdicts),
        "extra": sum(len(verdict.extra) for verdict in verdicts),
        "unread": sum(bool(verdict.error) for verdict in verdicts),
        **{name: {kind: _figures(group) for kind, group in each.items()} for name, each in groups.items()},
        "by_target": {t: _word_figures(w for w in words if _target(w) == t) for t in targets},
        "milliseconds": milliseconds([verdict.seconds for verdict in verdicts]),
    }


def _grouped(
    verdicts: Sequence[SentenceVerdict], kind_of: Callable[[SentenceVerdict], str]
) -> dict[str, list[SentenceVerdict]]:
    kinds = sorted({kind_of(verdict) for verdict in verdicts})
    return {kind: [verdict for verdict in verdicts if kind_of(verdict) == kind] for kind in kinds}


def _figures(verdicts: Sequence[SentenceVerdict]) -> dict[str, Any]:
    words = _word_figures(word for verdict in verdicts for word in verdict.words)
    return {**words, "sentences": share(verdict.right for verdict in verdicts)}


def _word_figures(words: Iterable[WordVerdict]) -> dict[str, Any]:
    each = list(words)
    overlaps = [word.overlap for word in each if word.overlap is not None]
    overlap = round(statistics.mean(overlaps), 4) if overlaps else None
    return {"words": share(word.right for word in each), "overlap": overlap}


def _target(word: WordVerdict) -> str:
    return word.word.targets[0].kind


def milliseconds(seconds: Sequence[float]) -> dict[str, float]:
    """`median` and `percentile_90` of times."""
    ordered = sorted(1000.0 * each for each in seconds)
    last = ordered[min(len(ordered) * _PERCENTILE // 100, len(ordered) - 1)]
    return {"median": round(statistics.median(ordered), 2), f"percentile_{_PERCENTILE}": round(last, 2)}


def missed(verdicts: Sequence[SentenceVerdict]) -> list[dict[str, Any]]:
    """The mistaken sentences: what was wanted of their words and what was found, and what is extra."""
    return [
        {
            "text": verdict.sentence.text,
            "kind": verdict.sentence.kind,
            "scene": verdict.sentence.scene.name,
            "words": [
                {"word": w.word.text, "wanted": w.word.target, "found": [_found(reach) for reach in w.found]}
                for w in verdict.words
                if not w.right
            ],
            "extra": [_found(reach) for reach in verdict.extra],
            "error": verdict.error,
        }
        for verdict in verdicts
        if not verdict.right
    ]


def _found(reach: Any) -> str:
    return f"{reach.attribute.word} → {reach}"


def show(results: Mapping[str, Any]) -> None:
    """Prints the tables, the mistaken sentences if they are among the results, and the closing figures."""
    console = Console(width=None if Console().is_terminal else 120)
    for name, title in _KINDS.items():
        console.print(_table(title, {**results[name], "all": results}))
        console.print()
    for row in results.get("misses", ()):
        console.print(mistaken(row), markup=False, highlight=False)
    closing = f"Attributes that no label covers: {results['extra']}. Sentences that were refused: {results['unread']}. "
    closing += f"A sentence took {taken(results['milliseconds'])}."
    if prompts := results["explaining"]["prompts"]:
        closing += (
            f" Explaining {prompts} prompts of some 40 words took {taken(results['explaining'])} of the processor each."
        )
    console.print(closing, markup=False, highlight=False)


def told(part: Mapping[str, Any]) -> str:
    """ "186 of 200 (93.0 %, 89 to 96 %)".

    Args:
        part: A `share`.
    """
    low, high = part["interval"]
    return f"{_of(part)} ({part['share'] or 0:.1%}, {low:.0%} to {high:.0%})"


def taken(spent: Mapping[str, float]) -> str:
    """A median and a percentile in words.

    Args:
        spent: Of `milliseconds`.
    """
    return f"{spent['median']} ms (median), {spent['percentile_90']} ms (90th percentile)"


def _table(title: str, rows: Mapping[str, Mapping[str, Any]]) -> Table:
    heads = ("words right", "share", "95 % interval", "overlap", "sentences without a mistake", "share")
    table = Table(title, *heads, box=None, pad_edge=False)
    for column in table.columns[1:]:
        column.justify = "right"
    for name, row in rows.items():
        words, sentences = row["words"], row.get("sentences")
        low, high = words["interval"]
        overlap = "" if row["overlap"] is None else f"{row['overlap']:.2f}"
        whole = (_of(sentences), f"{sentences['share']:.0%}") if sentences else ("", "")
        part = "" if words["share"] is None else f"{words['share']:.1%}"
        table.add_row(name, _of(words), part, f"{low:.0%} to {high:.0%}", overlap, *whole)
    return table


def _of(part: Mapping[str, Any]) -> str:
    return f"{part['held']} of {part['asked']}"


def mistaken(row: Mapping[str, Any]) -> str:
    """A mistaken sentence, and below it what is wrong.

    Args:
        row: One of `missed`.
    """
    words = [f"{w['word']}: wanted {w['wanted']}, found {'; '.join(w['found']) or 'nothing'}" for w in row["words"]]
    extra = [f"extra: {each}" for each in row["extra"]]
    error = [f"refused: {row['error']}"] if row["error"] else []
    return "\n    ".join([f"[{row['kind']}, {row['scene']}] {row['text']}", *words, *extra, *error])
