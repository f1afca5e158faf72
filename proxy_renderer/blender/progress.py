# SPDX-License-Identifier: Apache-2.0
"""A vibe's progress, for people: a bar in a terminal, plain lines elsewhere."""

from __future__ import annotations

import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any, TextIO


class TerminalBar:
    """A bar in a terminal, plain lines elsewhere. Use it as a context manager; standard output if there is no stream."""

    def __init__(self, stream: TextIO | None = None) -> None:
        self._stream = stream or sys.stdout
        self._start = time.monotonic()
        self._bar: Any = None
        self._task: Any = None

    def _open(self, columns: Sequence[Any], description: str, **task: Any) -> None:
        """Starts a bar with one task."""
        from rich.console import Console
        from rich.progress import Progress

        transient = task.pop("transient", False)
        self._bar = Progress(*columns, transient=transient, console=Console(file=self._stream))
        self._task = self._bar.add_task(description, **task)
        self._bar.start()

    def __exit__(self, *_: object) -> None:
        if self._bar is not None:
            self._bar.stop()
            self._bar = None

    def note(self, text: str) -> None:
        """A line that stays."""
        if self._bar is not None:
            self._bar.console.print(text, markup=False, highlight=False)
        else:
            print(text, file=self._stream, flush=True)


class VibeProgress(TerminalBar):
    """Shows events as they come."""

    def __init__(self, stream: TextIO | None = None) -> None:
        super().__init__(stream)
        self._round = 0
        self._result: dict[str, Any] = {}

    def __enter__(self) -> VibeProgress:
        if self._stream.isatty():
            from rich.progress import BarColumn, SpinnerColumn, TextColumn, TimeElapsedColumn

            columns = (
                SpinnerColumn(),
                TextColumn("{task.description}"),
                BarColumn(bar_width=32),
                TextColumn("{task.fields[detail]}"),
                TimeElapsedColumn(),
            )
            self._open(columns, "starting Blender", total=None, detail="", transient=True)
        return self

    def show(self, event: dict[str, Any]) -> None:
        """Shows one event."""
        kind = event.get("type")
        if kind == "stage":
            self.stage(event["name"])
        elif kind == "note":
            self.note(f"Note: {event['line']}")
        elif kind == "progress":
            self._progress(event)
        elif kind == "result":
            self._result = event

    def stage(self, name: str) -> None:
        """Shows that a new stage begins."""
        if self._bar is not None:
            self._bar.update(self._task, description=name, total=None, detail="")
        else:
            self.note(f"{time.monotonic() - self._start:5.1f} s  {name}")

    def end(self, out: Path) -> None:
        """Prints the outcome, and the file or the comparison picture to open."""
        seconds = time.monotonic() - self._start
        for line in self._result.get("lines", []):
            self.note(line)
        picture = out / "compare.png"
        if self._result.get("stopped"):
            self.note("Stopped early: this is the best so far.")
        missing = ", ".join(self._result.get("missing", []))
        ended = f"Ended without {missing}, after" if missing else "Done in"
        self.note(f"{ended} {seconds:.0f} s. Open {picture if picture.is_file() else out}")

    def _progress(self, event: dict[str, Any]) -> None:
        number, rounds, steps = event["round"], event["rounds"], event["steps"]
        left = int(event["seconds_left"])
        detail = f"loss {event['loss']:.3f}   {left // 60}:{left % 60:02d} left"
        if self._bar is not None:
            done = (number - 1) * steps + event["step"]
            title = f"round {number} of {rounds}"
            self._bar.update(
                self._task, description=title, total=rounds * steps, completed=done, detail=detail
            )
        elif number != self._round:
            self._round = number
            self.stage(f"round {number} of {rounds}: {detail}")
