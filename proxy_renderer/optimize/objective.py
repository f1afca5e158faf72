# SPDX-License-Identifier: Apache-2.0
"""The round's objective: parameters in, proxy picture, loss out."""

from __future__ import annotations

from collections.abc import Sequence, Set
from typing import TYPE_CHECKING

import torch
from torch import Tensor

from ..guidance.guide import Weights, border_loss, claims_loss, hue_consistency_loss, prior_loss
from .least_squares import Assessment, Slopes, fixed_views
from .shots import ShotState
from .slopes import Neighbors, backward_slopes, difference_slopes, forward_slopes, pictures_for
from .vector import ParameterVector

if TYPE_CHECKING:
    from ..render.proxy import Render


_PICTURES = 5
"""Pictures that take as long as a backward pass through one."""

_UNNAMED = 100.0
"""How much more a color that no word names is kept from other hues: a floor may be lighter, not greener."""
_GRAY, _BETWEEN_GRAYS = 1e-4, 8.0
"""How far the components of a gray may lie apart, and how much more a color between two of them is kept from having a hue: the darks
of a picture may be lifted, not tinted."""


class RoundObjective:
    """What one round minimizes, see `inner.least_squares.ClaimObjective`.

    Args:
        seen: Draws and judges the shots, one or several.
        vector: The parameters of u.
        free: Keys that gradients go to; the camera's visibility, say, is not differentiated when
            the camera is held.
        lower: (N,) lower corner of the feasible box.
        upper: (N,) upper corner.
        home: (N,) the artist's values, and where words have the search begin, see `PlanEntry.start`.
        pull: (N,) weight in [0, 1] of the pull to them, 0 where words name a range.
        any_hue: Keys of colors whose hue is free.
        differences: Whether slopes are taken by differences, see `inner.slopes.difference_slopes`.
        weights: Of the claims, of the prior and of the consistency of hues.
    """

    def __init__(
        self,
        seen: Sequence[ShotState],
        vector: ParameterVector,
        free: set[str],
        lower: Tensor,
        upper: Tensor,
        home: Tensor,
        pull: Tensor,
        weights: Weights,
        any_hue: Set[str] = frozenset(),
        differences: bool = False,
    ) -> None:
        self.seen, self.vector, self.free = seen, vector, free
        self._lower, self._span = lower, (upper - lower).clamp_min(1e-9)
        self._home, self._differences = home, differences
        self._moves = any(vector.instances[key].parameter.group == "camera" for key in free)
        self._pull, self._weights = pull, weights
        unnamed = (pull > 0.0) & (home == vector.encode({}))
        gray = torch.zeros_like(unnamed)
        colors = [
            vector.slices[key] for key in free - any_hue if vector.instances[key].parameter.components == 3
        ]
        for part in colors:
            gray[part] = all(float(end[part].max() - end[part].min()) < _GRAY for end in (lower, upper))
        self._hued = (upper - lower > 1e-9) * (1.0 + _UNNAMED * unnamed + _BETWEEN_GRAYS * gray)
        self._colors = (
            torch.tensor([[part.start + i for i in range(3)] for part in colors]).view(-1, 3).long()
        )

    @property
    def shots(self) -> int:
        """How many pictures there are."""
        return len(self.seen)

    def render(self, u: Tensor, shot: int) -> Render:
        """The proxy's picture of u, differentiable in the free keys.

        Args:
            u: (N,) in [0, 1].
            shot: Which one is drawn, from 0.
        """
        return self.seen[shot].draw(u, self.free)

    @property
    def claim_weight(self) -> float:
        """Of a noticeable step by which a claim is missed."""
        return self._weights.claims

    def stiffness(self, chosen: Tensor) -> Tensor:
        """Curvature of what holds values, by their places in their ranges: apart, a color's components leave its hue.

        Args:
            chosen: (N,) bool, the n components whose curvature is asked for: a scene may have thousands.

        Returns:
            (n, n).
        """
        prior = 2.0 * self._weights.prior * torch.diag(self._pull[chosen])
        rest, places = torch.zeros_like(self._pull), chosen.nonzero(as_tuple=True)

        def hue_loss(where: Tensor) -> Tensor:
            return hue_consistency_loss(rest.index_put(places, where), self._colors, self._hued)

        hue = torch.autograd.functional.hessian(hue_loss, rest[chosen], vectorize=True)
        return prior + self._weights.hue * hue

    def assess(self, u: Tensor) -> Assessment:
        """What is judged in the pictures of all shots, differentiable in the free keys.

        Args:
            u: (N,) in [0, 1].
        """
        return self._judge([self.render(u, shot) for shot in range(self.shots)], u)

    def slopes(self, u: Tensor, chosen: Tensor) -> Slopes:
        """How what is judged at u (N,) changes by the n chosen components (N,): forward or backward, whichever is cheaper.

        A picture that says hundreds of things is dear to go through backward hundreds of times, even through the film alone.
        A camera that moves sees other things: only backward passes know what that does to outlines.
        """
        if self._differences:
            stride = self.vector.strides(u)
            inside = u + stride <= self._lower + self._span
            strides = torch.where(inside, stride, -stride)
            with torch.no_grad():
                nearby = Neighbors(self.seen, self._judge, u, strides)
            return difference_slopes(nearby.assess, u, chosen, strides)
        keys = {key for key in self.free if chosen[self.vector.slices[key]].any()}
        moves = any(self.vector.instances[key].parameter.group == "camera" for key in keys)
        values = 1 + sum(len(shot.claims.claims) for shot in self.seen if shot.claims)
        if moves or pictures_for(self.seen, keys) > _PICTURES * values * self.shots:
            return backward_slopes(self.assess, u, chosen)
        return forward_slopes(self.seen, self._judge, u, chosen, (self._lower, self._lower + self._span))

    def _judge(self, pictures: Sequence[Render], u: Tensor) -> Assessment:
        similar = [
            term
            for n, picture in enumerate(pictures)
            for term in self._similar(picture, fixed_views(), n).values()
        ]
        rows = [row for shot, picture in zip(self.seen, pictures, strict=True) for row in shot.aims(picture)]
        values, lower, upper = (
            torch.cat([u.new_zeros(0), *(row[i].to(u) for row in rows)]) for i in range(3)
        )
        numbers = [torch.full(row[0].shape, number) for number, row in enumerate(rows)]
        rest = sum(similar, pictures[0].display.new_zeros(())).to(u) / self.shots + self.held(u)
        return Assessment(
            values, lower, upper, torch.cat([torch.zeros(0).long(), *numbers]), rest, pictures[0]
        )

    def account(self, u: Tensor) -> dict[str, dict[str, float]]:
        """What u is worth, as means over the shots.

        Args:
            u: (N,) in [0, 1].

        Returns:
            "terms": term -> weighted value.
        """
        terms = []
        for number, shot in enumerate(self.seen):
            with torch.no_grad():
                picture = shot.draw(u)
                terms.append({k: float(v) for k, v in self.terms(picture, fixed_views(), number).items()})
        return {"terms": {key: round(sum(row[key] for row in terms) / len(terms), 4) for key in terms[0]}}

    def terms(self, picture: Render, generator: torch.Generator, shot: int) -> dict[str, Tensor]:
        """The weighted terms of a picture, differentiable in it.

        Args:
            picture: As `render` returns it.
            shot: Which one it shows, from 0.
        """
        terms = self._similar(picture, generator, shot)
        if self.claim_weight and (residuals := self.seen[shot].residuals(picture)):
            terms["claims"] = self.claim_weight * claims_loss(residuals)
        return terms

    def _similar(self, picture: Render, generator: torch.Generator, shot: int) -> dict[str, Tensor]:
        guidance = self.seen[shot].guidance
        assert guidance is not None
        terms = guidance(picture.display, picture.mask, generator)
        if self._moves:
            terms["border"] = self._weights.border * border_loss(picture.mask)
        return terms

    def held(self, u: Tensor) -> Tensor:
        """() the pull home at u (N,), and that of a color's components to each other."""
        where, home = ((x - self._lower) / self._span for x in (u, self._home))
        prior = prior_loss(where, home.clamp(0.0, 1.0), self._pull)
        hue = hue_consistency_loss(where, self._colors, self._hued)
        return self._weights.prior * prior + self._weights.hue * hue
