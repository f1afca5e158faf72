# SPDX-License-Identifier: Apache-2.0
"""The samples as the camera sees them, and the direct light of each light on them, kept while neither camera nor light moves."""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, field
from typing import Self

import torch
from torch import Tensor

from ...scene.values import Recent, needs_gradient
from ..geometry.camera import View
from ..geometry.samples import Samples
from ..geometry.vectors import above, dot, reflect
from ..geometry.visibility import RayGeometry, Surface
from ..lights.area_specular import AreaSpecular, area_specular
from ..lights.light_source import DirectIrradiance, LightSource
from ..lights.shadows import LightClusters, ShadowFilter, cluster_shadow, shadow
from ..material import albedo
from ..transport.fog import FogMedium, LightPaths
from .edges import ShadowEdges


@dataclass
class _Shadowed:
    """The visible share (N,) of a light, and the direct light if it needs no gradients."""

    signature: tuple[float, ...]
    visible: Tensor
    direct_light: DirectLight | None = None
    edges: ShadowEdges | None = None


class DirectLights:
    """The direct light of each light in one view, whose samples are `seen`."""

    def __init__(self, geometry: RayGeometry, samples: Samples, seen: ViewSamples, clusters: LightClusters) -> None:
        self._geometry, self._samples, self._seen, self._clusters = geometry, samples, seen, clusters
        self._smoothing = ShadowFilter(samples, seen.surface)
        self._pixel = samples.pixel[: samples.surfaces]
        owner = geometry.object[samples.hits.triangle[: samples.surfaces]]
        self._on_center = owner == samples.owner[self._pixel]
        self._kept: dict[int, _Shadowed] = {}
        self._shared: dict[int, tuple[tuple[float, ...], Tensor]] = {}  # shadows of clusters, by row

    def aside(self) -> Self:
        """A copy in which lights may move while this one stays as it is."""
        other = copy(self)
        other._kept = dict(self._kept)
        return other

    def forget_moved(self, index: int, lamps: Sequence[LightSource]) -> bool:
        """Drops a light's shadows if the light, or another of its cluster, has moved; returns whether they have to be traced."""
        kept = self._kept.get(index)
        if kept is not None and kept.signature == self._signature(index, lamps):
            return False
        self._kept.pop(index, None)
        return True

    def of(self, index: int, lamps: Sequence[LightSource], view_samples: ViewSamples, view: View) -> DirectLight:
        """The direct light of a light, kept until `forget_moved` drops it; differentiable if light or camera moves."""
        lamp, moving = lamps[index], lamps[index].moving or view_samples.moving
        kept = self._kept.get(index)
        if not moving and kept is not None and kept.direct_light is not None:
            return kept.direct_light
        direct = lamp.irradiance(view_samples.surface.position, view_samples.surface.normal)
        if kept is None:
            with torch.no_grad():
                kept = self._kept[index] = self._shadowed(index, lamps, None if view_samples.moving else direct)
        if not moving:
            with torch.no_grad():
                kept.direct_light = DirectLight.of(lamp, self._seen, direct, kept.visible)
            return kept.direct_light
        visible = kept.visible
        if lamp.light.shadow and lamp.owner:  # surfaces that glow do not move
            if kept.edges is None:
                with torch.no_grad():
                    still = view.detached(), lamp.detached()
                    kept.edges = ShadowEdges.of(self._geometry, self._samples, *still, visible)
            # Zeros whose gradient is that of the light's shadows, which move with light and camera.
            term = kept.edges.term(view, lamp, self._samples.size[0] * self._samples.size[1])
            visible = visible + torch.where(self._on_center, term[self._pixel], 0.0)
        return DirectLight.of(lamp, view_samples, direct, visible)

    def _signature(self, index: int, lamps: Sequence[LightSource]) -> tuple[float, ...]:
        members = self._clusters.clusters[self._clusters.row[index]].members
        return tuple(number for member in members for number in lamps[member].signature())

    def _shadowed(self, index: int, lamps: Sequence[LightSource], direct: DirectIrradiance | None) -> _Shadowed:
        """Traces a light's shadows; its unshadowed irradiance is computed where the caller has none."""
        row, signature = self._clusters.row[index], self._signature(index, lamps)
        view, cluster = (self._geometry, self._smoothing), self._clusters.clusters[row]
        if len(cluster.members) > 1:
            if row not in self._shared or self._shared[row][0] != signature:
                self._shared[row] = signature, cluster_shadow(*view, cluster, lamps)
            return _Shadowed(signature, self._shared[row][1])
        still = lamps[index].detached()
        direct = direct or still.irradiance(self._seen.surface.position, self._seen.surface.normal)
        return _Shadowed(signature, shadow(*view, still, direct, lamps[index].moving))


