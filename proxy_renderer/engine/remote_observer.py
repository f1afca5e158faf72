# SPDX-License-Identifier: Apache-2.0
"""Tells Blender how the loop goes, and has it render the anchors."""

from __future__ import annotations

import queue
import time
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from ..optimize.progress import BEFORE, PREVIEW
from ..schema import messages
from .wire import Wire

if TYPE_CHECKING:
    from torch import Tensor

    from ..optimize.looks import EarlyLook

_PREVIEW_SECONDS = 1.0
_PROGRESS_SECONDS = 0.1
_ANSWER_SECONDS = 600.0
"""Most that Blender may take to answer: it may be rendering something else first."""
_Look = TypeVar("_Look", bound=messages.LookSoFar)


class RemoteObserver:
    """Tells the other side how the loop goes, and the loop when to end.

    Args:
        wants_looks: Whether the other side shows looks before the end.
    """

    def __init__(self, wire: Wire, job: Path, wants_looks: bool = False) -> None:
        self._wire, self._job, self.wants_looks = wire, job, wants_looks
        self._previewed = self._told = 0.0

    def stage(self, name: str) -> None:
        """Says what is going on outside of the loop."""
        self._wire.send(messages.Stage(name))

    def begin(self, display: Tensor) -> None:
        """Shows the picture of the artist's own values.

        Args:
            display: (H, W, 3) in [0, 1].
        """
        from .report import save_picture

        save_picture(display, self._job / BEFORE)
        self._wire.send(messages.Stage("looking for the look", BEFORE))

    def look(self, look: EarlyLook) -> None:
        """Hands a look over.

        Args:
            look: The look; one whose picture is not drawn yet leaves the last picture as it is.
        """
        self._wire.send(look_message(messages.LookSoFar, look, self._job))

    def step(self, progress: messages.Progress, display: Tensor) -> bool:
        """Reports a step, with a new preview about once a second.

        Args:
            progress: What the panel shows of it.
            display: (H, W, 3) the picture of the step's values, in [0, 1].

        Returns:
            Whether the loop should end.
        """
        from .report import save_picture

        now = time.monotonic()
        if now - self._previewed > _PREVIEW_SECONDS:
            save_picture(display, self._job / progress.preview)
            self._previewed = now
        if now - self._told > _PROGRESS_SECONDS or progress.step == progress.steps:
            self._wire.send(progress)
            self._told = now
        return self.stopped()

    def stopped(self) -> bool:
        """Whether the loop should end."""
        return self._wire.stop.is_set()

    def ask(self, request: messages.Anchor) -> messages.Anchored | None:
        """Has Blender render, and waits until it has.

        Returns:
            Its answer, which holds the error if it has failed or is overdue; None if the loop is to end.
        """
        if not self._wire.stop.is_set():
            self._wire.send(request)
        end = time.monotonic() + _ANSWER_SECONDS
        while not self._wire.stop.is_set() and time.monotonic() < end:
            try:
                answer = self._wire.anchored.get(timeout=0.1)
            except queue.Empty:
                continue
            if answer.number == request.number:
                return answer
        if self._wire.stop.is_set():
            return None
        return messages.Anchored(request.number, error=f"no answer within {_ANSWER_SECONDS:.0f} s")


def look_message(kind: type[_Look], look: EarlyLook, job: Path) -> _Look:
    """The message of a look, whose picture is written into the job folder."""
    from .report import save_picture

    if look.display is not None:
        save_picture(look.display, job / PREVIEW)
    values = {key: list(value) for key, value in look.values.items()}
    return kind(values, "" if look.display is None else PREVIEW, dict(look.words))
