# SPDX-License-Identifier: Apache-2.0
"""`vibe vocabulary`: an artist's or a studio's own words."""

from __future__ import annotations

import argparse
from pathlib import Path

from ...inputs import check
from ...schema import VibeError
from ...schema.options import command_line
from ...schema.options.table import named

SUMMARY = "Add words of your own, try them, and list what words there are."


def add_options(parser: argparse.ArgumentParser) -> None:
    """What to do, and its words."""
    actions = parser.add_subparsers(title="actions", metavar="ACTION", required=True, dest="action")
    add = actions.add_parser("add", help="write an entry or a color into your vocabulary")
    add.add_argument("name", metavar="NAME", help="the word")
    add.add_argument("--color", metavar="#RRGGBB", default="", help="it is a color, and this is it")
    add.add_argument("--slot", default="material", help="kind of look word (default: material)")
    add.add_argument("--words", default="", help="other ways to say it, comma separated")
    add.add_argument(
        "--wish",
        action="append",
        default=[],
        metavar="TEXT",
        help='what it wishes for: a class ("finish is glossy"), an effect or a claim; may be repeated',
    )
    add.add_argument("--means", default="", help="the same said in plain look words")
    test = actions.add_parser("test", help="say how a prompt is read with it")
    test.add_argument("text", metavar="TEXT", help="the look")
    listed = actions.add_parser("list", help="list entries and colors")
    listed.add_argument(
        "part", metavar="TEXT", nargs="?", default="", help="only those with this in a wording"
    )
    for action in (add, test, listed):
        command_line.add_option(action, named("vocabulary"))


def act(a: argparse.Namespace) -> int:
    """Carries out the command."""
    {"add": _add, "test": _test, "list": _list}[a.action](a)
    return 0


def _add(a: argparse.Namespace) -> None:
    from ...folders import config_folder
    from ...words.lexicon.user_words import add_color, add_look

    if bool(a.color) == bool(a.wish or a.means):
        raise VibeError(f"'{a.name}' needs a color, or what it does.", "Give --color, or --wish, or --means.")
    path = Path(a.vocabulary).expanduser() if a.vocabulary else config_folder() / "vocabulary.toml"
    if a.color:
        add_color(path, a.name, a.color)
    else:
        add_look(path, a.name, {"slot": a.slot, "words": a.words, "wishes": a.wish, "means": a.means})
    print(f"'{a.name}' is in {path} now.")


def _test(a: argparse.Namespace) -> None:
    from ..explain import account

    check.vocabulary(a.vocabulary)
    print(account(a.text, as_json=False))


def _list(a: argparse.Namespace) -> None:
    from ...words.lexicon.user_words import default_vocabulary

    check.vocabulary(a.vocabulary)
    known, part = default_vocabulary(), a.part.lower()
    for entry in known.entries.values():
        if any(part in word for word in entry.words):
            others = ", ".join(word for word in entry.words if word != entry.name)
            print(f"{entry.name} ({entry.slot}){': ' + others if others else ''}")
    print("\n".join(f"{name} (color)" for name in known.colors if part in name))
