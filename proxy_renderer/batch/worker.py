# SPDX-License-Identifier: Apache-2.0
"""A Blender process that stays open from job to job, and the files of a finished job for the contact sheet."""

import contextlib
import io
import json
import os
import queue
import subprocess
import tempfile
import threading
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TextIO

from PIL import Image

from ..blender import launch
from ..blender.meshes import prepared
from ..schema import VibeError, labels
from .manifest import Job, Limits
from .store import DONE, FINAL, FRAMES, LOG, WORDS, JobRow, head, read_json, tidy, write_bytes, write_json

_THUMB = 480  # pixels, the longer side
_PICTURES, _UNDERSTOOD = ("before", "after"), ("ignored", "guesses", "notes")
_ENGINE, _CYCLES = "engine: loop", ("render before", "render after")
_TICK = 0.5  # seconds between two checks of a job's time and memory


def leave(job: Job, folder: Path, memory_gb: float, seconds: float) -> JobRow:
    """Adds small images, details.js and, last, done.json to a finished vibe's folder; returns the job's row.

    `memory_gb` and `seconds` are the job's peak memory and duration. Raises VibeError without its report or images.
    """
    report = read_json(folder / "report.json")
    if report is None:
        raise VibeError(f"{folder.name} holds no report.", "See the job's log.")
    shots = report.get("shots", [])
    # small images for the sheet
    for name in [Path(shot[kind]).stem for shot in shots for kind in _PICTURES] or _PICTURES:
        content = io.BytesIO()
        try:
            with Image.open(folder / f"{name}.png") as picture:
                flat = picture.convert("RGB")
        except OSError as error:
            raise VibeError(f"{name}.png cannot be read: {error}.", "See the job's log.") from error
        flat.thumbnail((_THUMB, _THUMB), Image.Resampling.LANCZOS)
        flat.save(content, "JPEG", quality=88)
        write_bytes(folder / f"{name}.jpg", content.getvalue())
    write_bytes(folder / "details.js", _details(job, report))
    laps = report.get("timings", {})
    words = [row for row in report["verdicts"] if row["word"]]  # verdicts on the first shot
    row = head(job) | {"status": "done"}
    row |= {state: [row["word"] for row in words if row["state"] == state] for state in WORDS}
    row |= {"delta_e": report["delta_e"], "seconds": round(seconds, 2), "seconds_loop": laps.get(_ENGINE, 0.0)}
    row |= {"seconds_cycles": round(sum(laps.get(name, 0.0) for name in _CYCLES), 2), "memory_gb": memory_gb}
    row |= {"shots": [shot["name"] for shot in shots]} if shots else {}
    row |= {"variants": len(report["variants"])} if report.get("variants") else {}
    write_json(folder / DONE, row)
    return row


def leave_frames(job: Job, folder: Path, memory_gb: float, seconds: float) -> JobRow:
    """Writes final.json after a job's final frames have been rendered; returns the job's row. Arguments as `leave`."""
    count = sum(1 for _ in (folder / FRAMES).rglob("*.png"))
    row = head(job) | {"status": "done", "wanted": job.frames, "frames": count}
    row |= {"seconds": round(seconds, 2), "memory_gb": memory_gb}
    write_json(folder / FINAL, row)
    return row


def _details(job: Job, report: dict[str, Any]) -> bytes:
    """details.js, a job's details for the sheet: a script, because pages opened from disk can load nothing else."""
    parameters = report.get("parameters", {})
    rows = []  # label, old value, new value and reason of each parameter whose values differ as text
    for key, change in sorted(parameters.items(), key=lambda item: -item[1].get("moved", 0.0)):
        before, after = (tuple(v) if isinstance(v, list) else (v,) for v in (change["before"], change["after"]))
        if labels.same(key, before, after):
            continue
        shown = (labels.bare(key, before), labels.text(key, after)) if len(after) == 1 else (before, after)
        rows.append([labels.title(key), *shown, change["reason"]])
    understood = report.get("understood", {})
    content = {
        "parameters": rows,
        "left": len(parameters) - len(rows),
        "warnings": report.get("warnings", []),
        "understood": {name: understood[name] for name in _UNDERSTOOD if understood.get(name)},
    }
    return f"vibeDetails({json.dumps(job.name)}, {json.dumps(content, ensure_ascii=False)});\n".encode()


@dataclass(frozen=True)
class Setup:
    """Limits, environment and program of workers."""

    limits: Limits = field(default_factory=Limits)  # of each job
    variables: dict[str, str] = field(default_factory=dict)  # environment variables to add
    command: tuple[str, ...] = ()  # Python's arguments for the script that carries out jobs; () for Blender's side


class Interrupted(Exception):
    """The worker was closed in the middle of a job."""


