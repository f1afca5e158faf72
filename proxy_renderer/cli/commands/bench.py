# SPDX-License-Identifier: Apache-2.0
"""`vibe bench`: measurements."""

from __future__ import annotations

import argparse
from importlib import import_module
from pathlib import Path

from ...bench.options import BENCHES
from ...schema.options import checks
from ..parser import Help, Parser

SUMMARY = "Measure, and write DIR/results.json."
_MODULES = f"{__package__.partition('.')[0]}.bench"


def add_options(parser: argparse.ArgumentParser) -> None:
    """A command for each measurement, with its own options."""
    benches = parser.add_subparsers(
        title="measurements", metavar="NAME", dest="bench", required=True, parser_class=Parser
    )
    for name, (summary, add_own) in BENCHES.items():
        sub = benches.add_parser(name, help=summary, description=summary, formatter_class=Help)
        sub.add_argument("--out", required=True, type=Path, metavar="DIR", help="folder for the results")
        add_own(sub)


def act(a: argparse.Namespace) -> int:
    """Carries out the command."""
    checks.numbers(a)
    out = checks.folder(a.out)
    print(f"Measuring {a.bench} …", flush=True)
    options = {k: v for k, v in vars(a).items() if k not in ("act", "bench", "out")}
    results = import_module(f"{_MODULES}.{a.bench}").run(out, **options)
    print(f"Written: {out / 'results.json'}")
    return 1 if results.get("failed") else 0
