# SPDX-License-Identifier: Apache-2.0
"""Which attributes a labeled look word became: by their places in the sentence, as far as these can be told."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence

from lab.bench.binding.reading import Reach
from lab.train.sentences.labels import LabeledSentence, LookWord
from lab.train.sentences.right import as_meant
from proxy_renderer.words.lexicon.entries import normalize

_TOKEN = re.compile(r"[^\W_]+(?:['’][^\W_]+)*")
Span = tuple[int, int]


def matched(
    sentence: LabeledSentence, reaches: Sequence[Reach], is_right: Callable[[LookWord, Reach], bool]
) -> tuple[list[list[Reach]], list[Reach]]:
    """The attributes of each look word, and those that no look word covers.

    An attribute belongs to the look words in whose place it stands. Where the reader has put other words in place of
    the artist's ("5 pm"), it belongs to a look word that is left and that it is right for. What names the light or the
    thing that a look word beside it describes ("sunlight cold as ice"), or says where that light comes from, belongs to it.

    Args:
        reaches: Of the sentence's attributes, in order.
        is_right: Whether a look word may be bound like this.
    """
    places = _places(sentence.text, reaches)
    found: list[list[Reach]] = [[] for _ in sentence.words]
    over: list[tuple[Reach, Span | None]] = []
    for reach, span in zip(reaches, places, strict=True):
        mine = [i for i, word in enumerate(sentence.words) if span and _overlap(span, word)]
        for i in mine:
            found[i].append(reach)
        if not mine:
            over.append((reach, span))
    extra: list[Reach] = []
    for reach, span in over:
        right = [i for i, word in enumerate(sentence.words) if is_right(word, reach)]
        free = [i for i in right if not found[i] and (span is None or _shares(sentence.words[i], reach))]
        beside = [i for i in right if span is None or _is_beside(sentence, span, i) or reach.directs]
        if free:
            found[free[0]].append(reach)
        elif not beside:
            extra.append(reach)
    return found, extra


def _is_beside(sentence: LabeledSentence, span: Span, number: int) -> bool:
    """True if nothing but space is between a place and a look word."""
    word = sentence.words[number]
    between = sentence.text[span[1] : word.start] or sentence.text[word.end : span[0]]
    return (span[1] < word.start or word.end < span[0]) and not between.strip()


def _places(text: str, reaches: Sequence[Reach]) -> list[Span | None]:
    """Places of the last words of each attribute in a text; None for those without one.

    A word that is there several times is meant where the attribute's thing is next to it, or else in order.
    """
    tokens = [(as_meant(m.group()), m.span()) for m in _TOKEN.finditer(text)]
    words = [word for word, _ in tokens]
    taken: set[int] = set()
    places: list[Span | None] = []
    for reach in reaches:
        if reach.attribute.place:
            places.append(reach.attribute.place)
            continue
        things = [i for i, word in enumerate(words) if word in reach.attribute.thing.split()]
        said = _words(reach.attribute.word)
        place = None
        for length in range(len(said), 0, -1):
            starts = [i for i in range(len(words)) if words[i : i + length] == said[-length:]]
            if fresh := [i for i in starts if i not in taken]:
                at = min(fresh, key=lambda i: min((abs(i - thing) for thing in things), default=0))
                taken.add(at)
                place = tokens[at][1][0], tokens[at + length - 1][1][1]
            if starts:
                break
        places.append(place)
    return places


def _words(text: str) -> list[str]:
    return [as_meant(m.group()) for m in _TOKEN.finditer(normalize(text))]


def _overlap(span: Span, word: LookWord) -> bool:
    return span[0] < word.end and word.start < span[1]


def _shares(word: LookWord, reach: Reach) -> bool:
    """True if the last word of one is in the other: "too dark" takes the place of "dark"."""
    mine, theirs = _words(word.text), _words(reach.attribute.word)
    return bool(mine and theirs) and (mine[-1] in theirs or theirs[-1] in mine)
