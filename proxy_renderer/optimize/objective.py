# SPDX-License-Identifier: Apache-2.0
"""A round's objective: parameters in, images and loss out; and its slopes."""

from __future__ import annotations

from collections.abc import Callable, Sequence, Set
from dataclasses import replace
from typing import TYPE_CHECKING

import torch
from torch import Tensor

from ..guidance.guide import Weights, border_loss, claims_loss, hue_consistency_loss, prior_loss
from .least_squares import Assessment, Slopes, fixed_views
from .shots import ShotState, chosen_values
from .vector import ParameterVector

if TYPE_CHECKING:
    from ..render.proxy import LatentImage, Render


_NEAR = 5.0
"""Noticeable steps inside of an end of what is wanted, from where one step does not lose it."""


def asked(found: Assessment) -> Tensor:
    """(M,) bool: values that a step might bring out of what is wanted."""
    return (found.values < found.lower + _NEAR) | (found.values > found.upper - _NEAR)


def gradients(found: Assessment, leaves: Sequence[Tensor]) -> list[Tensor]:
    """For each of the leaves, (M + 1, ...) the gradients of the values, 0 for those that are not asked for, and of the rest."""
    rows = [*found.values.unbind(), found.rest]
    wanted = [*asked(found).tolist(), True]
    passes = []
    for row, is_wanted in zip(rows, wanted, strict=True):
        some: tuple[Tensor | None, ...] = (None,) * len(leaves)
        if is_wanted and row.requires_grad:
            some = torch.autograd.grad(row, leaves, retain_graph=True, allow_unused=True)
        passes.append(
            [torch.zeros_like(leaf) if g is None else g for g, leaf in zip(some, leaves, strict=True)]
        )
    return [torch.nan_to_num(torch.stack(each), 0.0, 0.0, 0.0) for each in zip(*passes, strict=True)]


def backward_slopes(assess: Callable[[Tensor], Assessment], u: Tensor, chosen: Tensor) -> Slopes:
    """Slopes by backward passes: one for each value that is asked for, and one for the rest.

    Args:
        assess: What is judged at a point, differentiable in it.
        u: (N,) the point.
        chosen: (N,) bool, the n components.
    """
    point = u.detach().clone().requires_grad_()
    found = assess(point)
    (slopes,) = gradients(found, [point])
    return Slopes(found.detached(), slopes[:-1, chosen], slopes[-1, chosen])


@torch.no_grad()
def difference_slopes(
    assess: Callable[[Tensor], Assessment], u: Tensor, chosen: Tensor, strides: Tensor
) -> Slopes:
    """Slopes by differences: one for each component.

    Args:
        assess: What is judged at a point.
        u: (N,) the point.
        chosen: (N,) bool, the n components.
        strides: (N,) moves at which differences are taken.
    """
    here = assess(u)
    columns, rest = [], []
    for i in chosen.nonzero()[:, 0]:
        stride = strides[i]
        there = assess(u.index_add(0, i[None], stride[None]))
        columns.append((there.values - here.values) / stride)
        rest.append((there.rest - here.rest) / stride)
    slopes = torch.nan_to_num(torch.stack(columns, 1), 0.0, 0.0, 0.0)
    return Slopes(here, slopes, torch.nan_to_num(torch.stack(rest), 0.0, 0.0, 0.0))


class Neighbors:
    """The points that lie one stride from another in one component.

    Args:
        judge: What is judged in their pictures at a point.
        u: (N,) the point.
        strides: (N,) what each component is moved by.
    """

    def __init__(
        self,
        seen: Sequence[ShotState],
        judge: Callable[[Sequence[Render], Tensor], Assessment],
        u: Tensor,
        strides: Tensor,
    ) -> None:
        self._shots, self._judge = [_ShotNearby(shot, u, strides) for shot in seen], judge

    def assess(self, point: Tensor) -> Assessment:
        """What is judged at the point itself, or at one of its neighbors (N,)."""
        return self._judge([shot.picture(point) for shot in self._shots], point)


class _ShotNearby:
    """A shot's pictures of a point and its neighbors; arguments as for `Neighbors`."""

    def __init__(self, shot: ShotState, u: Tensor, strides: Tensor) -> None:
        self._shot, self._u, self._moved, self._proxy = shot, u, u + strides, shot.corrected
        values = self._values(u)
        self._cache = self._proxy.traced(values)
        self._here = self._proxy.expose(values, self._cache)
        self._last: tuple[str, LatentImage] | None = None

    def picture(self, point: Tensor) -> Render:
        """The picture of the point or a neighbor (N,)."""
        vector, latent = self._shot.vector, self._here
        differs = point != self._u
        for key, part in vector.slices.items():
            if not differs[part].any():
                continue
            group = vector.instances[key].parameter.group
            if group == "camera":
                return self._shot.draw(point)
            if group != "film":
                latent = self._exposed(key, part, differs[part])
        return self._proxy.develop(latent, self._values(point))

    def _exposed(self, key: str, part: slice, components: Tensor) -> LatentImage:
        """What the film receives where some components (bool) of a key are moved."""
        if self._last is None or self._last[0] != key:
            there = self._u.clone()
            there[part] = self._moved[part]
            self._last = key, self._proxy.expose(self._values(there), self._cache.aside())
        latent = self._last[1]
        if len(components) == 1:
            return latent
        return replace(self._here, linear=torch.where(components, latent.linear, self._here.linear))

    def _values(self, point: Tensor) -> dict[str, Tensor]:
        return chosen_values(self._shot.vector, point, self._proxy.device)