class Worker:
    """Carries out jobs in one Blender process, started when needed; `cores`: numbers of its CPU cores, () for all."""

    def __init__(self, setup: Setup, cores: Sequence[int] = ()) -> None:
        self._setup, self._cores = setup, list(cores)
        self._start, self._next_check, self._peak_gb = 0.0, 0.0, 0.0  # of the job; seconds and gigabytes
        self._process: subprocess.Popen[str] | None = None
        self._lines: queue.SimpleQueue[str | None] = queue.SimpleQueue()
        self._closed = False

    def run(self, job: Job, folder: Path) -> JobRow:
        """Carries out a job in `folder`; its row is "done" or "failed". Raises Interrupted if the worker was closed."""
        self._start, self._next_check, self._peak_gb = time.monotonic(), 0.0, 0.0
        tidy(folder)
        try:
            with prepared(job.source) as source, (folder / LOG).open("a", encoding="utf-8") as log:
                sources = [str(source), *map(str, job.more)]
                if job.frames is None:
                    self._carry_out(["run", *sources, *job.arguments, f"--out={folder}"], log)
                for take in job.takes:  # of a job of final frames
                    camera = [f"--cameras={take.camera}"] if take.camera else []
                    place = [f"--frames={take.frames}", f"--out={folder / FRAMES / take.folder}"]
                    self._carry_out(["frames", sources[take.blend], *camera, *place], log)
            complete = leave if job.frames is None else leave_frames
            return complete(job, folder, self._peak_gb, time.monotonic() - self._start)
        except VibeError as error:
            if self._closed:
                raise Interrupted from error
            seconds = round(time.monotonic() - self._start, 2)
            row = head(job) | {"status": "failed", "seconds": seconds, "memory_gb": self._peak_gb}
            return row | {"error": error.message, "remedy": error.remedy}

    def close(self) -> None:
        """Ends the process and all of its children now; a running job is interrupted."""
        self._closed = True
        self._kill()

    def _carry_out(self, arguments: list[str], log: TextIO) -> None:
        process = self._started()
        print(f"\n== {time.strftime('%Y-%m-%d %H:%M:%S')}  {' '.join(arguments)}", file=log, flush=True)
        assert process.stdin is not None
        with contextlib.suppress(OSError):  # if the process has died, the end of its output says so
            process.stdin.write(json.dumps(arguments) + "\n")
            process.stdin.flush()
        last = ""
        while True:
            try:
                line = self._lines.get(timeout=_TICK)
            except queue.Empty:
                line = ""
            if line is None:
                code = process.wait()
                self._kill()
                words = f' Its last words: "{last[:200]}".' if last else ""
                raise VibeError(f"Blender crashed (exit code {code}).{words}", "See the job's log.")
            event = launch.event(line) or {}
            if event.get("type") != "progress" and line:
                log.write(line)
                log.flush()
            if event.get("type") == "error":
                raise VibeError(event.get("message", "It failed."), event.get("remedy", ""))
            if event.get("type") == "result":
                return
            last = line.strip() if line.strip() and not event else last
            try:
                self._check_limits(process.pid)
            except VibeError:
                self._kill()
                raise

    def _started(self) -> subprocess.Popen[str]:
        if self._process and self._process.poll() is None:
            return self._process
        if self._closed:
            raise VibeError("The worker is closed.")
        self._scratch = tempfile.TemporaryDirectory(prefix="vibe-", ignore_cleanup_errors=True)
        process = self._process = launch.start(
            self._setup.command or (str(launch.blender_side()), "--events", "serve"),
            Path(self._scratch.name),
            self._setup.variables | {"OMP_NUM_THREADS": str(self._setup.limits.cores)},
            stdin=subprocess.PIPE,
            start_new_session=True,  # Ctrl-C is for the batch, which ends its workers itself
        )
        if self._cores and hasattr(os, "sched_setaffinity"):
            os.sched_setaffinity(process.pid, self._cores)
        self._lines = queue.SimpleQueue()
        threading.Thread(target=_read, args=(process, self._lines), daemon=True).start()
        return process

    def _check_limits(self, pid: int) -> None:
        """Raises VibeError if the job has taken too long, or uses too much memory."""
        limits, now = self._setup.limits, time.monotonic()
        if now > self._start + 60 * limits.minutes:
            raise VibeError(f"It took longer than {limits.minutes:g} minutes.", "Raise [limits] minutes.")
        if now < self._next_check:
            return
        self._next_check = now + _TICK
        used = launch.memory(pid)
        self._peak_gb = max(self._peak_gb, round(used / 1e9, 3))
        if used > limits.memory_gb * 1e9:
            problem = f"It used {used / 1e9:.1f} GB of memory, more than {limits.memory_gb:g}."
            raise VibeError(problem, "Raise [limits] memory_gb, or use a smaller size.")

    def _kill(self) -> None:
        process, self._process = self._process, None
        if process is None:
            return
        launch.kill(process.pid)
        process.wait()
        assert process.stdin is not None
        with contextlib.suppress(OSError):
            process.stdin.close()
        self._scratch.cleanup()


def _read(process: subprocess.Popen[str], lines: queue.SimpleQueue[str | None]) -> None:
    assert process.stdout is not None
    with process.stdout as output:
        for line in output:
            lines.put(line)
    lines.put(None)
