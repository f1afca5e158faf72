# SPDX-License-Identifier: Apache-2.0
"""Spots: point lights behind a round mask (kernel/light/spot.h)."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import ClassVar

import torch
from jaxtyping import Float
from torch import Tensor

from ....scene import Light, SceneData
from ....scene.values import RenderValues, wanted
from ...geometry.vectors import dot
from .point import PointLight

_SOFT_RIM = 0.01
"""Radius of a spot, seen from a point, above which the rim of its cone is averaged over the light."""
_RIM_POINTS = 9


@dataclass(frozen=True)
class SpotLight(PointLight):
    """A point light that shines into a cone; inside it is as bright as a point light of the same power.

    Attributes:
        cone: () full opening angle, radians; that of the scene's record where none is given.
    """

    cone: Float[Tensor, ""] = field(default_factory=lambda: torch.tensor(math.nan))
    segment_parts: ClassVar[int] = 4  # its cone has an edge

    def __post_init__(self) -> None:
        if self.cone.isnan():
            object.__setattr__(self, "cone", self.size.new_tensor(self.light.spot_size))

    @classmethod
    def of(cls, light: Light, scene: SceneData, values: RenderValues) -> SpotLight:
        """See `LightSource.of`."""
        opening = values.scalar(f"light/{light.name}/cone", math.degrees(light.spot_size))
        return replace(super().of(light, scene, values), cone=torch.deg2rad(opening))

    @property
    def moving(self) -> bool:
        """Whether gradients with respect to its place, direction, size or cone are wanted."""
        return super().moving or wanted(self.cone)

    def signature(self) -> tuple[float, ...]:
        """See `LightSource.signature`."""
        return (*super().signature(), float(self.cone.detach()))

    def detached(self) -> SpotLight:
        """See `LightSource.detached`."""
        return replace(super().detached(), cone=self.cone.detach())

    def directivity(
        self, toward: Float[Tensor, "3 n"], radius: Float[Tensor, " n"] | None = None
    ) -> Float[Tensor, " n"]:
        """Blender's smoothstep between the cone's rim and its blend.

        Cycles evaluates it at the point of the light that it has sampled: a large light has a soft rim. The mean over
        the disc that faces a point needs only the offsets across the rim, which Gauss and Chebyshev's rule of the
        second kind weighs as a disc does.

        Args and returns are those of `PointLight.directivity`.
        """
        edge = torch.cos(self.cone / 2)
        slope = 1.0 / ((1.0 - edge) * self.light.spot_blend).clamp_min(1e-5)
        cosine = dot(toward, self.axes[:, 2:3])
        if radius is None or not bool((radius > _SOFT_RIM).any()):
            return _smoothstep((cosine - edge) * slope)
        reach = radius * (1 - cosine * cosine).clamp_min(1e-6).sqrt()
        shrink = (1 + radius * radius / 2).rsqrt()
        result = torch.zeros_like(cosine)
        for k in range(1, _RIM_POINTS + 1):
            angle = k * math.pi / (_RIM_POINTS + 1)
            step = _smoothstep(((cosine + reach * math.cos(angle)) * shrink - edge) * slope)
            result = result + step * (2 / (_RIM_POINTS + 1) * math.sin(angle) ** 2)
        return result


def _smoothstep(t: Tensor) -> Tensor:
    t = t.clamp(0.0, 1.0)
    return t * t * (3 - 2 * t)
