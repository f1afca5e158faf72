# SPDX-License-Identifier: Apache-2.0
"""Accuracy with which the encoder reads looks off shapes that it never saw, and its answers to wordings that no caption had.

Shapes are traced and rendered from seeds that neither training nor the choice of weights used. Wordings that
`train.text.wording` keeps back are asked in two ways: as a vibe asks, where the language turns them into phrases that
the encoder was trained on ("wordings": language and encoder together), and as they are ("raw wordings": the encoder
alone). Classes that keep no wording back are left out of both. The judge encoder, another one that never guides, is
measured beside it.
"""

from __future__ import annotations

import json
import os
import random
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import torch
from rich.console import Console
from rich.table import Table

from lab import judge as judge_encoder
from lab.bench import cache
from lab.bench.encoder.mistakes import save_mistakes
from lab.heads.attributes import ATTRIBUTES
from lab.heads.classes import classes_of
from lab.train.data import LOOKS, Batch
from lab.train.evaluate import FEW, Mistake, cost, judge, shaded, skill
from lab.train.pictures import bank, cycles
from lab.train.pictures.augment import WHOLE
from lab.train.pictures.looks import INDEX, NAMES
from lab.train.text.captions import caption, sayable
from lab.train.text.wording import WordingSplit
from proxy_renderer.guidance.encoder import Encoder, load_encoder
from proxy_renderer.planning.advice import compose
from proxy_renderer.schema import VibeError, atomic
from proxy_renderer.words.lexicon.entries import normalize
from proxy_renderer.words.lexicon.languages import Nearest
from proxy_renderer.words.lexicon.vocabulary import shipped_vocabulary
from proxy_renderer.words.parser import parse
from proxy_renderer.words.types import SceneDescription

WORDS = Path(__file__).parents[1] / "unseen_words.txt"
TEST = 200_000
"""Seeds of shapes from here on are for this measurement alone. Those from `train.encoder.HELD_OUT` on, by which weights
were chosen, are validation."""
_SIZE, _SHAPES = 160, 48
_KEPT = WordingSplit(held_out=True)


def run(
    out: Path, encoder: str = "embedded", views: int = 96, pairs: int = 240, cache_folder: str = ""
) -> dict[str, Any]:
    """Measures an encoder, and the judge beside it, and writes OUT/results.json and OUT/mistakes.png.

    Args:
        encoder: As for a vibe.
        views: How many views are traced; each is shaded under many looks.
        pairs: How many pairs of Cycles pictures are rendered; 0 to do without Blender.
        cache_folder: Where both are kept for the next time.

    Returns:
        `attribute_flip`, `swap` and `synonym` (fractions), `heads` and `flips` by attribute, `crops_seconds`, and the
        same by set of pictures and for the judge.
    """
    place = Path(cache_folder) if cache_folder else cache.folder().with_name("encoder")
    sets = _pictures(place, views, pairs)
    asked = load_encoder(encoder)
    mistakes: list[Mistake] = []
    results = _measure(asked, sets, mistakes)
    results["crops_seconds"] = cost(asked)
    results["synonym"], results["synonym_by_language"] = synonyms(asked, sets["meshes"])
    results["judge"] = _measure(judge_encoder.load(), sets, [])
    _print(results)
    out.mkdir(parents=True, exist_ok=True)
    save_mistakes(mistakes, out / "mistakes.png")
    atomic.write_text(out / "results.json", json.dumps(results, indent=1))
    return results


