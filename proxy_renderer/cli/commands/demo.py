# SPDX-License-Identifier: Apache-2.0
"""`vibe demo`: the first thing to try."""

from __future__ import annotations

import argparse
from pathlib import Path

from ...schema.options import command_line
from ...schema.options.table import named
from .run import add_how, carry_out

SUMMARY = "See it work on a scene that it builds itself."
_PROMPT = "Glossy teal on a pale sand background, warm soft light, slight vignette"


def add_options(parser: argparse.ArgumentParser) -> None:
    """The look, the folder, and how."""
    shown = f"the look (default: {_PROMPT}; with a picture: none)"
    command_line.add_option(parser, named("prompt"), default=None, help=shown)
    parser.add_argument(
        "--out", type=Path, default=Path("demo"), metavar="DIR", help="folder (default: %(default)s)"
    )
    add_how(parser)


def act(a: argparse.Namespace) -> int:
    """Carries out the command; the demo's own words make way for a picture."""
    if a.prompt is None:
        a.prompt = "" if a.like or a.goals else _PROMPT
    return carry_out(a, "demo")
