# SPDX-License-Identifier: Apache-2.0
"""Everything that stays the same while the camera stands still: samples, surfaces, direct light, and depth of field."""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Self

import numpy as np
import torch
from torch import Tensor

from ...color.tensors import luminance
from ...scene import Camera, SceneData
from ...scene.values import Recent, needs_gradient
from ..geometry.camera import View
from ..geometry.gather_points import SparseWeights
from ..geometry.samples import pixel_centers, take
from ..geometry.vectors import dot, unit
from ..geometry.visibility import RayGeometry, Surface, facing
from ..lights.emitters import Emitters
from ..lights.environment import GLOSSY, SATIN, Sky
from ..lights.light_source import LightSource
from ..lights.shadows import LightClusters
from ..material.inputs import MaterialTextures
from ..transport.indirect import FinalGather, IndirectFogRays
from ..transport.secondary_hits import SecondaryHits, through
from .direct_lights import DirectLight, DirectLights, Silhouettes, ViewSamples

_SMALL_STEP = 0.02  # relative change of a light's placement up to which gradient loops keep its bounced light
_LEAST_ALIKE = 0.1  # cosine between a mapped and the true normal below which the map does not count
_GEOMETRIC = ("alpha", "normal", "far")  # texture maps that are no shading inputs
_FIRST_RADIUS, _RADIUS_GROWTH = 0.75, 1.5  # radius in pixels of the first blurred layer; ratio to the next
_MOST_RADIUS = 0.12  # largest radius, in parts of the image's longer side
_LEAST_RADIUS = 0.2  # radius in pixels below which a whole image counts as sharp


@dataclass(frozen=True)
class GBuffer:
    """Images of the surfaces that the camera sees."""

    subject: Tensor  # (H, W) share of each pixel that the subject covers
    material: Tensor  # (H, W) int64, number of the material in the pixel's middle; -1 for the world
    materials: tuple[str, ...]  # names of the materials by number
    normal: Tensor  # (H, W, 3) unit normals, x to the right, y up, z towards the camera; zero for the world
    transmittance: Tensor  # (H, W) share of light that fog lets through between what is seen and the camera
    pattern: Tensor  # (H, W) luminance of textured base colors relative to their material's mean; else 1
    # names of materials of the surroundings; the subject may use them too, but words about the subject leave them alone
    surrounding: tuple[str, ...] = ()
    # (H, W, 3) display image with all surfaces gray, so that its colors are those of the light; black for the world;
    # None if not rendered
    gray: Tensor | None = None


