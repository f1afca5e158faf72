# SPDX-License-Identifier: Apache-2.0
"""Slopes of what is judged in pictures, forward: a picture beside for each parameter, a backward pass through the film.

The picture of a scene takes a fraction of a backward pass through it, and a parameter's components can share one: light of
one color stays light of that color until it is developed, so the components of a color change the channels of a picture
each on their own (Curtis, Powell and Reid 1974). The film and the claims are differentiated, which is cheap.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import torch
from torch import Tensor

from .drawing import chosen_values
from .inner.slopes import gradients
from .least_squares import Assessment, Slopes
from .shots import ShotState

if TYPE_CHECKING:
    from ..render.proxy import LatentImage, Render

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
        self._shot, self._u, self._proxy = shot, u, shot.proxy
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
