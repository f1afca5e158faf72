# SPDX-License-Identifier: Apache-2.0
"""Times of day that are told, not named: "three in the morning", "as the sun goes down", "after dusk" (hours.toml)."""

from __future__ import annotations

import re
import tomllib
from functools import cache
from pathlib import Path
from typing import Any

from .spelling import any_of
from .vocabulary import Vocabulary

_HALF, _DAY = 12, 24
_BESIDE = re.compile(r"\b(before|after) (?:the )?(\w+(?: \w+)?)", re.IGNORECASE)


def told(text: str, vocabulary: Vocabulary) -> str:
    """A prompt with times of day as the vocabulary calls them.

    Args:
        vocabulary: Has the names of times of day.
    """
    clock, sun, exactly = _patterns()
    text = exactly.sub("from ", clock.sub(_by_clock, sun.sub(_by_sun, text)))
    return _BESIDE.sub(lambda m: _beside(m, vocabulary), text)


def _by_clock(match: re.Match[str]) -> str:
    """ "3 am" as "night", "half past six in the evening" as "golden hour"."""
    rows, numbers = _rows()["clock"], _rows()["clock"]["numbers"]
    word, half = match["hour"].lower(), (match["half"] or "").lower()
    hour = numbers.index(word) + 1 if word in numbers else int(word)
    if hour > _DAY or not (half or match["exact"] or (match["at"] and match["minutes"])):
        return match[0]
    if half:
        at_night = half in rows["night"] and hour % _HALF >= _HALF / 2
        hour = hour % _HALF + _HALF * (half in rows["second"] or at_night)
    since = {int(start): name for start, (name,) in _rows()["from_hour"].items()}
    return f"{match['at'] or ''}{since[max(start for start in since if start <= hour % _DAY)]}"


def _by_sun(match: re.Match[str]) -> str:
    does = " ".join(match["does"].lower().split())
    return next(entry for entry, phrases in _rows()["sun"].items() if does in phrases)


def _beside(match: re.Match[str], vocabulary: Vocabulary) -> str:
    """ "After dusk" as "night"; what the vocabulary has as it is, "after dark", stays so."""
    day, side, both = _rows()["day"], match[1].lower(), match[2].lower()
    for said in (both, both.partition(" ")[0]):
        entry = vocabulary.synonyms.get(said, "")
        if f"{side} {said}" in vocabulary.synonyms:
            return match[0]
        if entry in day and entry not in _rows()["long"]:
            step = 1 if side == "after" else -1
            return str(day[(day.index(entry) + step) % len(day)]) + match[2][len(said) :]
    return match[0]


@cache
def _patterns() -> list[re.Pattern[str]]:
    """What tells a time by the clock, a time by the sun, and words that change nothing of where light comes from."""
    rows, sun = _rows()["clock"], _rows()["sun"]
    halves = any_of([*rows["first"], *rows["second"], *rows["night"]])
    does = any_of([phrase for name, phrases in sun.items() if name != "between" for phrase in phrases])
    clock = (
        rf"\b(?P<at>at )?(?:{any_of(rows['minutes'])} )?(?P<hour>{any_of(rows['numbers'])}|\d{{1,2}})"
        rf"(?P<minutes>(?<=\d):\d\d(?! ?:))?(?: ?(?P<exact>{any_of(rows['exact'])}))?(?: ?(?P<half>{halves}))?(?!\w)"
    )
    by_sun = rf"\b(?:the )?sun(?:'s)? (?:(?:{any_of(sun['between'])}) )*?(?P<does>{does})\b"
    exactly = rf"\bfrom (?:{any_of(_rows()['where']['exactly'])}) "
    return [re.compile(pattern, re.IGNORECASE) for pattern in (clock, by_sun, exactly)]


@cache
def _rows() -> dict[str, Any]:
    """hours.toml, each of its texts as a list of words."""

    def listed(row: Any) -> Any:
        if isinstance(row, dict):
            return {name: listed(part) for name, part in row.items()}
        return [word.strip() for word in row.split(",")]

    rows: dict[str, Any] = listed(tomllib.loads(Path(__file__).with_name("hours.toml").read_text("utf-8")))
    return rows
