# SPDX-License-Identifier: Apache-2.0
"""`vibe batch`: many scenes, many looks."""

from __future__ import annotations

import argparse
from pathlib import Path

SUMMARY = "Give many scenes many looks, on this machine or on a cluster."


def add_options(parser: argparse.ArgumentParser) -> None:
    """The manifest, where to, and by how many workers."""
    parser.add_argument(
        "manifest",
        type=Path,
        metavar="MANIFEST.toml",
        help="scenes, shots that share a look, prompts, seeds and options",
    )
    parser.add_argument("--out", required=True, type=Path, metavar="DIR", help="folder for all results")
    parser.add_argument(
        "--dry-run", action="store_true", help="only say what would be done, and how long it takes"
    )
    parser.add_argument(
        "--final",
        nargs="?",
        const="",
        metavar="A-B",
        help="then render these frames of every result with Cycles (without A-B: the scene's own frames)",
    )
    parser.add_argument(
        "--workers",
        type=int,
        default=0,
        metavar="N",
        help="jobs at a time (default: as many as cores, memory and graphics cards hold)",
    )
    parser.add_argument(
        "--ray",
        nargs="?",
        const="auto",
        default="",
        metavar="ADDRESS",
        help="on the Ray cluster at this address; without one, on the cluster that this machine belongs to",
    )


def act(a: argparse.Namespace) -> int:
    """Carries out the command."""
    from ...batch.command import run

    return run(a)
