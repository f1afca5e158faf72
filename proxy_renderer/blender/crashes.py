# SPDX-License-Identifier: Apache-2.0
"""Blender's processes: their memory, their end, and the error for one that crashed."""

from __future__ import annotations

import contextlib
import re
import signal
from collections.abc import Sequence
from pathlib import Path

import psutil

from ..schema import atomic, errors

_TRACE = re.compile(
    r"(Fatal Python error|Current thread|Thread 0x|Extension modules|\s+File |EGL Error|VIBE )"
)
_TELLING = re.compile(r"error|exception|abort|fail|invalid|corrupt|not a ", re.IGNORECASE)
_LAST = 20  # lines in which the telling one is looked for


def temporary(folder: Path) -> dict[str, str]:
    """The environment variables of a process whose temporary files go to a folder."""
    return dict.fromkeys(("TMPDIR", "TMP", "TEMP"), str(folder))


def tidy(out: Path, process: int) -> None:
    """Removes what a process that has ended left unfinished in the folder of its outputs."""
    for part in out.glob(f"{atomic.part_prefix(process)}*"):
        part.unlink(missing_ok=True)


def crash(code: int, doing: str, output: Sequence[str]) -> errors.UnexpectedError:
    """The error for a Blender that ended with an exit code, or a signal (negative); its output goes to a log."""
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
    """The line that tells most about a crash, of the last ones."""
    lines = [line.strip() for line in output if line.strip() and not _TRACE.match(line)][-_LAST:]
    telling = [line for line in lines if _TELLING.search(line)]
    return (telling or lines or [""])[-1][:200].rstrip(".")


def memory(number: int) -> int:
    """Bytes that a process and all it has started hold together; 0 if it is gone."""
    total = 0
    for process in _family(number):
        with contextlib.suppress(psutil.Error):
            total += process.memory_info().rss
    return total


def kill(number: int) -> None:
    """Ends a process and all it has started, the youngest first."""
    for process in reversed(_family(number)):
        with contextlib.suppress(psutil.Error):
            process.kill()


def _family(number: int) -> list[psutil.Process]:
    try:
        first = psutil.Process(number)
        return [first, *first.children(recursive=True)]
    except psutil.Error:
        return []
