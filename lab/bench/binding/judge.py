# SPDX-License-Identifier: Apache-2.0
"""Judgment of the binding of look words by their labels, sentence by sentence."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from lab.bench.binding.places import matched
from lab.bench.binding.reading import Reach, SentenceReading
from lab.bench.binding.targets import MATTER, SentenceTargets, painted
from lab.train.sentences.labels import LabeledSentence, LookWord
from proxy_renderer.words.lexicon.vocabulary import Vocabulary


@dataclass(frozen=True)
class WordVerdict:
    """A look word with what became of it.

    Attributes:
        word: With its label.
        found: What its attributes reach; none where the reader ignored it.
        right: Whether it is bound as the label says.
        overlap: Jaccard index of the materials wanted and found; None where the label names no materials.
    """

    word: LookWord
    found: tuple[Reach, ...]
    right: bool
    overlap: float | None


@dataclass(frozen=True)
class SentenceVerdict:
    """A sentence with what became of its words.

    Attributes:
        sentence: With its labels.
        words: One for each of its look words.
        extra: Attributes that no label covers.
        seconds: That reading took.
        error: Why it could not be read; "" if it could.
    """

    sentence: LabeledSentence
    words: tuple[WordVerdict, ...]
    extra: tuple[Reach, ...]
    seconds: float
    error: str

    @property
    def right(self) -> bool:
        """True if nothing in it is mistaken."""
        return not self.extra and all(word.right for word in self.words)


def judge(sentence: LabeledSentence, reading: SentenceReading, vocabulary: Vocabulary) -> SentenceVerdict:
    """Compares a reading with the labels.

    Args:
        reading: What the reader made of it.
    """
    targets = SentenceTargets(sentence, reading.roles, vocabulary)
    found, extra = matched(sentence, reading.reaches, targets.is_right)
    words = tuple(_verdict(w, f, targets) for w, f in zip(sentence.words, found, strict=True))
    return SentenceVerdict(sentence, words, tuple(extra), reading.seconds, reading.error)


def _verdict(word: LookWord, found: Sequence[Reach], targets: SentenceTargets) -> WordVerdict:
    """Of one look word, with all attributes that it became."""
    nothing = any(target.kind == "none" for target in word.targets)
    right = all(targets.is_right(word, reach) for reach in found) if found else nothing
    if word.targets[0].kind not in MATTER:
        return WordVerdict(word, tuple(found), right, None)
    shown = frozenset[str]().union(*(painted(reach) for reach in found))
    overlap = max(_jaccard(targets.materials(word, t), shown) for t in word.targets if t.kind in MATTER)
    return WordVerdict(word, tuple(found), right, 1.0 if right else overlap)


def _jaccard(one: frozenset[str], other: frozenset[str]) -> float:
    return len(one & other) / len(one | other) if one | other else 0.0
