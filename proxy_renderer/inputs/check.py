# SPDX-License-Identifier: Apache-2.0
"""Checks of a command's arguments before anything is started. A mistake raises VibeError."""

import argparse
import os
import re
from collections.abc import Sequence
from pathlib import Path

from ..schema import VibeError, frame_numbers
from ..schema.limits import MESH_FORMATS
from ..schema.options import checks

SCENES = (".blend", *MESH_FORMATS)
_DEVICE = re.compile(r"auto|cpu|(cuda|xpu)(:\d+)?")


def file(name: str, what: str) -> Path:
    """The absolute path of an existing, readable file that is not empty; `what`: its kind in error messages."""
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
    """The absolute path of an existing .blend or mesh. Raises VibeError if there is none, or for other formats."""
    path = file(name, "scene")
    if path.suffix.lower() not in SCENES:
        raise VibeError(f"{name} is not a scene that can be opened.", f"Use one of: {' '.join(SCENES)}.")
    return path


def shots(scenes: Sequence[Path], arguments: argparse.Namespace) -> list[Path]:
    """The scenes, each once; raises VibeError if they cannot share a look, or if other options do not fit them."""
    frames = frame_numbers(arguments.frames)
    cameras = [name for part in arguments.cameras for name in part.split(",") if name.strip()]
    several = max(len(scenes), len(frames), len(cameras)) > 1
    if (arguments.moments or arguments.markers) and (several or scenes[0].suffix.lower() != ".blend"):
        raise VibeError("Moments belong to one .blend and one camera.", "Give one of each.")
    if several and any(path.suffix.lower() != ".blend" for path in scenes):
        raise VibeError("Only .blends can share a look.", "Give bare meshes one at a time.")
    if several and "camera" in checks.groups(arguments.groups):
        raise VibeError("Shots that share a look keep their cameras.", "Leave camera out of --groups.")
    checks.shots(arguments, several)
    if arguments.grade_each and not several:
        raise VibeError("--grade-each is for several shots.", "Name --cameras, --frames or more scenes.")
    return list(dict.fromkeys(scenes))


def preset(name: str) -> str:
    """The path of an existing preset file; otherwise the name, which Blender's side looks up in the library."""
    if name.endswith(".json") or "/" in name or os.sep in name or Path(name).exists():
        return str(file(name, "preset"))
    if not name.strip() or name.startswith("-"):
        raise VibeError("That is no preset.", "Name a preset.json, or a preset of the library.")
    return name


def goals(name: str) -> str:
    """The path of a file of goals whose fields are all valid; "" for none."""
    if not name:
        return ""
    from ..goals.written import read

    path = file(name, "list of goals")
    read(path)
    return str(path)


def words(prompt: str, arguments: argparse.Namespace) -> None:
    """Refuses a prompt without a known look word, unless a vision-language model is configured, which knows more words."""
    from ..schema.messages import Options
    from ..vlm.endpoint import find_endpoint
    from ..words.parser import refuse_without_look

    if find_endpoint(Options(vlm_model=arguments.vlm_model, vlm_url=arguments.vlm_url)) is None:
        refuse_without_look(prompt)


def vocabulary(name: str) -> None:
    """Checks a vocabulary file by loading it, and sets it for this process and its children; "": the default file."""
    from ..words.lexicon.vocabulary import VARIABLE, default_vocabulary

    if name:
        os.environ[VARIABLE] = str(file(name, "vocabulary"))
    default_vocabulary()


def device(name: str) -> None:
    """Raises VibeError unless a name is auto, cpu, cuda or xpu, the last two with or without a number."""
    if not _DEVICE.fullmatch(name):
        raise VibeError(f"Unknown device {name!r}.", "Use auto, cpu, cuda or cuda:1; `vibe doctor` lists yours.")
