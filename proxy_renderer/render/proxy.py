# SPDX-License-Identifier: Apache-2.0
"""The proxy renderer: makes images of an exported scene from a set of values, and gradients with respect to them."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial

import torch
from torch import Tensor
from torch.nn import functional

from ..scene import SceneData
from ..scene.values import Recent, RenderValues, needs_gradient
from ..schema import FAMILIES, VibeError
from .cycles import Correction, CyclesPicture
from .film import Film
from .geometry.camera import View, view_of
from .lights.emitters import Emitters
from .lights.environment import Environment, sky_of
from .lights.light_source import LightSource
from .lights.light_types import light_sources
from .material.inputs import ShadingInputs, geometry_of, shading_inputs_of
from .surface import surfaces
from .surface.surfaces import RenderState
from .surface.view_cache import GBuffer, ViewCache
from .transport.fog import DIRECTIONS, FogMedium, SingleScattering
from .transport.indirect import IndirectLight
from .transport.secondary_hits import RadianceTable

_FILM_KEYS = tuple(key for key, p in FAMILIES.items() if p.group == "film")


@dataclass(frozen=True, kw_only=True)
class LatentImage:
    """The linear image before grade and view transform, with mask, depth, fog and alpha of its pixels."""

    linear: Tensor  # (H, W, 3) scene-linear Rec.709 before grade and view transform
    mask: Tensor  # (H, W) share of each pixel that the subject covers
    depth: Tensor  # (H, W) distance along the rays in meters; infinite where nothing is hit
    transmittance: Tensor  # (H, W) share of light that fog lets through between what is seen and the camera
    alpha: Tensor | None = None  # (H, W) coverage of a transparent film, already in `linear`; else None


@dataclass(frozen=True, kw_only=True)
class Render(LatentImage):
    """A latent image, and the image that `Film` develops from it."""

    display: Tensor  # (H, W, 3) as shown, sRGB-encoded in [0, 1]; on black where the film is transparent


class Proxy:
    """Renders one scene at one size (width, height), any number of times.

    Rays are traced on the CPU, and only where camera, lights, mirrors or glass have changed since the last render. `correction`
    comes from a Cycles render, see `anchor`; it is None if renders are not corrected.

    `seed` is for the jitter of bounce rays. If `fine`, smooth materials get several samples in every pixel, so that their
    reflections are antialiased, for images to look at. The first render of a camera position decides which are smooth.
    """

    def __init__(
        self, scene: SceneData, size: tuple[int, int], device: str = "cpu", seed: int = 0, fine: bool = False
    ) -> None:
        self.scene, self.size, self.seed, self.fine = scene, size, seed, fine
        self.device = torch.device(device)
        self.geometry = geometry_of(scene, self.device)
        self.environment = Environment(scene, self.device)
        self.film = Film(scene.film, size, device)
        self.volume = SingleScattering(self.geometry.clear)
        # A typical distance of what is seen, meters.
        self._near = float(scene.references.get("view_distance", self.geometry.size))
        self.emitters = Emitters(self.geometry, self._near)
        self.correction: Correction | None = None
        self._cache: ViewCache | None = None
        self._made = Recent()
        self._anchored: tuple[Correction, LatentImage] | None = None  # the last anchor
        self._undeveloped: tuple[LatentImage, Mapping[str, Tensor], Correction | None] | None = None

    def render(self, values: Mapping[str, Tensor]) -> Render:
        """Renders the scene, differentiably in `values`: key -> components (C,), where missing the scene's."""
        if torch.is_grad_enabled():
            return self.develop(self.expose(values), values)
        # The last latent image is developed again if only values of the film differ.
        scene_values = {key: value for key, value in values.items() if key not in _FILM_KEYS}
        if self._undeveloped is not None:
            latent, earlier, correction = self._undeveloped
            alike = scene_values.keys() == earlier.keys() and correction is self.correction
            if alike and all(torch.equal(v, earlier[k]) for k, v in scene_values.items()):
                return self.develop(latent, values)
        latent = self.expose(values)
        self._undeveloped = latent, scene_values, self.correction
        return self.develop(latent, values)

    def traced(self, values: Mapping[str, Tensor]) -> ViewCache:
        """The traced view at these values. `expose` can reuse it, or a copy of it by `aside`, for values nearby."""
        return self._frame(values).cache

    def develop(self, latent: LatentImage, values: Mapping[str, Tensor]) -> Render:
        """Applies grade and view transform to the result of `expose`; only the film's parameters of `values` count."""
        settings = RenderValues(self.scene, values, self.device)
        film = {key: settings.color(key) for key in _FILM_KEYS if key in values or key in self.scene.instances}
        return Render(display=self.film.develop(latent.linear, film, latent.alpha), **vars(latent))

    def expose(self, values: Mapping[str, Tensor], cache: ViewCache | None = None) -> LatentImage:
        """Renders the scene without grade and view transform; values of the film are ignored.

        With a `cache`, only lights that have moved are traced again: mirrors and glasses stay as they were traced, as
        for gradients. If `values` differ from the anchor's only in powers and colors of lights, see `layered`.
        """
        if (latent := self.layered(values)) is not None:
            return latent
        frame = self._frame(values, cache)
        radiance, passing = self._light(frame)
        # If the anchor had another camera, the correction is looked up per sample, so that outlines stay smooth.
        fits = self.correction is not None and self.correction.view.signature() == frame.view.signature()
        if self.correction and not fits:
            others = {k: v for k, v in self.correction.values.items() if not k.startswith("camera/")}
            there = {**others, **{k: v.detach() for k, v in values.items() if k.startswith("camera/")}}
            current = frame.owners, frame.view, frame.cache, lambda: self._light(self._frame(there, frame.cache))[0][:3]
            radiance = torch.cat((self.correction.samples(radiance[:3], *current), radiance[3:]))
        picture, mask = _resolve(frame, radiance)
        if self.correction and fits:
            picture = torch.cat((self.correction.pixels(picture[:3], frame.owners), picture[3:]))
        channels = picture.view(-1, *self.size[::-1])
        linear, alpha = channels[:3].permute(1, 2, 0), channels[3] if len(channels) > 3 else None
        seen = _transmittance(frame, passing)
        return LatentImage(linear=linear, mask=mask, depth=frame.cache.depth, transmittance=seen, alpha=alpha)

    def gbuffer(self, values: Mapping[str, Tensor]) -> GBuffer:
        """The G-buffer at these values: the surfaces that the camera sees, and the transmittance of fog in front of them."""
        with torch.no_grad():
            frame = self._frame(values)
            light, passing = self._through_fog(frame) if frame.fog.active else (0.0, None)
            clear = _transmittance(frame, passing)
            # Radiance (3, N) if every surface were diffuse with an albedo of 0.5; black where the world is seen.
            direct_lights, table = surfaces.direct_lights_of(frame), surfaces.table_of(frame)
            direct = surfaces.direct(list(zip(frame.lamps, direct_lights, strict=True)))
            received = (self._gather(frame, table).irradiance + direct) / (2 * math.pi)
            gray = functional.pad(received, (0, frame.cache.samples.place.shape[1] - received.shape[1]))
            gray = gray * (1.0 if passing is None else passing) + light
            linear = _resolve(frame, gray)[0].view(3, *clear.shape).permute(1, 2, 0)
            latent = LatentImage(linear=linear, mask=clear, depth=clear, transmittance=clear)
            return frame.cache.gbuffer(clear, self.develop(latent, values).display)

    def anchor(self, values: Mapping[str, Tensor], picture: CyclesPicture) -> Correction:
        """Corrects all further renders by Cycles' image of these values; raises VibeError if its size is another."""
        if picture.size != self.size:
            raise VibeError(f"Cycles' picture has {picture.size} pixels instead of {self.size}.", "Ask for that size.")
        with torch.no_grad():
            frame = self._frame(values)
            whole, colors = self._picture(frame), frame.owners
            emission = self._picture(frame.only(""))
            parts = {owner: self._picture(frame.only(owner)) - emission for owner in colors}
            self.correction = Correction.of(picture, whole, parts, colors, values, frame.cache)
            self._anchored = None  # the next line renders the anchor's own image without layers
            self._anchored = self.correction, self.expose(values, frame.cache)
        return self.correction

    def layered(self, values: Mapping[str, Tensor]) -> LatentImage | None:
        """The latent image as a sum of the anchor's light layers; None if it is not exact, or values need gradients."""
        if self._anchored is None or needs_gradient(*values.values()):
            return None
        correction, anchor = self._anchored
        if correction is not self.correction or not correction.has_layers_for(values, self.scene):
            return None
        settings = RenderValues(self.scene, values, self.device)
        sky = sky_of(self.environment, settings)
        colors = surfaces.colors_by_owner([*light_sources(self.scene, settings, self._made), *sky.lamps], sky)
        picture = correction.layered(colors)
        if picture is None:
            return None
        linear = correction.pixels(picture, colors).view(-1, *self.size[::-1]).permute(1, 2, 0)
        return replace(anchor, linear=linear)

    def _frame(self, values: Mapping[str, Tensor], cache: ViewCache | None = None) -> RenderState:
        """The state of a render at these values; `cache` is a traced view to reuse, None to trace what has changed."""
        settings = RenderValues(self.scene, values, self.device)
        view = view_of(self.scene, settings, self.size)
        shading_inputs = []
        for material in self.scene.materials:
            # Shading inputs cache terms that are computed from them, unless `fine`: the images are then large.
            made = partial(shading_inputs_of, material, settings, None if self.fine else {})
            shading_inputs.append(settings.kept(self._made, f"material/{material.name}", made))
        if cache is None:
            # The traced view is dropped if a glass has changed, or a surface glows for the first time.
            if self.geometry.let_through(torch.stack([surfaces.glass_transmittance(p) for p in shading_inputs])):
                self._cache, self.volume = None, SingleScattering(self.geometry.clear)
            if self.emitters.notice(shading_inputs):
                self._cache = None
        sky = sky_of(self.environment, settings)
        lamps = light_sources(self.scene, settings, self._made) + sky.lamps
        lamps += self.emitters.lamps(shading_inputs)
        cache = cache or self._cache_of(view, shading_inputs, lamps)
        fog = FogMedium(self.scene, settings)
        return RenderState(view, cache, cache.view_samples(view), lamps, sky, shading_inputs, fog)

    def _cache_of(self, view: View, shading_inputs: list[ShadingInputs], lamps: list[LightSource]) -> ViewCache:
        """The traced view: the last one, unless the camera has changed, or a light of a cluster begins to move.

        If mirrors have changed, only what they show is traced again, unless `fine`.
        """
        metals = torch.stack([surfaces.mirror_weight(p) for p in shading_inputs])
        kept = self._cache
        if kept is not None and kept.signature == view.signature() and kept.clusters.hold(lamps):
            if torch.equal(kept.metals, metals):
                return kept
            if not self.fine:
                self._cache = kept.with_mirrors(metals)
                return self._cache
        smooth = torch.stack([surfaces.sharp(p) & self.fine for p in shading_inputs])
        self._cache = ViewCache(self.scene, self.geometry, view, metals, smooth, lamps, self.emitters, self.seed)
        return self._cache

    def _picture(self, frame: RenderState) -> Tensor:
        """The proxy's own linear image (3, P), uncorrected."""
        return _resolve(frame, self._light(frame)[0])[0][:3]

    def _light(self, frame: RenderState) -> tuple[Tensor, Tensor | None]:
        """Radiance (3, N) of all samples through fog, (4, N) with coverage if the film is transparent.

        Also the fog's transmittance (N,); None without fog.
        """
        direct_lights, table = surfaces.direct_lights_of(frame), surfaces.table_of(frame)
        radiance = surfaces.radiance(frame, direct_lights, table, self._gather(frame, table))
        if not frame.fog.active:
            return radiance, None
        light, passing = self._through_fog(frame)
        veiled = radiance[:3] * passing + light
        if len(radiance) > 3:
            veiled = torch.cat((veiled, 1 - passing * (1 - radiance[3:])))
        return veiled, passing

    def _gather(self, frame: RenderState, table: RadianceTable) -> IndirectLight:
        if not frame.fog.active:
            return frame.cache.indirect.gather(table)
        indirect_fog = frame.cache.indirect_fog(self._near).gather(frame.fog, frame.sources, frame.sky)
        return frame.cache.indirect.gather_through(table, frame.fog, indirect_fog)

    def _through_fog(self, frame: RenderState) -> tuple[Tensor, Tensor]:
        """Light (3, N) that the fog in front of each sample scatters towards the camera, and that fog's transmittance (N,)."""
        sky, samples = frame.sky, frame.cache.samples
        world = sky.color[:, None] * sky.soft(DIRECTIONS.to(self.device))
        haze = self.volume.scatter(frame.fog, frame.view, self._near, frame.lamps, world)
        return haze.look_up(samples.place, samples.hits.distance)


def _transmittance(frame: RenderState, passing: Tensor | None) -> Tensor:
    """The fog's transmittance (H, W) by pixel, from `passing` (N,), that by sample; 1 if `passing` is None."""
    shape = frame.cache.depth.shape
    if passing is None:
        return torch.ones(shape, device=frame.cache.depth.device)
    return frame.cache.samples.resolve(passing[None]).view(shape)


def _resolve(frame: RenderState, radiance: Tensor) -> tuple[Tensor, Tensor]:
    """Linear image (3, P), (4, P) with alpha, after depth of field, and mask (H, W), from the samples' radiance."""
    view, cache = frame.view, frame.cache
    picture, mask = cache.samples.resolve(radiance), cache.mask
    if view.moving:
        term = cache.outlines.term(view, torch.cat((radiance, cache.inside)), picture.shape[1])
        picture, mask = picture + term[:-1], mask + term[-1].view(mask.shape)
    return (cache.defocus(picture) if cache.defocus else picture), mask
