# SPDX-License-Identifier: Apache-2.0
"""What is judged right beside a point, as differences ask for it: little is rendered again for each component.

What the film does is done to the picture that is there. Components of a color change the channels of a picture each on
their own until it is developed, so one picture serves all three (Curtis, Powell and Reid 1974). Lamps that move leave no trace.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import torch
from torch import Tensor

from .drawing import chosen_values
from .least_squares import Assessment
from .shots import ShotState

if TYPE_CHECKING:
    from ..render.proxy import LatentImage, Render


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
        self._shot, self._u, self._moved, self._proxy = shot, u, u + strides, shot.proxy
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
