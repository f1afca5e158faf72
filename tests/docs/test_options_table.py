# SPDX-License-Identifier: Apache-2.0
"""docs/headless.md has every option of every command, as the command line itself describes it.

python tests/docs/test_options_table.py     writes the table anew
"""

import argparse
import sys
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "headless.md"
START, END = "<!-- options: generated -->\n", "<!-- end of options -->"
COMMANDS = ("run", "apply", "revert", "explain", "batch")


def subparsers(parser: argparse.ArgumentParser) -> dict[str, argparse.ArgumentParser]:
    """The commands of the command line, by name."""
    return next(a.choices for a in parser._actions if isinstance(a, argparse._SubParsersAction))


def rows(parser: argparse.ArgumentParser) -> Iterator[str]:
    """One row of the table for each option and each argument."""
    for action in parser._actions:
        if isinstance(action, argparse._HelpAction):
            continue
        name = ", ".join(f"`{name}`" for name in action.option_strings) or f"`{action.metavar}`"
        value = "|".join(map(str, action.choices)) if action.choices else action.metavar
        if action.option_strings and action.nargs != 0 and value:
            name += f" `{value}`"
        meaning = (action.help or "") % {**vars(action), "prog": parser.prog}
        cells = (cell.replace("|", "\\|") for cell in (name, meaning))  # a bar would end the column
        yield f"| {' | '.join(cells)} |"


def table() -> str:
    """The generated part of the page."""
    from proxy_renderer.cli.main import parser

    parts = []
    for name, sub in subparsers(parser()).items():
        if name in COMMANDS:
            parts += [f"### vibe {name}", "", sub.description or "", "", "| option | meaning |", "|---|---|"]
            parts += [*rows(sub), ""]
    return "\n".join(parts)


def test_the_page_has_every_option_as_the_command_line_describes_it():
    text = PAGE.read_text(encoding="utf-8")
    assert text.partition(START)[2].partition(END)[0] == table()


if __name__ == "__main__":
    sys.path.insert(0, str(ROOT))
    before, _, rest = PAGE.read_text(encoding="utf-8").partition(START)
    PAGE.write_text(before + START + table() + END + rest.partition(END)[2], encoding="utf-8")
