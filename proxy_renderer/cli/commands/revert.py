# SPDX-License-Identifier: Apache-2.0
"""`vibe revert`: a .blend as it was before."""

from __future__ import annotations

import argparse

from ...inputs import check
from ...schema import VibeError

SUMMARY = "Take every vibe out of a .blend again, exactly."


def add_options(parser: argparse.ArgumentParser) -> None:
    """The file."""
    parser.add_argument(
        "scene", metavar="FILE.blend", help="a file that `vibe run` has written; it is changed in place"
    )


def act(a: argparse.Namespace) -> int:
    """Carries out the command.

    Raises:
        VibeError: The scene is missing, or not a .blend.
    """
    from ...blender.launch import launch

    scene = check.scene(a.scene)
    if scene.suffix.lower() != ".blend":
        raise VibeError(
            f"{a.scene} is not a .blend.", "Revert takes the vibed.blend that a vibe has written."
        )
    return launch(["revert", str(scene)], scene)
