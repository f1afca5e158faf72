# SPDX-License-Identifier: Apache-2.0
"""A prompt as a row of letters, one for each token: patterns say which nouns are listed together, and which are left out."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

from ..lexicon.vocabulary import Vocabulary
from ..tokens import Token
from .nouns import REGIONS, NounMention
from .passage import Passage

# The letters. Nouns: T a thing, K a light, N another name, and a noun that is a look; M a part of the picture, I anything else
# without a name in the scene; n are their other tokens. Others: Q "all", O "the rest", L a look, _ filler, u unknown, . what is
# known, a comma between clauses, and those of _LETTERS.
_LETTERS = {
    "P": {"spared"}, "X": {"exception"}, "G": {"again"}, "A": {"listing"},
    "F": {"of"}, "W": {"save", "refusal"}, "B": {"save"}, "R": {"refusal"},
}  # fmt: skip
"""Letter of a token that is no noun -> lists of the vocabulary's grammar that it is in."""
_LISTABLE, _NOUNS = "TKNM", "TKNMI"
_NOUN = f"[{_NOUNS}]n*"
_LISTED = f"(?:[_ALOQu]*{_NOUN}(?:_*A[_ALOQu]*{_NOUN})*)"
_THINGS = "(?:[_A]*Tn*(?:_*A[_A]*Tn*)*)"
_SPARED = [
    re.compile(pattern)
    for pattern in (
        f"[XP]({_LISTED})",  # "except the floor and the wall"
        f"[OQ][BW]({_LISTED})",  # "everything but the floor"
        f"[OQ][^,]*[BW]({_LISTED})(?=[^L,]*(?:,|$))",  # "everything grey but the floor"
        f"[RW]({_THINGS})",  # "not the cables"
        "(Tn*)_*(?:P|[RW]_*(?:,|$))",  # "the buckle excepted", "the grid not"
    )
]
_ALL = re.compile("Q(?=[_F]*[TK])")  # "all of the fruit"
_JOINED = re.compile(  # "box and cup"; over a comma only names: "bezel, strap and dial"
    f"[{_LISTABLE}]n*(?:(?:(?:_*A)+_*(?:[uI]_*)?|(?<=[TKNn])[_A]*,[_A]*(?=[TKN]))[{_LISTABLE}]n*)+"
)


class NounRow:
    """The nouns of a prompt among its other tokens."""

    def __init__(self, passage: Passage, single: Iterable[NounMention], vocabulary: Vocabulary) -> None:
        self._vocabulary = vocabulary
        self._nouns = {mention.start: mention for mention in single}
        self._inside = {i for m in self._nouns.values() for i in range(m.start + 1, m.end + 1)}
        self._places: list[int] = []
        self._letters = ""
        for place, token in enumerate(passage.items):
            parted = place and token.clause != passage.items[place - 1].clause
            self._letters += "," * bool(parted) + self._letter(place, token)
            self._places += [place] * (1 + bool(parted))

    def determiners(self) -> set[int]:
        """Where "all" only says that all of the noun after it is meant."""
        return {self._places[match.start()] for match in _ALL.finditer(self._letters)}

    def spared(self) -> set[int]:
        """Where nouns begin that the prompt leaves out."""
        spans = [match.span(1) for pattern in _SPARED for match in pattern.finditer(self._letters)]
        return {noun.start for span in spans for noun in self._within(*span, _NOUNS)}

    def joined(self) -> list[list[NounMention]]:
        """The lists of nouns that have nothing said between them."""
        return [list(self._within(*match.span(), _LISTABLE)) for match in _JOINED.finditer(self._letters)]

    def _within(self, start: int, end: int, letters: str) -> Iterator[NounMention]:
        places = (self._places[i] for i in range(start, end) if self._letters[i] in letters)
        return (self._nouns[place] for place in places)

    def _letter(self, place: int, token: Token) -> str:
        if place in self._inside:
            return "n"
        noun = self._nouns.get(place)
        if noun and noun.noun == "others":
            return "Q" if token.filler else "O"
        if noun:
            return self._noun_letter(noun, token)
        kinds = [letter for letter, lists in _LETTERS.items() if lists <= token.lists]
        rest = "_" if token.filler else "L" if token.names_a_look else "." if token.known else "u"
        return kinds[0] if kinds else rest

    def _noun_letter(self, noun: NounMention, token: Token) -> str:
        if not noun.named:
            return "M" if noun.noun in REGIONS and noun.end + 1 not in self._nouns else "I"
        entry = self._vocabulary.entries.get(token.entry)
        if token.names_a_look and not (entry and entry.slot == "setting"):
            return "N"
        return "T" if any(named.kind == "things" for named in noun.named) else "K"
