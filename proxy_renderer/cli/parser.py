# SPDX-License-Identifier: Apache-2.0
"""How the commands read their command lines, and the scene that most of them take."""

from __future__ import annotations

import argparse
from typing import Any, NoReturn

from ..schema.limits import MESH_FORMATS
from ..schema.options.command_line import add_option
from ..schema.options.table import named


class Parser(argparse.ArgumentParser):
    """Argument mistakes in one line, like every other mistake."""

    program = "vibe"

    def error(self, message: str) -> NoReturn:
        """Exits with code 2."""
        self.exit(2, f"{self.program}: {message[:1].upper()}{message[1:]}. See `{self.prog} --help`.\n")


class Help(argparse.HelpFormatter):
    """Help texts in a column wide enough for the option names."""

    def __init__(self, prog: str) -> None:
        super().__init__(prog, max_help_position=28, width=100)


def add_scene(parser: argparse.ArgumentParser, optional: bool = False) -> None:
    """Adds the scene and `--subject` to a command.

    Args:
        optional: Whether the scene may be left out; it is "" then.
    """
    count: dict[str, Any] = {"nargs": "?", "default": ""} if optional else {}
    meshes = " ".join(MESH_FORMATS)
    parser.add_argument("scene", metavar="SCENE", help=f"a .blend, or a mesh: {meshes}", **count)
    add_option(parser, named("subject"))
