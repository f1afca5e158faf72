# SPDX-License-Identifier: Apache-2.0
"""`vibe explain`: what words mean."""

from __future__ import annotations

import argparse

from ...inputs import check
from ...schema.options import checks, command_line
from ...schema.options.table import named
from ..parser import add_scene

SUMMARY = "Say what the words mean to Vibe Render, and to a scene."


def add_options(parser: argparse.ArgumentParser) -> None:
    """The words, and the scene that they are about, if there is one."""
    parser.add_argument("prompt", metavar="TEXT", help="the look")
    add_scene(parser, optional=True)
    command_line.add_option(parser, named("vocabulary"))
    command_line.add_option(parser, named("target"))
    parser.add_argument(
        "--why",
        action="store_true",
        help="what each look word may be bound to, with scores and the facts that decided",
    )
    parser.add_argument(
        "--goals", action="store_true", help="what the words wish for, as JSON that `vibe run --goals` reads"
    )
    parser.add_argument("--json", action="store_true", help="for programs")


def act(a: argparse.Namespace) -> int:
    """Carries out the command."""
    from ..explain import account

    checks.prompt(a.prompt)
    check.vocabulary(a.vocabulary)
    checks.targets(a.target)
    scene = check.scene(a.scene) if a.scene else None
    subject = [f"--subject={name}" for name in a.subject]
    print(account(a.prompt, a.json, scene, subject, a.why, a.target, a.goals))
    return 0
