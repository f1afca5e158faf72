# SPDX-License-Identifier: Apache-2.0
"""Starts Blender in a process of its own and shows its progress.

Blender's side (`vibe_render/batch.py --events`) prints lines `VIBE {json}`: "stage", "progress",
"result" and "error", besides whatever Blender itself prints.
"""

from __future__ import annotations

import importlib.util
import json
import os
import signal
import subprocess
import sys
import tempfile
from collections import deque
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from ..schema import VibeError, errors
from .crashes import crash, temporary, tidy
from .progress import VibeProgress

_MARK = "VIBE "


def launch(arguments: list[str], out: Path, progress: VibeProgress | None = None) -> int:
    """Runs batch.py with these arguments to its end; returns the command's exit code: 0, or 130 after a second Ctrl-C.

    Ctrl-C is passed on once, and Blender's side then finishes with the best so far; a second one ends it at once. The artist
    is told to open OUT at the end. Raises VibeError: what Blender's side reports, or that it died.
    """
    told = progress is None
    progress = progress or VibeProgress()
    progress.stage(doing := "starting Blender")
    tail: deque[str] = deque(maxlen=400)
    failure: VibeError | None = None
    scratch = tempfile.TemporaryDirectory(prefix="vibe-", ignore_cleanup_errors=True)
    with scratch as folder, progress:
        process = start([str(blender_side()), "--events", *arguments], Path(folder), **_own_group())
        with _forwarded_interrupts(process, progress) as presses:
            for event in events(process, tail):
                doing = event["name"] if event.get("type") == "stage" else doing
                if event.get("type") == "error":
                    kind = errors.UnexpectedError if event.get("unexpected") else VibeError
                    failure = kind(event.get("message", "It failed."), event.get("remedy", ""))
                else:
                    progress.show(event)
            code = process.wait()
    tidy(out if out.is_dir() else out.parent, process.pid)
    if failure:
        raise failure
    if len(presses) > 1:
        return 130
    if code != 0:
        raise crash(code, doing, tail)
    if told:
        progress.end(out)
    return 0


def start(arguments: Sequence[str], scratch: Path | None = None, **options: Any) -> subprocess.Popen[str]:
    """Python with these arguments, as a Blender whose `events` can be read; its temporary files go to `scratch`."""
    return subprocess.Popen(
        [sys.executable, *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        stdin=subprocess.DEVNULL,
        encoding="utf-8",
        errors="replace",
        env=environment() | (temporary(scratch) if scratch else {}),
        **options,
    )


def events(process: subprocess.Popen[str], tail: deque[str]) -> Iterator[dict[str, Any]]:
    """The events among the lines that Blender's side prints, as they come.

    All other lines, Blender's own and broken events, go to the tail.
    """
    assert process.stdout is not None
    for line in process.stdout:
        if line.startswith(_MARK):
            try:
                yield json.loads(line[len(_MARK) :])
                continue
            except ValueError:
                pass
        tail.append(line)


@contextmanager
def _forwarded_interrupts(process: subprocess.Popen[str], progress: VibeProgress) -> Iterator[list[int]]:
    """Lets Ctrl-C and termination reach Blender's side inside the block; yields the list of presses, as it grows."""
    presses: list[int] = []

    def on_signal(number: int, frame: Any) -> None:
        presses.append(number)
        if len(presses) == 1:
            progress.note("Stopping with the best so far … (Ctrl-C again to give up)")
            interrupt = signal.SIGINT if os.name != "nt" else signal.CTRL_BREAK_EVENT  # type: ignore[attr-defined]
            process.send_signal(interrupt)
        else:
            process.kill()

    before = {number: signal.signal(number, on_signal) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield presses
    finally:
        for number, handler in before.items():
            signal.signal(number, handler or signal.SIG_DFL)  # None: it was not set from Python


def _own_group() -> dict[str, Any]:
    """A terminal sends Ctrl-C to its whole group; Blender's side gets it from here, once."""
    if os.name == "nt":
        return {"creationflags": subprocess.CREATE_NEW_PROCESS_GROUP}  # type: ignore[attr-defined]
    return {"start_new_session": True}


def blender_side() -> Path:
    """Where batch.py is: in the installed package, or in the clone that this file is in; raises VibeError if in neither."""
    spec = importlib.util.find_spec("vibe_render")
    places = [Path(p) for p in (spec.submodule_search_locations or [])] if spec else []
    places.append(Path(__file__).resolve().parents[2] / "addon" / "vibe_render")
    for place in places:
        if (place / "batch.py").is_file():
            return place / "batch.py"
    raise VibeError(
        "The Blender side of vibe-render is missing.",
        "Install it again: `pip install .` in a clone of Vibe Render.",
    )


def environment() -> dict[str, str]:
    """For Blender's side: this process's environment, with a clone's own packages first."""
    root = Path(__file__).resolve().parents[2]
    paths = [str(root), str(root / "addon")] if (root / "addon").is_dir() else []
    inherited = filter(None, [os.environ.get("PYTHONPATH", "")])
    return {**os.environ, "PYTHONPATH": os.pathsep.join([*paths, *inherited]), "PYTHONUNBUFFERED": "1"}
