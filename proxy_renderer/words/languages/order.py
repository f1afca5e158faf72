# SPDX-License-Identifier: Apache-2.0
"""Puts the pieces of a prompt into the order in which English says them: patterns of their kinds, moved."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from itertools import groupby, pairwise

from ..lexicon.languages import LanguageLexicon
from ..lexicon.vocabulary import Vocabulary
from .pieces import Piece

_LOOKS = ("looks", "shades", "phrase")
_NOUNS = ("things", "name", "unknown", "looked")
"""Kinds of pieces that look words stand beside; "looked" is a look that is a noun: a night, smoke."""
_PLACE = "~"
"""Where in an English wording the words stand that another language puts before it."""
_THAN, _MORE = "than", "more"
GENITIVE = "'s"
"""English of what ties a thing to what it belongs to, or a look to its thing."""

# One letter for each piece: look, noun, intensity, and, comparison, genitive, behind its words in that language, mark, other.
_SAID = "I*L(?:A?I*L)*"  # look words in a row
_FRONTED = re.compile("(L+N?|[^M])(B)")  # "seat than"
_COMPARED = re.compile(f"(CN)({_SAID})")  # "than seat brighter"
_OWNED = re.compile(f"(N)G({_SAID})(?=N)")  # "window's cold light"
_LED = re.compile(f"(N*)({_SAID})(?=(N?))")  # "car blue dark"


def ordered(found: list[Piece], lexicon: LanguageLexicon, vocabulary: Vocabulary) -> list[Piece]:
    """Pieces as English has them.

    Args:
        found: In the order of the prompt.
    """

    def moved(found: list[Piece], pattern: re.Pattern[str], order: Callable[..., list[Piece]]) -> list[Piece]:
        """The pieces, in each place that fits a pattern of kinds in another order."""
        placed, last = [], 0
        for match in pattern.finditer(_kinds(found, vocabulary)):
            groups = (found[slice(*match.span(group))] for group in range(1, pattern.groups + 1))
            placed += [*found[last : match.start()], *order(*groups)]
            last = match.end()
        return [*placed, *found[last:]]

    known = [_as_noun(piece, vocabulary) for piece in _than(found, lexicon, vocabulary)]
    placed = _fronted(known, vocabulary)
    placed = moved(placed, _COMPARED, lambda than, looks: looks + than)
    placed = moved(placed, _OWNED, lambda noun, looks: looks + noun)
    placed = [piece for piece in placed if piece.english != GENITIVE]  # "blue's car" is a blue car
    if lexicon.adjectives == "after":
        placed = moved(placed, _LED, _led_by_looks)
    return _once(_shaded(_compared(placed, vocabulary), vocabulary))


def _kinds(found: list[Piece], vocabulary: Vocabulary) -> str:
    """A letter for each piece."""
    return "".join(_kind(piece, vocabulary) for piece in found)


def _kind(piece: Piece, vocabulary: Vocabulary) -> str:
    rules = (
        ("L", piece.kind in _LOOKS),
        ("N", piece.kind in _NOUNS),
        ("M", piece.kind == "mark"),
        ("G", piece.english == GENITIVE),
        ("B", piece.kind == "behind"),
        ("A", piece.english == "and"),
        ("C", piece.english in vocabulary.lists["comparison"]),
        ("I", piece.english in vocabulary.intensity),
    )
    return next((letter for letter, holds in rules if holds), "O")


def _than(found: list[Piece], lexicon: LanguageLexicon, vocabulary: Vocabulary) -> list[Piece]:
    """Clauses with a "than" that compare nothing: the "que" of "que la luz sea suave" is left out, but after 比 and より things are "more"."""
    clauses = (list(group) for _, group in groupby(found, key=lambda piece: piece.kind == "mark"))
    placed: list[Piece] = []
    for clause in clauses:
        if any(_is_compared(piece.english, vocabulary) for piece in clause):
            placed += clause
        elif lexicon.compares:
            placed += _with_more(clause)
        else:
            placed += [p for p in clause if (p.english, p.kind) != (_THAN, "grammar")]
    return placed


def _with_more(clause: list[Piece]) -> list[Piece]:
    """A clause with "more" before what is compared, or in the place of a より with nothing before it."""
    placed: list[Piece] = []
    compares = False
    for before, piece in zip([None, *clause], clause, strict=False):
        if piece.english == _THAN:
            compares = piece.kind != "behind" or (before is not None and before.kind in _NOUNS)
            piece = piece if compares else replace(piece, english=_MORE, kind="grammar")
        elif compares and piece.kind in _LOOKS:
            placed.append(Piece(_MORE, piece.start, piece.start, "grammar"))
            compares = False
        placed.append(piece)
    return placed


def _is_compared(english: str, vocabulary: Vocabulary) -> bool:
    """Whether words say more or less of something: "more", "less glossy", "darker"."""
    stems = vocabulary.stems(english, "comparative")
    looks = any(stem in vocabulary.adjectives or stem in vocabulary.synonyms for stem in stems)
    return looks or english.split()[:1] in ([_MORE], ["less"])


def _as_noun(piece: Piece, vocabulary: Vocabulary) -> Piece:
    """Times, places, and parts of the picture, have looks of their own."""
    noun = piece.english in vocabulary.nouns or piece.english in vocabulary.lists["hour"]
    noun |= vocabulary.slot(piece.english) == "setting"
    noun |= piece.english.endswith("light") and " " not in piece.english
    noun &= piece.english not in vocabulary.colors and piece.english not in vocabulary.adjectives
    return replace(piece, kind="looked") if piece.kind == "looks" and noun else piece


def _fronted(found: list[Piece], vocabulary: Vocabulary) -> list[Piece]:
    """What stands behind its words in another language and before them in English: "seat than" as "than seat"."""
    while match := _FRONTED.search(_kinds(found, vocabulary)):
        start, end = match.start(), match.start(2)
        said = found[end].english.split(_PLACE)
        first, *last = (replace(found[end], english=part.strip(), kind="grammar") for part in said)
        found = [*found[:start], first, *found[start:end], *last, *found[end + 1 :]]
    return found


def _led_by_looks(nouns: list[Piece], looks: list[Piece], ahead: list[Piece]) -> list[Piece]:
    """ "Car blue dark" as "dark blue car": the last look first, with what joins two between them."""
    if ahead and not nouns:  # looks before a noun stay there
        return looks
    turned: list[Piece] = []
    unit: list[Piece] = []
    for piece in looks:
        unit.append(piece)
        if piece.kind in _LOOKS:  # a unit ends in its look
            turned = [*sorted(unit, key=lambda p: p.english == "and"), *turned]
            unit = []
    return turned + nouns


def _compared(found: list[Piece], vocabulary: Vocabulary) -> list[Piece]:
    """ "More dark" as "darker", where the vocabulary knows that word."""
    placed: list[Piece] = []
    for more, piece in zip([None, *found], found, strict=False):
        form = _comparative(piece, vocabulary) if more and more.english == _MORE else ""
        if more and form:
            placed.pop()
            start, end = min(more.start, piece.start), max(more.end, piece.end)
            piece = replace(piece, english=form, start=start, end=end, shade="")
        placed.append(piece)
    return placed


def _comparative(piece: Piece, vocabulary: Vocabulary) -> str:
    """The word for more of a look; "" where the vocabulary has none."""
    word = piece.english if piece.kind in _LOOKS else ""
    forms = (f"{word}er", f"{word}r", f"{word[:-1]}ier")
    return next((form for form in forms if form in vocabulary.adjectives), "")


def _shaded(found: list[Piece], vocabulary: Vocabulary) -> list[Piece]:
    """Words that are a shade beside a color or a material: "bright" wood is light wood."""
    placed = list(found)
    for place, (piece, after) in enumerate(pairwise(found)):
        colored = after.english in vocabulary.colors or vocabulary.slot(after.english) == "material"
        if piece.shade and colored:
            placed[place] = replace(piece, english=piece.shade)
    return placed


def _once(found: list[Piece]) -> list[Piece]:
    """ "Side light" for "side light light"."""
    placed = found[:1]
    for before, piece in pairwise(found):
        said_twice = piece.kind == "things" and f" {before.english}".endswith(f" {piece.english}")
        placed += [] if said_twice else [piece]
    return placed