def _pictures(place: Path, views: int, pairs: int) -> dict[str, list[Batch]]:
    """The sets of pictures: shaded views of meshes, and Cycles pictures."""
    traced, real = place / f"test-views-{views}-{_SIZE}", place / f"test-cycles-{pairs}-{_SIZE}"
    if not traced.exists():
        print(f"Tracing {views} views …", flush=True)
        bank.build(traced, views, _SHAPES, TEST, _SIZE, os.cpu_count() or 1)
    if pairs and not real.exists():
        print(f"Rendering {2 * pairs} Cycles pictures …", flush=True)
        cycles.build(real, pairs, TEST, _SIZE)
    sets = {"meshes": list(shaded(bank.load(traced), max(1, views // 16)))}
    return sets | ({"cycles": [_batch(cycles.load(real))]} if pairs else {})


def _batch(real: dict[str, np.ndarray]) -> Batch:
    """A bank of Cycles pictures as one batch of whole pictures."""
    count, none = len(real["labels"]), torch.empty(0)
    pictures = torch.from_numpy(real["pictures"]).float() / 255
    labels, flipped = (torch.from_numpy(real[name]) for name in ("labels", "flipped"))
    whole, masks = torch.full((count,), WHOLE), torch.from_numpy(real["masks"]) > 127
    return Batch(pictures, labels, [], none, flipped, whole, none, none, [], none, masks)


def _measure(asked: Encoder, sets: dict[str, list[Batch]], mistakes: list[Mistake]) -> dict[str, Any]:
    """Figures by set; means are over those that a vibe meets, so without the wordings that no language reads."""
    figures = {name: judge(asked, batches, mistakes=mistakes) for name, batches in sets.items()}
    figures["wordings"] = judge(asked, sets["meshes"], _in_other_words, mistakes)
    raw = judge(asked, sets["meshes"], _raw, mistakes)
    over = {
        kind: {
            name: _mean(
                one[kind].get(name) for one in figures.values() if one["comparisons"].get(f"{what}/{name}", 0) >= FEW
            )
            for name in NAMES
        }
        for kind, what in (("flip_by_attribute", "flip"), ("heads", "heads"))
    }
    return {
        "attribute_flip": _mean(over["flip_by_attribute"].values()),
        "swap": _mean(one["swap"] for one in figures.values()),
        "flips": over["flip_by_attribute"],
        "heads": over["heads"],
        "skill": skill(one for name, one in figures.items() if name != "wordings"),
        "sets": figures | {"raw wordings": raw},
    }


def _mean(values: Any) -> float | None:
    numbers = [value for value in values if value is not None]
    return round(float(np.mean(numbers)), 4) if numbers else None


def _raw(classes: dict[str, str], _noun: str, wording: float) -> str:
    """A sentence in words that no caption of training used; "" where a class has none.

    A sentence names one thing: "vase, a photo of a metallic truck", as training has it, asks for no metallic vase.
    """
    return caption(classes, random.Random(wording), split=_KEPT) if sayable(classes, _KEPT) else ""


def _in_other_words(classes: dict[str, str], noun: str, wording: float) -> str:
    """The encoder's text for such a sentence: phrases of the language, which training has taught."""
    sentence = _raw(classes, noun, wording)
    if not sentence:
        return ""
    try:
        return compose(parse(sentence, SceneDescription())).whole or sentence
    except VibeError:  # the language has no word of it
        return sentence


def synonyms(asked: Encoder, batches: list[Batch]) -> tuple[float, float]:
    """The share of words unknown to the vocabulary that are understood.

    A word is understood as far as the language finds an entry that is right for it, and, where that entry speaks of
    what the encoder reads, as far as the encoder tells pictures that show it from their flips by the entry's phrase.

    Returns:
        Two fractions: by language and encoder, and by language alone.
    """
    vocabulary = shipped_vocabulary()
    search = vocabulary.made(Nearest)
    listed = {*vocabulary.synonyms, *vocabulary.colors, *vocabulary.adjectives, *vocabulary.nouns, *vocabulary.shades}
    listed |= {*vocabulary.intensity} | {w for group in vocabulary.lists.values() for w in group}
    told: dict[str, float] = {}
    scores, places = [], []
    for word, right in _unseen():
        if word in listed:
            continue
        nearest = next(iter(search.choices(word, 1)), "")
        entry = vocabulary.synonyms.get(nearest, "")
        places.append(entry in right)
        if entry in right and entry not in told:
            told[entry] = _told_apart(
                asked, batches, vocabulary.entries[entry].phrase, classes_of(vocabulary.entries[entry])
            )
        scores.append(told[entry] if entry in right else 0.0)
    return round(float(np.mean(scores)), 4), round(float(np.mean(places)), 4)


def _unseen() -> Iterator[tuple[str, set[str]]]:
    """(word, entries that are right for it) of the list beside this module."""
    for line in WORDS.read_text(encoding="utf-8").splitlines():
        if not line.startswith("#"):
            _, word, right = line.split("|")
            yield normalize(word), {r.strip() for r in right.split(",")}


def _told_apart(asked: Encoder, batches: list[Batch], phrase: str, heads: dict[str, str]) -> float:
    """Share of pictures with a phrase's look that are nearer to it than their one-attribute flips; 1 where it asks for nothing."""
    right: list[bool] = []
    for name, value in heads.items():
        column, wanted = INDEX[name], ATTRIBUTES[name].index(value)
        for batch in batches:
            flips = (batch.flipped == column).nonzero()[:, 0].tolist()
            shown = {i: [int(batch.labels[k, column]) for k in (i, i - i % LOOKS)] for i in flips}
            pairs = [(i, i - i % LOOKS) for i, each in shown.items() if wanted in each and min(each) >= 0]
            if not pairs:
                continue
            text = asked.encode_texts([f"an object, {phrase}"]).cpu()[0]
            with torch.no_grad():
                a, b = (
                    asked.encode_images(batch.pictures[list(rows)]).cpu() @ text for rows in zip(*pairs, strict=True)
                )
            is_it = torch.tensor([int(batch.labels[i, column]) == wanted for i, _ in pairs])
            right += ((a > b) == is_it).tolist()
    return float(np.mean(right)) if right else 1.0


def _print(results: dict[str, Any]) -> None:
    columns = {name: results["sets"][name] for name in results["sets"]}
    shown = Table("attribute", *(f"flip, {name}" for name in columns), "heads", "judge's heads", "skill")
    for name in NAMES:
        flips = (one["flip_by_attribute"].get(name) for one in columns.values())
        judged = results.get("judge", {}).get("heads", {}).get(name)
        cells = (*flips, results["heads"][name], judged, results["skill"].get(name))
        shown.add_row(name, *("–" if value is None else f"{value:.2f}" for value in cells))
    Console().print(shown)
    for name in ("attribute_flip", "swap", "synonym", "synonym_by_language", "crops_seconds"):
        print(f"{name}: {results[name]}")
