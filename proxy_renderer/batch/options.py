# SPDX-License-Identifier: Apache-2.0
"""The options of `vibe batch`. Nothing heavy here."""

from __future__ import annotations

import argparse
from pathlib import Path


def add_batch_options(sub: argparse.ArgumentParser) -> None:
    """The options of the command."""
    sub.add_argument(
        "manifest",
        type=Path,
        metavar="MANIFEST.toml",
        help="scenes, shots that share a look, prompts, seeds and options",
    )
    sub.add_argument("--out", required=True, type=Path, metavar="DIR", help="folder for all results")
    sub.add_argument(
        "--dry-run", action="store_true", help="only say what would be done, and how long it takes"
    )
    sub.add_argument(
        "--final",
        nargs="?",
        const="",
        metavar="A-B",
        help="then render these frames of every result with Cycles (without A-B: the scene's own frames)",
    )
    sub.add_argument(
        "--workers", type=int, default=0, metavar="N",
        help="jobs at a time (default: as many as cores, memory and graphics cards hold)",
    )  # fmt: skip
    sub.add_argument(
        "--ray", nargs="?", const="auto", default="", metavar="ADDRESS",
        help="on the Ray cluster at this address; without one, on the cluster that this machine belongs to",
    )  # fmt: skip
