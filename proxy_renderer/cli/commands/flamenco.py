# SPDX-License-Identifier: Apache-2.0
"""`vibe flamenco install`: the job type for a Flamenco farm."""

from __future__ import annotations

import argparse
from pathlib import Path

SUMMARY = "Install the job type that brings looks to a Flamenco farm."


def add_options(parser: argparse.ArgumentParser) -> None:
    """Where the Manager is."""
    parser.add_argument(
        "action", choices=("install",), metavar="install", help="the only thing to do with it"
    )
    parser.add_argument(
        "--scripts",
        required=True,
        type=Path,
        metavar="DIR",
        help="folder `scripts` of your Flamenco Manager",
    )


def act(a: argparse.Namespace) -> int:
    """Carries out the command."""
    from ...batch.flamenco import install

    print(f"Written: {install(a.scripts)}. Restart the Manager, then refresh the job types in Blender.")
    return 0
