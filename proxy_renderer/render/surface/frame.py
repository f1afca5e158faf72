# SPDX-License-Identifier: Apache-2.0
"""The state of one render, and which values make rays be traced again."""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace

import torch
from torch import Tensor

from ...color.tensors import luminance
from ..geometry.camera import View
from ..lights.environment import Sky
from ..lights.types.light_source import LightSource
from ..material import albedo
from ..material.shading_inputs import ShadingInputs
from ..transport.fog import FogMedium
from .view_cache import ViewCache
from .view_samples import ViewSamples

_SMOOTH = 0.25
"""Roughness below which reflections are sharp."""
_LEAST_COAT = 0.05
_GLASS_STEPS = 8
"""Steps in which light through glass changes: shadows are traced again at each."""


@dataclass(frozen=True)
class RenderState:
    """The state of one render: camera, samples, lights, world, materials, fog.

    Attributes:
        view: The camera.
        cache: What has been traced for it.
        view_samples: The samples as it sees them.
        lamps: The lights: the scene's, the environment's suns, glowing surfaces.
        sky: The world.
        shading_inputs: Of every material.
        fog: The medium.
    """

    view: View
    cache: ViewCache
    view_samples: ViewSamples
    lamps: list[LightSource]
    sky: Sky
    shading_inputs: list[ShadingInputs]
    fog: FogMedium

    @functools.cached_property
    def colors(self) -> Tensor:
        """(L, 3) colors of the lamps."""
        return (
            torch.stack([lamp.color for lamp in self.lamps])
            if self.lamps
            else self.sky.color.new_zeros((0, 3))
        )

    @functools.cached_property
    def sources(self) -> list[LightSource]:
        """The lights of indirect light: few ones as they are, many in clusters."""
        return self.cache.clusters.sources(self.lamps)

    @property
    def owners(self) -> dict[str, Tensor]:
        """Owner, "light/NAME" or "world", to the color (3,) of its light."""
        return {**{lamp.owner: lamp.color for lamp in self.lamps if lamp.owner}, "world": self.sky.color}

    def only(self, owner: str) -> RenderState:
        """The same with one owner's light only ("" for no owner's), and with what surfaces emit."""
        dark = torch.zeros_like(self.sky.color)
        return replace(
            self,
            lamps=[lamp if lamp.owner in (owner, "") else replace(lamp, color=dark) for lamp in self.lamps],
            sky=self.sky if owner == "world" else replace(self.sky, color=dark, backdrop_color=dark),
        )


def mirror_weight(inputs: ShadingInputs) -> Tensor:
    """Weight () of mirror reflection where other surfaces show a material: 1 - roughness of a metal, else 0.

    In quarters, because rays are traced again when it changes.
    """
    smooth = (1 - inputs.roughness.detach()) * (inputs.metallic.detach() > 0.5)
    return (smooth * 4).ceil() / 4


def sharp(inputs: ShadingInputs) -> Tensor:
    """Whether () a material shows reflections sharp enough for several samples in every pixel."""
    shines = (inputs.metallic > 0) | (inputs.specular > 0) | (inputs.transmission > 0)
    coated = (inputs.coat > _LEAST_COAT) & (inputs.coat_roughness < _SMOOTH)
    return (coated | (shines & (inputs.roughness < _SMOOTH))).reshape(())


def glass_transmittance(inputs: ShadingInputs) -> Tensor:
    """Gray transmittance () of one surface of a material's glass, in steps: shadows are traced again at each.

    Cycles finds such light by chance, as caustics. Here it goes straight on, which is right on average. A
    Principled BSDF tints it with the root of its base color at each surface (kernel/svm/closure.h).
    """
    solid = inputs.transmission * (1 - inputs.metallic)
    through = solid * (1 - albedo.f0_of(inputs.ior)) * luminance(inputs.base.clamp(0, 1)).sqrt()
    return (through.detach() * _GLASS_STEPS).round().reshape(()) / _GLASS_STEPS
