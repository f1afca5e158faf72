# SPDX-License-Identifier: Apache-2.0
"""The command `vibe`. Nothing heavy is imported before the arguments have been found good."""

import argparse
import sys
from collections.abc import Sequence
from typing import NoReturn

from .. import __version__
from ..schema import VibeError, errors
from .commands import COMMANDS


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


def main(argv: Sequence[str] | None = None) -> int:
    """Runs the command; returns 0, or 2 with a line for what the user can mend, or 1 with one that names a log."""
    arguments = _arguments(argv)
    try:
        return arguments.act(arguments)
    except VibeError as error:
        print(f"vibe: {error}", file=sys.stderr)
        return 1 if isinstance(error, errors.UnexpectedError) else 2
    except KeyboardInterrupt:
        print("vibe: stopped.", file=sys.stderr)
        return 130
    except BrokenPipeError:
        sys.stderr.close()
        return 1
    except Exception as error:
        print(f"vibe: {errors.unexpected(error, 'carrying out the command')}", file=sys.stderr)
        return 1


def _arguments(argv: Sequence[str] | None) -> argparse.Namespace:
    """The command line; a scene that may be left out is also found behind options, where argparse looks no more."""
    top = parser()
    arguments, left = top.parse_known_args(argv)
    if left and getattr(arguments, "scene", None) == "" and not left[0].startswith("-"):
        arguments.scene = left.pop(0)
    if left:
        top.error(f"unrecognized arguments: {' '.join(left)}")
    return arguments


def parser() -> argparse.ArgumentParser:
    """The command line, with its help."""
    top = Parser(
        prog="vibe",
        description="Type a vibe, get Blender node values that render it.",
        epilog="Start with `vibe demo`. Each command explains itself: `vibe run --help`.",
    )
    top.add_argument("--version", action="version", version=f"vibe-render {__version__}")
    commands = top.add_subparsers(title="commands", metavar="COMMAND", required=True, parser_class=Parser)
    for name, command in COMMANDS.items():
        sub = commands.add_parser(
            name, help=command.summary, description=command.summary, formatter_class=Help
        )
        sub.set_defaults(act=command.act)
        command.add_options(sub)
    return top
