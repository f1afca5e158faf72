# SPDX-License-Identifier: Apache-2.0
"""Looks that are shown before the end: what the plan alone gives, at once, and then what the rounds find."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import torch
from torch import Tensor

from ..claims.claim import Claim
from ..claims.verdict import ShotClaims
from ..planning.advice import Advice, Advisor
from ..prompt.types import SceneDescription
from ..render.gbuffer import GBuffer
from ..schema import verdicts
from . import context
from .drawing import chosen_values
from .plan import feasible_ranges
from .shots import ShotState
from .vector import begun, project


@dataclass(frozen=True)
class EarlyLook:
    """Values on the way to the result.

    Attributes:
        values: Key to components, of what differs from the artist's scene.
        display: (H, W, 3) their picture in [0, 1]; None where it has not been drawn yet.
        words: Word to whether the picture shows it; words that claim nothing measurable are left out.
    """

    values: Mapping[str, tuple[float, ...]]
    display: Tensor | None
    words: Mapping[str, bool]


class Looks:
    """Looks of one shot. No anchor is asked for: pictures are corrected by those that were taken anyway.

    Args:
        shot: Of a vibe that has no other.
        described: The scene, before any change.
    """

    def __init__(self, shot: ShotState, described: SceneDescription) -> None:
        self._shot, self._described, self._home = shot, described, shot.vector.encode({})
        with torch.no_grad():
            self.before = shot.draw(self._home)
        self._before_seen = self._seen(self._home)

    def planned(self, advisor: Advisor) -> tuple[Tensor, Advice]:
        """Lines 2 to 5 and 7 of Algorithm 1 on the artist's scene: what the words alone give.

        Returns:
            (N,) the artist's point with the starts of what words name, projected into the plan's ranges; and the advice.

        Raises:
            VibeError: No word of the prompt is known.
        """
        vector, proxy = self._shot.vector, self._shot.proxy
        values = vector.values(self._home)
        now = context.described_now(self._described, proxy, values, self.before)
        advice = advisor.advise(self.before.display, vector.instances, now)
        ranges = feasible_ranges(advice.plan, vector.instances, values)
        return project(begun(vector, advice.plan, self._home), *vector.bounds(ranges)), advice

    def values(self, u: Tensor) -> EarlyLook:
        """The values of u (N,), without a picture."""
        return EarlyLook(self._shot.vector.changes(u), None, {})

    def drawn(self, u: Tensor, claims: tuple[Claim, ...]) -> EarlyLook:
        """The values of u with their picture.

        Args:
            u: (N,) the point.
        """
        with torch.no_grad():
            display = self._shot.draw(u).display
        judged = ShotClaims(claims, self._before_seen, self._seen(u))
        rows = judged.verdicts(self.before.display, display, display)
        words = {word: not missing for word, missing in verdicts.missing_by_word(rows).items()}
        return EarlyLook(self._shot.vector.changes(u), display, words)

    def _seen(self, u: Tensor) -> GBuffer:
        with torch.no_grad():
            return self._shot.proxy.gbuffer(chosen_values(self._shot.vector, u, self._shot.proxy.device))
