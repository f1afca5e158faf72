# SPDX-License-Identifier: Apache-2.0
"""Color temperatures that are told as numbers: "3200 K key light", "a 5600 kelvin softbox"."""

from __future__ import annotations

import re
from typing import Any

_LEAST, _MOST, _STEP = 1300, 15500, 100
"""Kelvins that lights can have, and how finely they are told apart; 4K and 8K are sizes of pictures."""
_ASKED = (600, 40000)  # what somebody may ask for: redder and bluer light than lamps have
_REACH = 0.03  # share by which a lamp may differ from what it is said to be
_WARM, _COOL = 4800, 7200
"""Below the one light is warm, above the other it is cool."""
_NUMBER = re.compile(r"\b(\d{1,2}[.,' ]?\d{3}|\d{3,5})[\s-]*(?:k|kelvins?|degrees kelvin)\b", re.IGNORECASE)
_KINDS = ("light", "fill", "rim")


def told(text: str) -> str:
    """A prompt with its temperatures as the entries are called: "3,200K" as "3200 kelvin"."""

    def named(match: re.Match[str]) -> str:
        kelvins = int(re.sub(r"\D", "", match[1]))
        if not _ASKED[0] <= kelvins <= _ASKED[1]:
            return match[0]
        return _name(min(max(round(kelvins / _STEP) * _STEP, _LEAST), _MOST))

    return _NUMBER.sub(named, text)


def temperature(entry: str) -> int | None:
    """The kelvins of an entry that is called by them; None for others."""
    number, _, unit = entry.partition(" ")
    return int(number) if unit == "kelvin" and number.isdigit() else None


def entries() -> dict[str, dict[str, Any]]:
    """Name -> the rows of an entry, as in vocabulary.toml, for each temperature that can be told."""
    return {_name(kelvins): _entry(kelvins) for kelvins in range(_LEAST, _MOST + 1, _STEP)}


def adjectives() -> dict[str, dict[str, str]]:
    """Name -> kind of light -> the entry that it is there."""
    names = map(_name, range(_LEAST, _MOST + 1, _STEP))
    return {name: dict.fromkeys((*_KINDS, "otherwise"), name) for name in names}


def _name(kelvins: int) -> str:
    return f"{kelvins} kelvin"


def _entry(kelvins: int) -> dict[str, Any]:
    tinged = "warm" if kelvins < _WARM else "cool" if kelvins > _COOL else ""
    return {
        "slot": "lighting",
        "wishes": [
            *([f"light_color is {tinged}"] if tinged else []),
            f"lights/temperature {kelvins * (1 - _REACH):.0f}..{kelvins * (1 + _REACH):.0f} !1",
        ],
        "phrase": f"{tinged or 'neutral'} light",
    }
