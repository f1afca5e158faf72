# SPDX-License-Identifier: Apache-2.0
"""``python -m lab``: measurements, and the training of what is shipped. Nothing heavy is imported before the arguments are good."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path

from lab.bench.options import BENCHES
from proxy_renderer.cli.main import Help, Parser
from proxy_renderer.schema import VibeError
from proxy_renderer.schema.options import checks

TRAININGS = {
    "train": ("the encoder that guides, or the one that judges", "lab.train.encoder"),
    "fit": ("the weights that bind words, to labeled sentences", "lab.train.binding"),
    "words": ("the table of words, from word vectors and WordNet", "lab.train.text.words"),
}
"""Commands that make what is shipped: what, and the module that reads the rest of the command line."""


class LabParser(Parser):
    """Argument mistakes in one line."""

    program = "lab"


def main(argv: Sequence[str] | None = None) -> int:
    """Carries out a command and returns its exit code: 0, 1 if a part of it failed, or 2 with one line for a user's mistake."""
    given = list(sys.argv[1:] if argv is None else argv)
    try:
        if given and given[0] in TRAININGS:
            import_module(TRAININGS[given[0]][1]).main(given[1:])
            return 0
        arguments = parser().parse_args(given)
        return arguments.act(arguments)
    except VibeError as error:
        print(f"lab: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("lab: stopped.", file=sys.stderr)
        return 130


def parser() -> argparse.ArgumentParser:
    """The command line, with its help."""
    made = "\n".join(f"  {name:<8}{what}" for name, (what, _) in TRAININGS.items())
    top = LabParser(
        prog="python -m lab",
        description="Measure, and write DIR/results.json.",
        epilog=f"Commands that make what is shipped:\n{made}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    commands = top.add_subparsers(title="measurements", metavar="NAME", required=True, parser_class=LabParser)
    for name, (summary, add_own) in BENCHES.items():
        sub = commands.add_parser(name, help=summary, description=summary, formatter_class=Help)
        sub.add_argument("--out", required=True, type=Path, metavar="DIR", help="folder for the results")
        add_own(sub)
        sub.set_defaults(act=_measure, bench=name)
    return top


def _measure(a: argparse.Namespace) -> int:
    checks.numbers(a)
    out = checks.folder(a.out)
    print(f"Measuring {a.bench} …", flush=True)
    options = {k: v for k, v in vars(a).items() if k not in ("act", "bench", "out")}
    results = import_module(f"lab.bench.{a.bench}").run(out, **options)
    print(f"Written: {out / 'results.json'}")
    return 1 if results.get("failed") else 0


if __name__ == "__main__":
    sys.exit(main())
