# SPDX-License-Identifier: Apache-2.0
"""A round's objective: from parameters to images and the loss; and its slopes (derivatives), in the cheapest of three ways.

- Backward: one backward pass for each value of the claims.
- Differences: one image for each component, of which little is rendered again.
- Forward: one undeveloped image for each parameter, and backward passes through film and claims alone. Red light stays red until
  the film develops it, so each component of a color changes one channel of the image alone, and one image serves all three
  (Curtis, Powell and Reid 1974).
"""

import itertools
from collections.abc import Callable, Collection, Sequence
from dataclasses import replace

import torch
from torch import Tensor

from ..claims.measures import MEASURES
from ..guidance.guide import Weights, border_loss, claims_loss, hue_consistency_loss, prior_loss
from ..planning.types import Plan
from ..render.proxy import LatentImage, Render
from .least_squares import Assessment, Slopes, fixed_views
from .shots import ShotState, chosen_values
from .vector import ParameterVector, start_point

_PICTURES = 5  # images that take as long to draw as one backward pass
_NAMED = 0.15  # weight of the pull to a start that words name: claims override this pull, similarity alone does not
_UNNAMED = 100.0  # added weight of keeping hue for colors without words: a floor may get lighter, not greener
_GRAY = 1e-4  # largest difference between the components of a gray, in u
_BETWEEN_GRAYS = 8.0  # added weight, if both ends of a range are gray: shadows may be lifted, not tinted
_TOGETHER = 32  # most backward passes in one batch: each needs the memory of a pass
_NEAR = 5.0  # values farther inside of an aim, in noticeable steps, get no gradients: no step leaves it
_STEP = 0.02  # share of its range by which a component is moved: large, for moved shadows have some grain

_Judge = Callable[[Sequence[Render], Tensor], Assessment]  # (an image of each shot, point (N,)) -> assessment


