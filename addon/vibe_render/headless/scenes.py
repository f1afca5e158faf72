# SPDX-License-Identifier: GPL-3.0-or-later
"""Opens the scene that the command line names, and saves it elsewhere.

A Blender that is a Python module cannot run fluid simulations: they abort it, or write caches next to the scene. They are
switched off while such a file is open.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path

import bpy

from ..core import compat, files
from ..core.schema_import import limits, schema
from ..scene.stage import DEMO_SUBJECT, build_demo, build_stage
from ..scene.subject import SubjectChoice
from .arguments import Reporter

_fluids: list[tuple[str, str, bool, bool]] = []
"""Of the open file: object and modifier that are switched off, whether the viewport and renders showed it."""


def open_scene(args: argparse.Namespace, reporter: Reporter) -> tuple[bpy.types.Scene, SubjectChoice, bool]:
    """Opens or builds the scene; returns it, how its subject is chosen, and if it is a mesh on our stage."""
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
    """Opens a .blend, without running scripts in it, and switches its fluids off before Blender evaluates any of it."""
    if not path.is_file():
        raise schema.VibeError(f"There is no file {path}.", "Check the path.")
    _fluids.clear()
    try:
        with _at("load_post", _switch_off) if compat.IS_MODULE else nullcontext():
            bpy.ops.wm.open_mainfile(filepath=str(path), load_ui=False, use_scripts=False)
    except RuntimeError as error:
        reason = str(error).strip().splitlines()[-1].removeprefix("Error: ").rstrip(".")
        raise schema.VibeError(
            f"{path.name} cannot be opened: {reason}.", "Check that it is a .blend."
        ) from error


def save_blend(path: Path) -> None:
    """Saves the open file under another name; its paths stay right for that folder, its fluids as the artist has them."""
    # Every operator evaluates the scene before and after, so fluids are back for no longer than the writing.
    try:
        with _at("save_pre", lambda: _set_fluids(True)), _at("save_post", lambda: _set_fluids(False)):
            bpy.ops.wm.save_as_mainfile(
                filepath=str(path), copy=True, relative_remap=True, check_existing=False
            )
    except RuntimeError as error:
        raise files.unwritable(path, error, "Make room there, or choose another --out.") from error


def fluid_note() -> str:
    """Names the fluids of the open file that are left out, for the artist; "" without any."""
    names = ", ".join(dict.fromkeys(f'"{name}"' for name, *_ in _fluids))
    return names and f"The fluid simulation of {names} is left out of the pictures: vibe it inside Blender."


@contextmanager
def _at(moment: str, act: Callable[[], None]) -> Iterator[None]:
    """Calls a function whenever Blender reaches a moment inside the block."""
    handlers = getattr(bpy.app.handlers, moment)
    handler = bpy.app.handlers.persistent(lambda *_: act())  # others go when a file is opened
    handlers.append(handler)
    try:
        yield
    finally:
        handlers.remove(handler)


def _switch_off() -> None:
    for obj in bpy.data.objects:
        for modifier in obj.modifiers:
            if modifier.type == "FLUID" and (modifier.show_viewport or modifier.show_render):
                _fluids.append((obj.name, modifier.name, modifier.show_viewport, modifier.show_render))
    _set_fluids(False)


def _set_fluids(shown: bool) -> None:
    """Shows the fluids as the artist has them, or hides them."""
    for name, modifier_name, viewport, renders in _fluids:
        obj = bpy.data.objects.get(name)
        if obj and (modifier := obj.modifiers.get(modifier_name)):
            modifier.show_viewport, modifier.show_render = shown and viewport, shown and renders
