# SPDX-License-Identifier: Apache-2.0
"""Tables of a TOML file whose values are checked as they are read: a mistake names file, place and remedy."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from typing import Any

from proxy_renderer.batch.manifest import TomlSource
from proxy_renderer.schema import VibeError


@dataclass(frozen=True)
class CheckedTable:
    """A table of a file.

    Attributes:
        source: The file.
        keys: The way to the table in the file.
        content: What it says.
    """

    source: TomlSource
    keys: tuple[str, ...]
    content: dict[str, Any]

    @staticmethod
    def listed(source: TomlSource, name: str, known: Collection[str]) -> Iterator[CheckedTable]:
        """The [[name]] tables of a file, in which there is nothing else."""
        for key in source.content:
            if key != name:
                raise source.problem(f"'{key}' is not known here.", f"Write [[{name}]] tables only.", key)
        rows = source.content.get(name, [])
        if not isinstance(rows, list) or not all(isinstance(row, dict) for row in rows):
            raise source.problem(f"'{name}' is no list of tables.", f"Write [[{name}]].", name)
        for number, row in enumerate(rows, 1):
            table = CheckedTable(source, (name, str(number)), row)
            table.check_keys(known)
            yield table

    def problem(self, what: str, remedy: str, *place: str) -> VibeError:
        """An error at a place in this table; the caller raises it."""
        return self.source.problem(what, remedy, *self.keys, *place)

    def check_keys(self, known: Collection[str]) -> None:
        """Raises VibeError where a key is not known."""
        for key in self.content:
            if key not in known:
                raise self.problem(f"'{key}' is not known here.", f"Use: {', '.join(known)}.")

    def text(self, key: str) -> str:
        """A text that is not empty."""
        value = self.content.get(key)
        if not isinstance(value, str) or not value.strip():
            raise self.problem(f"'{key}' is no text, or missing.", f'Write {key} = "...".')
        return value

    def one_of(self, key: str, choices: Collection[str]) -> str:
        """One of several texts."""
        value = self.text(key)
        if value not in choices:
            raise self.problem(f"'{value}' is no {key}.", f"Use one of: {', '.join(choices)}.", value)
        return value

    def flag(self, key: str) -> bool:
        """True or false; false where it is missing."""
        value = self.content.get(key, False)
        if not isinstance(value, bool):
            raise self.problem(f"'{key}' is neither true nor false.", f"Write {key} = true.")
        return value

    def number(self, key: str, least: float, most: float) -> float:
        """A number between two others."""
        return self.numbers(key, (self.content.get(key),), ((least, most),))[0]

    def numbers(self, key: str, values: Any, ranges: Collection[tuple[float, float]]) -> tuple[float, ...]:
        """Values that have to be numbers, each in its range."""
        shown = ", ".join(f"{low:g} to {high:g}" for low, high in ranges)
        given = values if isinstance(values, list | tuple) and len(values) == len(ranges) else ()
        for value, (low, high) in zip(given, ranges, strict=False):
            if isinstance(value, bool) or not isinstance(value, int | float) or not low <= value <= high:
                given = ()
        if not given:
            raise self.problem(f"'{key}' is {values}.", f"Write numbers: {shown}.", key)
        return tuple(float(value) for value in given)

    def names(self, key: str, known: Collection[str] = ()) -> tuple[str, ...]:
        """A list of names; empty where it is missing.

        Args:
            known: Names that exist; empty where any will do.
        """
        return self.checked_names(key, self.content.get(key, []), known)

    def checked_names(self, key: str, values: Any, known: Collection[str] = ()) -> tuple[str, ...]:
        """Values that have to be a list of names, see `names`."""
        if not isinstance(values, list) or not all(isinstance(value, str) and value for value in values):
            raise self.problem(f"'{key}' is no list of names.", 'Write ["...", "..."].', key)
        for value in values:
            if known and value not in known:
                raise self.problem(
                    f"'{key}' names '{value}', which the scene lacks.", f"It has: {', '.join(known)}.", value
                )
        return tuple(values)

    def table(self, key: str, known: Collection[str] = ()) -> dict[str, Any]:
        """A table of names; empty where it is missing.

        Args:
            known: Names that exist; empty where any will do.
        """
        value = self.content.get(key, {})
        if not isinstance(value, dict):
            raise self.problem(f"'{key}' is no table.", f"Write [{self.keys[0]}.{key}].", key)
        self.checked_names(key, list(value), known)
        return value