class RoundObjective:
    """The function that a round minimizes, see `least_squares.ClaimObjective`.

    Args:
        seen: The shots, which draw and judge images.
        free: Keys that get gradients. If the camera is not among them, visibility is not differentiated.
        box: Lower and upper corner of the feasible box, each (N,).
        differences: True to compute slopes by differences.
    """

    def __init__(
        self,
        seen: Sequence[ShotState],
        vector: ParameterVector,
        plan: Plan,
        free: Collection[str],
        box: tuple[Tensor, Tensor],
        weights: Weights,
        differences: bool = False,
    ) -> None:
        self.seen, self.vector, self.free = seen, vector, set(free)
        self.claim_weight = weights.claims
        self._box, self._weights, self._differences = box, weights, differences
        self._span = (box[1] - box[0]).clamp_min(1e-9)

        # The pull of each component to its start, `home`, with a weight in [0, 1], which is 0 if words name a range
        artist = vector.encode({})
        self._home = start_point(vector, plan, artist)
        self._pull = torch.zeros_like(artist)
        for key in free:
            self._pull[vector.slices[key]] = plan[key].prior if plan[key].start is None else _NAMED
        parameters = {key: vector.instances[key].parameter for key in sorted(free)}
        self._camera = {key for key, p in parameters.items() if p.group == "camera"}
        scene = [key for key, p in parameters.items() if p.group != "material"]
        self._supports = vector.mark(key for key in scene if not plan[key].is_named)

        # Colors keep their hue
        unnamed = (self._pull > 0.0) & (self._home == artist)
        gray = torch.zeros_like(unnamed)
        colors = [vector.slices[k] for k, p in parameters.items() if p.components == 3 and not plan[k].any_hue]
        for part in colors:
            gray[part] = all(float(end[part].max() - end[part].min()) < _GRAY for end in box)
        self._hued = (box[1] - box[0] > 1e-9) * (1.0 + _UNNAMED * unnamed + _BETWEEN_GRAYS * gray)
        self._colors = torch.tensor([[*range(part.start, part.stop)] for part in colors]).view(-1, 3).long()

    def assess(self, u: Tensor) -> Assessment:
        """The assessment of the images of all shots at u (N,), differentiable in the free keys."""
        return self.judge([shot.draw(u, self.free) for shot in self.seen], u)

    def judge(self, pictures: Sequence[Render], u: Tensor) -> Assessment:
        """The assessment of u (N,) from given images of it, one for each shot."""
        similar = [self._similar(picture, fixed_views(), n).values() for n, picture in enumerate(pictures)]
        total = sum(itertools.chain(*similar), pictures[0].display.new_zeros(()))
        rows = [row for shot, picture in zip(self.seen, pictures, strict=True) for row in shot.aims(picture)]
        aims = [row[1:] for row in rows]
        values, lower, upper = (torch.cat([u.new_zeros(0), *(row[i].to(u) for row in aims)]) for i in range(3))
        numbers = [torch.full(row[0].shape, number) for number, row in enumerate(aims)]
        claim = torch.cat([torch.zeros(0).long(), *numbers])
        finish = torch.tensor([MEASURES[each.measure].of_finish for each, *_ in rows]).bool()[claim]
        rest = total.to(u) / len(self.seen) + self.held(u)
        return Assessment(values, lower, upper, claim, rest, pictures[0], finish)

    def account(self, u: Tensor) -> dict[str, dict[str, float]]:
        """{"terms": {term: its weighted value at u (N,), as a mean over the shots}}, for the report."""
        with torch.no_grad():
            rows = [self.terms(shot.draw(u), fixed_views(), number) for number, shot in enumerate(self.seen)]
        return {"terms": {name: round(sum(float(row[name]) for row in rows) / len(rows), 4) for name in rows[0]}}

    def terms(self, picture: Render, generator: torch.Generator, shot: int) -> dict[str, Tensor]:
        """The weighted terms of the loss for an image of a shot (from 0), differentiable in the image."""
        terms = self._similar(picture, generator, shot)
        if self.claim_weight and (residuals := self.seen[shot].residuals(picture)):
            terms["claims"] = self.claim_weight * claims_loss(residuals)
        return terms

    def _similar(self, picture: Render, generator: torch.Generator, shot: int) -> dict[str, Tensor]:
        guidance = self.seen[shot].guidance
        assert guidance is not None
        terms = guidance(picture.display, picture.mask, generator)
        if self._camera:
            terms["border"] = self._weights.border * border_loss(picture.mask)
        return terms

    def held(self, u: Tensor) -> Tensor:
        """Sum () of two terms at u (N,): the pull to the start values, and the pull of colors to keep their hue."""
        where, home = ((x - self._box[0]) / self._span for x in (u, self._home))
        prior = prior_loss(where, home.clamp(0.0, 1.0), self._pull)
        hue = hue_consistency_loss(where, self._colors, self._hued)
        return self._weights.prior * prior + self._weights.hue * hue

    def stiffness(self, chosen: Tensor) -> Tensor:
        """Curvature (n, n) of `held` over the n components chosen (N,) bool, as places in [0, 1] of their ranges."""
        prior = 2.0 * self._weights.prior * torch.diag(self._pull[chosen])
        rest, places = torch.zeros_like(self._pull), chosen.nonzero(as_tuple=True)

        def hue_loss(where: Tensor) -> Tensor:
            return hue_consistency_loss(rest.index_put(places, where), self._colors, self._hued)

        hue = torch.autograd.functional.hessian(hue_loss, rest[chosen], vectorize=True)
        return prior + self._weights.hue * hue

    def slopes(self, u: Tensor, chosen: Tensor) -> Slopes:
        """Slopes at u (N,) over the n components chosen (N,) bool, in the cheapest of the module's three ways.

        A reference image has hundreds of values. Backward passes for all are expensive, even through the film alone, so
        differences are used. A camera that moves sees other objects: only backward passes differentiate outlines.
        """
        keys = {key for key in self.free if chosen[self.vector.slices[key]].any()}
        values = 1 + sum(len(shot.claims.claims) for shot in self.seen if shot.claims)
        box = self._box[0], self._box[0] + self._span
        if self._differences:
            stride = self.vector.strides(u)
            strides = torch.where(u + stride <= box[1], stride, -stride)
            found = difference_slopes(neighbors(self.seen, self.judge, u, strides), u, chosen, strides)
        elif keys & self._camera or pictures_for(self.seen, keys) > _PICTURES * values * len(self.seen):
            found = backward_slopes(self.assess, u, chosen)
        else:
            found = forward_slopes(self.seen, self.judge, u, chosen, box)
        # Supporting parameters have slope 0 for claims about a finish: a darker room does not make a sofa duller.
        assert found.here.finish is not None
        faked = found.here.finish[:, None] & self._supports[chosen]
        return found._replace(values=found.values.masked_fill(faked, 0.0))


