# SPDX-License-Identifier: Apache-2.0
"""Starts Blender in a process of its own, shows its progress, and explains its crashes.

Blender's side (`vibe_render/batch.py --events`) prints lines `VIBE {json}`: "stage", "progress",
"result" and "error", besides whatever Blender itself prints.
"""

import contextlib
import importlib.util
import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import time
from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TextIO

import psutil
from rich.console import Console
from rich.progress import BarColumn, Progress, SpinnerColumn, TimeElapsedColumn

from ..schema import VibeError, atomic, errors

_TRACE = re.compile(r"(Fatal Python error|Current thread|Thread 0x|Extension modules|\s+File |EGL Error|VIBE )")
_TELLING = re.compile(r"error|exception|abort|fail|invalid|corrupt|not a ", re.IGNORECASE)
_LAST = 20  # number of last lines that are searched for the one that explains a crash
_MARK = "VIBE "


class TerminalBar(Progress):
    """A progress bar on `stream` (None: standard output), plain lines if it is no terminal; a context manager."""

    def __init__(self, columns: Sequence[Any], stream: TextIO | None, transient: bool, **task: Any) -> None:
        self._stream = stream or sys.stdout
        self._start = time.monotonic()
        self._plain = not self._stream.isatty()
        console, hour = Console(file=self._stream), 3600.0  # its steps give the remaining time
        super().__init__(
            *columns, transient=transient, console=console, disable=self._plain, speed_estimate_period=hour
        )
        self._task = self.add_task(**task)

    def note(self, text: str) -> None:
        """Prints a line that stays."""
        if self._plain:
            print(text, file=self._stream, flush=True)
        else:
            self.console.print(text, markup=False, highlight=False, emoji=False)


class VibeProgress(TerminalBar):
    """Shows the events of one vibe as they come."""

    def __init__(self, stream: TextIO | None = None) -> None:
        bar = BarColumn(bar_width=32)
        columns = (SpinnerColumn(), "{task.description}", bar, "{task.fields[detail]}", TimeElapsedColumn())
        super().__init__(columns, stream, True, description="", total=None, detail="")
        self._round = 0
        self._result: dict[str, Any] = {}

    def show(self, event: dict[str, Any]) -> None:
        """Shows one event."""
        kind = event.get("type")
        if kind == "stage":
            self.stage(event["name"])
        elif kind == "note":
            self.note(f"Note: {event['line']}")
        elif kind == "result":
            self._result = event
        elif kind == "progress":
            number, rounds, steps, left = event["round"], event["rounds"], event["steps"], int(event["seconds_left"])
            title = f"round {number} of {rounds}"
            detail = f"loss {event['loss']:.3f}   {left // 60}:{left % 60:02d} left"
            done = (number - 1) * steps + event["step"]
            self.update(self._task, description=title, total=rounds * steps, completed=done, detail=detail)
            if self._plain and number != self._round:
                self._round = number
                self.stage(f"{title}: {detail}")

    def stage(self, name: str) -> None:
        """Shows that a new stage begins."""
        self.update(self._task, description=name, total=None, detail="")
        if self._plain:
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


def crash(code: int, doing: str, output: Sequence[str]) -> errors.UnexpectedError:
    """The error for a Blender that crashed while `doing`; `code`: exit code or minus a signal. Logs `output`."""
    log = errors.write_log(f"Blender ended while {doing}, exit code {code}\n\n" + "".join(output))
    kind = signal.strsignal(-code) if code < 0 else None
    last = last_words(output)
    words = f' Its last words: "{last}".' if last else ""
    return errors.UnexpectedError(
        f"Blender crashed while {doing} ({kind or f'exit code {code}'}).{words}",
        "Render the file in Blender: if that crashes too, find out there which object or modifier does it. "
        f"If not, please report it with {log}.",
    )


def last_words(output: Sequence[str]) -> str:
    """The first of the last lines of output that mentions an error, else the first of them; "" without output."""
    lines = [line.strip() for line in output if line.strip() and not _TRACE.match(line)][-_LAST:]
    return (list(filter(_TELLING.search, lines)) or lines or [""])[-1][:200].rstrip(".")


def memory(number: int) -> int:
    """Bytes of memory that a process and all its descendants use; 0 if the process is gone."""
    total = 0
    for process in _family(number):
        with contextlib.suppress(psutil.Error):
            total += process.memory_info().rss
    return total


def kill(number: int) -> None:
    """Ends a process and all its descendants, the youngest first."""
    for process in reversed(_family(number)):
        with contextlib.suppress(psutil.Error):
            process.kill()


def _family(number: int) -> list[psutil.Process]:
    try:
        first = psutil.Process(number)
        return [first, *first.children(recursive=True)]
    except psutil.Error:
        return []


