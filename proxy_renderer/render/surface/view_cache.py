# SPDX-License-Identifier: Apache-2.0
"""What stays the same while the camera stands still: samples, surfaces, and per lamp its beam."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import torch
from torch import Tensor

from ...scene import Material, SceneData
from ...scene.values import wanted
from ..edges.shadow_edges import ShadowEdges
from ..edges.silhouette import Silhouettes
from ..geometry.camera import View
from ..geometry.gather_points import Spread
from ..geometry.samples import take
from ..geometry.vectors import dot, unit
from ..geometry.visibility import Geometry, Surface, facing
from ..lights.environment import Sky
from ..lights.irradiance import Arrival, arrival
from ..lights.lamps import Lamp
from ..lights.prefilter import GLOSSY, SATIN
from ..lights.shadows import Smoothing, shadow
from ..material.textures import Maps
from ..transport.indirect import Indirect
from ..transport.indirect_fog import MurkRays
from ..transport.refraction import through
from ..transport.secondary_hits import Far
from .view_samples import Beam, Sight

_SMALL_STEP = 0.02
"""Part of a lamp's distance by which a gradient loop may move it before bounced light is traced again."""

_LEAST_ALIKE = 0.1
"""Cosine between a mapped and the true normal below which the map cannot be meant."""
_GEOMETRIC = ("alpha", "normal", "far")


@dataclass
class _Shadowed:
    """A lamp's shadows (N,), and the beam that they make if nothing about it is learned."""

    signature: tuple[float, ...]
    visible: Tensor
    beam: Beam | None = None
    edges: ShadowEdges | None = None


@dataclass(frozen=True)
class Behind:
    """What rays (N,) through a transparent material meet: far hits, final directions (3, N), irradiance there."""

    far: Far
    toward: Tensor
    ambient: Spread