@dataclass(frozen=True)
class ViewSamples:
    """The samples as the camera sees them; differentiable when the camera is."""

    surface: Surface  # what N samples meet
    toward_eye: Tensor  # (3, N) unit vectors
    basis: Tensor  # (7, N) albedo basis of the viewing cosine
    mirrored: Tensor  # (3, N) mirror directions
    beyond: Tensor  # (3, B) directions of the samples that meet nothing
    _parts: dict[int, Tensor] = field(default_factory=dict, repr=False, compare=False)

    def part(self, samples: slice) -> Tensor:
        """The albedo basis (7, n) at the samples of one material; the same object every time, see `ShadingInputs.seen`."""
        if samples.start not in self._parts:
            self._parts[samples.start] = self.basis[:, samples]
        return self._parts[samples.start]

    @staticmethod
    def of(surface: Surface, toward: Tensor) -> ViewSamples:
        """From the surface at the first N of the rays (3, N + B)."""
        n = surface.position.shape[1]
        cosine = -dot(surface.normal, toward[:, :n])
        mirrored = above(reflect(toward[:, :n], surface.normal), surface.facet)
        return ViewSamples(surface, -toward[:, :n], albedo.basis(cosine.clamp(1e-3, 1.0)), mirrored, toward[:, n:])

    @property
    def moving(self) -> bool:
        """True if gradients with respect to the camera are wanted."""
        # If only the camera's position is learned, rays do not turn.
        return needs_gradient(self.toward_eye, self.surface.position)


@dataclass(frozen=True)
class DirectLight:
    """Direct light of one light at N samples, per unit of its color."""

    irradiance: Tensor  # (N,) shadowed
    area_specular: AreaSpecular | None  # shadowed; None for glowing surfaces and wide suns
    paths: LightPaths  # from the samples to the light
    _parts: dict[int, AreaSpecular] = field(default_factory=dict, repr=False, compare=False)
    _fogged: Recent = field(default_factory=Recent, repr=False, compare=False)

    def part(self, samples: slice) -> AreaSpecular:
        """The highlight at the samples of one material; the same object every time, because it caches lobes."""
        assert self.area_specular
        if samples.start not in self._parts:
            self._parts[samples.start] = self.area_specular.pick(samples)
        return self._parts[samples.start]

    def through(self, fog: FogMedium) -> DirectLight:
        """The direct light dimmed by the fog between light and samples; the same fog gives the same object, because it caches lobes."""

        def dimmed() -> DirectLight:
            passing = self.paths.transmittance(fog)
            specular = self.area_specular and self.area_specular.times(passing)
            return DirectLight(self.irradiance * passing, specular, self.paths)

        return dimmed() if fog.signature is None else self._fogged.of("", fog.signature, dimmed)

    @staticmethod
    def of(lamp: LightSource, view_samples: ViewSamples, direct: DirectIrradiance, visible: Tensor) -> DirectLight:
        """From unshadowed irradiance and the visible share (N,) of the light."""
        surface, specular = view_samples.surface, None
        if not lamp.pictured:
            unshadowed = area_specular(lamp, direct, surface.position, surface.normal, view_samples.toward_eye)
            specular = unshadowed.times(visible * lamp.reaches("glossy"))
        paths = LightPaths(surface.position, direct.toward, direct.distance)
        return DirectLight(direct.irradiance * visible * lamp.reaches("diffuse"), specular, paths)