class ViewCache:
    """Samples, shadows and bounced light that are traced once per camera position.

    `metals` (M,) are the materials' weights of mirror reflection, 0 for all but metals. Pixels of `smooth` materials
    (M,) bool get several samples. `lamps` are all lights, with the suns of the world and glowing surfaces.
    """

    def __init__(
        self,
        scene: SceneData,
        geometry: RayGeometry,
        view: View,
        metals: Tensor,
        smooth: Tensor,
        lamps: Sequence[LightSource],
        emitters: Emitters,
        seed: int,
    ) -> None:
        self.scene, self.geometry, self.metals = scene, geometry, metals
        self.signature = view.signature()
        moving = [lamp.moving for lamp in lamps]  # asked while gradients are enabled: inside, none would move
        with torch.no_grad():
            self.samples = samples = take(geometry, view.detached(), smooth)
            self._hits = samples.hits.pick(slice(0, samples.surfaces))
            toward = samples.toward
            self._maps = MaterialTextures(scene, geometry.device, view.size)
            surface = geometry.surface(self._hits, toward[:, : samples.surfaces])
            self._view_samples = ViewSamples.of(self._bumped(surface, toward), toward)
            surface = self._view_samples.surface
            self.clusters = LightClusters.of(lamps, moving, surface)
            self._direct = DirectLights(geometry, samples, self._view_samples, self.clusters)
            self.view = view.detached()
            shape = metals, len(self.clusters), emitters, self._maps, torch.Generator().manual_seed(seed)
            self.indirect = FinalGather(geometry, samples, surface, self.view, *shape)
            # (3,) average of every material's linked base color; 1 where none is linked
            plain = np.ones(3, np.float32)
            means = (m.texture.image.mean((0, 1)) if m.texture else plain for m in scene.materials)
            self.mean_texture = [torch.from_numpy(mean).to(geometry.device) for mean in means]
            # (1, N + B) 1 or 0 by sample: no holdout; on the subject; on any surface
            subject = torch.tensor([o.subject for o in scene.objects], device=geometry.device)
            owner = geometry.object[samples.hits.triangle.clamp_min(0)]
            holdout = torch.tensor(["film" in o.hidden for o in scene.objects], device=geometry.device)
            shown = ~holdout[owner] | ~samples.hits.hit
            self.on_film = shown.to(torch.float32)[None]
            self.inside = (subject[owner] & samples.hits.hit & shown).to(torch.float32)[None]
            self.covered = samples.hits.hit.to(torch.float32)[None]
            # (H, W) distance along the rays through pixel centers
            self.depth = samples.center_hits.distance.view(view.size[::-1])
            self.defocus = Defocus.of(scene.camera, view.detached(), self.depth)
            self.mask = samples.resolve(self.inside).view(self.depth.shape)
        self._varying: dict[int, dict[str, Tensor]] = {}
        self._bounced: dict[int, LightSource] = {}
        self._indirect_fog: IndirectFogRays | None = None
        self._through: dict[tuple[int, int], tuple[float, Any, SecondaryHits, SparseWeights]] = {}
        self._worlds = Recent()

    def aside(self) -> Self:
        """A copy in which lights may move while this cache stays as it is."""
        other = copy(self)
        other._direct, other._bounced = self._direct.aside(), dict(self._bounced)
        other._through, other.indirect = dict(self._through), self.indirect.aside()
        return other

    def with_mirrors(self, metals: Tensor) -> Self:
        """A copy with other mirror weights (M,), in which only what mirrors show is traced again."""
        other = self.aside()
        other.metals, other._through = metals, {}
        with torch.no_grad():
            other.indirect = self.indirect.with_mirrors(metals, self._bounced)
        return other

    def view_samples(self, view: View) -> ViewSamples:
        """The samples as the view sees them; computed again, with gradients, if the view needs them."""
        if not view.moving:
            return self._view_samples
        origin, toward = view.rays(self.samples.place)
        n = self.samples.surfaces
        surface = self.geometry.follow(self._hits, origin[:, :n], toward[:, :n])
        return ViewSamples.of(self._bumped(surface, toward), toward)

    def _bumped(self, surface: Surface, toward: Tensor) -> Surface:
        """The surface with normals from its materials' normal maps, turned to face the rays (3, N + B)."""
        slices = self.samples.slices
        if not any(self._maps.has(material, "normal") for material, _, _ in slices):
            return surface
        normals = []
        for material, start, stop in slices:
            part = surface.pick(slice(start, stop))
            normals.append(part.normal)
            if self._maps.has(material, "normal"):
                mapped = unit(self._maps.at(material, "normal", part) * 2 - 1)
                # where the exported camera did not see the surface, a map may have any value
                sound = dot(mapped, part.normal) > _LEAST_ALIKE
                normals[-1] = facing(torch.where(sound, mapped, part.normal), toward[:, start:stop])
        return replace(surface, normal=torch.cat(normals, 1))

    def textured_inputs(self, material: int, part: slice, view_samples: ViewSamples) -> dict[str, Tensor]:
        """Name of a textured input, "base_color" or a parameter -> values (C, n) at a material's samples `part`."""
        if material in self._varying and not view_samples.moving:
            return self._varying[material]
        names = ["base_color", *(n for n in self.scene.materials[material].maps if n not in _GEOMETRIC)]
        surface = view_samples.surface.pick(part)
        found = {name: self._maps.at(material, name, surface) for name in names if self._maps.has(material, name)}
        if not view_samples.moving:
            self._varying[material] = found
        return found

    @torch.no_grad()
    def gbuffer(self, transmittance: Tensor, gray: Tensor) -> GBuffer:
        """The G-buffer of the view, with the fog's `transmittance` (H, W) and the `gray` image (H, W, 3)."""
        hits = self.samples.center_hits
        _, toward = self.view.rays(pixel_centers(self.view.size).to(self.geometry.device))
        surface = self.geometry.surface(hits, toward)
        normal = torch.where(hits.hit, self.view.rotation.T @ surface.normal, 0.0)
        pattern = torch.ones_like(self.inside)
        for material, start, stop in self.samples.slices:
            color = self.textured_inputs(material, slice(start, stop), self._view_samples).get("base_color")
            if color is not None:
                light = luminance(color.detach().T)[:, 0]
                pattern[0, start:stop] = light / light.mean().clamp_min(1e-3)
        return GBuffer(
            subject=self.mask,
            material=torch.where(hits.hit, surface.material, -1).view(self.depth.shape),
            materials=tuple(m.name for m in self.scene.materials),
            normal=normal.T.reshape(*self.depth.shape, 3),
            transmittance=transmittance,
            pattern=self.samples.resolve(pattern).view(self.depth.shape),
            gray=gray,
            surrounding=tuple(m.name for m in self.scene.materials if m.role != "subject"),
        )

    def direct_light(self, index: int, lamps: list[LightSource], view_samples: ViewSamples, view: View) -> DirectLight:
        """Direct light of light `index`; shadows are traced again if a light of its cluster has moved."""
        row, moved = self.clusters.row[index], self._direct.forget_moved(index, lamps)
        first = index == self.clusters.clusters[row].members[0]
        if first and (moved or row not in self._bounced):
            # Bounced light is traced again after a jump of a light, but not after each small step of a gradient loop.
            lamp, last = lamps[index], self._bounced.get(row)
            place, small = torch.tensor(lamp.signature()), False
            if lamp.moving and last is not None:
                step = (place - torch.tensor(last.signature())).abs().amax()
                small = bool(step < place.abs().amax() * _SMALL_STEP)
            if not small:
                self._bounced[row] = lamp.detached()
                # If only its size has changed, the rays to its center are the same.
                same_rays = last is not None and lamp.position.equal(last.position) and lamp.axes.equal(last.axes)
                with torch.no_grad():
                    self.indirect.light(row, self._bounced[row], same_rays)
        return self._direct.of(index, lamps, view_samples, view)

    def behind(
        self, material: int, side: int, part: slice, ior: float, lamps: Sequence[LightSource]
    ) -> tuple[SecondaryHits, SparseWeights]:
        """Hits of rays refracted through a material's samples `part`, and weights that interpolate irradiance to hits.

        The weights are for values at the gather points. Results are kept by material and `side`: 0 for the material's
        own IOR, -1 and 1 for IORs one step below and above. `lamps` has one light for each cluster.
        """
        place = tuple(lamp.signature() for lamp in lamps)
        kept = self._through.get((material, side))
        if kept is None or abs(kept[0] - ior) > 1e-3:
            with torch.no_grad():
                surface, toward = self._view_samples.surface.pick(part), self.samples.toward[:, part]
                rays = self.geometry, *through(self.geometry, surface, toward, ior), 1
                hits = SecondaryHits(*rays, self.metals, len(self.clusters), "transmission", self._maps)
            kept = ior, None, hits, self.indirect.spread_to(hits)
        if kept[1] != place:
            hits = kept[2].aside()
            with torch.no_grad():
                for i, lamp in enumerate(lamps):
                    if kept[1] is None or kept[1][i] != place[i]:
                        hits.light(i, lamp.detached())
            kept = kept[0], place, hits, kept[3]
        self._through[material, side] = kept
        return kept[2:]

    def indirect_fog(self, near: float) -> IndirectFogRays:
        """Rays along which fog between surfaces is integrated; `near` is a typical viewing distance in meters."""
        if self._indirect_fog is None:
            with torch.no_grad():
                points = self._view_samples.surface, self.view, self.indirect.gather_points
                self._indirect_fog = IndirectFogRays(self.geometry, self.samples, *points, near)
        return self._indirect_fog

    @cached_property
    def outlines(self) -> Silhouettes:
        """Pixel pairs at outlines, for gradients with respect to the camera."""
        with torch.no_grad():
            return Silhouettes.of(self.samples, self._view_samples.surface)

    def worlds(self, sky: Sky, view_samples: ViewSamples) -> tuple[Tensor, ...]:
        """World's radiance per unit of `Sky.color`: reflections (3, N), sharp to blurred; then background (3, B)."""

        def looked_up(samples: ViewSamples) -> tuple[Tensor, ...]:
            rough = (GLOSSY,) if sky.plain else (SATIN, GLOSSY)
            lobes = [sky.reflected(samples.mirrored, samples.surface.normal, samples.basis, r) for r in rough]
            return sky.mirror(samples.mirrored), *lobes, sky.backdrop(samples.beyond)

        varied = not sky.plain or sky.environment.backdrop is not None
        if needs_gradient(sky.turn) or (view_samples.moving and varied):
            return looked_up(view_samples)
        with torch.no_grad():
            return self._worlds.of("", sky.signature(), lambda: looked_up(self._view_samples))


