# SPDX-License-Identifier: Apache-2.0
"""EEVEE's figures on the same scenes, from a Blender that has a window."""

from __future__ import annotations

import subprocess
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import torch

from lab.bench.metrics import difference
from proxy_renderer.engine.pictures import load_picture
from proxy_renderer.schema import VibeError

_DIGITS = 3
_FRAME = "EEVEE frame, ms: "
"""Mark that Blender's side prints before the time of a frame."""


def measure(
    blender: str, scenes: Mapping[str, dict[str, Any]], work: Path, size: int, failed: dict[str, str], frames: int = 1
) -> None:
    """Renders WORK/NAME/scene.blend to WORK/NAME/eevee.png, and adds the figures to the scenes' rows.

    Args:
        scenes: What has been measured, by name; gets `eevee_delta_e`, `eevee_psnr`, and `eevee_ms` of the last frame.
        failed: Gets the scenes that EEVEE did not render.
        frames: How often each is rendered; the first frame compiles shaders, too.
    """
    for number, (name, row) in enumerate(scenes.items(), 1):
        path = work / name / "eevee.png"
        path.unlink(missing_ok=True)
        printed = _render(blender, work / name / "scene.blend", size, frames)
        times = [line.removeprefix(_FRAME) for line in printed if line.startswith(_FRAME)]
        if not (path.is_file() and times):
            failed[name] = f"EEVEE rendered nothing; Blender said last: {(printed or ['nothing'])[-1][:200]}"
            continue
        picture, reference = (torch.from_numpy(load_picture(p).copy()) for p in (path, work / name / "cycles.png"))
        apart = difference(picture, reference)
        row |= {"eevee_delta_e": round(apart.delta_e, _DIGITS), "eevee_psnr": round(apart.psnr, _DIGITS)}
        row["eevee_ms"] = float(times[-1])
        print(f"[{number}/{len(scenes)}] {name}: EEVEE {apart.delta_e:.2f}", flush=True)


def _render(blender: str, scene: Path, size: int, frames: int) -> list[str]:
    """Renders one file; a Blender for each, for one that opens a second file may crash on a software display.

    Returns:
        The lines that Blender printed.
    """
    command = [blender, "--python-exit-code", "1", "--python", str(_script()), "--"]
    command += [str(size), str(frames), str(scene)]
    try:
        done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True, errors="replace")
    except OSError as error:
        raise VibeError(f"{blender} does not start: {error.strerror}.", "Name a Blender with --eevee.") from error
    return [line.strip() for line in (done.stdout + done.stderr).splitlines() if line.strip()]


def _script() -> Path:
    """The script that Blender runs."""
    return Path(__file__).parents[1] / "blender" / "eevee.py"