def backward_slopes(assess: Callable[[Tensor], Assessment], u: Tensor, chosen: Tensor) -> Slopes:
    """Slopes at u (N,) over the chosen components (N,), by backward passes through a differentiable `assess`."""
    point = u.detach().clone().requires_grad_()
    found = assess(point)
    (slopes,) = gradients(found, [point])
    return Slopes(found.detached(), slopes[:-1, chosen], slopes[-1, chosen])


def gradients(found: Assessment, leaves: Sequence[Tensor], together: bool = False) -> list[Tensor]:
    """For each leaf, the gradients (M + 1, ...) of the M values of `found` and, last, of its rest.

    Values so far inside of their aims that no step leads out get 0. If `together`, backward passes run in batches: on
    a GPU a batch needs no more kernel launches than one pass.
    """
    near_end = (found.values < found.lower + _NEAR) | (found.values > found.upper - _NEAR)
    rows = [*found.values.unbind(), found.rest]
    needed = [i for i, near in enumerate(near_end.tolist()) if near and rows[i].requires_grad]
    size = _TOGETHER if together else 1
    passes = [needed[i : i + size] for i in range(0, len(needed), size)]
    if found.rest.requires_grad:  # a pass through an encoder is in no batch
        passes.append([len(rows) - 1])
    slopes = [leaf.new_zeros((len(rows), *leaf.shape)) for leaf in leaves]
    for some in passes:
        outputs, units = rows[some[0]], None
        if len(some) > 1:
            outputs, units = torch.stack([rows[i] for i in some]), torch.eye(len(some)).to(outputs)
        passed = torch.autograd.grad(
            outputs, leaves, units, True, allow_unused=True, is_grads_batched=units is not None
        )
        for slope, gradient in zip(slopes, passed, strict=True):
            if gradient is not None:
                slope[some] = gradient
    return [torch.nan_to_num(slope, 0.0, 0.0, 0.0) for slope in slopes]


@torch.no_grad()
def difference_slopes(assess: Callable[[Tensor], Assessment], u: Tensor, chosen: Tensor, strides: Tensor) -> Slopes:
    """Slopes at u (N,) over the components chosen (N,) bool: each is moved alone, by its stride in `strides` (N,)."""
    here = assess(u)
    columns = []
    for i in chosen.nonzero()[:, 0]:
        there = assess(u.index_add(0, i[None], strides[i, None]))
        moved = torch.cat([there.values - here.values, (there.rest - here.rest)[None]])
        columns.append(torch.nan_to_num(moved / strides[i], 0.0, 0.0, 0.0))
    slopes = torch.stack(columns, 1)
    return Slopes(here, slopes[:-1], slopes[-1])


@torch.no_grad()
def neighbors(seen: Sequence[ShotState], judge: _Judge, u: Tensor, strides: Tensor) -> Callable[[Tensor], Assessment]:
    """A function that assesses u (N,), or u with one component moved by its stride (N,), with shared ray tracing."""
    shots = [_ShotNeighbors(shot, u, strides) for shot in seen]
    return lambda point: judge([shot.picture(point) for shot in shots], point)


class _ShotNeighbors:
    """A shot's images of a point u and of its neighbors, moved in one component; arguments as for `neighbors`."""

    def __init__(self, shot: ShotState, u: Tensor, strides: Tensor) -> None:
        self._shot, self._u, self._moved, self._proxy = shot, u, u + strides, shot.corrected
        values = self._values(u)
        self._cache = self._proxy.traced(values)
        self._here = self._proxy.expose(values, self._cache)
        self._last: tuple[str, LatentImage] | None = None

    def picture(self, point: Tensor) -> Render:
        """The image of the point or a neighbor (N,)."""
        vector, latent = self._shot.vector, self._here
        differs = point != self._u
        for key, part in vector.slices.items():
            if not differs[part].any():
                continue
            group = vector.instances[key].parameter.group
            if group == "camera":
                return self._shot.draw(point)
            if group == "film":
                continue
            if self._last is None or self._last[0] != key:
                there = self._u.clone()
                there[part] = self._moved[part]
                self._last = key, self._proxy.expose(self._values(there), self._cache.aside())
            latent = self._last[1]
            if len(differs[part]) > 1:  # all components of a color are moved in one image, and each changes one channel
                linear = torch.where(differs[part], latent.linear, self._here.linear)
                latent = replace(self._here, linear=linear)
        return self._proxy.develop(latent, self._values(point))

    def _values(self, point: Tensor) -> dict[str, Tensor]:
        return chosen_values(self._shot.vector, point, self._proxy.device)


