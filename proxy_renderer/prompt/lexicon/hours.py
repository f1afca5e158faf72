# SPDX-License-Identifier: Apache-2.0
"""Times of day that are told, not named: "three in the morning", "as the sun goes down", "after dusk" (hours.toml)."""

from __future__ import annotations

import re
import tomllib
from functools import cache
from pathlib import Path
from typing import Any

from .vocabulary import Vocabulary

_HALF, _DAY = 12, 24


def told(text: str, vocabulary: Vocabulary) -> str:
    """A prompt with times of day as the vocabulary calls them.

    Args:
        text: The prompt.
        vocabulary: Has the names of times of day.
    """
    text = _clock().sub(_by_clock, _sun().sub(_by_sun, text))
    text = _exactly().sub("from ", text)
    return re.sub(
        r"\b(before|after) (?:the )?(\w+(?: \w+)?)", lambda m: _beside(m, vocabulary), text, flags=re.I
    )


def _by_clock(match: re.Match[str]) -> str:
    """ "3 am" as "night", "half past six in the evening" as "golden hour"."""
    rows = _rows()["clock"]
    word, half = match["hour"].lower(), (match["half"] or "").lower()
    numbers = _words(rows["numbers"])
    hour = numbers.index(word) + 1 if word in numbers else int(word)
    if hour > _DAY or not (half or match["exact"] or (match["at"] and match["minutes"])):
        return match[0]
    if half:
        at_night = half in _words(rows["night"]) and hour % _HALF >= _HALF / 2
        hour = hour % _HALF + _HALF * (half in _words(rows["second"]) or at_night)
    return f"{match['at'] or ''}{_at(hour % _DAY)}"


def _by_sun(match: re.Match[str]) -> str:
    does = " ".join(match["does"].lower().split())
    return next(entry for entry, phrases in _doings().items() if does in phrases)


def _beside(match: re.Match[str], vocabulary: Vocabulary) -> str:
    """ "After dusk" as "night"; what the vocabulary has as it is, "after dark", stays so."""
    rows = _rows()
    day = _words(rows["day"])
    both = match[2].lower()
    for said in (both, both.partition(" ")[0]):
        entry = vocabulary.synonyms.get(said, "")
        if f"{match[1].lower()} {said}" in vocabulary.synonyms:
            return match[0]
        if entry in day and entry not in _words(rows["long"]):
            step = 1 if match[1].lower() == "after" else -1
            return day[(day.index(entry) + step) % len(day)] + match[2][len(said) :]
    return match[0]


def _at(hour: int) -> str:
    """The time of day of an hour in [0, 24)."""
    since = {int(start): name for start, name in _rows()["from_hour"].items()}
    return str(since[max(start for start in since if start <= hour)])


@cache
def _clock() -> re.Pattern[str]:
    rows = _rows()["clock"]
    halves = _any([*_words(rows["first"]), *_words(rows["second"]), *_words(rows["night"])])
    return re.compile(
        rf"\b(?P<at>at )?(?:{_any(_words(rows['minutes']))} )?(?P<hour>{_any(_words(rows['numbers']))}|\d{{1,2}})"
        rf"(?P<minutes>(?<=\d):\d\d(?! ?:))?(?: ?(?P<exact>{_any(_words(rows['exact']))}))?"
        rf"(?: ?(?P<half>{halves}))?(?!\w)",
        re.IGNORECASE,
    )


@cache
def _sun() -> re.Pattern[str]:
    between = _any(_words(_rows()["sun"]["between"]))
    does = _any([phrase for phrases in _doings().values() for phrase in phrases])
    return re.compile(rf"\b(?:the )?sun(?:'s)? (?:(?:{between}) )*?(?P<does>{does})\b", re.IGNORECASE)


@cache
def _exactly() -> re.Pattern[str]:
    return re.compile(rf"\bfrom (?:{_any(_words(_rows()['where']['exactly']))}) ", re.IGNORECASE)


@cache
def _doings() -> dict[str, list[str]]:
    """Time of day -> what the sun does then."""
    return {name: _words(said) for name, said in _rows()["sun"].items() if name != "between"}


@cache
def _rows() -> dict[str, Any]:
    return tomllib.loads(Path(__file__).with_name("hours.toml").read_text("utf-8"))


def _words(text: str) -> list[str]:
    return [word.strip() for word in text.split(",")]


def _any(phrases: list[str]) -> str:
    """A pattern of any of the phrases, the longest that fits."""
    return "(?:" + "|".join(map(re.escape, sorted(phrases, key=len, reverse=True))) + ")"
