# SPDX-License-Identifier: Apache-2.0
"""The options of `vibe run` in a manifest. A mistake raises VibeError, which names its place in the file."""

import argparse
import tomllib
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from ..inputs import check
from ..schema import VibeError, frame_numbers
from ..schema.options import checks
from ..schema.options.table import TABLE, Option, to_arguments


class TomlSource:
    """A TOML file, with its `path` as it was named and its `content`."""

    def __init__(self, path: Path) -> None:
        self.path = path
        try:
            self.content: dict[str, Any] = tomllib.loads(path.read_text("utf-8"))
        except tomllib.TOMLDecodeError as error:
            raise VibeError(f"{path} is not TOML: {error}.", "Mend that line.") from error
        except (OSError, UnicodeDecodeError) as error:
            raise VibeError(f"{path} cannot be read: {error}.", "Save it as UTF-8 text.") from error

    def problem(self, what: str, remedy: str, *place: str) -> VibeError:
        """An error that names the file and a place in it: keys, outermost first, and a value; the caller raises it."""
        return VibeError(f"{' > '.join(filter(None, (str(self.path), *place)))}: {what}", remedy)

    @contextmanager
    def at(self, *place: str) -> Iterator[None]:
        """Errors inside the block name their place."""
        try:
            yield
        except VibeError as error:
            raise self.problem(error.message, error.remedy, *place) from error


IN_FILES = ("like", "goals")  # options that name a file, instead of a prompt or together with one
_ELSEWHERE = {"seed": "Write seeds = [0, 1] at the top."}


class OptionReader:
    """Reads the tables of options."""

    def __init__(self, source: TomlSource, base: Path, options: Iterable[Option] = TABLE) -> None:
        self._source, self._problem, self._base = source, source.problem, base
        self._rows = {row.name: row for row in options}
        self._defaults = {row.name: row.command_default for row in self._rows.values() if row.name != "stage"}

    def read(self, table: dict[str, Any], keys: tuple[str, ...], where: str = "") -> dict[str, Any]:
        """The options in a table of the manifest, checked for type and value; `where` is "scene", "shots" or "".

        Tables of scenes and of shots allow a few more options than [options] does.
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
        """A checked value, as a parsed command line holds it."""
        several = isinstance(row.default, tuple)
        if several and isinstance(value, str):
            value = [value]
        if row.name == "frames" and isinstance(value, list):
            value = ",".join(map(str, value))
        if type(value) is not (list if several else type(row.default)) or (several and not texts(value)):
            shown = {bool: "false", tuple: '["a", "b"]', str: '"text"'}
            example = "[1, 50, 100]" if row.name == "frames" else shown.get(type(row.default), row.default)
            remedy = f"Write it as in {row.name} = {example}."
            raise self._problem(f"{key} cannot be {value!r}.", remedy, *keys, key)
        if row.choices and value not in row.choices:
            raise self._problem(f"{key} cannot be {value!r}.", f"Use {', '.join(row.choices)}.", *keys, key)
        with self._source.at(*keys, key):
            given = argparse.Namespace(**self._defaults | {row.name: value})
            checks.numbers(given, self._rows.values())
            checks.groups(given.groups)
            checks.locks(given.lock)
            checks.targets(given.target)
            checks.traits(given.like_only, given.like or "perhaps in another table")
            check.device(given.device)
            frame_numbers(getattr(given, "frames", ""))
            if given.vocabulary:
                check.vocabulary(str(self._base / given.vocabulary))
            if row.name in IN_FILES and isinstance(value, str) and value:
                path = str(self._base / value)
                value = str(check.file(path, "picture")) if row.name == "like" else check.goals(path)
        return value

    def prompt(self, prompt: str, options: dict[str, Any]) -> None:
        """Raises VibeError for a prompt that `vibe run` would refuse."""
        checks.prompt(prompt, options.get("like", ""), options.get("goals", ""))
        if prompt.strip():
            check.words(prompt, argparse.Namespace(**self._defaults | options))

    def arguments(self, options: dict[str, Any], scenes: list[Path]) -> tuple[str, ...]:
        """A job's options as the command line of Blender's side, without prompt and seed."""
        given = argparse.Namespace(**self._defaults | options)
        checks.numbers(given, self._rows.values())
        given.groups = checks.groups(given.groups)
        checks.traits(given.like_only, given.like)
        check.shots(scenes, given)
        if scenes[0].suffix.lower() == ".blend":
            given.stage = ""
        rows = [row for row in self._rows.values() if row.name not in ("prompt", "seed")]
        return tuple(to_arguments(given, rows))


def texts(given: Any) -> bool:
    """True for a list of texts that is not empty."""
    return isinstance(given, list) and bool(given) and all(isinstance(text, str) for text in given)
