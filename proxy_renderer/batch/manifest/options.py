# SPDX-License-Identifier: Apache-2.0
"""The options in a manifest: those of `vibe run`, each of the right type, and good."""

from __future__ import annotations

import argparse
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from ...inputs import check
from ...schema import VibeError, frame_numbers
from ...schema.options import checks, command_line
from ...schema.options.option import Option
from ...schema.options.table import TABLE
from .toml_source import TomlSource

IN_FILES = ("like", "goals")
"""Options that name files in the place of a prompt, or next to one."""
_ELSEWHERE = {"seed": "Write seeds = [0, 1] at the top."}


class OptionReader:
    """Reads the tables of options."""

    def __init__(self, source: TomlSource, base: Path, options: Iterable[Option] = TABLE) -> None:
        self._problem, self._base = source.problem, base
        self._rows = {row.name: row for row in options}
        self._defaults = {row.name: row.command_default for row in self._rows.values() if row.name != "stage"}

    def read(self, table: dict[str, Any], keys: tuple[str, ...], where: str = "") -> dict[str, Any]:
        """The options in a table of the manifest, each of its type, and good.

        Args:
            where: "scene" or "shots" if more may stand there than the options of every vibe.

        Raises:
            VibeError: One is not; names the line.
        """
        rows = {n: row for n, row in self._rows.items() if {"options", where} & set(row.manifest)}
        options: dict[str, Any] = {}
        for key, value in table.items():
            name = key.replace("-", "_")
            if name not in rows:
                remedy = _ELSEWHERE.get(name, f"Use {', '.join(sorted(rows))}.")
                raise self._problem(f"Unknown option {key!r}.", remedy, *keys, key)
            options[name] = self._value(rows[name], key, value, keys)
        return options

    def _value(self, row: Option, key: str, value: Any, keys: tuple[str, ...]) -> Any:
        """A value as a command line would hold it."""
        several = isinstance(row.default, tuple)
        if several and isinstance(value, str):
            value = [value]
        if row.name == "frames" and isinstance(value, list):
            value = ",".join(map(str, value))
        if type(value) is not (list if several else type(row.default)) or (several and not texts(value)):
            remedy = f"Write it as in {row.name} = {_example(row)}."
            raise self._problem(f"{key} cannot be {value!r}.", remedy, *keys, key)
        if row.choices and value not in row.choices:
            raise self._problem(f"{key} cannot be {value!r}.", f"Use {', '.join(row.choices)}.", *keys, key)
        try:
            self._check_options(self._defaults | {row.name: value})
            if row.name == "like" and isinstance(value, str) and value:
                value = str(check.file(str(self._base / value), "picture"))
            if row.name == "goals" and isinstance(value, str) and value:
                value = check.goals(str(self._base / value))
        except VibeError as error:
            raise self._problem(error.message, error.remedy, *keys, key) from error
        return value

    def _check_options(self, options: dict[str, Any]) -> None:
        given = argparse.Namespace(**options)
        checks.numbers(given, self._rows.values())
        checks.groups(given.groups)
        checks.locks(given.lock)
        checks.targets(given.target)
        checks.traits(given.like_only, given.like or "perhaps in another table")
        check.device(given.device)
        frame_numbers(getattr(given, "frames", ""))
        if given.vocabulary:
            check.vocabulary(str(self._base / given.vocabulary))

    def prompt(self, prompt: str, options: dict[str, Any]) -> None:
        """Refuses a prompt that a vibe could not work with.

        Args:
            options: Of the job; those that are missing have the manifest's defaults.

        Raises:
            VibeError: It is empty or too long, or nothing in it is understood and no model is there to ask.
        """
        checks.prompt(prompt, options.get("like", ""), options.get("goals", ""))
        if prompt.strip() and not check.model(argparse.Namespace(**self._defaults | options)):
            check.words(prompt)

    def arguments(self, options: dict[str, Any], scenes: list[Path]) -> tuple[str, ...]:
        """A job's options as the command line of Blender's side, without prompt and seed.

        Args:
            options: Of the job; those that are missing have the manifest's defaults.
            scenes: The job's scenes, one or more that share a look.

        Raises:
            VibeError: A value is out of bounds, or options do not go together.
        """
        given = argparse.Namespace(**self._defaults | options)
        checks.numbers(given, self._rows.values())
        given.groups = checks.groups(given.groups)
        checks.traits(given.like_only, given.like)
        check.shots(scenes, given)
        if scenes[0].suffix.lower() == ".blend":
            given.stage = ""
        rows = [row for row in self._rows.values() if row.name not in ("prompt", "seed")]
        return tuple(command_line.to_arguments(given, rows))


def texts(given: Any) -> bool:
    """Whether this is a list of texts, and not an empty one."""
    return isinstance(given, list) and bool(given) and all(isinstance(text, str) for text in given)


def _example(row: Option) -> str:
    if row.name == "frames":
        return "[1, 50, 100]"
    return {bool: "false", tuple: '["a", "b"]', str: '"text"'}.get(type(row.default), str(row.default))
