# SPDX-License-Identifier: Apache-2.0
"""Cuts a prompt of another language into pieces that its lexicon knows, each with its place in the prompt."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Container, Iterator
from dataclasses import dataclass, replace
from difflib import get_close_matches
from functools import lru_cache

from ..lexicon.languages import LanguageLexicon, Meaning
from ..lexicon.spelling import folded
from ..lexicon.things import thing_words
from .spaceless import cut

_LONGEST = 5  # words of a wording
_SHORTEST = 3  # letters of a part of a compound
_MISTYPED, _ALIKE = 7, 0.92  # letters of a word that may be mistyped, and the share of them that is right
_SCENES = 8  # whose names are kept with the words of a language
_WORD = re.compile(r"[^\W_]+['’]?|(?<!\w)[-_]|[-_](?!\w)|[^\w\s-]")
_SPACELESS = re.compile(r"[\u2e80-\u9fff\uf900-\ufaff]")
_MARKS = {"、": ",", "。": ".", "・": " ", "「": '"', "」": '"'}


@dataclass(frozen=True)
class Piece:
    """A part of the prompt.

    Attributes:
        english: What it says; as it stands in the prompt where nobody knows it.
        start: Place of its first letter.
        end: Place after its last letter.
        kind: A table of the lexicon, "name" of a thing in the scene, "phrase" of the vocabulary, "mark" for punctuation, or
            "unknown".
        shade: What it is beside a color or a material; "" for the same.
    """

    english: str
    start: int
    end: int
    kind: str
    shade: str = ""


def pieces(
    text: str, lexicon: LanguageLexicon, names: frozenset[str], phrases: Container[str] = ()
) -> list[Piece]:
    """All of a prompt, in its order.

    Args:
        names: Parts of the names in the scene, folded.
        phrases: What the vocabulary knows as it stands: "film noir", and the artist's own words.
    """
    cuts = list(_cuts(text, lexicon, names))
    cutter = _Cutter(text, lexicon, names, phrases)
    found: list[Piece] = []
    while cuts:
        counts = range(min(_LONGEST, len(cuts)), 0, -1)
        wholes = ((count, whole) for count in counts if (whole := cutter.whole(cuts[:count])))
        count, whole = next(wholes, (1, None))
        found += [whole] if whole else cutter.parts(cuts[0])
        del cuts[:count]
    return found


def _cuts(text: str, lexicon: LanguageLexicon, names: frozenset[str]) -> Iterator[Piece]:
    """Words and marks; where words are not written apart, the longest that the lexicon or the scene knows."""
    tight = frozenset(filter(_SPACELESS.search, names))  # most scenes have none, and share a pattern
    for match in _WORD.finditer(text):
        start, word = match.start(), match.group()
        apart = lexicon.spaces or not _SPACELESS.search(word)
        for part in [word] if apart else cut(word, _known(lexicon, tight), lexicon.compounds):
            yield Piece(part, start, start + len(part), "unknown")
            start += len(part)


@lru_cache(_SCENES)
def _known(lexicon: LanguageLexicon, names: frozenset[str]) -> frozenset[str]:
    """What letters without spaces are cut into."""
    return frozenset({*lexicon.folded.forms, *names} - {""})


@dataclass(frozen=True)
class _Cutter:
    """Finds what words mean; all as in `pieces`."""

    text: str
    lexicon: LanguageLexicon
    names: frozenset[str]
    phrases: Container[str]

    def whole(self, cuts: list[Piece]) -> Piece | None:
        """Some words in a row as one piece; None where they are none."""
        start, end = cuts[0].start, cuts[-1].end
        said = Piece(self.text[start:end], start, end, "unknown")
        if " ".join(cut.english.lower() for cut in cuts) in self.phrases:
            return replace(said, kind="phrase")
        found = self.lexicon.find([cut.english for cut in cuts])
        if found is None:
            return None
        wording, meaning = found
        named = len(cuts) == 1 and not {folded(cuts[0].english), wording[0]}.isdisjoint(self.names)
        if named and meaning.table == "things":
            return replace(said, kind="name")
        here = (other for other in meaning.others if other in self.names)
        return replace(_meant(said, meaning), english=next(here, meaning.english))

    def parts(self, cut: Piece) -> list[Piece]:
        """What a word is that no lexicon has: a mark, a name, a compound; itself where nobody knows it."""
        if not cut.english[0].isalnum():
            mark = _MARKS.get(cut.english) or unicodedata.normalize("NFKC", cut.english)
            return [replace(cut, english=mark, kind="mark")]
        if folded(cut.english) in self.names:
            return [replace(cut, kind="name")]
        both = next(self._compounds(folded(cut.english)), [])
        return [_meant(cut, meaning) for meaning in both if meaning.table != "grammar"] or [cut]

    def _compounds(self, word: str) -> Iterator[list[Meaning]]:
        """What the two parts of a compound mean, the longest first part first."""
        known = self.lexicon.folded
        for place in range(len(word) - _SHORTEST, _SHORTEST - 1, -1) if self.lexicon.links else ():
            last = known.find([word[place:]])
            heads = [word[:place], *(word[:place].removesuffix(link) for link in self.lexicon.links)]
            first = next(((h,) for h in heads if len(h) >= _SHORTEST and (h,) in known.meanings), None)
            if first and last:
                yield [known.meanings[first], known.meanings[last]]


def with_particles(found: list[Piece], text: str, lexicon: LanguageLexicon) -> list[Piece]:
    """Pieces with small words as the looks that they are at the end of a clause: "Lampe aus" is off, "aus Messing" made of brass.

    Args:
        found: In the order of the prompt.
    """
    ends = [after is None or after.kind == "mark" for after in (*found[1:], None)]
    said = [lexicon.particles.get(folded(text[p.start : p.end]), "") for p in found]
    return [
        replace(piece, english=look, kind="looks") if end and look else piece
        for piece, end, look in zip(found, ends, said, strict=True)
    ]


def corrected(piece: Piece, lexicon: LanguageLexicon) -> Piece:
    """A long word that nobody knows as the known one that it is but for a letter; names of things, in any language, stay."""
    word = folded(piece.english)
    if piece.kind != "unknown" or len(word) < _MISTYPED or not lexicon.spaces or word in thing_words().rows:
        return piece
    known = lexicon.folded
    alike = (other for other in known.begins(word[0]) if abs(len(other) - len(word)) < 2)
    wordings = (known.find([near]) for near in get_close_matches(word, alike, 1, _ALIKE))
    meaning = next((known.meanings[wording] for wording in wordings if wording), None)
    return _meant(piece, meaning) if meaning and meaning.english else piece


def _meant(cut: Piece, meaning: Meaning) -> Piece:
    return replace(cut, english=meaning.english, kind=meaning.table, shade=meaning.shade)
