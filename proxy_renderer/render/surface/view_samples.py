# SPDX-License-Identifier: Apache-2.0
"""The samples as the camera sees them, and the direct light that they get."""

from __future__ import annotations

from dataclasses import dataclass, field

from torch import Tensor

from ...scene.values import wanted
from ..geometry.directions import above, reflect
from ..geometry.vectors import dot
from ..geometry.visibility import Surface
from ..lights.area_specular import AreaSpecular, area_specular
from ..lights.types.light_source import DirectIrradiance, LightSource
from ..material import albedo
from ..transport.fog import FogMedium, LightPaths


@dataclass(frozen=True)
class ViewSamples:
    """The samples as the camera sees them; differentiable when the camera is.

    Attributes:
        surface: What N samples meet.
        toward_eye: (3, N) unit vectors.
        basis: (7, N) albedo basis of the viewing cosine.
        mirrored: (3, N) mirror directions.
        beyond: (3, B) directions of the samples that meet nothing.
    """

    surface: Surface
    toward_eye: Tensor
    basis: Tensor
    mirrored: Tensor
    beyond: Tensor

    @staticmethod
    def of(surface: Surface, toward: Tensor) -> ViewSamples:
        """From the surface at the first N of the rays (3, N + B)."""
        n = surface.position.shape[1]
        cosine = -dot(surface.normal, toward[:, :n])
        mirrored = above(reflect(toward[:, :n], surface.normal), surface.facet)
        return ViewSamples(
            surface, -toward[:, :n], albedo.basis(cosine.clamp(1e-3, 1.0)), mirrored, toward[:, n:]
        )

    @property
    def moving(self) -> bool:
        """Whether gradients with respect to the camera are wanted."""
        # A camera that only comes nearer turns no ray.
        return wanted(self.toward_eye, self.surface.position)


@dataclass(frozen=True)
class DirectLight:
    """Direct light of one light at N samples, per unit of its color.

    Attributes:
        irradiance: (N,) shadowed.
        area_specular: The shadowed highlight; None for glowing surfaces and wide suns, which reflections show.
        paths: From the samples to the light.
    """

    irradiance: Tensor
    area_specular: AreaSpecular | None
    paths: LightPaths
    _parts: dict[int, AreaSpecular] = field(default_factory=dict, repr=False, compare=False)

    def part(self, samples: slice) -> AreaSpecular:
        """The highlight at the samples of one material; the same object every time, because it caches lobes."""
        assert self.area_specular
        if samples.start not in self._parts:
            self._parts[samples.start] = self.area_specular.pick(samples)
        return self._parts[samples.start]

    def through(self, fog: FogMedium) -> DirectLight:
        """The same behind the fog between light and samples."""
        passing = self.paths.transmittance(fog)
        specular = self.area_specular and self.area_specular.times(passing)
        return DirectLight(self.irradiance * passing, specular, self.paths)

    @staticmethod
    def of(
        lamp: LightSource, view_samples: ViewSamples, direct: DirectIrradiance, visible: Tensor
    ) -> DirectLight:
        """From unshadowed irradiance and the visible share (N,) of the light."""
        point, normal = view_samples.surface.position, view_samples.surface.normal
        specular = None
        if not lamp.pictured:
            specular = area_specular(lamp, direct, point, normal, view_samples.toward_eye).times(visible)
        paths = LightPaths(point, direct.toward, direct.distance)
        return DirectLight(direct.irradiance * visible, specular, paths)
