# SPDX-License-Identifier: Apache-2.0
"""What can be wrong with a command, found before anything is started. Everything raises VibeError."""

from __future__ import annotations

import argparse
import os
import re
import tempfile
from collections.abc import Sequence
from pathlib import Path

from ..schema import GROUPS, VibeError, budgets, frame_numbers

STAGES = ("none", "floor", "cyclorama")
SCENES = (".blend", ".obj", ".glb", ".gltf", ".ply", ".stl")
LONGEST_PROMPT = 1000
_RANGES = {
    "rounds": (1, 1000),
    "steps": (1, 10000),
    "starts": (1, 1000),
    "variants": (1, 12),
    "top_k": (1, 10000),
    "seed": (0, 2**31 - 1),
    "size": (32, 8192),
    "samples": (1, 65536),
}
_DEVICE = re.compile(r"auto|cpu|(cuda|xpu)(:\d+)?")


def file(name: str, what: str) -> Path:
    """An existing file that can be read."""
    path = Path(name).expanduser()
    if path.is_dir():
        raise VibeError(f"{name} is a folder, not a {what}.", f"Name the {what} file in it.")
    if not path.is_file():
        raise VibeError(f"There is no {what} {name}.", "Check the path.")
    if not os.access(path, os.R_OK):
        raise VibeError(f"{name} cannot be read.", "Check its permissions.")
    if path.stat().st_size == 0:
        raise VibeError(f"{name} is empty.", f"Use another {what} file.")
    return path.resolve()


def scene(name: str) -> Path:
    """An existing .blend or mesh."""
    path = file(name, "scene")
    if path.suffix.lower() not in SCENES:
        raise VibeError(f"{name} is not a scene that can be opened.", f"Use one of: {' '.join(SCENES)}.")
    return path


def shots(scenes: Sequence[Path], arguments: argparse.Namespace) -> list[Path]:
    """Scenes, cameras and frames that can share a look: what is named once.

    Raises:
        VibeError: Bare meshes among several scenes, frames that are none, or a camera that would have to move.
    """
    frames = frame_numbers(arguments.frames)
    cameras = [name for part in arguments.cameras for name in part.split(",") if name.strip()]
    several = max(len(scenes), len(frames), len(cameras)) > 1
    if several and any(path.suffix.lower() != ".blend" for path in scenes):
        raise VibeError("Only .blends can share a look.", "Give bare meshes one at a time.")
    if several and "camera" in groups(arguments.groups):
        raise VibeError("Shots that share a look keep their cameras.", "Leave camera out of --groups.")
    if arguments.grade_each and not several:
        raise VibeError("--grade-each is for several shots.", "Name --cameras, --frames or more scenes.")
    return list(dict.fromkeys(scenes))


def preset(name: str) -> str:
    """An existing preset file, or what may be a name in the library, which the Blender side knows."""
    if name.endswith(".json") or "/" in name or os.sep in name or Path(name).exists():
        return str(file(name, "preset"))
    if not name.strip() or name.startswith("-"):
        raise VibeError("That is no preset.", "Name a preset.json, or a preset of the library.")
    return name


def prompt(text: str) -> str:
    """A prompt with something in it, of a length that a person types."""
    if not text.strip():
        raise VibeError(
            "The prompt is empty.", 'Describe the look: --prompt "misty, cool blue fog, vignette".'
        )
    if len(text) > LONGEST_PROMPT:
        raise VibeError(
            f"The prompt has {len(text)} characters, more than {LONGEST_PROMPT}.",
            "A sentence or two is best.",
        )
    return text


def words(text: str) -> None:
    """At least one word of the prompt names a look."""
    from ..prompt.parser import parse
    from ..prompt.types import SceneWords

    parse(text, SceneWords())


def model(arguments: argparse.Namespace) -> bool:
    """Whether a vision-language model is configured, and rightly: it knows more words than we do."""
    from ..schema.messages import Options
    from ..vlm.endpoint import find_endpoint

    options = Options(vlm_model=arguments.vlm_model, vlm_url=arguments.vlm_url)
    return find_endpoint(options) is not None and not arguments.baseline


def vocabulary(name: str) -> None:
    """The artist's own words, if any, can be used; this process and those that it starts will use them."""
    from ..prompt.lexicon.user_words import VARIABLE, default_vocabulary

    if name:
        os.environ[VARIABLE] = str(file(name, "vocabulary"))
    default_vocabulary()


def numbers(arguments: argparse.Namespace) -> None:
    """Every number within its range; those that the budget decides are filled in."""
    if hasattr(arguments, "budget"):
        budgets.fill(arguments)
    for name, (low, high) in _RANGES.items():
        value = getattr(arguments, name, low)
        if not low <= value <= high:
            raise VibeError(f"--{name.replace('_', '-')} {value} is out of range.", f"Use {low} to {high}.")


def groups(given: Sequence[str]) -> list[str]:
    """Group names from "a,b" lists."""
    names = [g for part in given for g in re.split(r"[,\s]+", part) if g]
    if given and not names:
        raise VibeError("--groups names no group.", f"Use some of: {', '.join(GROUPS)}.")
    for name in names:
        if name not in GROUPS:
            raise VibeError(f"Unknown group {name!r}.", f"Use some of: {', '.join(GROUPS)}.")
    return list(dict.fromkeys(names))


def locks(patterns: Sequence[str]) -> None:
    """Patterns that could match something in a scene; whether they do, the scene will tell."""
    for pattern in patterns:
        head = pattern.partition("/")[0]
        if head not in GROUPS and not any(c in head for c in "*?["):
            raise VibeError(
                f"The lock {pattern!r} can match nothing.",
                f"Start it with a group ({', '.join(GROUPS)}) or a *, as in light/Key or */roughness.",
            )


def device(name: str) -> None:
    """A device name that torch could know."""
    if not _DEVICE.fullmatch(name):
        raise VibeError(
            f"Unknown device {name!r}.", "Use auto, cpu, cuda or cuda:1; `vibe doctor` lists yours."
        )


def folder(path: Path) -> Path:
    """An output folder that exists now and can be written."""
    path = path.expanduser()
    try:
        path.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=path):
            pass
    except OSError as error:
        reason = error.strerror or type(error).__name__
        raise VibeError(
            f"The folder {path} cannot be written ({reason}).", "Choose another with --out."
        ) from error
    return path.resolve()
