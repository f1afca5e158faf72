# SPDX-License-Identifier: GPL-3.0-or-later
"""What a headless run prints: lines for people, or events for the `vibe` command. No bpy here."""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from ..core.schema_import import errors, messages, schema


class Reporter:
    """Prints to the standard output.

    Args:
        events: Print lines `VIBE {json}` for the `vibe` command instead of lines for people.

    Attributes:
        doing: The present stage.
    """

    def __init__(self, events: bool) -> None:
        self._events = events
        self._start = time.monotonic()
        self._round = 0
        self.doing = "starting"

    def stage(self, name: str) -> None:
        """Reports a new stage."""
        self.doing = name
        self._print({"type": "stage", "name": name}, f"{time.monotonic() - self._start:5.1f} s  {name}")

    def note(self, line: str) -> None:
        """Reports something that the artist should know at once."""
        self._print({"type": "note", "line": line}, f"Note: {line}")

    def engine(self, message: messages.Message) -> None:
        """Reports a stage or progress message of the engine."""
        if isinstance(message, messages.Stage):
            self.stage(message.name)
        elif isinstance(message, messages.Progress):
            line = ""
            if message.round != self._round:
                self._round = message.round
                line = f"round {message.round} of {message.rounds}: {message.seconds_left:.0f} s left"
            self._print({"type": "progress", **asdict(message)}, line)

    def result(self, lines: list[str], stopped: bool = False, missing: Sequence[str] = ()) -> None:
        """Reports the result.

        Args:
            lines: For people.
            stopped: Whether Ctrl-C ended the search early.
            missing: Words that the picture does not show.
        """
        event = {"type": "result", "lines": lines, "stopped": stopped, "missing": list(missing)}
        self._print(event, "\n".join(lines))

    def error(self, error: schema.VibeError) -> None:
        """Reports an error."""
        if self._events:
            unexpected = isinstance(error, errors.UnexpectedError)
            event = {"type": "error", "message": error.message, "remedy": error.remedy}
            self._print({**event, "unexpected": unexpected}, "")
        else:
            print(f"vibe: {error}", file=sys.stderr, flush=True)

    def _print(self, event: dict[str, Any], line: str) -> None:
        if self._events:
            print(f"VIBE {json.dumps(event)}", flush=True)
        elif line:
            print(line, flush=True)
