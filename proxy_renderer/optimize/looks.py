# SPDX-License-Identifier: Apache-2.0
"""Looks that are shown before the end: first what the plan alone gives, then the best result of the rounds so far."""

from collections.abc import Mapping
from dataclasses import dataclass

import torch
from torch import Tensor

from ..claims.claim import Claim, ShotClaims
from ..planning.advice import Advice, Advisor
from ..schema import messages
from ..words.types import SceneDescription
from .shots import ShotState
from .vector import feasible_ranges, project, start_point


@dataclass(frozen=True)
class EarlyLook:
    """Values that are shown before the final result, with their image."""

    values: Mapping[str, tuple[float, ...]]  # key -> components of each value that is not the artist's
    display: Tensor | None  # (H, W, 3) the image in [0, 1]; None if it is not drawn yet
    words: Mapping[str, bool]  # word with measurable claims -> whether the image satisfies them


class Looks:
    """Makes early looks of one shot without new Cycles renders; `before` is the proxy's image of the artist's values."""

    def __init__(self, shot: ShotState, described: SceneDescription) -> None:
        self._shot, self._described, self._home = shot, described, shot.vector.encode({})
        with torch.no_grad():
            self.before = shot.draw(self._home).display
            self._seen = shot.gbuffer(self._home)

    def planned(self, advisor: Advisor) -> tuple[Tensor, Advice]:
        """The point u (N,) of the words alone (lines 2 to 5 and 7), and the advice; VibeError if no word is known."""
        vector, home = self._shot.vector, self._home
        advice = self._shot.advised(advisor, home, self._described)
        bounds = vector.bounds(feasible_ranges(advice.plan, vector.instances, vector.values(home)))
        return project(start_point(vector, advice.plan, home), *bounds), advice

    def drawn(self, u: Tensor, claims: tuple[Claim, ...], shot: ShotState | None = None) -> EarlyLook:
        """The look of u (N,) with its image, drawn by `shot`, whose proxy is corrected; None: without correction."""
        shot = shot or self._shot
        with torch.no_grad():
            display = shot.draw(u).display
            judged = ShotClaims(claims, self._seen, shot.gbuffer(u))
        rows = judged.verdicts(self.before, display, display)
        words = {word: state != "missed" for word, state in messages.word_states(rows).items()}
        return EarlyLook(shot.vector.changes(u), display, words)
