# SPDX-License-Identifier: Apache-2.0
"""Keeps the loop's proxy near Cycles: asks for pictures of where the loop is, and corrects the proxy by them."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import torch
from torch import Tensor

from ..color.tensors import mean_difference
from ..render.cycles import CyclesPicture
from ..scene import SceneData
from ..schema import VibeError, messages
from .drawing import chosen_values, draw
from .vector import ParameterVector

if TYPE_CHECKING:
    from ..render.cycles import Correction
    from ..render.proxy import Proxy

SAMPLES = 16
LONGEST = 30.0
"""Seconds that a picture may take; after a slower one no more are asked for."""
_HERE = 0.01  # of a component's whole range: so near, the last correction is as good as a new one
_NEAR = 0.25  # of a component's whole range: so far an old correction is better than none
_FAILURES = 2  # in a row, after which no more pictures are asked for

AnchorRequest = Callable[[messages.Anchor], messages.Anchored | None]
"""Sends a request to Blender; None if the loop is to end instead."""


class BlenderPictures:
    """A source of Cycles' pictures of one scene. What goes wrong is noted, and the loop goes on without.

    Args:
        shot: Which of a vibe's shots it is.

    Attributes:
        seconds: How long Blender took for each picture.
        waited: Seconds that it was busy with something else, as the artist's own picture, when it was asked.
        notes: What went wrong, in words for the artist.
    """

    def __init__(self, scene: SceneData, ask: AnchorRequest, seed: int, shot: int = 0) -> None:
        self._scene, self._ask, self._seed, self._shot = scene, ask, seed, shot
        self._number = self._failures = 0
        self._over = False
        self.seconds: list[float] = []
        self.waited = 0.0
        self.notes: list[str] = []

    def __call__(self, values: dict[str, list[float]], size: tuple[int, int]) -> CyclesPicture | None:
        """A picture of values, width and height as given; None where there is none to be had."""
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
            self._miss(error.message)
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
        picture = CyclesPicture.load(path, answer.groups, self._scene.film)
        if picture.size != size:
            raise VibeError(f"it has {picture.size} pixels instead of {size}", "")
        path.unlink(missing_ok=True)
        return picture

    def _miss(self, reason: str) -> None:
        self._failures += 1
        self._over = self._failures >= _FAILURES
        self._note(f"Without a Cycles picture for a while: {reason.rstrip('.')}")

    def _note(self, text: str) -> None:
        if f"{text}." not in self.notes:
            self.notes.append(f"{text}.")


PictureSource = Callable[[dict[str, list[float]], tuple[int, int]], CyclesPicture | None]


AnchorState = tuple["Correction | None", "Correction | None", "Tensor | None"]
"""The newest correction, the one before it, and where (N,) the newest is exact."""


@dataclass
class Anchoring:
    """The corrections of one run.

    Attributes:
        proxy: The loop's.
        vector: The parameters of u.
        source: Of Cycles' pictures; None to leave the proxy as it is.
        earlier: The correction before the newest.
        records: One per picture: the number of the round, and the mean CIEDE2000 between what the proxy had
            predicted and what it says with the picture.
    """

    proxy: Proxy
    vector: ParameterVector
    source: PictureSource | None
    earlier: Correction | None = None
    records: list[dict[str, Any]] = field(default_factory=list)
    _where: Tensor | None = None

    def renew(self, u: Tensor, number: int, slack: float = _HERE) -> None:
        """Corrects the proxy at u (N,), unless that has been done within `slack` of every component.

        Args:
            number: Of the round, from 0.
            slack: Share of a component's whole range.
        """
        if self.source is None or self._distance(u) <= slack:
            return
        changed = {key: list(value) for key, value in self.vector.changes(u).items()}
        picture = self.source(changed, self.proxy.size)
        if picture is None:
            if self._distance(u) > _NEAR:
                self.earlier, self.proxy.correction, self._where = None, None, None
            return
        with torch.no_grad():
            predicted = draw(self.proxy, self.vector, u).display
            self.earlier = self.proxy.correction
            self.proxy.anchor(chosen_values(self.vector, u, self.proxy.device), picture)
            difference = mean_difference(predicted, draw(self.proxy, self.vector, u).display)
        self._where = u.clone()
        self.records.append({"round": number + 1, "delta_e": round(float(difference), 3)})

    def expire(self) -> None:
        """The newest picture shows other values than u says; another one is due."""
        self._where = None

    @property
    def newest(self) -> AnchorState:
        """What `recall` brings back."""
        return self.proxy.correction, self.earlier, self._where

    def recall(self, anchor: AnchorState) -> None:
        """Corrects the proxy as it once was."""
        self.proxy.correction, self.earlier, self._where = anchor

    def _distance(self, u: Tensor) -> float:
        """How far u is from the newest picture's, in its worst component; infinite before the first."""
        return float((u - self._where).abs().max()) if self._where is not None else float("inf")
