# SPDX-License-Identifier: Apache-2.0
"""What one eye sees of the samples, and what a lamp sends to them."""

from __future__ import annotations

from dataclasses import dataclass, field

from torch import Tensor

from ...scene.values import wanted
from ..geometry.directions import above, reflect
from ..geometry.vectors import dot
from ..geometry.visibility import Surface
from ..lights.area_specular import Highlight, highlight
from ..lights.irradiance import Arrival
from ..lights.lamps import Lamp
from ..material import albedo
from ..transport.fog import Fog, Ways


@dataclass(frozen=True)
class Sight:
    """The samples as one eye sees them; differentiable when the camera is.

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
    def of(surface: Surface, toward: Tensor) -> Sight:
        """From the surface at the first N of the rays (3, N + B)."""
        n = surface.position.shape[1]
        cosine = -dot(surface.normal, toward[:, :n])
        mirrored = above(reflect(toward[:, :n], surface.normal), surface.facet)
        return Sight(surface, -toward[:, :n], albedo.basis(cosine.clamp(1e-3, 1.0)), mirrored, toward[:, n:])

    @property
    def moving(self) -> bool:
        """Whether gradients with respect to the camera are wanted."""
        # A camera that only comes nearer turns no ray.
        return wanted(self.toward_eye, self.surface.position)


@dataclass(frozen=True)
class Beam:
    """A lamp's shadowed irradiance (N,) and highlight at all samples, per unit of its color, and its ways to them.

    Glowing surfaces and wide suns have no highlight: reflections show them.
    """

    irradiance: Tensor
    highlight: Highlight | None
    ways: Ways
    _parts: dict[int, Highlight] = field(default_factory=dict, repr=False, compare=False)

    def part(self, samples: slice) -> Highlight:
        """The highlight at the samples of one material; the same object every time, for what it keeps."""
        assert self.highlight
        if samples.start not in self._parts:
            self._parts[samples.start] = self.highlight.pick(samples)
        return self._parts[samples.start]

    def through(self, fog: Fog) -> Beam:
        """The beam after the fog between lamp and samples."""
        passing = self.ways.transmittance(fog)
        shine = self.highlight and self.highlight.times(passing)
        return Beam(self.irradiance * passing, shine, self.ways)

    @staticmethod
    def of(lamp: Lamp, sight: Sight, met: Arrival, visible: Tensor) -> Beam:
        """From what arrives unshadowed, and the share (N,) of the lamp that is seen."""
        point, normal = sight.surface.position, sight.surface.normal
        shine = None
        if not lamp.pictured:
            shine = highlight(lamp, met, point, normal, sight.toward_eye).times(visible)
        ways = Ways(point, met.toward, met.distance)
        return Beam(met.irradiance * visible, shine, ways)
