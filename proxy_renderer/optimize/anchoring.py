# SPDX-License-Identifier: Apache-2.0
"""Pictures of Cycles that keep the loop's proxy near it, and the corrections that come of them."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from torch import Tensor

from ..render.cycles import Correction, CyclesPicture
from ..scene import SceneData
from ..schema import VibeError, messages

SAMPLES = 16
LONGEST = 30.0  # seconds that a picture may take; after a slower one no more are asked for
_FAILURES = 2  # in a row, after which no more pictures are asked for

AnchorRequest = Callable[[messages.Anchor], messages.Anchored | None]  # to Blender; None to end the loop


class BlenderPictures:
    """A source of Cycles' pictures of one of a vibe's shots. Failures are noted, and the loop goes on without."""

    def __init__(self, scene: SceneData, ask: AnchorRequest, seed: int, shot: int = 0) -> None:
        self._scene, self._ask, self._seed, self._shot = scene, ask, seed, shot
        self._number = self._failures = 0
        self._over = False
        self.seconds: list[float] = []  # Blender's time for each picture
        # seconds that it was busy with something else, as the artist's own image, when it was asked
        self.waited = 0.0
        self.notes: list[str] = []  # failures, in words for the artist

    def __call__(self, values: dict[str, list[float]], size: tuple[int, int]) -> CyclesPicture | None:
        """A picture of values, of a width and height; None where there is none to be had."""
        if self._over:
            return None
        self._number += 1
        request = messages.Anchor(self._number, values, max(size), SAMPLES, self._seed, self._shot)
        asked = time.monotonic()
        answer = self._ask(request)
        if answer is None:
            return None
        self.waited += max(time.monotonic() - asked - answer.seconds, 0.0)
        try:
            picture = self._load(answer, size)
        except VibeError as error:
            self._failures += 1
            self._over = self._failures >= _FAILURES
            self._note(f"Without a Cycles picture for a while: {error.message.rstrip('.')}")
            return None
        self._failures = 0
        self.seconds.append(answer.seconds)
        if answer.seconds > LONGEST:
            self._over = True
            self._note(f"A small Cycles picture takes {answer.seconds:.0f} s here, too long for more of them")
        return picture

    def _load(self, answer: messages.Anchored, size: tuple[int, int]) -> CyclesPicture:
        """The picture of an answer; raises VibeError if it has none that can be used."""
        if answer.error:
            raise VibeError(answer.error, "")
        path = Path(self._scene.folder) / answer.picture
        picture = CyclesPicture.load(path, answer.groups)
        if picture.size != size:
            raise VibeError(f"it has {picture.size} pixels instead of {size}", "")
        path.unlink(missing_ok=True)
        return picture

    def _note(self, text: str) -> None:
        if f"{text}." not in self.notes:
            self.notes.append(f"{text}.")


PictureSource = Callable[[dict[str, list[float]], tuple[int, int]], CyclesPicture | None]


@dataclass(frozen=True)
class AnchorState:
    """A proxy's correction by a picture of Cycles."""

    correction: Correction | None = None  # None for the plain proxy
    # (N,) the values of the picture, where the correction is exact; None where there is no picture of the current
    # ones
    u: Tensor | None = None
    earlier: Correction | None = None  # the one before: what was a prediction worth without the last picture?

    def distance(self, u: Tensor) -> float:
        """Distance of u (N,) from the picture, in its worst component's whole range; infinite without one."""
        return float((u - self.u).abs().max()) if self.u is not None else float("inf")
