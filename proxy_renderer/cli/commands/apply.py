# SPDX-License-Identifier: Apache-2.0
"""`vibe apply`: a preset on a scene."""

from __future__ import annotations

import argparse
from pathlib import Path

from ...inputs import check
from ...schema import limits
from ...schema.options import checks, command_line
from ...schema.options.table import named
from ..parser import add_scene

SUMMARY = "Give a scene the look that a preset holds, and render it."


def add_options(parser: argparse.ArgumentParser) -> None:
    """The preset, the scene, and what Cycles renders."""
    parser.add_argument(
        "preset", metavar="PRESET", help="a preset.json that `vibe run` has written, or a name: noir"
    )
    add_scene(parser)
    parser.add_argument(
        "--out", required=True, type=Path, metavar="DIR", help="folder for pictures and .blend"
    )
    render = parser.add_argument_group("render")
    command_line.add_option(render, named("size"), default=limits.STANDARD.size)
    command_line.add_option(render, named("samples"))


def act(a: argparse.Namespace) -> int:
    """Carries out the command."""
    from ...blender.launch import launch
    from ...blender.meshes import prepared

    checks.numbers(a)
    preset, scene = check.preset(a.preset), check.scene(a.scene)
    out = checks.folder(a.out)
    with prepared(scene) as place:
        return launch(["apply", preset, str(place), f"--out={out}", *command_line.to_arguments(a)], out)
