# SPDX-License-Identifier: Apache-2.0
"""Labeled sentences in other languages as the reader takes them: in English words, each label where its words went."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import groupby

from lab.train.sentences.labels import LabeledSentence, LookWord
from proxy_renderer.words.foreign import Piece, gloss
from proxy_renderer.words.lexicon.vocabulary import Vocabulary
from proxy_renderer.words.types import SceneDescription


def glossed(sentence: LabeledSentence, scene: SceneDescription, vocabulary: Vocabulary) -> LabeledSentence:
    """A sentence in English words; itself where it is English.

    Words of one label that do not stand together any more are labeled each.
    """
    read = gloss(sentence.text, scene, vocabulary)
    if not read.language:
        return sentence
    said = [piece for piece in read.pieces if piece.english]
    places = [*_places(read.english, said)]
    labeled = [next((w for w in sentence.words if _covers(w, piece)), None) for piece in said]
    words = []
    for word, group in groupby(range(len(said)), key=lambda i: labeled[i]):
        run = list(group)
        if word:
            start, end = places[run[0]][0], places[run[-1]][1]
            words.append(LookWord(read.english[start:end], start, word.targets))
    return replace(sentence, text=read.english, words=tuple(words))


def _covers(word: LookWord, piece: Piece) -> bool:
    return piece.kind != "mark" and piece.start < word.end and word.start < piece.end


def _places(english: str, said: list[Piece]) -> Iterator[tuple[int, int]]:
    """Places of pieces in the English text, in its order."""
    end = 0
    for piece in said:
        start = english.index(piece.english, end)
        end = start + len(piece.english)
        yield start, end
