# SPDX-License-Identifier: Apache-2.0
"""All that one render is made of, and what of it has to be traced again when values change."""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace

import torch
from torch import Tensor

from ...color.tensors import luminance
from ..geometry.camera import View
from ..lights.environment import Sky
from ..lights.lamps import Lamp
from ..material import albedo
from ..material.shading_inputs import Paint
from ..transport.fog import Fog
from .view_cache import ViewCache
from .view_samples import Sight

_SMOOTH = 0.25
"""Roughness below which reflections are sharp."""
_LEAST_COAT = 0.05
_GLASS_STEPS = 8
"""Steps in which light through glass changes: shadows are traced again at each."""


@dataclass(frozen=True)
class Frame:
    """All that one render is made of."""

    view: View
    cache: ViewCache
    sight: Sight
    lamps: list[Lamp]
    sky: Sky
    paints: list[Paint]
    fog: Fog

    @functools.cached_property
    def colors(self) -> Tensor:
        """(L, 3) colors of the lamps."""
        return (
            torch.stack([lamp.color for lamp in self.lamps])
            if self.lamps
            else self.sky.color.new_zeros((0, 3))
        )

    @property
    def owners(self) -> dict[str, Tensor]:
        """Owner, "light/NAME" or "world", to the color (3,) of its light."""
        return {**{lamp.owner: lamp.color for lamp in self.lamps if not lamp.glow}, "world": self.sky.color}

    def only(self, owner: str) -> Frame:
        """The same with the light of one owner, "" for none, besides what surfaces emit."""
        dark = torch.zeros_like(self.sky.color)
        return replace(
            self,
            lamps=[lamp if lamp.owner in (owner, "") else replace(lamp, color=dark) for lamp in self.lamps],
            sky=self.sky if owner == "world" else replace(self.sky, color=dark),
        )


def mirroring(paint: Paint) -> Tensor:
    """How much like a mirror () a material is where other surfaces show it, in coarse steps; 0 if it is no metal."""
    smooth = (1 - paint.roughness.detach()) * (paint.metallic.detach() > 0.5)
    return (smooth * 4).ceil() / 4


def sharp(paint: Paint) -> Tensor:
    """Whether () a material shows reflections sharp enough for several samples in every pixel."""
    shines = (paint.metallic > 0) | (paint.specular > 0) | (paint.transmission > 0)
    coated = (paint.coat > _LEAST_COAT) & (paint.coat_roughness < _SMOOTH)
    return (coated | (shines & (paint.roughness < _SMOOTH))).reshape(())


def glassy(paint: Paint) -> Tensor:
    """Share () of light that passes a surface of a material's glass, in coarse steps and grey.

    Cycles finds such light by chance, as caustics. Here it goes straight on, which is right on average. A
    Principled BSDF tints it with the root of its base color at each surface (kernel/svm/closure.h).
    """
    solid = paint.transmission * (1 - paint.metallic)
    through = solid * (1 - albedo.f0_of(paint.ior)) * luminance(paint.base.clamp(0, 1)).sqrt()
    return (through.detach() * _GLASS_STEPS).round().reshape(()) / _GLASS_STEPS
