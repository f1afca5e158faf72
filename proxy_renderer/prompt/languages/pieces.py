# SPDX-License-Identifier: Apache-2.0
"""Cuts a prompt of another language into pieces that its lexicon knows, each with its place in the prompt."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Container, Iterator
from dataclasses import dataclass
from itertools import product

from ..lexicon.languages import LanguageLexicon, Meaning, Wording
from ..lexicon.spelling import folded

_LONGEST = 5  # words of a wording
_SHORTEST = 3  # letters of a part of a compound
_LETTERS = 12  # of a word that is not written apart, at most
_WORD = re.compile(r"[^\W_]+['’]?|(?<!\w)[-_]|[-_](?!\w)|[^\w\s-]")
_SPACELESS = re.compile(r"[\u2e80-\u9fff\uf900-\ufaff]")
_LATIN = re.compile(r"[a-zA-Z0-9]+")
_KATAKANA = re.compile(r"[\u30a0-\u30ff]+")
_MARKS = {"、": ",", "。": ".", "・": " ", "「": '"', "」": '"'}

_Form = tuple[Wording, Meaning]


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


@dataclass(frozen=True)
class Cut:
    """A word as it stands in the prompt."""

    text: str
    start: int
    end: int


def pieces(
    text: str, lexicon: LanguageLexicon, names: Container[str], phrases: Container[str] = ()
) -> list[Piece]:
    """All of a prompt, in its order.

    Args:
        text: The prompt.
        lexicon: Of its language.
        names: Parts of the names in the scene, folded.
        phrases: What the vocabulary knows as it stands: "film noir", and the artist's own words.
    """
    cuts = list(_cuts(text, lexicon, names))
    found: list[Piece] = []
    while cuts:
        count = _phrase_length(cuts, phrases)
        new = [Piece(text[cuts[0].start : cuts[count - 1].end], cuts[0].start, cuts[count - 1].end, "phrase")]
        if not count:
            count, new = _first(cuts, lexicon, names)
        found += new
        del cuts[:count]
    return found


def _cuts(text: str, lexicon: LanguageLexicon, names: Container[str]) -> Iterator[Cut]:
    """Words and marks; where words are not written apart, the longest that the lexicon or the scene knows."""
    for match in _WORD.finditer(text):
        start, word = match.start(), match.group()
        if lexicon.spaces or not _SPACELESS.search(word):
            yield Cut(word, start, match.end())
        else:
            yield from _segments(word, start, lexicon, names)


def _segments(run: str, offset: int, lexicon: LanguageLexicon, names: Container[str]) -> Iterator[Cut]:
    """A run of letters without spaces, cut by longest match; what nobody knows stays together."""
    unknown = place = 0
    while place < len(run):
        length = _known_length(run, place, lexicon, names)
        if not length:
            place += 1
            continue
        if unknown < place:
            yield Cut(run[unknown:place], offset + unknown, offset + place)
        yield Cut(run[place : place + length], offset + place, offset + place + length)
        place += length
        unknown = place
    if unknown < len(run):
        yield Cut(run[unknown:], offset + unknown, offset + len(run))


def _known_length(run: str, place: int, lexicon: LanguageLexicon, names: Container[str]) -> int:
    """How many letters from a place on are a known word; 0 for none. Katakana and Latin are not cut inside of words."""
    if latin := _LATIN.match(run, place):
        return latin.end() - place
    for length in range(min(_LETTERS, len(run) - place), 0, -1):
        word = folded(run[place : place + length])
        if word in lexicon.bases or word in names:
            return length
    katakana = _KATAKANA.match(run, place)
    return katakana.end() - place if katakana else 0


def _phrase_length(cuts: list[Cut], phrases: Container[str]) -> int:
    """How many words make up a phrase that stays; 0 for none."""
    counts = range(min(_LONGEST, len(cuts)), 0, -1)
    return next((n for n in counts if " ".join(c.text.lower() for c in cuts[:n]) in phrases), 0)


def _first(cuts: list[Cut], lexicon: LanguageLexicon, names: Container[str]) -> tuple[int, list[Piece]]:
    """The piece that begins with the first word, and how many words it takes; several pieces of a compound."""
    for count in range(min(_LONGEST, len(cuts)), 0, -1):
        form = _form([folded(cut.text).replace("’", "'") for cut in cuts[:count]], lexicon)
        if form:
            piece = _piece(cuts[0].start, cuts[count - 1].end, form, lexicon)
            named = count == 1 and piece.kind == "things" and _is_named(cuts[0], form[0], names)
            return count, [Piece(cuts[0].text, piece.start, piece.end, "name") if named else piece]
    cut = cuts[0]
    if not cut.text[0].isalnum():
        mark = _MARKS.get(cut.text) or unicodedata.normalize("NFKC", cut.text)
        return 1, [Piece(mark, cut.start, cut.end, "mark")]
    if folded(cut.text) in names:
        return 1, [Piece(cut.text, cut.start, cut.end, "name")]
    return 1, _compound(cut, lexicon) or [Piece(cut.text, cut.start, cut.end, "unknown")]


def _is_named(cut: Cut, wording: Wording, names: Container[str]) -> bool:
    return folded(cut.text) in names or wording[0] in names


def _form(words: list[str], lexicon: LanguageLexicon) -> _Form | None:
    """The wording that words are inflected from, and what it says; None where they are none."""
    each = product(*(lexicon.bases.get(word, ()) for word in words))
    return next(((wording, said) for wording in each if (said := lexicon.meaning(wording))), None)


def _piece(start: int, end: int, form: _Form, lexicon: LanguageLexicon) -> Piece:
    wording, meaning = form
    return Piece(meaning.english, start, end, meaning.table, lexicon.shades.get(wording, ""))


def _compound(cut: Cut, lexicon: LanguageLexicon) -> list[Piece]:
    """The parts of a compound, the longest first part that there is; none where it is no compound of known words."""
    word = folded(cut.text)
    places = range(len(word) - _SHORTEST, _SHORTEST - 1, -1) if lexicon.links else ()
    for place in places:
        heads = [word[:place], *(word[:place].removesuffix(link) for link in lexicon.links)]
        firsts = ((h,) for h in heads if len(h) >= _SHORTEST)
        first = next(((head, said) for head in firsts if (said := lexicon.meaning(head))), None)
        last = _form([word[place:]], lexicon)
        if first and last:
            parts = (_piece(cut.start, cut.end, form, lexicon) for form in (first, last))
            return [part for part in parts if part.kind != "grammar"]
    return []
