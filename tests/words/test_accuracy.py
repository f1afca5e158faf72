# SPDX-License-Identifier: Apache-2.0
"""Look words of labeled sentences reach what they describe, at least as often as is written here."""

from pathlib import Path

import pytest

from lab.bench.binding.judge import SentenceVerdict, WordVerdict, judge
from lab.bench.binding.reading import read
from lab.train import sentences
from lab.train.sentences import read_folder
from proxy_renderer.words.lexicon.vocabulary import shipped_vocabulary

FOLDER = Path(sentences.__file__).parent
LANGUAGES = ("german", "french", "spanish", "japanese", "chinese")


def verdicts_of(*folders: str) -> list[SentenceVerdict]:
    vocabulary = shipped_vocabulary()
    labeled = [s for folder in folders for s in read_folder(FOLDER / folder)]
    return [judge(s, read(s.text, s.scene, vocabulary), vocabulary) for s in labeled]


def share_right(*folders: str) -> float:
    right = [word.right for verdict in verdicts_of(*folders) for word in verdict.words]
    return sum(right) / len(right)


def is_asked_for(word: WordVerdict) -> bool:
    """Whether a word is right, and not forbidden where the artist asks for it."""
    forbids = word.word.text.split()[0] in ("no", "not", "less")
    return word.right and (forbids or not any(reach.attribute.negated for reach in word.found))


def test_exchanges():
    """What replaces another look is asked for; what it replaces is not."""
    verdicts = verdicts_of("exchanges")
    right = [is_asked_for(word) for verdict in verdicts for word in verdict.words]
    replaced = [e for verdict in verdicts for e in verdict.extra if not e.attribute.negated]
    assert sum(right) >= 110  # of 125
    assert len(replaced) <= 12


@pytest.mark.slow
def test_held_out_sentences():
    assert share_right("held_out") > 0.67


@pytest.mark.slow
def test_other_languages():
    held_out = (f"{language}_{kind}" for language in LANGUAGES for kind in ("native", "held_out"))
    assert share_right(*held_out) > 0.74
