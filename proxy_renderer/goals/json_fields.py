# SPDX-License-Identifier: Apache-2.0
"""The fields of JSON objects that people write, checked one by one: a mistake is named with its place and the remedy."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from typing import Any, TypeVar

from ..color.floats import is_hex, srgb_from_hex
from ..schema import VibeError
from ..schema.errors import quoted

T = TypeVar("T")
_SHOWN = 60  # characters of what is quoted
_MOST_OF_SHADES = 200.0
_TYPES = {
    str: "a text in quotes",
    float: "a finite number",
    bool: "true or false",
    list: "a list",
    dict: "an object {...}",
}


class JsonFields:
    """The fields of a JSON object, each taken once and checked.

    Args:
        place: Where it stands, for messages: "goals.words[2]".
    """

    def __init__(self, raw: Any, place: str) -> None:
        if not isinstance(raw, dict):
            raise VibeError(f"{place} is no object.", "Write {...} there.")
        self.raw, self.place = raw, place
        self._taken: set[str] = set()

    def take(self, name: str, kind: type, default: Any = None) -> Any:
        """A field of a type; VibeError where it is of another, or missing and has no default."""
        self._taken.add(name)
        value = self.raw.get(name, default)
        if value is None:
            raise VibeError(f"{self.place} has no '{name}'.", f"Add it: {_TYPES[kind]}.")
        if kind is float and _is_number(value):
            return float(value)
        if not isinstance(value, kind):
            raise VibeError(f"{self.place}.{name} is of the wrong type.", f"Write {_TYPES[kind]}.")
        return value

    def named(self, name: str) -> str:
        """A text that is not empty."""
        value: str = self.take(name, str)
        if not value.strip():
            raise VibeError(f"{self.place}.{name} is empty.", "Write a word.")
        return value

    def number(self, name: str, default: float, least: float = -math.inf, most: float = math.inf) -> float:
        """A finite number between two others."""
        value: float = self.take(name, float, default)
        if not least <= value <= most:
            raise VibeError(
                f"{self.place}.{name} is {value:g}.", f"Write a number from {least:g} to {most:g}."
            )
        return value

    def choice(self, name: str, known: tuple[str, ...], default: str | None = None) -> str:
        """One of several texts."""
        value: str = self.take(name, str, default)
        if value not in known:
            raise VibeError(
                f"{self.place}.{name} is {quoted(value, _SHOWN)}.", f"Choose from: {', '.join(known)}."
            )
        return value

    def texts(self, name: str) -> list[str]:
        """A list of texts; empty where it is missing."""
        values: list[Any] = self.take(name, list, [])
        if not all(isinstance(value, str) for value in values):
            raise VibeError(f"{self.place}.{name} holds something else than texts.", 'Write ["...", "..."].')
        return values

    def numbers(self, name: str) -> tuple[int, ...]:
        """A list of whole numbers; empty where it is missing."""
        values: list[Any] = self.take(name, list, [])
        if not all(isinstance(value, int) and not isinstance(value, bool) for value in values):
            raise VibeError(f"{self.place}.{name} holds something else than whole numbers.", "Write [1, 2].")
        return tuple(values)

    def color(self, code: str) -> tuple[float, ...]:
        """A color of "#rrggbb"."""
        if not is_hex(code):
            raise VibeError(f"{self.place}.color is {quoted(code, _SHOWN)}.", 'Write it as "#rrggbb".')
        return srgb_from_hex(code)

    def shades(self) -> tuple[tuple[float, float, float, float], ...]:
        """Changes of a material's own color: lists of four numbers; none where they are missing."""
        rows: list[Any] = self.take("shades", list, [])
        if not all(isinstance(row, list) and len(row) == 4 and all(map(_is_shade, row)) for row in rows):
            problem = f"{self.place}.shades holds something else than lists of four small numbers."
            raise VibeError(problem, "Write lightness, chroma, L* and warmth of each: [[0.6, 1, 20, 0]].")
        return tuple((float(a), float(b), float(c), float(d)) for a, b, c, d in rows)

    def each(self, name: str, read_text: Callable[[str], T]) -> tuple[T, ...]:
        """Texts that are read; what is wrong with one of them is said with its place."""
        try:
            return tuple(map(read_text, self.texts(name)))
        except VibeError as error:
            message = " ".join(error.message.removeprefix("Vocabulary: ").split())
            raise VibeError(f"{self.place}.{name}: {message}", error.remedy) from error

    def end(self) -> None:
        """VibeError where there are fields that nobody has taken: they would be ignored."""
        if unknown := sorted(self.raw.keys() - self._taken):
            known = ", ".join(sorted(self._taken))
            raise VibeError(
                f"{self.place} has an unknown field {quoted(unknown[0], _SHOWN)}.", f"Known are: {known}."
            )


def _is_number(value: Any) -> bool:
    """Whether a value is a finite number; an integer may have hundreds of digits."""
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) <= sys.float_info.max


def _is_shade(value: Any) -> bool:
    """Whether a value may be an argument of `color.shade`: a factor, an L* or a b*."""
    return _is_number(value) and abs(value) <= _MOST_OF_SHADES
