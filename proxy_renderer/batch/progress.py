# SPDX-License-Identifier: Apache-2.0
"""A batch's progress: a bar in a terminal, a line for each job elsewhere."""

from __future__ import annotations

import sys
import time
from types import TracebackType
from typing import Any, TextIO

from .plan import Job
from .store import JobRow


class BatchProgress:
    """Counts jobs and shows them. Use it as a context manager around the batch.

    Args:
        done: Those that had been done before.
        stream: Where to; standard output if None.

    Attributes:
        counts: Jobs by "done", "failed" and "running".
    """

    def __init__(self, total: int, done: int, stream: TextIO | None = None) -> None:
        self._total, self._before = total, done
        self._stream = stream or sys.stdout
        self._start = time.monotonic()
        self.counts = {"done": done, "failed": 0, "running": 0}
        self._bar: Any = None
        self._task: Any = None

    def __enter__(self) -> BatchProgress:
        if self._stream.isatty():
            from rich.console import Console
            from rich.progress import BarColumn, TextColumn, TimeElapsedColumn
            from rich.progress import Progress as Bar

            columns = (
                TextColumn("{task.completed:.0f}/{task.total:.0f} jobs"),
                BarColumn(bar_width=32),
                TextColumn("{task.description}"),
                TimeElapsedColumn(),
            )
            self._bar = Bar(*columns, console=Console(file=self._stream))
            self._task = self._bar.add_task(self._state(), total=self._total, completed=self._before)
            self._bar.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._bar is not None:
            self._bar.stop()
            self._bar = None

    def tell(self, what: str, job: Job, row: JobRow) -> None:
        """Counts and shows an event of a job.

        Args:
            what: "started", "done", "failed", "again" (it is tried once more) or "lost" (with its worker).
        """
        self.counts["running"] += 1 if what == "started" else -1
        if what in ("done", "failed"):
            self.counts[what] += 1
        if self._bar is not None:
            ended = self.counts["done"] + self.counts["failed"]
            self._bar.update(self._task, description=self._state(), completed=ended)
        if what == "failed" or (what != "started" and self._bar is None):
            self.note(self._line(what, job, row))

    def note(self, text: str) -> None:
        """A line that stays."""
        if self._bar is not None:
            self._bar.console.print(text, markup=False, highlight=False)
        else:
            print(text, file=self._stream, flush=True)

    def summary(self) -> str:
        """The outcome in one line."""
        seconds = time.monotonic() - self._start
        new = self.counts["done"] - self._before
        waiting = self._total - self.counts["done"] - self.counts["failed"]
        parts = [f"{self.counts['done']} of {self._total} jobs are done ({new} now, in {duration(seconds)})"]
        parts += [f"{self.counts['failed']} failed"] if self.counts["failed"] else []
        parts += [f"{waiting} wait"] if waiting else []
        return ", ".join(parts) + "."

    def _line(self, what: str, job: Job, row: JobRow) -> str:
        ended = self.counts["done"] + self.counts["failed"]
        who = f"{job.scene} · {job.prompt} · {job.seed}"
        if what == "done" and job.frames is not None:
            how = f"{row['seconds']:.0f} s, {row['frames']} frames"
        elif what == "done":
            how = f"{row['seconds']:.0f} s, delta E {row['delta_e']:.1f}"
        elif what == "lost":
            how = "its machine is lost; it will be done elsewhere"
        else:
            how = f"{row['error']}{' It will be tried again.' if what == 'again' else ''}"
        return f"[{ended}/{self._total}] {what:6} {who}: {how}   {self._left()}".rstrip()

    def _state(self) -> str:
        failed = f", {self.counts['failed']} failed" if self.counts["failed"] else ""
        return f"{self.counts['running']} running{failed}   {self._left()}"

    def _left(self) -> str:
        """Rate and time left, by the jobs that have ended since the start."""
        ended = self.counts["done"] + self.counts["failed"]
        if ended == self._before:
            return ""
        pace = (time.monotonic() - self._start) / (ended - self._before)
        return f"{3600 / pace:.0f} jobs/h, {duration(pace * (self._total - ended))} left"


def duration(seconds: float) -> str:
    """A time for people.

    >>> duration(45), duration(200), duration(7500)
    ('45 s', '3:20 min', '2:05 h')
    """
    if seconds < 60:
        return f"{seconds:.0f} s"
    if seconds < 3600:
        return f"{int(seconds) // 60}:{int(seconds) % 60:02d} min"
    return f"{int(seconds) // 3600}:{int(seconds) % 3600 // 60:02d} h"
