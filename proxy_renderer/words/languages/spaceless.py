# SPDX-License-Identifier: Apache-2.0
"""Cuts letters that are written without spaces into words: as much as possible is known, and no word begins inside of another."""

from __future__ import annotations

import re
from collections.abc import Container
from dataclasses import dataclass

_LONGEST = 14  # letters of a word
_WORD, _LETTER, _UNKNOWN = 1.0, 1.2, 2.0
"""Cost of a known word, of one of a single letter, and of each unknown letter."""
_LATIN, _HIRAGANA, _KATAKANA, _OTHERS = range(4)
_LETTERS = {_LATIN: r"[a-zA-Z0-9]", _HIRAGANA: r"[\u3040-\u309f]", _KATAKANA: r"[\u30a0-\u30ff]"}
_SEAMS = {_LATIN: (9.0, 9.0), _HIRAGANA: (3.0, 1.5), _KATAKANA: (4.0, 4.0), _OTHERS: (0.9, 0.0)}
"""Script -> cost of a known word of one letter, or of several, right beside an unknown letter of that script."""


@dataclass(frozen=True)
class _Cut:
    """The cheapest way to cut the letters up to a place: its cost, and its words; whether the last one is known."""

    cost: float
    words: tuple[str, ...] = ()
    known: bool = True


def cut(letters: str, known: Container[str], compounds: bool) -> tuple[str, ...]:
    """The words of letters without spaces, those that are not known among them: the path of the least cost.

    Args:
        compounds: Whether words of several letters are made of such of one, so that one of them says little: 液体.
    """
    best: list[list[_Cut]] = [[_Cut(0.0)], *([] for _ in letters)]
    for start in range(len(letters)):
        ends = range(start + 1, min(start + _LONGEST, len(letters)) + 1)
        for before in best[start]:
            best[start + 1].append(_with_unknown(before, letters[start], compounds))
            words = (letters[start:end] for end in ends)
            for word in (word for word in words if word in known):
                best[start + len(word)].append(_with_known(before, word, compounds))
        best[start + 1] = _cheapest(best[start + 1])
    return min(best[-1], key=_rank).words


def _cheapest(cuts: list[_Cut]) -> list[_Cut]:
    """The cheapest that ends in a known word, and the cheapest that does not."""
    groups = ([c for c in cuts if c.known is known] for known in (True, False))
    return [min(group, key=_rank) for group in groups if group]


def _rank(cut: _Cut) -> tuple[float, list[int]]:
    """The cost; of two that cost the same, the one whose first words are longer counts."""
    return cut.cost, [-len(word) for word in cut.words]


def _with_known(before: _Cut, word: str, compounds: bool) -> _Cut:
    cost = _WORD if len(word) > 1 else _LETTER
    seam = 0.0 if before.known else _seam(word, word[0], before.words[-1][-1], compounds)
    return _Cut(before.cost + cost + seam, (*before.words, word))


def _with_unknown(before: _Cut, letter: str, compounds: bool) -> _Cut:
    *first, last = before.words or ("",)
    if not before.known and (_script(last[-1]) == _LATIN) == (_script(letter) == _LATIN):
        return _Cut(before.cost + _UNKNOWN, (*first, last + letter), known=False)
    inside = before.known and last and not _is_particle(before.words)
    seam = _seam(last, last[-1], letter, compounds) if inside else 0.0
    return _Cut(before.cost + _UNKNOWN + seam, (*before.words, letter), known=False)


def _seam(word: str, own: str, other: str, compounds: bool) -> float:
    """The cost of a known word whose letter stands beside an unknown one."""
    script = _script(own)
    if script != _script(other) or (script == _OTHERS and not compounds):
        return 0.0
    return _SEAMS[script][len(word) > 1]


def _is_particle(words: tuple[str, ...]) -> bool:
    """Whether the last word is a letter of Hiragana after another script: 影は."""
    scripts = [_script(word[-1]) for word in words[-2:]]
    return len(words[-1]) == 1 and len(scripts) == 2 and scripts[1] == _HIRAGANA != scripts[0]


def _script(letter: str) -> int:
    return next((script for script, its in _LETTERS.items() if re.match(its, letter)), _OTHERS)
