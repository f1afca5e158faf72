# SPDX-License-Identifier: Apache-2.0
"""`vibe extension`: the Blender extension."""

from __future__ import annotations

import argparse
from pathlib import Path

SUMMARY = "Build the Blender extension, or install it."


def add_options(parser: argparse.ArgumentParser) -> None:
    """What to do, and where."""
    parser.add_argument(
        "action", choices=("build", "install"), help="make a .zip to install from disk, or install it at once"
    )
    parser.add_argument(
        "--out", type=Path, default=Path("dist"), metavar="DIR", help="build: folder (default: %(default)s)"
    )
    parser.add_argument(
        "--blender", default="", metavar="PATH", help="install: into this Blender (default: the PATH's)"
    )


def act(a: argparse.Namespace) -> int:
    """Carries out the command."""
    from ...blender.extension import build, install

    print(install(a.blender) if a.action == "install" else f"Written: {build(a.out)}")
    return 0