def launch(arguments: list[str], out: Path, progress: VibeProgress | None = None) -> int:
    """Runs batch.py with these arguments to its end; returns the command's exit code: 0, or 130 after a second Ctrl-C.

    The first Ctrl-C is passed on, and Blender's side then finishes with the best so far; a second one ends it at once.
    Without `progress`, prints the outcome and the file in `out` to open. Raises VibeError if Blender's side reports
    an error or crashes.
    """
    told = progress is None
    progress = progress or VibeProgress()
    progress.stage(doing := "starting Blender")
    tail: deque[str] = deque(maxlen=400)
    failure: VibeError | None = None
    scratch = tempfile.TemporaryDirectory(prefix="vibe-", ignore_cleanup_errors=True)
    # A group of its own: a terminal sends Ctrl-C to its whole group, and this process passes it on.
    group: dict[str, Any] = {"start_new_session": True}
    if os.name == "nt":
        group = {"creationflags": subprocess.CREATE_NEW_PROCESS_GROUP}  # type: ignore[attr-defined]
    with scratch as folder, progress:
        process = start([str(blender_side()), "--events", *arguments], Path(folder), **group)
        with _forwarded_interrupts(process, progress) as presses:
            for now in events(process, tail):
                doing = now["name"] if now.get("type") == "stage" else doing
                if now.get("type") == "error":
                    kind = errors.UnexpectedError if now.get("unexpected") else VibeError
                    failure = kind(now.get("message", "It failed."), now.get("remedy", ""))
                else:
                    progress.show(now)
            code = process.wait()
    for unfinished in (out if out.is_dir() else out.parent).glob(f"{atomic.part_prefix(process.pid)}*"):
        unfinished.unlink(missing_ok=True)
    if failure:
        raise failure
    if len(presses) > 1:
        return 130
    if code != 0:
        raise crash(code, doing, tail)
    if told:
        progress.end(out)
    return 0


def start(
    arguments: Sequence[str], scratch: Path | None = None, variables: Mapping[str, str] | None = None, **options: Any
) -> subprocess.Popen[str]:
    """Starts Python with these arguments as Blender's side, for `events` to read; its temporary files go to `scratch`."""
    places = dict.fromkeys(("TMPDIR", "TMP", "TEMP"), str(scratch)) if scratch else {}
    return subprocess.Popen(
        [sys.executable, *arguments], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, encoding="utf-8",
        errors="replace", env=environment() | places | dict(variables or {}),
        **{"stdin": subprocess.DEVNULL, **options},
    )  # fmt: skip


def events(process: subprocess.Popen[str], tail: deque[str]) -> Iterator[dict[str, Any]]:
    """The events among the lines that Blender's side prints, as they come; all other lines are added to `tail`."""
    assert process.stdout is not None
    for line in process.stdout:
        if found := event(line):
            yield found
        else:
            tail.append(line)


def event(line: str) -> dict[str, Any] | None:
    """The event in a line of Blender's side; None for other lines, and for broken ones."""
    with contextlib.suppress(ValueError):
        return json.loads(line.removeprefix(_MARK)) if line.startswith(_MARK) else None
    return None


@contextmanager
def _forwarded_interrupts(process: subprocess.Popen[str], progress: VibeProgress) -> Iterator[list[int]]:
    """Passes Ctrl-C and SIGTERM on to Blender's side inside the block; yields the growing list of received signals."""
    presses: list[int] = []

    def on_signal(number: int, frame: Any) -> None:
        presses.append(number)
        if len(presses) == 1:
            progress.note("Stopping with the best so far … (Ctrl-C again to give up)")
            interrupt = signal.SIGINT if os.name != "nt" else signal.CTRL_BREAK_EVENT  # type: ignore[attr-defined]
            process.send_signal(interrupt)
        else:
            process.kill()

    with handling(on_signal, signal.SIGINT, signal.SIGTERM):
        yield presses


@contextmanager
def handling(handler: Any, *numbers: int) -> Iterator[None]:
    """Sets a handler of signals inside the block; afterwards the old ones are back."""
    before = {number: signal.signal(number, handler) for number in numbers}
    try:
        yield
    finally:
        for number, old in before.items():
            signal.signal(number, old or signal.SIG_DFL)  # None: it was not set from Python


def blender_side() -> Path:
    """The path of batch.py: in the installed package, or in the clone that this file is in; raises VibeError if in neither."""
    spec = importlib.util.find_spec("vibe_render")
    places = [Path(p) for p in (spec.submodule_search_locations or [])] if spec else []
    places.append(Path(__file__).resolve().parents[2] / "addon" / "vibe_render")
    for place in places:
        if (place / "batch.py").is_file():
            return place / "batch.py"
    remedy = "Install it again: `pip install .` in a clone of Vibe Render."
    raise VibeError("The Blender side of vibe-render is missing.", remedy)


def environment() -> dict[str, str]:
    """Environment variables for Blender's side: this process's, with a clone's packages first on PYTHONPATH."""
    root = Path(__file__).resolve().parents[2]
    paths = [str(root), str(root / "addon")] if (root / "addon").is_dir() else []
    inherited = filter(None, [os.environ.get("PYTHONPATH", "")])
    return {**os.environ, "PYTHONPATH": os.pathsep.join([*paths, *inherited]), "PYTHONUNBUFFERED": "1"}
