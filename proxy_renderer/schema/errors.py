# SPDX-License-Identifier: Apache-2.0
"""Errors that a user is shown: what went wrong, and what to do about it. Unexpected ones name a log."""

import os
import sys
import tempfile
import time
import traceback
from contextlib import suppress
from pathlib import Path

_KEPT = 20  # logs; older ones are deleted
_LONGEST = 200  # characters of a reason


class VibeError(Exception):
    """An error that the user can fix, with the remedy."""

    def __init__(self, message: str, remedy: str = "") -> None:
        super().__init__(message)
        self.message = message
        self.remedy = remedy

    def __str__(self) -> str:
        return f"{self.message} {self.remedy}".strip()


def quoted(text: str, most: int = 40) -> str:
    """A text in quotes for a message: escaped, so that it is on one line, and cut after `most` characters."""
    return repr(text if len(text) <= most else text[:most] + "…")


class UnexpectedError(VibeError):
    """A bug of Vibe Render or of Blender, which the user can only work around."""


def to_show(error: BaseException, doing: str) -> VibeError:
    """The error to show: a VibeError as it is; else an UnexpectedError "while `doing`", whose log has the traceback."""
    if isinstance(error, VibeError):
        return error
    reason = " ".join(f"{type(error).__name__}: {error}".split())[:_LONGEST].rstrip(".: ")
    log = write_log(f"while {doing}\n\n" + "".join(traceback.format_exception(error)))
    return UnexpectedError(f"Something broke while {doing}: {reason}.", f"Please report it with {log}.")


def write_log(text: str) -> Path:
    """Writes a text to a new log, and deletes the oldest logs; returns the new log's path, even if the disk is full."""
    log = log_folder() / f"vibe-{time.strftime('%Y%m%d-%H%M%S')}-{os.getpid()}.log"
    with suppress(OSError):  # a full disk: the message still names the error
        log.write_text(f"{sys.version}\n{sys.platform}\n{text}\n", encoding="utf-8", errors="replace")
    return log


def log_folder() -> Path:
    """The user's folder for logs, made if missing, old logs deleted; the temporary folder if it cannot be written."""
    home = Path.home()
    if sys.platform == "win32":
        folder = Path(os.environ.get("LOCALAPPDATA") or home / "AppData" / "Local") / "vibe-render" / "Logs"
    elif sys.platform == "darwin":
        folder = home / "Library" / "Logs" / "vibe-render"
    else:
        folder = Path(os.environ.get("XDG_STATE_HOME") or home / ".local" / "state") / "vibe-render" / "log"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        logs = sorted(folder.glob("vibe-*.log"), key=lambda log: log.stat().st_mtime)
        for log in logs[:-_KEPT]:
            with suppress(OSError):
                log.unlink()
    except OSError:
        return Path(tempfile.gettempdir())
    return folder if os.access(folder, os.W_OK) else Path(tempfile.gettempdir())
