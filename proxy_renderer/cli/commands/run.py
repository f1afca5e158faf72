# SPDX-License-Identifier: Apache-2.0
"""`vibe run`: a scene, or several, and the look that they are to have."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path

from ...inputs import check
from ...schema import VibeError
from ...schema.options import checks, command_line
from ...schema.options.table import named
from ..parser import add_scene

SUMMARY = "Give a scene the look that words describe, or a picture has."
_HOW = ("picture", "budget", "reach", "engine", "render")


def add_options(parser: argparse.ArgumentParser) -> None:
    """Scenes, the look, and everything that a vibe can be told."""
    add_scene(parser)
    parser.add_argument(
        "more", nargs="*", metavar="SCENE", help="more .blends that are to have the same look"
    )
    command_line.add_option(parser, named("prompt"))
    parser.add_argument(
        "--out", required=True, type=Path, metavar="DIR", help="folder for pictures, .blend and report"
    )
    command_line.add_option(parser, named("stage"), default="")
    command_line.add_options(parser, ("shots", *_HOW))


def add_how(parser: argparse.ArgumentParser) -> None:
    """How a vibe is carried out, whatever the scene."""
    command_line.add_options(parser, _HOW)


def act(a: argparse.Namespace) -> int:
    """Carries out the command.

    Raises:
        VibeError: An input or an option is wrong; nothing was started then.
    """
    scene = check.scene(a.scene)
    if a.stage and scene.suffix.lower() == ".blend":
        raise VibeError("--stage is for bare meshes; a .blend brings its own.", "Leave --stage out.")
    scenes = check.shots([scene, *map(check.scene, a.more)], a)
    return carry_out(a, "run", scenes)


def carry_out(a: argparse.Namespace, what: str, scenes: Sequence[Path] = ()) -> int:
    """Checks everything that can be checked without Blender, then starts it.

    Args:
        what: The command of Blender's side.
    """
    checks.prompt(a.prompt, a.like, a.goals)
    checks.numbers(a)
    a.groups = checks.groups(a.groups)
    checks.locks(a.lock)
    checks.targets(a.target)
    a.like_only = checks.traits(a.like_only, a.like)
    a.like = str(check.file(a.like, "picture")) if a.like else ""
    check.device(a.device)
    from ...blender.launch import launch
    from ...blender.meshes import prepared

    with ExitStack() as stack:
        places = [str(stack.enter_context(prepared(scene))) for scene in scenes]
        check.vocabulary(a.vocabulary)  # after the meshes: it takes as long as they do
        a.goals = check.goals(a.goals)
        if a.prompt.strip() and not check.model(a):
            check.words(a.prompt)
        out = checks.folder(a.out)  # last: a mistake leaves no folder
        return launch([what, *places, f"--out={out}", *command_line.to_arguments(a)], out)