def pictures_for(seen: Sequence[ShotState], keys: set[str]) -> int:
    """Number of images that `forward_slopes` would draw for the shots `seen` and parameters `keys`."""
    named = [shot.vector.instances[own] for shot in seen for own, key in shot.names.items() if key in keys]
    return sum(instance.parameter.group != "film" for instance in named)


def forward_slopes(
    seen: Sequence[ShotState], judge: _Judge, u: Tensor, chosen: Tensor, box: tuple[Tensor, Tensor]
) -> Slopes:
    """Slopes at u (N,) over the components chosen (N,) bool, by the module's forward way; not for camera parameters."""
    point = u.detach().clone().requires_grad_()
    span = box[1] - box[0]
    move = torch.where(chosen, torch.where(u + _STEP * span > box[1], -_STEP, _STEP) * span, 0.0)
    nearby = [_ForwardShot(shot, u.detach(), chosen) for shot in seen]
    found = judge([each.picture(point) for each in nearby], point)
    leaves = [leaf for each in nearby for leaf in each.leaves]
    slopes, *others = gradients(found, [point, *leaves], together=leaves[0].is_cuda)
    for each in nearby:
        mine, others = others[: len(each.leaves)], others[len(each.leaves) :]
        with torch.no_grad():
            each.add(slopes, mine, move)
    return Slopes(found.detached(), slopes[:-1, chosen], slopes[-1, chosen])


class _ForwardShot:
    """The images of a shot near a point u (N,), along the chosen components (N,) bool."""

    def __init__(self, shot: ShotState, u: Tensor, chosen: Tensor) -> None:
        self._shot, self._u, self._proxy = shot, u, shot.corrected
        keys = {own for own, part in shot.vector.slices.items() if chosen[part].any()}
        self._film = {key for key in keys if shot.vector.instances[key].parameter.group == "film"}
        self._scene = keys - self._film
        self._values = chosen_values(shot.vector, u, self._proxy.device, keys)
        with torch.no_grad():
            self._cache = self._proxy.traced(self._values)
            self._here = self._proxy.expose(self._values, self._cache)
        # copies of the fields of the undeveloped image at u that parameters change; gradients end there
        self.leaves = [field.clone().requires_grad_() for field in _fields(self._here)]

    def picture(self, point: Tensor) -> Render:
        """The image of the point u (N,), differentiable in the leaves and in the film's values."""
        linear, transmittance, *alpha = self.leaves
        latent = replace(self._here, linear=linear, transmittance=transmittance, alpha=alpha[0] if alpha else None)
        values = chosen_values(self._shot.vector, point, self._proxy.device, self._film)
        return self._proxy.develop(latent, values)

    def add(self, slopes: Tensor, gradients: Sequence[Tensor], move: Tensor) -> None:
        """Adds slopes of the scene's parameters to `slopes` (M + 1, N): leaves' gradients times changes by `move`."""
        moved = self._shot.vector.along(self._u, move)
        for key in sorted(self._scene):
            part = self._shot.vector.slices[key]
            values = self._values | {key: moved[key].to(self._proxy.device)}
            there = self._proxy.expose(values, self._cache.aside())
            changes = [b - a for a, b in zip(_fields(self._here), _fields(there), strict=True)]
            if part.stop - part.start == 3:
                effect = torch.einsum("mhwc,hwc->mc", gradients[0], changes[0])
            else:
                pairs = zip(gradients, changes, strict=True)
                effect = torch.stack([g.flatten(1) @ change.flatten() for g, change in pairs]).sum(0)[:, None]
            slopes[:, part] += torch.where(move[part] != 0, effect.to(slopes) / move[part], 0.0)


def _fields(latent: LatentImage) -> list[Tensor]:
    """The fields of an undeveloped image that the scene's parameters change while the camera stands still."""
    return [field for field in (latent.linear, latent.transmittance, latent.alpha) if field is not None]