class ViewCache:
    """Everything that is traced and looked up once per camera position.

    Args:
        scene: The exported scene.
        geometry: Its triangles.
        view: The camera.
        metals: (M,) how much like a mirror each material is where others see it; 0 for what is no metal.
        smooth: (M,) bool: materials of which every pixel gets several samples.
        lamps: How many the scene has, the suns of its world and glowing surfaces included.
        glowing: Indices of materials whose light comes from lamps.
        seed: For jitter.
    """

    def __init__(
        self,
        scene: SceneData,
        geometry: Geometry,
        view: View,
        metals: Tensor,
        smooth: Tensor,
        lamps: int,
        glowing: Sequence[int],
        seed: int,
    ) -> None:
        self.scene, self.geometry, self.metals, self._lamps = scene, geometry, metals, lamps
        self.signature = view.signature()
        with torch.no_grad():
            self.samples = samples = take(geometry, view.detached(), smooth)
            self._hits = samples.hits.pick(slice(0, samples.surfaces))
            toward = samples.toward
            self._maps = Maps(scene, geometry.device, view.size)
            surface = geometry.surface(self._hits, toward[:, : samples.surfaces])
            self._sight = Sight.of(self._bumped(surface, toward), toward)
            self._smoothing = Smoothing(samples, self._sight.surface)
            generator = torch.Generator().manual_seed(seed)
            shape = metals, lamps, glowing, self._maps, generator
            self.indirect = Indirect(geometry, samples, self._sight.surface, view.detached(), *shape)
            self.mean_texture = [_mean(m, geometry.device) for m in scene.materials]
            self.inside, self.depth = self._inside(), self._depth()
            owner = geometry.object[self._hits.triangle]
            self._on_center = owner == samples.owner[samples.pixel[: samples.surfaces]]
            self.covered = samples.hits.hit.to(torch.float32)[None]
            self.mask = samples.resolve(self.inside).view(self.depth.shape)
        self._beams: dict[int, _Shadowed] = {}
        self._varying: dict[int, dict[str, Tensor]] = {}
        self._bounced: dict[int, Tensor] = {}
        self._outlines: Silhouettes | None = None
        self._murk: MurkRays | None = None
        self._view = view.detached()
        self._through: dict[tuple[int, int], tuple[float, object, Behind]] = {}
        self._worlds: tuple[object, tuple[Tensor, ...]] | None = None

    def sight(self, view: View) -> Sight:
        """The samples as the view sees them; re-evaluated with gradients when it asks for them."""
        if not view.moving:
            return self._sight
        origin, toward = view.rays(self.samples.place)
        n = self.samples.surfaces
        surface = self.geometry.follow(self._hits, origin[:, :n], toward[:, :n])
        return Sight.of(self._bumped(surface, toward), toward)

    def _bumped(self, surface: Surface, toward: Tensor) -> Surface:
        """The surface with the normals of its materials' maps, turned to the rays (3, N) as its own are."""
        slices = self.samples.slices
        if not any(self._maps.has(material, "normal") for material, _, _ in slices):
            return surface
        normals = []
        for material, start, stop in slices:
            part = surface.pick(slice(start, stop))
            normals.append(part.normal)
            if self._maps.has(material, "normal"):
                mapped = unit(self._maps.at(material, "normal", part) * 2 - 1)
                # a map that the camera did not see here may hold anything
                sound = dot(mapped, part.normal) > _LEAST_ALIKE
                normals[-1] = facing(torch.where(sound, mapped, part.normal), toward[:, start:stop])
        return replace(surface, normal=torch.cat(normals, 1))

    def inputs(self, material: int, part: slice, sight: Sight) -> dict[str, Tensor]:
        """What varies of a material's inputs (C, n) at its samples: "base_color", and parameters by name."""
        if sight.moving:
            return self._inputs(material, sight.surface.pick(part))
        if material not in self._varying:
            with torch.no_grad():
                self._varying[material] = self._inputs(material, self._sight.surface.pick(part))
        return self._varying[material]

    def _inputs(self, material: int, surface: Surface) -> dict[str, Tensor]:
        names = ["base_color", *(n for n in self.scene.materials[material].maps if n not in _GEOMETRIC)]
        return {
            name: self._maps.at(material, name, surface) for name in names if self._maps.has(material, name)
        }

    def beam(self, index: int, lamp: Lamp, sight: Sight, view: View) -> Beam:
        """A lamp's beam; its shadows are traced again when it has moved."""
        signature = lamp.signature()
        kept = self._beams.get(index)
        moving = lamp.moving or sight.moving
        if not moving and kept is not None and kept.signature == signature and kept.beam is not None:
            return kept.beam
        met = arrival(lamp, sight.surface.position, sight.surface.normal)
        if kept is None or kept.signature != signature:
            with torch.no_grad():
                kept = self._beams[index] = self._trace(lamp, signature, None if sight.moving else met)
            self._bounce(index, lamp)
        if moving:
            return Beam.of(lamp, sight, met, kept.visible + self._moving_shadow(kept, lamp, view))
        with torch.no_grad():
            kept.beam = Beam.of(lamp, self._sight, met, kept.visible)
        return kept.beam

    def _trace(self, lamp: Lamp, signature: tuple[float, ...], met: Arrival | None) -> _Shadowed:
        """Traces a lamp's shadows; what arrives at the samples is computed if it is not known."""
        surface = self._sight.surface
        still = lamp.detached()
        met = met or arrival(still, surface.position, surface.normal)
        visible = shadow(self.geometry, self._smoothing, surface, still, met, lamp.moving)
        return _Shadowed(signature, visible)

    def _moving_shadow(self, kept: _Shadowed, lamp: Lamp, view: View) -> Tensor:
        """Zeros (N,) with the gradient of a lamp's shadows, which move with lamp and camera."""
        if not lamp.light.shadow or lamp.glow:
            return torch.zeros_like(kept.visible)
        if kept.edges is None:
            with torch.no_grad():
                still = view.detached(), lamp.detached()
                kept.edges = ShadowEdges.of(self.geometry, self.samples, *still, kept.visible)
        term = kept.edges.term(view, lamp, self.depth.numel())
        return torch.where(self._on_center, term[self.samples.pixel[: self.samples.surfaces]], 0.0)

    def _bounce(self, index: int, lamp: Lamp) -> None:
        """Renews bounced light: at once after a jump, but only now and then on a gradient loop's small steps."""
        place = torch.tensor(lamp.signature())
        last = self._bounced.get(index)
        scale = place.abs().amax() * _SMALL_STEP
        if lamp.moving and last is not None and bool((place - last).abs().amax() < scale):
            return
        self._bounced[index] = place
        with torch.no_grad():
            self.indirect.light(index, lamp.detached())

    def behind(self, material: int, side: int, part: slice, ior: float, lamps: list[Lamp]) -> Behind:
        """What is seen through a material's samples; traced anew for a new IOR.

        Args:
            material: Its index.
            side: 0, or -1 and 1 for the IORs beside it: each is kept.
            part: Its samples.
            ior: Its IOR.
            lamps: The lights.
        """
        place = tuple(lamp.signature() for lamp in lamps)
        kept = self._through.get((material, side))
        if kept is None or abs(kept[0] - ior) > 1e-3:
            with torch.no_grad():
                toward = self.samples.toward[:, part]
                shape = ior, self.metals, self._lamps, self._maps
                far, onward = through(self.geometry, self._sight.surface.pick(part), toward, *shape)
            kept = ior, None, Behind(far, onward, self.indirect.spread_to(far))
        if kept[1] != place:
            with torch.no_grad():
                for i, lamp in enumerate(lamps):
                    kept[2].far.light(i, lamp.detached())
            kept = kept[0], place, kept[2]
        self._through[material, side] = kept
        return kept[2]

    def murk(self, near: float) -> MurkRays:
        """The rays along which fog acts between surfaces; `near` is a typical distance of what is seen, meters."""
        if self._murk is None:
            with torch.no_grad():
                self._murk = MurkRays(
                    self.geometry, self.samples, self._sight.surface, self._view, self.indirect.anchors, near
                )
        return self._murk

    def outlines(self) -> Silhouettes:
        """The outlines, for gradients with respect to the camera."""
        if self._outlines is None:
            with torch.no_grad():
                self._outlines = Silhouettes.of(self.samples, self._sight.surface)
        return self._outlines

    def worlds(self, sky: Sky, sight: Sight) -> tuple[Tensor, ...]:
        """Uncolored world in the mirror directions, sharp to blurred (3, N), and behind all (3, B).

        A picture has a third level between the two.
        """
        if wanted(sky.turn) or (sight.moving and not sky.plain):
            return _worlds(sky, sight)
        if self._worlds is None or self._worlds[0] != sky.signature():
            with torch.no_grad():
                self._worlds = sky.signature(), _worlds(sky, self._sight)
        return self._worlds[1]

    def _inside(self) -> Tensor:
        """(1, N + B) 1 for samples of the subject, else 0."""
        subject = torch.tensor([o.subject for o in self.scene.objects], device=self.geometry.device)
        owner = self.geometry.object[self.samples.hits.triangle.clamp_min(0)]
        return (subject[owner] & self.samples.hits.hit).to(torch.float32)[None]

    def _depth(self) -> Tensor:
        """(H, W) distance along the rays through the pixels' centers."""
        width, height = self.samples.size
        return self.samples.center_hits.distance.view(height, width)


def _worlds(sky: Sky, sight: Sight) -> tuple[Tensor, ...]:
    rough = (GLOSSY,) if sky.plain else (SATIN, GLOSSY)
    lobes = [sky.reflected(sight.mirrored, sight.surface.normal, sight.basis, r) for r in rough]
    return sky.mirror(sight.mirrored), *lobes, sky.seen(sight.beyond)


def _mean(material: Material, device: torch.device) -> Tensor:
    """(3,) average of a linked base color; 1 where none is linked."""
    if material.texture is None:
        return torch.ones(3, device=device)
    return torch.from_numpy(material.texture.image.mean((0, 1))).to(device)
