# SPDX-License-Identifier: Apache-2.0
"""Least change: what only supports the words goes back towards the artist's values, as far as all words still show.

A round steps at once to where everything holds, and often past it: a dark car may need a little more light to be told from
its floor, and gets a white floor in glaring light, for nothing that is claimed speaks against that.
"""

from __future__ import annotations

import torch
from torch import Tensor

from ...claims.claim import outside
from ...planning.types import Plan
from .search import Search

_FAR = 0.05
"""Of a component's whole range: what has moved less is not worth a picture of Cycles."""
_SHARES = (0.0, 0.25, 0.5, 0.75)
"""Of its way from the artist's value that a support may keep, the least first."""
_SAME = 0.1
"""Steps that people notice, by which a claim may be farther from what is sought."""


def eased(search: Search, plan: Plan, u: Tensor) -> Tensor | None:
    """Where supports are as near to the artist's values as the proxy's pictures allow.

    Args:
        search: Its proxies are corrected at u.
        plan: Says what only supports the words.
        u: (N,) a point at which all claims hold.

    Returns:
        (N,) another point that shows each claim as well; None where nothing is gained.
    """
    if search.reference:  # of which all values are free alike
        return None
    supports = search.vector.mark(key for key, e in plan.items() if e.priority is not None and e.prior > 0.0)
    moved = torch.where(supports, u - search.vector.encode({}), 0.0)
    if float(moved.abs().amax()) < _FAR:
        return None
    most = _missed(search, u) + _SAME
    points = (u - (1.0 - share) * moved for share in _SHARES)
    return next((point for point in points if bool((_missed(search, point) <= most).all())), None)


def _missed(search: Search, u: Tensor) -> Tensor:
    """(C,) how far the pictures of u (N,) are from what is sought of each claim, which lies inside of what holds: steps that people notice."""
    found = [torch.zeros(())]
    with torch.no_grad():
        for shot in search.shots:
            shot.look(u)
            for value, lower, upper in shot.aims(shot.draw(u)):
                found.append(outside(value, lower, upper).norm().cpu())
    return torch.stack(found)
