# SPDX-License-Identifier: Apache-2.0
"""Builds the extension's zip: the add-on with the schema copied into it. Blender's own tool packs it."""

from __future__ import annotations

import importlib.util
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from .schema import VibeError

_IGNORED = shutil.ignore_patterns(
    "__pycache__",
    "*.pyc",
    "bench",  # measurements are the command's
    "make_looks.py",  # looks are made here, and come made
    "prompts.toml",
)


def build(out: Path) -> Path:
    """Builds and validates the extension for Blender's "Install from Disk".

    Args:
        out: The folder for the zip; made if it does not exist.

    Returns:
        The zip, OUT/vibe_render-VERSION.zip. It remembers which Python built it, so that on this
        computer Blender finds the engine by itself.

    Raises:
        VibeError: If Blender's tool is not installed or refuses, or the folder cannot be written.
    """
    tool = _blender_tool()
    with tempfile.TemporaryDirectory() as scratch:
        package = Path(scratch) / "vibe_render"
        _assemble(package)
        _ask(tool, "validate", str(package))
        _ask(tool, "build", "--source-dir", str(package), "--output-dir", scratch)
        _ask(tool, "validate", str(made := next(Path(scratch).glob("*.zip"))))
        return _deliver(made, out)


def _assemble(package: Path) -> None:
    """Puts the add-on, the schema and the note about this Python together."""
    shutil.copytree(_addon(), package, ignore=_IGNORED)
    shutil.copytree(Path(__file__).parent / "schema", package / "schema", ignore=_IGNORED)
    (package / "engine.txt").write_text(sys.executable, encoding="utf-8")


def _addon() -> Path:
    """The add-on's folder: importable beside this package, or in the clone that this is part of."""
    spec = importlib.util.find_spec("vibe_render")
    places = [Path(p) for p in (spec.submodule_search_locations or [])] if spec else []
    places.append(Path(__file__).resolve().parents[1] / "addon" / "vibe_render")
    for place in places:
        if (place / "blender_manifest.toml").is_file():
            return place
    raise VibeError("The add-on's files are missing.", "Reinstall vibe-render, or run it from a clone.")


def _blender_tool() -> Path:
    """Blender's own extension tool, which comes with the bpy package (and needs no Blender to run)."""
    spec = importlib.util.find_spec("bpy")
    for place in (spec.submodule_search_locations or []) if spec else []:
        for tool in Path(place).glob("*/scripts/addons_core/bl_pkg/cli/blender_ext.py"):
            return tool
    raise VibeError(
        "Blender's packing tool was not found.", "Install it with `pip install bpy` on Python 3.11 or 3.13."
    )


def _ask(tool: Path, *arguments: str) -> None:
    """Runs Blender's tool; its complaint becomes the error."""
    done = subprocess.run([sys.executable, str(tool), *arguments], capture_output=True, text=True)
    if done.returncode:
        said = (done.stderr or done.stdout).strip().rpartition("\n")[2]
        raise VibeError(
            f"Blender's tool refused to {arguments[0]} the extension: {said}", "Report this as a bug."
        )


def _deliver(made: Path, out: Path) -> Path:
    """Moves the zip into place in one step, so that a broken one is never found there."""
    try:
        out.mkdir(parents=True, exist_ok=True)
        part = out / f".{made.name}.part"
        shutil.copyfile(made, part)
        os.replace(part, out / made.name)
    except OSError as error:
        raise VibeError(
            f"Cannot write to {out}: {error.strerror}.", "Choose another folder with --out."
        ) from error
    return out / made.name
