# SPDX-License-Identifier: Apache-2.0
"""What the words claim of a vibe's shots, and whether the prediction shows it."""

from __future__ import annotations

from typing import Any

import torch

from ..claims.verdict import ShotClaims
from ..optimize.drawing import chosen_values
from ..optimize.pipeline import Outcome


def claims_about(outcome: Outcome) -> list[ShotClaims]:
    """The claims of the prompt about each shot.

    Args:
        outcome: What was found.
    """
    home = outcome.vector.encode({})
    rows = []
    for shot in outcome.shots:
        with torch.no_grad():
            before, after = (
                shot.proxy.gbuffer(chosen_values(shot.vector, u, shot.proxy.device))
                for u in (home, outcome.u)
            )
        rows.append(ShotClaims(outcome.claims, before, after))
    return rows


def foreseen(outcome: Outcome, claims: list[ShotClaims]) -> list[dict[str, Any]]:
    """Whether the claims about the first shot hold on its prediction, as the last anchors have it.

    Args:
        outcome: What was found.
        claims: Of each shot.
    """
    shot, home = outcome.shots[0], outcome.vector.encode({})
    with torch.no_grad():
        before, after = (shot.draw(u).display for u in (home, outcome.u))
    return claims[0].verdicts(before, after, after)
