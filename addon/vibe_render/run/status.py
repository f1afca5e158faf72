# SPDX-License-Identifier: GPL-3.0-or-later
"""What the engine has reported of a vibe so far, in words, numbers and pictures for the panel."""

from __future__ import annotations

import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ..core.schema_import import messages
from .notes.claims import words_shown
from .notes.model import failure_note
from .notes.words import word_notes

LOOKING = "Looking for the look"


class SessionStatus:
    """What the engine has reported of one vibe.

    Args:
        job: The job folder, in which the engine writes its pictures.

    Attributes:
        stage: The present stage, in words.
        progress: The newest progress message.
        before: The engine's picture of the scene as it was.
        look: The newest look that is shown in the scene before the result.
        words: Word to whether that look's picture shows it.
        preview: The newest picture of the look.
        variants: The variants, the best first, each with its picture; empty unless several were asked for.
    """

    def __init__(self, job: Path) -> None:
        self.stage = "Starting the engine"
        self.progress: messages.Progress | None = None
        self.before: Path | None = None
        self.look: messages.LookSoFar | None = None
        self.words: dict[str, bool] = {}
        self.preview: Path | None = None
        self.variants: list[tuple[messages.Variant, Path]] = []
        self._job = job
        self._result: messages.Result | None = None
        self._last_word_at = 0.0  # time of the engine's last message; 0 before it is asked
        self._stopping = False

    @property
    def fraction(self) -> float:
        """The part of the loop that is done, 0 to 1."""
        p = self.progress
        return ((p.round - 1) * p.steps + p.step) / (p.rounds * p.steps) if p else 0.0

    @property
    def asked(self) -> bool:
        """Whether the engine has been given the vibe."""
        return self._last_word_at > 0.0

    @property
    def silence(self) -> float:
        """Seconds since the engine's last message, while one is expected; otherwise 0."""
        return time.monotonic() - self._last_word_at if self.asked and not self._result else 0.0

    @property
    def can_stop(self) -> bool:
        """Whether there is a best look so far, which `stop` would take."""
        return self.progress is not None and not self._stopping

    @property
    def report(self) -> Mapping[str, Any]:
        """The fields of report.json that the engine knows; empty before the result."""
        return self._result.report if self._result else {}

    @property
    def model_note(self) -> str:
        """How the vision-language model failed in a vibe that has succeeded; "" if it did not."""
        return failure_note(self._result.report) if self._result else ""

    @property
    def prediction_error(self) -> float | None:
        """Mean CIEDE2000 between the last prediction and the anchor after it; None without anchors."""
        return self.report.get("anchored", {}).get("predicted")

    @property
    def anchor_notes(self) -> list[str]:
        """What went wrong with anchors, in words for the artist."""
        return self.report.get("anchored", {}).get("notes", [])

    @property
    def words_shown(self) -> dict[str, str]:
        """Word -> "" if the prediction shows it, else what is missing."""
        return words_shown(self.report.get("claims", ()))

    @property
    def prompt_notes(self) -> list[str]:
        """Words of the prompt that were left out, guessed or contradictory, in words for the artist."""
        return word_notes(self._result.report) if self._result else []

    def receive(self, message: messages.Message) -> None:
        """Takes a message of the engine's."""
        self._last_word_at = time.monotonic()
        if isinstance(message, messages.Stage):
            self.stage = message.name.capitalize()
            if message.picture:
                self.before = self._job / message.picture
        elif isinstance(message, messages.LookSoFar):
            self.look, self.words = message, message.words or self.words
            if message.picture:
                self.preview = self._job / message.picture
        elif isinstance(message, messages.Progress):
            self.progress = message
            self.stage = LOOKING
            if message.preview:
                self.preview = self._job / message.preview
        elif isinstance(message, messages.Result):
            self._result = message
            self.preview = self._job / message.prediction
            self.variants = [(v, self._job / v.picture) for v in message.variants]
