# SPDX-License-Identifier: Apache-2.0
"""The observer of the loop, and the clock that estimates the time that is left."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Protocol

from ..schema.messages import Anchor, Anchored, Progress

if TYPE_CHECKING:
    from torch import Tensor

    from ..render.proxy import Render
    from .looks import EarlyLook

BEFORE, PREVIEW = "before.png", "preview.png"
"""File names in the job folder: of the image of the artist's own values, and of the image of the newest look."""


class Observer(Protocol):
    """Receives the progress of the loop, for a panel or a terminal, and may end the loop."""

    wants_looks: bool  # whether it shows looks before the end, see the module `looks`

    def stage(self, name: str) -> None:
        """Work other than a step begins, with a name for the user, as "trying 6 starts"."""

    def begin(self, display: Tensor, lit: bool) -> None:
        """The loop begins with `display` (H, W, 3), the image of the artist's values.

        `lit` is False if both this image and that of the first values from the words are black.
        """

    def look(self, look: EarlyLook) -> None:
        """A first or a better look is found; the same look may follow again with its image."""

    def step(self, progress: Progress, display: Tensor) -> bool:
        """A step is done, with image `display` (H, W, 3) in [0, 1]. True ends the loop with the best result so far."""

    def stopped(self) -> bool:
        """True to end the loop with the best result so far; asked during long work outside of steps."""

    def ask(self, request: Anchor) -> Anchored | None:
        """Blender's answer to a request for a Cycles image; None if it gives no answer, or the loop should end."""


class Clock:
    """Turns steps into progress messages with the time left; `stopped` is True once the observer has asked for the end."""

    def __init__(self, rounds: int, steps: int, observer: Observer) -> None:
        self._rounds, self._most, self._observer = rounds, steps, observer
        self._steps, self._seconds = 0, 0.0
        self.stopped = False

    def follow(self, number: int) -> Callable[[int, float, Render], bool]:
        """The callback `on_step` of `least_squares.solve` for the round `number`, from 0."""
        rounds, steps = self._rounds, self._most
        begin, earlier = time.monotonic(), self._seconds

        def on_step(step: int, loss: float, picture: Render) -> bool:
            self._steps, self._seconds = self._steps + 1, earlier + time.monotonic() - begin
            seconds = self._seconds / self._steps * ((rounds - number) * steps - step)
            progress = Progress(number + 1, rounds, step, steps, loss, seconds, PREVIEW)
            self.stopped |= self._observer.step(progress, picture.display.detach())
            return self.stopped

        return on_step
