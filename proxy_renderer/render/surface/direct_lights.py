# SPDX-License-Identifier: Apache-2.0
"""The direct light of each light on what the camera sees, kept as long as neither camera nor light moves."""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass
from typing import Self

import torch
from torch import Tensor

from ..edges.shadow_edges import ShadowEdges
from ..geometry.camera import View
from ..geometry.samples import Samples
from ..geometry.visibility import RayGeometry
from ..lights.cluster_shadows import ClusterShadows
from ..lights.clusters import LightClusters
from ..lights.shadows import ShadowFilter, shadow
from ..lights.types.light_source import DirectIrradiance, LightSource
from .view_samples import DirectLight, ViewSamples


@dataclass
class _Shadowed:
    """A light's shadows (N,), and its direct light if none of its values is learned."""

    signature: tuple[float, ...]
    visible: Tensor
    direct_light: DirectLight | None = None
    edges: ShadowEdges | None = None


class DirectLights:
    """Of one view."""

    def __init__(
        self, geometry: RayGeometry, samples: Samples, seen: ViewSamples, clusters: LightClusters
    ) -> None:
        self._geometry, self._samples, self._seen, self._clusters = geometry, samples, seen, clusters
        self._smoothing = ShadowFilter(samples, seen.surface)
        self._shared = ClusterShadows(geometry, self._smoothing, seen.surface, clusters)
        self._pixel = samples.pixel[: samples.surfaces]
        owner = geometry.object[samples.hits.triangle[: samples.surfaces]]
        self._on_center = owner == samples.owner[self._pixel]
        self._kept: dict[int, _Shadowed] = {}

    def aside(self) -> Self:
        """A copy for one picture, whose moved lights leave nothing behind in this one."""
        other = copy(self)
        other._kept = dict(self._kept)
        return other

    def forget_moved(self, index: int, lamps: Sequence[LightSource]) -> bool:
        """Forgets a light's shadows if it, or one of its cluster, has moved; returns whether they have to be traced."""
        kept = self._kept.get(index)
        if kept is not None and kept.signature == self._signature(index, lamps):
            return False
        self._kept.pop(index, None)
        return True

    def of(
        self, index: int, lamps: Sequence[LightSource], view_samples: ViewSamples, view: View
    ) -> DirectLight:
        """The direct light of one of the lights, as it was before unless `forget_moved`; differentiable where it, or the camera, moves.

        Args:
            view_samples: As the view sees the samples.
        """
        lamp, moving = lamps[index], lamps[index].moving or view_samples.moving
        kept = self._kept.get(index)
        if not moving and kept is not None and kept.direct_light is not None:
            return kept.direct_light
        direct = lamp.irradiance(view_samples.surface.position, view_samples.surface.normal)
        if kept is None:
            with torch.no_grad():
                kept = self._kept[index] = self._shadowed(
                    index, lamps, None if view_samples.moving else direct
                )
        if moving:
            visible = kept.visible + self._moving_shadow(kept, lamp, view)
            return DirectLight.of(lamp, view_samples, direct, visible)
        with torch.no_grad():
            kept.direct_light = DirectLight.of(lamp, self._seen, direct, kept.visible)
        return kept.direct_light

    def _signature(self, index: int, lamps: Sequence[LightSource]) -> tuple[float, ...]:
        members = self._clusters.clusters[self._clusters.row[index]].members
        return tuple(number for member in members for number in lamps[member].signature())

    def _shadowed(
        self, index: int, lamps: Sequence[LightSource], direct: DirectIrradiance | None
    ) -> _Shadowed:
        """Traces a light's shadows; its unshadowed irradiance is computed where the caller has none."""
        lamp, row, signature = lamps[index], self._clusters.row[index], self._signature(index, lamps)
        if len(self._clusters.clusters[row].members) > 1:
            return _Shadowed(signature, self._shared.of(row, lamps, signature))
        surface, still = self._seen.surface, lamp.detached()
        direct = direct or still.irradiance(surface.position, surface.normal)
        visible = shadow(self._geometry, self._smoothing, surface, still, direct, lamp.moving)
        return _Shadowed(signature, visible)

    def _moving_shadow(self, kept: _Shadowed, lamp: LightSource, view: View) -> Tensor:
        """Zeros (N,) with the gradient of a light's shadows, which move with light and camera."""
        if not lamp.has_shadow_edges:
            return torch.zeros_like(kept.visible)
        if kept.edges is None:
            with torch.no_grad():
                still = view.detached(), lamp.detached()
                kept.edges = ShadowEdges.of(self._geometry, self._samples, *still, kept.visible)
        width, height = self._samples.size
        term = kept.edges.term(view, lamp, width * height)
        return torch.where(self._on_center, term[self._pixel], 0.0)
