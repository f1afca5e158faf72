# SPDX-License-Identifier: Apache-2.0
"""Converts options to command lines and back, in the same way for `vibe` and for the Blender process."""

import argparse
from collections.abc import Iterable
from typing import Any

from .table import HEADINGS, TABLE, Option, Options, rows


def add_option(container: argparse._ActionsContainer, option: Option, **changes: Any) -> None:
    """Adds one option; `changes` are its `default`, `required` and `help` in this command."""
    default = changes.get("default", option.command_default)
    keywords: dict[str, Any] = {"dest": option.name, "default": default, "help": option.text(default)}
    if isinstance(option.default, bool):
        keywords["action"] = "store_false" if option.default else "store_true"
    elif isinstance(option.default, tuple):
        keywords |= {"action": "append", "metavar": option.unit}
    elif isinstance(option.default, int):
        keywords |= {"type": int, "metavar": option.unit}
    else:
        keywords |= {"choices": option.choices} if option.choices else {"metavar": option.unit}
    container.add_argument(option.flag, **(keywords | changes))


def add_options(parser: argparse.ArgumentParser, headings: Iterable[str], table: Iterable[Option] = TABLE) -> None:
    """Adds all options under some of the `HEADINGS`, each heading with its title."""
    table = tuple(table)
    for heading in headings:
        title = HEADINGS[heading]
        container = parser.add_argument_group(title) if title else parser
        for option in table:
            if option.heading == heading:
                add_option(container, option)


def to_arguments(given: argparse.Namespace, table: Iterable[Option] = TABLE) -> list[str]:
    """Arguments with the same options, for the command line of the Blender process."""
    arguments: list[str] = []
    for option in table:
        value = getattr(given, option.name, None)
        if not option.blender or option.name == "effort" or value is None:
            continue
        if isinstance(option.default, bool):
            arguments += [option.flag] if value is not option.default else []
        elif isinstance(option.default, tuple):
            arguments += [f"{option.flag}={one}" for one in value]
        elif value != "":
            arguments.append(f"{option.flag}={value}")
    return arguments


def engine_options(given: argparse.Namespace, camera: bool, online: bool) -> Options:
    """The options for the engine from a parsed command line."""
    chosen = {row.name: getattr(given, row.name) for row in rows(Options)}
    return Options.from_dict({**chosen, "camera": camera, "online": online})
