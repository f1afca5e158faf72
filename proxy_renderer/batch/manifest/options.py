# SPDX-License-Identifier: Apache-2.0
"""The options in a manifest: those of `vibe run`, each of the right type, and good."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from ...options import check
from ...options.arguments import add_vibe_options, shot_arguments, vibe_arguments
from ...schema import VibeError, budgets, frame_numbers
from .toml_source import Source

OF_SCENE: dict[str, Any] = {"subject": [], "stage": ""}
"""What a scene may have besides the options of a vibe."""

OF_SHOTS: dict[str, Any] = {"subject": [], "cameras": [], "frames": "", "grade_each": False}
"""What shots that share a look may have besides them."""

_ELSEWHERE = {"seed": "Write seeds = [0, 1] at the top."}


class OptionReader:
    """Reads the tables of options.

    Args:
        source: The manifest.
        base: Its folder.
    """

    def __init__(self, source: Source, base: Path) -> None:
        self._problem, self._base = source.problem, base
        parser = argparse.ArgumentParser(add_help=False)
        add_vibe_options(parser)
        self._defaults = vars(parser.parse_args([]))
        self._choices = {a.dest: tuple(a.choices or ()) for a in parser._actions} | {"stage": check.STAGES}

    def read(
        self, table: dict[str, Any], keys: tuple[str, ...], more: dict[str, Any] | None = None
    ) -> dict[str, Any]:
        """Options of a vibe, and `more`, each of the type of its default, and good."""
        defaults = {k: v for k, v in self._defaults.items() if k not in _ELSEWHERE} | (more or {})
        found: dict[str, Any] = {}
        for key, value in table.items():
            name = key.replace("-", "_")
            if name not in defaults:
                remedy = _ELSEWHERE.get(name, f"Use {', '.join(sorted(defaults))}.")
                raise self._problem(f"Unknown option {key!r}.", remedy, *keys, key)
            default, choices = defaults[name], self._choices.get(name)
            if isinstance(default, list) and isinstance(value, str):
                value = [value]
            if name == "frames" and isinstance(value, list):
                value = ",".join(map(str, value))
            kind = int if default is None else type(default)
            if type(value) is not kind or (isinstance(value, list) and not texts(value)):
                remedy = f"Write it as in {name} = {_example(name, default)}."
                raise self._problem(f"{key} cannot be {value!r}.", remedy, *keys, key)
            if choices and value not in choices:
                raise self._problem(f"{key} cannot be {value!r}.", f"Use {', '.join(choices)}.", *keys, key)
            try:
                self._check_options(self._defaults | {name: value})
            except VibeError as error:
                raise self._problem(error.message, error.remedy, *keys, key) from error
            found[name] = value
        return found

    def _check_options(self, options: dict[str, Any]) -> None:
        given = argparse.Namespace(**options)
        check.numbers(given)
        check.groups(given.groups)
        check.locks(given.lock)
        check.device(given.device)
        frame_numbers(getattr(given, "frames", ""))
        if given.vocabulary:
            check.vocabulary(str(self._base / given.vocabulary))

    def prompt(self, prompt: str, options: dict[str, Any]) -> None:
        """Raises VibeError unless this is a prompt that can be worked with."""
        check.prompt(prompt)
        if not check.model(argparse.Namespace(**self._defaults | options)):
            check.words(prompt)

    def arguments(self, options: dict[str, Any], scenes: list[Path]) -> tuple[str, ...]:
        """The options for Blender's side, without prompt and seed.

        Raises:
            VibeError: They do not go together.
        """
        given = argparse.Namespace(**self._defaults | OF_SHOTS | options)
        check.numbers(given)
        check.shots(scenes, given)
        arguments = [*vibe_arguments(given, check.groups(given.groups)), *shot_arguments(given)]
        more = [f"--subject={name}" for name in given.subject]
        stage = options.get("stage") if scenes[0].suffix.lower() != ".blend" else ""
        more += [f"--stage={stage}"] if stage else []
        return tuple(a for a in [*arguments, *more] if not a.startswith("--seed="))


def texts(given: Any) -> bool:
    """Whether this is a list of texts, and not an empty one."""
    return isinstance(given, list) and bool(given) and all(isinstance(text, str) for text in given)


def _example(name: str, default: Any) -> str:
    if name == "frames":
        return "[1, 50, 100]"
    if default is None:
        return str(getattr(budgets.STANDARD, name))
    return {bool: "false", list: '["a", "b"]', str: '"text"'}.get(type(default), str(default))
