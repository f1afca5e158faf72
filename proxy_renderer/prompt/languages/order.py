# SPDX-License-Identifier: Apache-2.0
"""Puts the pieces of a prompt into the order in which English says them."""

from __future__ import annotations

from dataclasses import replace

from ..lexicon.languages import LanguageLexicon
from ..lexicon.vocabulary import Vocabulary
from .pieces import Piece

_LOOKS = ("looks", "shades", "phrase")
_NOUNS = ("things", "name", "unknown", "looked")
"""Kinds of pieces that look words stand beside; "looked" is a look that is a noun: a night, smoke."""
_PLACE = "~"
"""Where in an English wording the words stand that another language puts before it."""
GENITIVE = "'s"
"""English of what ties a thing to what it belongs to, or a look to its thing."""


def ordered(found: list[Piece], lexicon: LanguageLexicon, vocabulary: Vocabulary) -> list[Piece]:
    """Pieces as English has them.

    Args:
        found: In the order of the prompt.
        lexicon: Of their language.
        vocabulary: Knows colors, materials and comparatives.
    """
    placed = _fronted([_as_noun(piece, vocabulary) for piece in found], vocabulary)
    placed = _of_genitives(placed, vocabulary)
    if lexicon.adjectives == "after":
        placed = _led_by_looks(placed, vocabulary)
    return _once(_shaded(_compared(placed, vocabulary), vocabulary))


def _as_noun(piece: Piece, vocabulary: Vocabulary) -> Piece:
    """Times, and parts of the picture, have looks of their own."""
    noun = piece.english in vocabulary.nouns or piece.english in vocabulary.lists["hour"]
    noun |= piece.english.endswith("light") and " " not in piece.english
    noun &= piece.english not in vocabulary.colors and piece.english not in vocabulary.adjectives
    return replace(piece, kind="looked") if piece.kind == "looks" and noun else piece


def _once(found: list[Piece]) -> list[Piece]:
    """ "Side light" for "side light light"."""
    return [
        piece
        for before, piece in zip([None, *found], found, strict=False)
        if not (before and f" {before.english}".endswith(f" {piece.english}") and piece.kind == "things")
    ]


def _is_intensity(piece: Piece, vocabulary: Vocabulary) -> bool:
    return piece.kind == "grammar" and piece.english in vocabulary.intensity


def _units(found: list[Piece], start: int, vocabulary: Vocabulary) -> list[list[Piece]]:
    """The look words from a place on, each with its intensities; an "and" between two goes with the second."""
    units: list[list[Piece]] = []
    place = start
    while place < len(found):
        end = place
        if units and found[end].english == "and":
            end += 1
        while end < len(found) and _is_intensity(found[end], vocabulary):
            end += 1
        if end == len(found) or found[end].kind not in _LOOKS:
            break
        units.append(found[place : end + 1])
        place = end + 1
    return units


def _led_by_looks(found: list[Piece], vocabulary: Vocabulary) -> list[Piece]:
    """ "Car blue dark" as "dark blue car"."""
    placed: list[Piece] = []
    start = 0
    while start < len(found):
        end = start
        while end < len(found) and found[end].kind in _NOUNS:
            end += 1
        units = _units(found, end, vocabulary)
        if not units:
            placed += found[start : max(end, start + 1)]
            start = max(end, start + 1)
            continue
        taken = sum(map(len, units))
        if found[end + taken :] and found[end + taken].kind in _NOUNS and end == start:
            placed += found[start : start + taken]  # looks before a noun stay there
            start += taken
            continue
        placed += _reversed(units) + found[start:end]
        start = end + taken
    return placed


def _reversed(units: list[list[Piece]]) -> list[Piece]:
    """The last look first, with what joins two of them between them."""
    turned: list[Piece] = []
    for unit in reversed(units):
        joins = [piece for piece in unit[:1] if piece.english == "and"]
        turned += [*unit[len(joins) :], *joins]
    return turned


def _phrase_start(placed: list[Piece]) -> int:
    """Where the noun, or the look, at the end of a list begins, with the looks before it."""
    start = len(placed)
    if start and placed[start - 1].kind in _NOUNS:
        start -= 1
    while start and placed[start - 1].kind in _LOOKS:
        start -= 1
    return min(start, len(placed) - 1) if placed else 0


def _fronted(found: list[Piece], vocabulary: Vocabulary) -> list[Piece]:
    """What stands behind its words in another language and before them in English: "seat than" as "than seat"."""
    placed: list[Piece] = []
    for piece in found:
        stays = piece.kind != "behind" or piece.english == GENITIVE
        if stays or not placed or placed[-1].kind == "mark":
            placed.append(piece)
            continue
        start = _phrase_start(placed)
        before, _, after = piece.english.partition(_PLACE)
        placed.insert(start, replace(piece, english=before.strip(), kind="grammar"))
        if after:
            placed.append(replace(piece, english=after.strip(), kind="grammar"))
    return _after_looks(placed, vocabulary)


def _after_looks(found: list[Piece], vocabulary: Vocabulary) -> list[Piece]:
    """ "Than seat brighter" as "brighter than seat"."""
    for place, piece in enumerate(found[:-2]):
        if piece.english in vocabulary.lists["comparison"] and found[place + 1].kind in _NOUNS:
            looks = [p for unit in _units(found, place + 2, vocabulary) for p in unit]
            rest = found[place + 2 + len(looks) :]
            if looks:
                return [*found[:place], *looks, *found[place : place + 2], *_after_looks(rest, vocabulary)]
    return found


def _of_genitives(found: list[Piece], vocabulary: Vocabulary) -> list[Piece]:
    """ "Window's cold light" as "cold window light"; "blue's car" as "blue car"."""
    placed: list[Piece] = []
    place = 0
    while place < len(found):
        piece = found[place]
        place += 1
        if piece.english != GENITIVE:
            placed.append(piece)
            continue
        if placed and placed[-1].kind in _NOUNS:
            units = _units(found, place, vocabulary)
            looks = [p for unit in units for p in unit]
            follows = found[place + len(looks) :]
            if looks and follows and follows[0].kind in _NOUNS:
                placed[-1:] = [*looks, placed[-1]]
                place += len(looks)
    return placed


def _compared(found: list[Piece], vocabulary: Vocabulary) -> list[Piece]:
    """ "More dark" as "darker", where the vocabulary knows that word."""
    placed: list[Piece] = []
    for piece in found:
        last = placed[-1] if placed else None
        if last and last.english == "more" and piece.kind in _LOOKS:
            forms = (piece.english + "er", piece.english + "r", piece.english[:-1] + "ier")
            form = next((f for f in forms if f in vocabulary.adjectives), "")
            if form:
                start, end = min(last.start, piece.start), max(last.end, piece.end)
                placed[-1] = Piece(form, start, end, piece.kind)
                continue
        placed.append(piece)
    return placed


def _shaded(found: list[Piece], vocabulary: Vocabulary) -> list[Piece]:
    """Words that are a shade beside a color or a material: "bright" wood is light wood."""
    placed = list(found)
    for place, piece in enumerate(found[:-1]):
        if piece.shade and _is_colored(found[place + 1].english, vocabulary):
            placed[place] = replace(piece, english=piece.shade)
    return placed


def _is_colored(english: str, vocabulary: Vocabulary) -> bool:
    return english in vocabulary.colors or vocabulary.slot(english) == "material"
