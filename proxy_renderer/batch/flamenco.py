# SPDX-License-Identifier: Apache-2.0
"""`vibe flamenco install`: the job type that brings a look to a Flamenco render farm."""

from __future__ import annotations

import json
from pathlib import Path

from ..blender.launch import blender_side
from ..schema import VibeError
from .store import write_bytes

NAME = "vibe-render.js"


def install(scripts: Path) -> Path:
    """Copies the job type to a Flamenco Manager's scripts; it proposes this installation's `batch.py`."""
    scripts = scripts.expanduser().resolve()
    if not scripts.parent.is_dir():
        raise VibeError(f"There is no folder {scripts.parent}.", "Name the folder of your Flamenco Manager.")
    scripts.mkdir(exist_ok=True)
    source = Path(__file__).with_name("flamenco.js").read_text("utf-8")
    script = json.dumps(blender_side().as_posix())[1:-1]
    write_bytes(scripts / NAME, source.replace("{{script}}", script).encode())
    return scripts / NAME
