# SPDX-License-Identifier: Apache-2.0
"""Cuts letters that are written without spaces into words: as much as possible is known, and no word begins inside of another."""

from __future__ import annotations

import re
from collections.abc import Container
from dataclasses import dataclass

_LONGEST = 14  # letters of a word
_WORD, _LETTER, _UNKNOWN = 1.0, 1.2, 2.0
"""Cost of a known word, of one of a single letter, and of each unknown letter."""
_SCRIPTS = (
    (re.compile(r"[a-zA-Z0-9]"), 9.0),
    (re.compile(r"[\u3040-\u309f]"), 3.0),
    (re.compile(r"[\u30a0-\u30ff]"), 3.0),
    (re.compile(r"."), 0.0),
)
"""Letters of a script: Latin, Hiragana, Katakana, others; and the cost of what is known right beside an unknown letter of the same script."""
_SINGLE = 0.9  # the same for a single letter of the others: the first of two that are one word


@dataclass(frozen=True)
class _Cut:
    """The cheapest way to cut the letters up to a place: its cost, and its words; whether the last one is known."""

    cost: float
    words: tuple[str, ...] = ()
    known: bool = True


def cut(letters: str, known: Container[str], compounds: bool) -> tuple[str, ...]:
    """The words of letters without spaces, those that are not known among them: the path of the least cost.

    Args:
        letters: What stands together.
        known: Words.
        compounds: Whether words of several letters are made of such of one, so that one of them says little: 液体.
    """
    single = _SINGLE if compounds else 0.0
    best: list[list[_Cut]] = [[_Cut(0.0)], *([] for _ in letters)]
    for start in range(len(letters)):
        for before in best[start]:
            best[start + 1].append(_with_unknown(before, letters[start], single))
            for end in range(start + 1, min(start + _LONGEST, len(letters)) + 1):
                if letters[start:end] in known:
                    best[end].append(_with_known(before, letters[start:end], single))
        for end in range(start + 1, min(start + _LONGEST, len(letters)) + 1):
            best[end] = _cheapest(best[end])
    return min(best[-1], key=_rank).words


def _cheapest(cuts: list[_Cut]) -> list[_Cut]:
    """The cheapest that ends in a known word, and the cheapest that does not."""
    groups = ([c for c in cuts if c.known is known] for known in (True, False))
    return [min(group, key=_rank) for group in groups if group]


def _rank(cut: _Cut) -> tuple[float, list[int]]:
    """The cost; of two that cost the same, the one whose first words are longer counts."""
    return cut.cost, [-len(word) for word in cut.words]


def _with_known(before: _Cut, word: str, single: float) -> _Cut:
    cost = _WORD if len(word) > 1 else _LETTER
    if not before.known:
        cost += _seam(before.words[-1][-1], word[0], single * (len(word) == 1))
    return _Cut(before.cost + cost, (*before.words, word))


def _with_unknown(before: _Cut, letter: str, single: float) -> _Cut:
    if not before.known and _is_latin(before.words[-1][-1]) == _is_latin(letter):
        return _Cut(before.cost + _UNKNOWN, (*before.words[:-1], before.words[-1] + letter), known=False)
    last = before.words[-1] if before.words else ""
    seam = 0.0 if _is_particle(before.words) else _seam(last[-1], letter, single * (len(last) == 1))
    return _Cut(before.cost + _UNKNOWN + seam, (*before.words, letter), known=False)


def _is_particle(words: tuple[str, ...]) -> bool:
    """Whether what ends in a single letter after another script ends in a particle: 影は; or nothing stands there at all."""
    scripts = [_script(word[-1]) for word in words[-2:]]
    return not words or (len(scripts) == 2 and len(words[-1]) == 1 and scripts[0] != scripts[1])


def _is_latin(letter: str) -> bool:
    return _script(letter) == 0


def _script(letter: str) -> int:
    return next(n for n, (script, _) in enumerate(_SCRIPTS) if script.match(letter))


def _seam(last: str, first: str, single: float) -> float:
    """The cost of a known word beside an unknown one."""
    script = _script(last)
    if script != _script(first):
        return 0.0
    return _SCRIPTS[script][1] or single
