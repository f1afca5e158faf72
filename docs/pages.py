# SPDX-License-Identifier: Apache-2.0
"""The parts of the documents that are made from the code: `PYTHONPATH=. python docs/pages.py` writes them anew.

A part stands between two comments, `<!-- NAME -->` and `<!-- /NAME -->`. `tests/docs/test_pages.py` checks that each
is what this script makes.
"""

import argparse
import re
from collections.abc import Callable, Iterable
from pathlib import Path

from proxy_renderer.cli.main import COMMANDS
from proxy_renderer.cli.main import parser as command_line
from proxy_renderer.schema import GROUPS, PARAMETERS
from proxy_renderer.schema.options.table import TABLE
from proxy_renderer.words.lexicon.vocabulary import shipped_vocabulary

DOCS = Path(__file__).resolve().parent

KINDS = {
    "material": "Materials",
    "finish": "Surfaces",
    "lighting": "Light",
    "atmosphere": "Air",
    "grade": "Color and grade",
    "mood": "Moods and styles",
    "setting": "Places",
}
"""Slots of the vocabulary that the cheat sheet lists, with their titles."""

WORDS_EACH = 24
"""Words of a kind on the cheat sheet."""


def table(*rows: Iterable[str]) -> str:
    """A table in Markdown; the first row has the titles."""
    titles, *others = ([cell.replace("|", r"\|") for cell in row] for row in rows)
    return "\n".join(f"| {' | '.join(row)} |" for row in (titles, ["---"] * len(titles), *others))


def options() -> str:
    """The options of `vibe run`, in the order of its help."""
    rows = {row.name: row for row in TABLE}
    found = []
    for action in actions("run"):
        if action.dest not in rows:
            continue
        row = rows[action.dest]
        bounds = f"{row.bounds[0]} to {row.bounds[1]}" if row.bounds else ""
        found.append((f"`{called(action)}`", action.help or "", bounds, row.panel.title if row.panel else ""))
    return table(("option", "meaning", "bounds", "in Blender"), *found)


def commands() -> str:
    """All commands, with what they do."""
    return table(("command", "what it does"), *((f"`vibe {n}`", c.summary) for n, c in COMMANDS.items()))


def other_options() -> str:
    """Options and arguments of the commands that `vibe run` does not have, command by command."""
    shared = {action.dest for action in actions("run")}
    rows = [
        (f"`vibe {name}`", f"`{called(action)}`", action.help or "")
        for name in COMMANDS
        for action in actions(name)
        if action.dest not in shared and not isinstance(action, argparse._SubParsersAction)
    ]
    for name, sub in nested(subparser("vocabulary")).items():
        rows += [
            (f"`vibe vocabulary {name}`", f"`{called(a)}`", a.help or "") for a in own(sub) if a.dest not in shared
        ]
    return table(("command", "argument or option", "meaning"), *rows)


def parameters() -> str:
    """Every value that a vibe may change, group by group."""
    parts = []
    for group in GROUPS:
        rows = [
            (
                f"`{p.name}`",
                p.doc,
                f"{p.lower:g} to {p.upper:g}{f' {p.unit}' if p.unit else ''}{f' × {p.reference}' if p.reference else ''}",
                p.blender,
            )
            for p in PARAMETERS
            if p.group == group
        ]
        parts.append(f"## {group}\n\n{table(('name', 'what it is', 'bounds', 'in Blender'), *rows)}")
    return "\n\n".join(parts)


def cheat_sheet() -> str:
    """Words of each kind, spread over the vocabulary, with how many there are."""
    vocabulary = shipped_vocabulary()
    names = {kind: [e.name for e in vocabulary.entries.values() if e.slot == kind] for kind in KINDS}
    lines = [listed(title, names[kind]) for kind, title in KINDS.items()]
    lines.append(listed("Colors", [name for name in vocabulary.colors if " " not in name], len(vocabulary.colors)))
    wordings = sum(len(entry.words) for entry in vocabulary.entries.values())
    count = f"{len(vocabulary.entries)} looks in {wordings:,} wordings, and {len(vocabulary.colors)} names of colors"
    return f"The vocabulary has {count}.\n\n" + "\n".join(lines)


def listed(title: str, names: list[str], count: int = 0) -> str:
    """A line with some of the names; those that only a definition needs ("dry surface") are left out."""
    shown = sorted(name for name in names if not re.search(r"\d|surface|material|surroundings|metal$|gem$|sky$", name))
    return f"- **{title}** ({count or len(names)}): {', '.join(spread(shown, WORDS_EACH))}"


def spread(names: list[str], most: int) -> list[str]:
    """At most so many of the names, evenly spread."""
    step = max(len(names) / most, 1.0)
    return [names[int(i * step)] for i in range(min(most, len(names)))]


def actions(command: str) -> list[argparse.Action]:
    """The arguments and options of a command of `vibe`, without its help."""
    return own(subparser(command))


def own(parser: argparse.ArgumentParser) -> list[argparse.Action]:
    """A parser's actions, without its help."""
    return [action for action in parser._actions if not isinstance(action, argparse._HelpAction)]


def subparser(command: str) -> argparse.ArgumentParser:
    """The parser of a command of `vibe`."""
    return nested(command_line())[command]


def nested(parser: argparse.ArgumentParser) -> dict[str, argparse.ArgumentParser]:
    """The parsers of a parser's commands."""
    return next(a for a in parser._actions if isinstance(a, argparse._SubParsersAction)).choices


def called(action: argparse.Action) -> str:
    """An option with its value, or an argument, as in the help."""
    name = action.option_strings[-1] if action.option_strings else ""
    if action.nargs == 0:
        return name
    value = action.metavar or ("{" + ",".join(map(str, action.choices)) + "}" if action.choices else action.dest)
    return f"{name} {value}".strip()


PARTS: dict[str, tuple[str, Callable[[], str]]] = {
    "options": ("reference/command-line.md", options),
    "commands": ("reference/command-line.md", commands),
    "other options": ("reference/command-line.md", other_options),
    "parameters": ("reference/parameters.md", parameters),
    "cheat sheet": ("guide/prompts.md", cheat_sheet),
}
"""Name of each part, its page, and what makes it."""


def written_anew(page: str, text: str) -> str:
    """A page's text with its parts as the code has them."""
    for name, (where, make) in PARTS.items():
        if where == page:
            new = f"<!-- {name} -->\n{make()}\n<!-- /{name} -->"
            text, found = re.subn(rf"<!-- {name} -->\n.*?<!-- /{name} -->", lambda _, new=new: new, text, flags=re.S)
            assert found == 1, name
    return text


def main() -> None:
    """Writes all parts."""
    for page in {page for page, _ in PARTS.values()}:
        path = DOCS / page
        path.write_text(written_anew(page, path.read_text(encoding="utf-8")), encoding="utf-8")


if __name__ == "__main__":
    main()
