# SPDX-License-Identifier: Apache-2.0
"""Words that only compare, as "colder" and "less contrast" do: beside a picture they are meant relative to it."""

from __future__ import annotations

from collections.abc import Sequence

from ..words.lexicon.vocabulary import Vocabulary
from ..words.types import Attribute


def compares(attribute: Attribute, all_of_them: Sequence[Attribute], vocabulary: Vocabulary) -> bool:
    """Whether an attribute, or the mood that it comes from, is said by a word that compares.

    Args:
        vocabulary: Knows what "colder" is made of.
    """
    if not attribute.cause:
        return any(_is_comparative(word, vocabulary) for word in _english(attribute).split())
    moods = [a for a in all_of_them if not a.cause and attribute.cause == a.word]
    return any(compares(mood, (), vocabulary) for mood in moods)


def _english(attribute: Attribute) -> str:
    return attribute.english or attribute.word


def _is_comparative(word: str, vocabulary: Vocabulary) -> bool:
    known = vocabulary.adjectives.keys() | vocabulary.synonyms.keys()
    return word in vocabulary.lists["degree"] or not known.isdisjoint(vocabulary.stems(word, "comparative"))
