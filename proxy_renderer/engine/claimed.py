# SPDX-License-Identifier: Apache-2.0
"""What the words claim of a vibe's shots, and whether the prediction shows it."""

from __future__ import annotations

from typing import Any

import torch

from ..claims.measures.picture import MeasuredPicture
from ..claims.verdict import ShotClaims
from ..optimize.pipeline import Outcome
from ..optimize.shots import ShotState


def claims_about(outcome: Outcome) -> list[ShotClaims]:
    """The claims of the prompt about each shot."""
    return [
        ShotClaims(outcome.claims, _before(shot).seen, shot.seen_now(outcome.u)) for shot in outcome.shots
    ]


def foreseen(outcome: Outcome, claims: list[ShotClaims]) -> list[dict[str, Any]]:
    """Whether the claims about the first shot hold on its prediction, as the last anchors have it."""
    shot = outcome.shots[0]
    with torch.no_grad():
        after = shot.draw(outcome.u).display
    return claims[0].verdicts(_before(shot).display, after, after)


def _before(shot: ShotState) -> MeasuredPicture:
    assert shot.before is not None, "the loop has begun"
    return shot.before
