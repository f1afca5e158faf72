# SPDX-License-Identifier: Apache-2.0
"""The round's objective: parameters in, proxy picture, loss out."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import torch
from torch import Tensor

from ..guidance.losses import prior_loss
from .inner import fixed_views
from .vector import ParameterVector

if TYPE_CHECKING:
    from ..render.proxy import Proxy, Render

Terms = Callable[[Tensor, Tensor, torch.Generator], dict[str, Tensor]]
"""(display, mask, generator) -> weighted loss terms."""


class RoundObjective:
    """What one round minimises, see `inner.Objective`.

    Args:
        proxy: Renders the values.
        vector: The parameters of u.
        terms: The guidance.
        free: Keys that gradients go to; the camera's visibility, say, is not differentiated when
            the camera is held.
        lower: (N,) lower corner of the feasible box.
        upper: (N,) upper corner.
        pull: (N,) weight of the prior on each component, 0 where words name the value.
    """

    def __init__(
        self,
        proxy: Proxy,
        vector: ParameterVector,
        terms: Terms,
        free: set[str],
        lower: Tensor,
        upper: Tensor,
        pull: Tensor,
    ) -> None:
        self.proxy, self.vector, self.terms, self.free = proxy, vector, terms, free
        self._lower, self._span = lower, (upper - lower).clamp_min(1e-9)
        self._home = vector.encode({})
        self._pull = pull

    def render(self, u: Tensor) -> Render:
        """The proxy's picture of u (N,), differentiable in the free keys."""
        return draw(self.proxy, self.vector, u, self.free)

    def loss(self, picture: Render, u: Tensor, generator: torch.Generator) -> Tensor:
        """The sum of all terms."""
        terms = self.terms(picture.display, picture.mask, generator)
        where, home = ((x - self._lower) / self._span for x in (u, self._home))
        prior = prior_loss(where, home.clamp(0.0, 1.0), self._pull)
        return torch.stack(list(terms.values())).sum() + prior.float().to(picture.display.device)

    def account(self, u: Tensor) -> dict[str, float]:
        """Each weighted term at u, on the views that the best point is judged on."""
        with torch.no_grad():
            picture = draw(self.proxy, self.vector, u)
            terms = self.terms(picture.display, picture.mask, fixed_views())
        return {name: round(float(value), 4) for name, value in terms.items()}


def draw(
    proxy: Proxy, vector: ParameterVector, u: Tensor, free: set[str] | frozenset[str] = frozenset()
) -> Render:
    """Renders u (N,): values that are the artist's own are left to the scene, exactly as they are."""
    moved = (u.detach() - vector.encode({})).abs() > 1e-9
    values = {}
    for key, value in vector.decode(u).items():
        if key in free:
            values[key] = value.to(proxy.device)
        elif moved[vector.slices[key]].any():
            values[key] = value.detach().to(proxy.device)
    return proxy.render(values)
