# SPDX-License-Identifier: Apache-2.0
"""The proxy's picture of an anchor, split by light. Light adds up: a picture of other powers and colors is a sum of layers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import torch
from torch import Tensor

from ..scene import SceneData
from ..schema import split_key
from .lights.environment import has_own_backdrop

_OF_LIGHTS = ("power", "strength", "color", "temperature")
_OF_WORLD = ("strength", "color", "tint")
_BLACK = 1e-9  # radiance of a light that was off
_BRIGHTER = 8.0  # times as bright as at the anchor: a layer of a light that hardly shone there is noise


@dataclass(frozen=True)
class AnchorLayers:
    """The proxy's own picture at some values, by what sheds its light."""

    values: Mapping[str, Tensor]  # key to (components,); missing ones are the scene's
    colors: Mapping[str, Tensor]  # owner, as "light/NAME" or "world", to the color (3,) of its light
    parts: Mapping[str, Tensor]  # the same owners to their light (3, P)
    rest: Tensor  # (3, P) light that belongs to no owner: of what glows

    def serve(self, values: Mapping[str, Tensor], scene: SceneData) -> bool:
        """True if other values differ from these only in powers and colors of lights, or in what the film does."""
        keys = (key for key in values.keys() | self.values.keys() if not key.startswith("film/"))
        return all(is_of_light(key, scene) or self._stays(key, values, scene) for key in keys)

    def _stays(self, key: str, values: Mapping[str, Tensor], scene: SceneData) -> bool:
        own = torch.tensor(scene.value(key), dtype=torch.float32)
        one, other = (each.get(key, own).detach().reshape(-1).cpu().float() for each in (values, self.values))
        return torch.equal(one, other)

    def picture(self, colors: Mapping[str, Tensor]) -> Tensor | None:
        """The picture (3, P) with owners' light of other colors (3,); None where a layer says too little of that."""
        whole = self.rest
        for owner, part in self.parts.items():
            before, now = self.colors[owner], colors[owner]
            off = before < _BLACK
            growth = torch.where(off, 1.0, now / torch.where(off, 1.0, before))
            if bool((growth > _BRIGHTER).any()) or bool((off & (now > _BLACK)).any()):
                return None
            whole = whole + part * growth[:, None]
        return whole


def is_of_light(key: str, scene: SceneData) -> bool:
    """True if a picture is linear in a parameter, or in the color of light that follows from it."""
    group, _, name = split_key(key)
    if group == "light":
        return name in _OF_LIGHTS
    # A backdrop of its own keeps its light when the world's changes.
    return group == "world" and name in _OF_WORLD and not has_own_backdrop(scene)