@dataclass(frozen=True)
class Defocus:
    """Depth of field of one view; a constant for gradients, which pass through the colors.

    The image is cut into layers of about the same blur. Each layer is blurred by a disc, and the layers are laid over
    each other from far to near. Parts of a layer that a near object hides are filled from the layer around them.
    """

    size: tuple[int, int]  # width and height of the image in pixels
    # from far to near: a layer's opacity (H, W), and the Fourier spectrum of the disc that blurs it; None if sharp
    layers: list[tuple[Tensor, Tensor | None]]
    padded: tuple[int, int]  # height and width of images for convolution

    @staticmethod
    def of(camera: Camera, view: View, distance: Tensor) -> Defocus | None:
        """The blur of a view with distances (H, W) along its rays, infinite for the world; None if all is sharp."""
        if camera.aperture <= 0:
            return None
        # Radius (H, W) of a thin lens's circles of confusion, as in Cycles: pixels, below 0 behind the plane in focus.
        toward = view.rays(pixel_centers(view.size).to(distance.device))[1]
        ahead = -view.rotation[:, 2:3]
        depth = (distance.flatten() * dot(ahead, toward)).view(distance.shape)
        focus = camera.focus_distance
        if camera.focus_point is not None:
            offset = torch.tensor(camera.focus_point, device=distance.device) - view.position
            focus = float(dot(ahead, offset[:, None]).abs())
        focus = max(focus, 1e-4)
        blur = 1 - depth / focus if view.orthographic else 1 / depth.clamp_min(1e-6) - 1 / focus
        pixel = float(view.scale) * view.extent[0] / view.size[0]
        most = _MOST_RADIUS * max(view.size)
        radius = (blur * (camera.aperture / pixel)).clamp(-most, most)
        if float(radius.abs().max()) < _LEAST_RADIUS:
            return None
        knots = [0.0]  # signed radii of the layers, from far to near
        while knots[0] > float(radius.min()):
            knots.insert(0, knots[0] * _RADIUS_GROWTH or -_FIRST_RADIUS)
        while knots[-1] < float(radius.max()):
            knots.append(knots[-1] * _RADIUS_GROWTH or _FIRST_RADIUS)
        pad = int(max(abs(k) for k in knots)) + 1
        padded = distance.shape[0] + pad, distance.shape[1] + pad
        layers = []
        for number, knot in enumerate(knots):
            # Opacity: 1 from the layer's radius half way to its neighbors', 0 there. One layer is opaque at each pixel.
            share = torch.ones_like(radius)
            for neighbor in (*knots[number - 1 : number], *knots[number + 1 : number + 2]):
                share = torch.minimum(share, (radius - neighbor) / (knot - neighbor))
            disc = _disc(abs(knot), padded).to(radius.device) if knot else None
            layers.append(((2 * share).clamp(0.0, 1.0), disc))
        return Defocus(view.size, layers, padded)

    def __call__(self, picture: Tensor) -> Tensor:
        """The blurred image (C, P) of a linear one (C, P); differentiable."""
        width, height = self.size
        sharp = picture.view(-1, height, width)
        total = torch.zeros((len(sharp) + 1, height, width), device=picture.device)
        for opacity, disc in self.layers:
            layer = torch.cat((sharp * opacity, opacity[None]))
            if disc is not None:
                spectrum = torch.fft.rfft2(layer, s=self.padded) * disc
                layer = torch.fft.irfft2(spectrum, s=self.padded)[:, :height, :width]
            total = total * (1 - layer[-1:].clamp(0.0, 1.0)) + layer
        return (total[:-1] / total[-1:].clamp_min(1e-3)).clamp_min(0.0).view(picture.shape)


def _disc(radius: float, size: tuple[int, int]) -> Tensor:
    """Fourier spectrum, for an image (height, width), of a disc of sum 1 with a radius in pixels at the first pixel."""
    y, x = (torch.minimum(torch.arange(n), n - torch.arange(n)).float() for n in size)
    away = (y[:, None].square() + x.square()).sqrt()
    weight = (radius + 0.5 - away).clamp(0.0, 1.0)
    return torch.fft.rfft2(weight / weight.sum())
