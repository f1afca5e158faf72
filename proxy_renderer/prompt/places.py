# SPDX-License-Identifier: Apache-2.0
"""Places that nobody listed: "inside of a casino" is the nearest setting that the vocabulary has, said to be guessed."""

from __future__ import annotations

from collections.abc import Sequence

from .lexicon.nearest import nearest
from .lexicon.things import english_things
from .lexicon.vocabulary import Vocabulary
from .tokens import Token


def guess_places(tokens: Sequence[Token], vocabulary: Vocabulary) -> None:
    """Marks unknown words that say what is all around with the nearest place.

    Args:
        tokens: Of a clause; changed.
        vocabulary: What is known.
    """
    for index, token in enumerate(tokens):
        unknown = not (token.known or token.near or token.guess)
        if unknown and _is_around(tokens[:index]):
            token.near = nearest(vocabulary).place(token.text, english_things())


def _is_around(before: Sequence[Token]) -> bool:
    """Whether what follows these tokens is said to be all around: "in a", "feels like the inside of an old"."""
    for token in reversed(before):
        if "place" in token.lists:
            return True
        if not (token.entry or token.color or token.adjective or "stop" in token.lists):
            return False
    return False
