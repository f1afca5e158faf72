# SPDX-License-Identifier: Apache-2.0
"""Places that nobody listed: "inside of a casino" is the nearest setting that the vocabulary has, said to be guessed."""

from __future__ import annotations

from collections.abc import Sequence

from .lexicon.nearest import Places
from .lexicon.vocabulary import Vocabulary
from .tokens import Token


def guess_places(tokens: Sequence[Token], vocabulary: Vocabulary) -> None:
    """Marks unknown words that say what is all around with the nearest place.

    Args:
        tokens: Of a clause; changed.
        vocabulary: What is known.
    """
    for place, token in enumerate(tokens):
        if not (token.known or token.near) and _is_around(tokens[:place]):
            token.near = vocabulary.made(Places).guess(token.text)


def _is_around(before: Sequence[Token]) -> bool:
    """Whether what follows these tokens is said to be all around: "in a", "feels like the inside of an old"."""
    for token in reversed(before):
        if "place" in token.lists:
            return True
        if not (token.entry or token.color or token.adjective or "stop" in token.lists):
            return False
    return False
