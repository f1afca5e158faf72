# SPDX-License-Identifier: Apache-2.0
"""The observer of the loop, and the time that is left."""

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
"""Names in the job folder: of the picture of the artist's own values, and of the newest look's."""


class Observer(Protocol):
    """Follows the loop."""

    wants_looks: bool  # whether looks are shown before the end, see `looks`

    def stage(self, name: str) -> None:
        """Something other than a step begins."""

    def begin(self, display: Tensor, lit: bool) -> None:
        """The loop begins; display (H, W, 3) in [0, 1] shows the artist's values: black, also with the words, if not `lit`."""

    def look(self, look: EarlyLook) -> None:
        """There is a look, or a better one; its image may come a moment later."""

    def step(self, progress: Progress, display: Tensor) -> bool:
        """A step is done, whose values look like display (H, W, 3) in [0, 1]; True ends the loop with the best so far."""

    def stopped(self) -> bool:
        """True to end the loop with the best so far: work that takes long outside of steps asks this."""

    def ask(self, request: Anchor) -> Anchored | None:
        """Blender's answer; None if there is none, or the loop should end."""


class Clock:
    """Turns steps into progress messages; `stopped` once the observer has asked for the end."""

    def __init__(self, rounds: int, steps: int, observer: Observer) -> None:
        self._rounds, self._most, self._observer = rounds, steps, observer
        self._steps, self._seconds = 0, 0.0
        self.stopped = False

    def follow(self, number: int) -> Callable[[int, float, Render], bool]:
        """The callback for the inner steps of a round, from 0: takes (step from 1, loss, picture), and returns whether the loop should end."""
        rounds, steps = self._rounds, self._most
        last = time.monotonic()

        def on_step(step: int, loss: float, picture: Render) -> bool:
            nonlocal last
            now = time.monotonic()
            self._steps, self._seconds, last = self._steps + 1, self._seconds + now - last, now
            seconds = self._seconds / self._steps * ((rounds - number) * steps - step)
            progress = Progress(number + 1, rounds, step, steps, loss, seconds, PREVIEW)
            self.stopped |= self._observer.step(progress, picture.display.detach())
            return self.stopped

        return on_step
