# SPDX-License-Identifier: Apache-2.0
"""The round's objective: parameters in, proxy picture, loss out."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

import torch
from torch import Tensor

from ..guidance.guide import Weights
from ..guidance.losses import leash_loss, prior_loss
from ..guidance.regions import Views
from .inner import fixed_views
from .vector import ParameterVector

if TYPE_CHECKING:
    from ..render.proxy import Proxy, Render


class Terms(Protocol):
    """The guidance: `guide.Guide`, or the baseline's.

    Attributes:
        views: How many crops of each region it looks at.
    """

    views: Views

    def __call__(self, display: Tensor, mask: Tensor, generator: torch.Generator) -> dict[str, Tensor]:
        """The weighted loss terms of a picture (H, W, 3) with its mask (H, W)."""

    def measure(self, display: Tensor) -> dict[str, float]:
        """Probabilities of the attributes that the words ask for."""


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
        pull: (N,) weight in [0, 1] of the prior on each component, 0 where words name the value.
        weights: Of the prior and of the leash on colors; None for neither.
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
        weights: Weights | None,
    ) -> None:
        self.proxy, self.vector, self.terms, self.free = proxy, vector, terms, free
        self._lower, self._span = lower, (upper - lower).clamp_min(1e-9)
        self._home = vector.encode({})
        self._pull, self._weights = pull, weights
        self._range = (upper - lower > 1e-9).to(lower)
        colors = [vector.slices[key] for key in free if vector.instances[key].parameter.components == 3]
        self._colors = (
            torch.tensor([[part.start + i for i in range(3)] for part in colors]).view(-1, 3).long()
        )

    def render(self, u: Tensor) -> Render:
        """The proxy's picture of u (N,), differentiable in the free keys."""
        return draw(self.proxy, self.vector, u, self.free)

    def loss(self, picture: Render, u: Tensor, generator: torch.Generator) -> Tensor:
        """The sum of all terms."""
        total = torch.stack(list(self.terms(picture.display, picture.mask, generator).values())).sum()
        if self._weights is None:
            return total
        where, home = ((x - self._lower) / self._span for x in (u, self._home))
        prior = self._weights.prior * prior_loss(where, home.clamp(0.0, 1.0), self._pull)
        leash = self._weights.leash * leash_loss(where, self._colors, self._range)
        return total + (prior + leash).float().to(total.device)

    def account(self, u: Tensor) -> dict[str, dict[str, float]]:
        """What the picture of u is worth: its weighted terms, and how sure the named attributes are."""
        with torch.no_grad():
            picture = draw(self.proxy, self.vector, u)
            terms = self.terms(picture.display, picture.mask, fixed_views())
        return {
            "terms": {name: round(float(value), 4) for name, value in terms.items()},
            "seen": self.terms.measure(picture.display),
        }


def draw(
    proxy: Proxy, vector: ParameterVector, u: Tensor, free: set[str] | frozenset[str] = frozenset()
) -> Render:
    """Renders u (N,): values that are the artist's own are left to the scene, exactly as they are."""
    return proxy.render(chosen_values(vector, u, proxy.device, free))


def chosen_values(
    vector: ParameterVector,
    u: Tensor,
    device: torch.device,
    free: set[str] | frozenset[str] = frozenset(),
) -> dict[str, Tensor]:
    """The values of u (N,) that are free, with gradients, or no longer the artist's."""
    moved = (u.detach() - vector.encode({})).abs() > 1e-9
    values = {}
    for key, value in vector.decode(u).items():
        if key in free:
            values[key] = value.to(device)
        elif moved[vector.slices[key]].any():
            values[key] = value.detach().to(device)
    return values
