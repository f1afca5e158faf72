# SPDX-License-Identifier: Apache-2.0
"""A warm Blender that carries out one job after another, each within its limits.

It is a process that runs `batch.py serve`, with the engine as its child. Whatever goes wrong in a job is recorded;
after a crash, or when a limit has been hit, the next job gets a fresh process.
"""

from __future__ import annotations

import contextlib
import json
import os
import queue
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, TextIO

from ..blender import crashes
from ..blender.crashes import temporary
from ..blender.launch import blender_side, environment
from ..blender.meshes import prepared
from ..schema import VibeError
from .manifest.manifest import Limits
from .outcome import leave, leave_frames
from .plan import Job
from .store import FRAMES, LOG, JobRow, head, tidy

_MARK = "VIBE "
_TICK = 0.5
"""Seconds between two looks at the clock and at the memory."""


@dataclass(frozen=True)
class Setup:
    """How workers are started.

    Attributes:
        limits: Of each job.
        variables: Of the environment, besides those that are there.
        command: The program that carries out jobs; empty for Blender.
    """

    limits: Limits = field(default_factory=Limits)
    variables: dict[str, str] = field(default_factory=dict)
    command: tuple[str, ...] = ()


class Interrupted(Exception):
    """The worker was closed in the middle of a job."""


class Worker:
    """One process at a time, started when it is needed.

    Args:
        cores: Numbers of the cores that it keeps to; empty for all.
    """

    def __init__(self, setup: Setup, cores: Sequence[int] = ()) -> None:
        self._setup, self._cores = setup, list(cores)
        self._process: subprocess.Popen[str] | None = None
        self._lines: queue.SimpleQueue[str | None] = queue.SimpleQueue()
        self._closed = False

    def run(self, job: Job, folder: Path) -> JobRow:
        """Carries out a job; its files go to the folder, `done.json` last.

        Args:
            folder: Of the job; what an earlier attempt left there is removed.

        Returns:
            The job's row, of status "done" or "failed".

        Raises:
            Interrupted: The worker was closed meanwhile.
        """
        start = time.monotonic()
        tidy(folder)
        watch = _Watch(self._setup.limits)
        try:
            with prepared(job.source) as source, (folder / LOG).open("a", encoding="utf-8") as log:
                for order in _orders(replace(job, source=source), folder):
                    self._carry_out(order, log, watch)
            complete = leave if job.frames is None else leave_frames
            return complete(job, folder, watch.peak_gb, time.monotonic() - start)
        except VibeError as error:
            if self._closed:
                raise Interrupted from error
            seconds = round(time.monotonic() - start, 2)
            failure = {"error": error.message, "remedy": error.remedy}
            return head(job) | {"status": "failed", "seconds": seconds, "memory_gb": watch.peak_gb} | failure

    def close(self) -> None:
        """Ends the process and all of its children now; a running job is interrupted."""
        self._closed = True
        self._kill()

    def _carry_out(self, arguments: list[str], log: TextIO, watch: _Watch) -> None:
        """Gives an order and waits for its end."""
        process = self._started()
        print(f"\n== {time.strftime('%Y-%m-%d %H:%M:%S')}  {' '.join(arguments)}", file=log, flush=True)
        assert process.stdin is not None
        with contextlib.suppress(OSError):  # it has died: the end of its output tells
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
                said = f' Its last words: "{last[:200]}".' if last else ""
                raise VibeError(f"Blender crashed (exit code {code}).{said}", "See the job's log.")
            event = _event(line)
            if event.get("type") != "progress" and line:
                log.write(line)
                log.flush()
            if event.get("type") == "error":
                raise VibeError(event.get("message", "It failed."), event.get("remedy", ""))
            if event.get("type") == "result":
                return
            last = line.strip() if line.strip() and not event else last
            try:
                watch.look(process.pid)
            except VibeError:
                self._kill()
                raise

    def _started(self) -> subprocess.Popen[str]:
        if self._process and self._process.poll() is None:
            return self._process
        if self._closed:
            raise VibeError("The worker is closed.")
        threads = str(self._setup.limits.cores)
        self._scratch = tempfile.TemporaryDirectory(prefix="vibe-", ignore_cleanup_errors=True)
        process = self._process = subprocess.Popen(
            self._setup.command or (sys.executable, str(blender_side()), "--events", "serve"),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            encoding="utf-8",
            errors="replace",
            env=environment()
            | temporary(Path(self._scratch.name))
            | self._setup.variables
            | {"OMP_NUM_THREADS": threads},
            start_new_session=True,  # Ctrl-C is for the batch, which ends its workers itself
        )
        if self._cores and hasattr(os, "sched_setaffinity"):
            os.sched_setaffinity(process.pid, self._cores)
        self._lines = queue.SimpleQueue()
        threading.Thread(target=_read, args=(process, self._lines), daemon=True).start()
        return process

    def _kill(self) -> None:
        process, self._process = self._process, None
        if process is None:
            return
        crashes.kill(process.pid)
        process.wait()
        assert process.stdin is not None
        with contextlib.suppress(OSError):
            process.stdin.close()
        self._scratch.cleanup()


def _orders(job: Job, folder: Path) -> list[list[str]]:
    """The command lines of Blender's side: one for a vibe, one for each of its takes."""
    sources = [str(job.source), *map(str, job.more)]
    if job.frames is None:
        return [["run", *sources, *job.arguments, f"--out={folder}"]]
    return [
        [
            "frames",
            sources[take.blend],
            *([f"--cameras={take.camera}"] if take.camera else []),
            f"--frames={take.frames}",
            f"--out={folder / FRAMES / take.folder}",
        ]
        for take in job.takes
    ]


class _Watch:
    """A job's clock and its memory."""

    def __init__(self, limits: Limits) -> None:
        self._limits = limits
        self._end = time.monotonic() + 60 * limits.minutes
        self._next = 0.0
        self.peak_gb = 0.0

    def look(self, pid: int) -> None:
        """Raises VibeError if a limit has been passed."""
        now = time.monotonic()
        if now > self._end:
            raise VibeError(
                f"It took longer than {self._limits.minutes:g} minutes.", "Raise [limits] minutes."
            )
        if now < self._next:
            return
        self._next = now + _TICK
        used = crashes.memory(pid)
        self.peak_gb = max(self.peak_gb, round(used / 1e9, 3))
        if used > self._limits.memory_gb * 1e9:
            raise VibeError(
                f"It used {used / 1e9:.1f} GB of memory, more than {self._limits.memory_gb:g}.",
                "Raise [limits] memory_gb, or use a smaller size.",
            )


def _read(process: subprocess.Popen[str], lines: queue.SimpleQueue[str | None]) -> None:
    assert process.stdout is not None
    with process.stdout as output:
        for line in output:
            lines.put(line)
    lines.put(None)


def _event(line: str) -> dict[str, Any]:
    """What a line of Blender's side says, if it is one of those."""
    if not line.startswith(_MARK):
        return {}
    try:
        return json.loads(line[len(_MARK) :])
    except ValueError:
        return {}
