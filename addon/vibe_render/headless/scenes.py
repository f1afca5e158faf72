# SPDX-License-Identifier: GPL-3.0-or-later
"""Opens the scene that the command line names, and saves it elsewhere."""

from __future__ import annotations

import argparse
import os
from pathlib import Path

import bpy

from ..core import files
from ..core.schema_import import limits, schema
from ..scene.stage import DEMO_SUBJECT, build_demo, build_stage
from ..scene.subject import SubjectChoice
from . import fluids
from .reporter import Reporter


def open_scene(args: argparse.Namespace, reporter: Reporter) -> tuple[bpy.types.Scene, SubjectChoice, bool]:
    """Opens, stages or builds the scene that the command line names.

    Returns:
        The scene, how its subject is chosen, and whether it is a bare mesh on our stage.

    Raises:
        VibeError: It cannot be opened.
    """
    path = Path(args.scene).expanduser().absolute() if args.scene else None
    chosen = tuple(args.subject)
    if args.command == "demo" or args.demo:
        reporter.stage("building the demo scene")
        return build_demo(), SubjectChoice(chosen or (DEMO_SUBJECT,)), False
    if path and path.suffix.lower() in limits.MESH_FORMATS:
        reporter.stage(f"staging {path.name}")
        scene = build_stage(path, args.stage)
        return scene, SubjectChoice(chosen, selected=not chosen), True
    if path:
        reporter.stage(f"opening {path.name}")
        open_blend(path)
    return bpy.context.scene, SubjectChoice(chosen), False


def open_blend(path: Path) -> None:
    """Opens a .blend, without running scripts in it."""
    if not path.is_file():
        raise schema.VibeError(f"There is no file {path}.", "Check the path.")
    try:
        with fluids.left_out():
            bpy.ops.wm.open_mainfile(filepath=str(path), load_ui=False, use_scripts=False)
    except RuntimeError as error:
        reason = str(error).strip().splitlines()[-1].removeprefix("Error: ").rstrip(".")
        raise schema.VibeError(
            f"{path.name} cannot be opened: {reason}.", "Check that it is a .blend."
        ) from error


def check_writable(path: Path) -> None:
    """Raises a VibeError for a read-only file: replacing it would need no permission of the file's."""
    if not os.access(path, os.W_OK):
        raise schema.VibeError(
            f"{path.name} is read-only.", "Make it writable, or copy it to where it can be changed."
        )


def save_blend(path: Path) -> None:
    """Saves the open file under another name; its paths stay right for that folder."""
    try:
        with fluids.as_opened():
            bpy.ops.wm.save_as_mainfile(
                filepath=str(path), copy=True, relative_remap=True, check_existing=False
            )
    except RuntimeError as error:
        raise files.unwritable(path, error, "Make room there, or choose another --out.") from error
