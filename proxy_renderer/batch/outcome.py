# SPDX-License-Identifier: Apache-2.0
"""The files of a finished job for the sheet: its row, small pictures, and its parameters with their reasons."""

from __future__ import annotations

import io
import json
from pathlib import Path
from typing import Any

from PIL import Image

from ..schema import VibeError, labels
from .plan import Job
from .store import DONE, FINAL, FRAMES, JobRow, head, read_json, write_bytes, write_json

_THUMB = 480  # pixels, the longer side
_PICTURES = ("before", "after")
_ENGINE, _CYCLES = "engine: loop", ("render before", "render after")


def leave(job: Job, folder: Path, memory_gb: float, seconds: float) -> JobRow:
    """Completes a job's folder after Blender has written its files; `done.json` is written last.

    Args:
        folder: Of the job, with Blender's report in it.
        seconds: The job's time on the clock.

    Returns:
        The job's row, as it is in `done.json`.

    Raises:
        VibeError: Something is missing, or cannot be written.
    """
    report = read_json(folder / "report.json")
    if report is None:
        raise VibeError(f"{folder.name} holds no report.", "See the job's log.")
    shots = report.get("shots", [])
    for name in [Path(shot[kind]).stem for shot in shots for kind in ("before", "after")] or _PICTURES:
        _thumb(folder, name)
    write_bytes(folder / "details.js", _details(job, report))
    laps = report.get("timings", {})
    row = head(job) | {
        "status": "done",
        "similarity": report["similarity"]["after"],
        "similarity_before": report["similarity"]["before"],
        "delta_e": report["delta_e"],
        "seconds": round(seconds, 2),
        "seconds_loop": laps.get(_ENGINE, 0.0),
        "seconds_cycles": round(sum(laps.get(name, 0.0) for name in _CYCLES), 2),
        "memory_gb": memory_gb,
    }
    row |= {"shots": [shot["name"] for shot in shots]} if shots else {}
    row |= {"variants": len(report["variants"])} if report.get("variants") else {}
    write_json(folder / DONE, row)
    return row


def leave_frames(job: Job, folder: Path, memory_gb: float, seconds: float) -> JobRow:
    """Completes a job's folder after its final frames have been rendered.

    Args:
        job: The job, with its `frames`.
        folder: Of the job, with the frames in it.
        seconds: The render's time on the clock.

    Returns:
        The job's row, with the frames that were wanted and how many pictures there are.

    Raises:
        VibeError: The row cannot be written.
    """
    count = sum(1 for _ in (folder / FRAMES).rglob("*.png"))
    row = head(job) | {"status": "done", "wanted": job.frames, "frames": count}
    row |= {"seconds": round(seconds, 2), "memory_gb": memory_gb}
    write_json(folder / FINAL, row)
    return row


def _thumb(folder: Path, name: str) -> None:
    """A small JPEG of a picture."""
    content = io.BytesIO()
    try:
        with Image.open(folder / f"{name}.png") as picture:
            flat = picture.convert("RGB")
    except OSError as error:
        raise VibeError(f"{name}.png cannot be read: {error}.", "See the job's log.") from error
    flat.thumbnail((_THUMB, _THUMB), Image.Resampling.LANCZOS)
    flat.save(content, "JPEG", quality=88)
    write_bytes(folder / f"{name}.jpg", content.getvalue())


def _details(job: Job, report: dict[str, Any]) -> bytes:
    """What the sheet shows of a job on demand: a script, because pages from disk may load nothing else."""
    parameters = report.get("parameters", {})
    largest_first = sorted(parameters.items(), key=lambda item: -item[1].get("moved", 0.0))
    rows = [row for key, change in largest_first if (row := _changed(key, change))]
    understood = report.get("understood", {})
    content = {
        "parameters": rows,
        "left": len(parameters) - len(rows),
        "warnings": report.get("warnings", []),
        "understood": {
            k: understood[k] for k in ("whole", "ignored", "guesses", "notes") if understood.get(k)
        },
        "timings": report.get("timings", {}),
        "versions": report.get("versions", {}),
    }
    return f"vibeDetails({json.dumps(job.name)}, {json.dumps(content, ensure_ascii=False)});\n".encode()


def _changed(key: str, change: dict[str, Any]) -> list[Any] | None:
    """A parameter's name, old value, new value and reason, for people; None if the values read the same."""
    before, after = (tuple(v) if isinstance(v, list) else (v,) for v in (change["before"], change["after"]))
    if labels.same(key, before, after):
        return None
    if len(after) == 1:
        return [labels.title(key), labels.bare(key, before), labels.text(key, after), change["reason"]]
    return [labels.title(key), before, after, change["reason"]]
