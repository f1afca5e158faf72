# SPDX-License-Identifier: Apache-2.0
"""Looks that are shown before the end: what the plan alone gives, at once, and then what the rounds find."""

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
    """Values on the way to the result."""

    values: Mapping[str, tuple[float, ...]]  # key to components, of what differs from the artist's scene
    display: Tensor | None  # (H, W, 3) their image in [0, 1]; None where it has not been drawn yet
    words: Mapping[str, bool]  # word to whether the image shows it, of those that claim something measurable


class Looks:
    """Looks of one shot, as loaded. No anchor is asked for: images are corrected by those that were taken anyway; `before` is the artist's."""

    def __init__(self, shot: ShotState, described: SceneDescription) -> None:
        self._shot, self._described, self._home = shot, described, shot.vector.encode({})
        with torch.no_grad():
            self.before = shot.draw(self._home).display
            self._seen = shot.gbuffer(self._home)

    def planned(self, advisor: Advisor) -> tuple[Tensor, Advice]:
        """Lines 2 to 5 and 7 of Algorithm 1: what the words alone give (N,), and the advice; raises VibeError if no word is known."""
        vector, home = self._shot.vector, self._home
        advice = self._shot.advised(advisor, home, self._described)
        ranges = feasible_ranges(advice.plan, vector.instances, vector.values(home))
        return project(start_point(vector, advice.plan, home), *vector.bounds(ranges)), advice

    def values(self, u: Tensor) -> EarlyLook:
        """The values of u (N,), without an image."""
        return EarlyLook(self._shot.vector.changes(u), None, {})

    def drawn(self, u: Tensor, claims: tuple[Claim, ...], shot: ShotState | None = None) -> EarlyLook:
        """The values of u (N,) with their image; a `shot` has its proxy corrected, None is the plain one."""
        shot = shot or self._shot
        with torch.no_grad():
            display = shot.draw(u).display
            judged = ShotClaims(claims, self._seen, shot.gbuffer(u))
        rows = judged.verdicts(self.before, display, display)
        words = {word: state != "missed" for word, state in messages.word_states(rows).items()}
        return EarlyLook(shot.vector.changes(u), display, words)