_STEP = 0.02
"""Of a component's range, by which it is moved: shadows that move are traced anew, and have some grain."""

_Judge = Callable[[Sequence["Render"], Tensor], Assessment]


def pictures_for(seen: Sequence[ShotState], keys: set[str]) -> int:
    """How many pictures `forward_slopes` would draw."""
    return sum(key in keys and not _of_film(shot, own) for shot in seen for own, key in shot.names.items())


def forward_slopes(
    seen: Sequence[ShotState], judge: _Judge, u: Tensor, chosen: Tensor, box: tuple[Tensor, Tensor]
) -> Slopes:
    """Slopes at u, where no camera moves.

    Args:
        judge: What is judged in their pictures at a point, differentiable in both.
        u: (N,) the point.
        chosen: (N,) bool, the n components.
        box: Lower and upper corner, each (N,), of where u may be.
    """
    point = u.detach().clone().requires_grad_()
    span = box[1] - box[0]
    move = torch.where(chosen, torch.where(u + _STEP * span > box[1], -_STEP, _STEP) * span, 0.0)
    nearby = [_Nearby(shot, u.detach(), chosen) for shot in seen]
    found = judge([each.picture(point) for each in nearby], point)
    leaves = [leaf for each in nearby for leaf in each.leaves]
    slopes, *others = gradients(found, [point, *leaves])
    for each in nearby:
        mine, others = others[: len(each.leaves)], others[len(each.leaves) :]
        with torch.no_grad():
            each.add(slopes, mine, move)
    return Slopes(found.detached(), slopes[:-1, chosen], slopes[-1, chosen])


class _Nearby:
    """The pictures of a shot near a point.

    Attributes:
        leaves: What the film receives at the point, as far as parameters change it: gradients go there.
    """

    def __init__(self, shot: ShotState, u: Tensor, chosen: Tensor) -> None:
        self._shot, self._u, self._proxy = shot, u, shot.corrected
        keys = {own for own, part in shot.vector.slices.items() if chosen[part].any()}
        self._film = {key for key in keys if _of_film(shot, key)}
        self._scene = keys - self._film
        self._values = chosen_values(shot.vector, u, shot.proxy.device, keys)
        with torch.no_grad():
            self._cache = self._proxy.traced(self._values)
            self._here = self._proxy.expose(self._values, self._cache)
        self.leaves = [field.clone().requires_grad_() for field in _fields(self._here)]

    def picture(self, point: Tensor) -> Render:
        """The picture of the point (N,), differentiable in the leaves and in the film's values."""
        linear, transmittance, *alpha = self.leaves
        latent = replace(
            self._here, linear=linear, transmittance=transmittance, alpha=alpha[0] if alpha else None
        )
        return self._proxy.develop(
            latent, chosen_values(self._shot.vector, point, self._proxy.device, self._film)
        )

    def add(self, slopes: Tensor, gradients: Sequence[Tensor], move: Tensor) -> None:
        """Adds what the scene's parameters change to slopes (M + 1, N).

        Args:
            gradients: (M + 1, ...) of the leaves.
            move: (N,) by how much components are moved; 0 for those that are not chosen.
        """
        moved = self._shot.vector.along(self._u, move)
        for key in sorted(self._scene):
            part = self._shot.vector.slices[key]
            values = self._values | {key: moved[key].to(self._proxy.device)}
            there = self._proxy.expose(values, self._cache.aside())
            changes = [b - a for a, b in zip(_fields(self._here), _fields(there), strict=True)]
            if part.stop - part.start == 3:
                told = torch.einsum("mhwc,hwc->mc", gradients[0], changes[0])
            else:
                pairs = zip(gradients, changes, strict=True)
                told = torch.stack([g.flatten(1) @ change.flatten() for g, change in pairs]).sum(0)[:, None]
            steps = move[part]
            slopes[:, part] += torch.where(steps != 0, told.to(slopes) / steps, 0.0)


def _fields(latent: LatentImage) -> list[Tensor]:
    """What parameters of the scene change while the camera stands still."""
    fields = latent.linear, latent.transmittance, latent.alpha
    return [field for field in fields if field is not None]


def _of_film(shot: ShotState, key: str) -> bool:
    return shot.vector.instances[key].parameter.group == "film"


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
