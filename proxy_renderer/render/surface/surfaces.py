# SPDX-License-Identifier: Apache-2.0
"""The state of one render, and the light that surfaces and the background send to the camera, before any fog."""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import torch
from torch import Tensor

from ...color.tensors import luminance
from ...scene.values import needs_gradient
from ..geometry.camera import View
from ..geometry.vectors import within
from ..lights.environment import GLOSSY, SATIN, Sky
from ..lights.light_source import LightSource
from ..material import albedo
from ..material.inputs import ShadingInputs, used
from ..transport.fog import FogMedium
from ..transport.glow import BLURS
from ..transport.indirect import IndirectLight
from ..transport.secondary_hits import RadianceTable
from .direct_lights import DirectLight, ViewSamples
from .principled import IncidentLight, ReflectedRadiance, shade
from .view_cache import ViewCache

_BENT = 0.02  # step of the IOR in finite differences of refracted images
_SMOOTH = 0.25  # roughness below which reflections are sharp
_LEAST_COAT = 0.05  # coat weight above which a coat's reflections count
_GLASS_STEPS = 8  # steps of a glass's transmittance from 0 to 1


def direct_lights_of(frame: RenderState) -> list[DirectLight]:
    """Direct light of each light, dimmed by fog. Bounced light of lights that have moved is also traced again."""
    state = frame.lamps, frame.view_samples, frame.view
    direct_lights = [frame.cache.direct_light(i, *state) for i in range(len(frame.lamps))]
    return [each.through(frame.fog) for each in direct_lights] if frame.fog.active else direct_lights


def radiance(
    frame: RenderState, direct_lights: list[DirectLight], table: RadianceTable, gathered: IndirectLight
) -> Tensor:
    """Radiance (3, N + B) of all samples: surfaces in the order of their materials, then background.

    With a transparent film, a fourth row is the coverage of each sample. `direct_lights` is from `direct_lights_of`,
    `table` from `table_of`. `gathered` is the indirect light; it must be gathered after `direct_lights_of`, which
    traces its shadows.
    """
    cache, view_samples, sky = frame.cache, frame.view_samples, frame.sky
    gathered = cache.indirect.following(gathered, table, frame.sources)
    irradiance = gathered.irradiance
    shining = [pair for pair in zip(frame.lamps, direct_lights, strict=True) if pair[0].shines]
    pictured = [pair for pair in shining if pair[0].pictured]
    bare = [pair for pair in shining if not pair[0].pictured]
    around = (irradiance := irradiance + direct(pictured)) / math.pi
    irradiance = irradiance + direct(bare)
    colors = torch.stack([lamp.color for lamp, _ in bare]) if bare else sky.color.new_zeros((0, 3))
    *levels, behind = cache.worlds(sky, view_samples)
    tint = (sky.color * sky.reaches("glossy"))[:, None]
    knots, images = _images(gathered, [level * tint for level in levels], around)
    # The gradient of one split is one concatenation; that of each slice would be zeros for all samples.
    sizes = [stop - start for _, start, stop in cache.samples.slices]
    parts = zip(*(field.split(sizes, 1) for field in (irradiance, *images, *gathered.glow)), strict=True)
    pieces = []
    for (material, start, stop), (received, *reflections) in zip(cache.samples.slices, parts, strict=True):
        part, inputs = slice(start, stop), frame.shading_inputs[material]
        incoming = IncidentLight(
            irradiance=received,
            lamps=colors,
            highlights=[direct_light.part(part) for _, direct_light in bare],
            view=view_samples.part(part),
            reflected=_reflected(knots, reflections),
            behind=_behind(frame, table, gathered, material, part) if used(inputs.transmission) else None,
        )
        varying = dict(cache.textured_inputs(material, part, view_samples))
        texture = varying.pop("base_color", None)
        pieces.append(shade(inputs.varied(varying), incoming, texture))
    if not cache.scene.film.transparent:
        samples = cache.samples
        height = 1.0 - samples.place[1, samples.surfaces :] / samples.size[1]
        backdrop = sky.backdrop_tint(height) * sky.reaches("camera")
        return torch.cat((*pieces, behind * backdrop), 1) * cache.on_film
    shown = torch.cat((*pieces, torch.zeros_like(behind)), 1)
    return torch.cat((shown, cache.covered)) * cache.on_film


def direct(lights: Sequence[tuple[LightSource, DirectLight]]) -> Tensor | float:
    """Shadowed irradiance (3, N) of some lights at the N surface samples; 0 without lights."""
    if not lights:
        return 0.0
    colors = torch.stack([lamp.color for lamp, _ in lights])
    return colors.T @ torch.stack([direct_light.irradiance for _, direct_light in lights])


def _images(gathered: IndirectLight, worlds: list[Tensor], around: Tensor) -> tuple[tuple[float, ...], list[Tensor]]:
    """Roughness knots, and for each knot the radiance (3, N) that surfaces of this roughness reflect.

    The first, at 0, is the mirror image; the last, at 1, is the mean light `around` (3, N). `worlds` has the world's
    part (3, N) at each knot but the last.
    """
    sharp, blurred = worlds[0], worlds[-1]
    first = gathered.mirror + sharp * gathered.open_mirror
    last = gathered.glossy + blurred * gathered.open_glossy
    if len(worlds) == 2:
        return (0.0, GLOSSY, 1.0), [first, last, around]
    # Between first and last, surfaces are the mean of both; the world has an image of its own.
    between = (gathered.mirror + gathered.glossy) / 2 + worlds[1] * ((gathered.open_mirror + gathered.open_glossy) / 2)
    return (0.0, SATIN, GLOSSY, 1.0), [first, between, last, around]


def _reflected(knots: tuple[float, ...], images: list[Tensor]) -> ReflectedRadiance:
    """Reflected radiance from images (3, n): one for each knot, then those of glowing surfaces, if anything glows."""
    images, glow = images[: len(knots)], images[len(knots) :]
    if not glow:
        return ReflectedRadiance(knots, images)
    # The last image, at a roughness of 1, contains the glow already.
    return ReflectedRadiance(knots, images, ReflectedRadiance((0.0, *BLURS, 1.0), [*glow, torch.zeros_like(glow[0])]))


def table_of(frame: RenderState) -> RadianceTable:
    """Radiance of all surfaces, and of the world, that secondary rays can meet in this render."""
    rows = zip(frame.shading_inputs, frame.cache.mean_texture, strict=True)
    bounces = min(frame.cache.scene.bounces, 1)
    colors = torch.stack([p.base * mean * (1 - p.transmission) * bounces for p, mean in rows])
    albedos, sky = within(colors, 0.0, 1.0), frame.sky
    lit = [s.color * s.reaches("diffuse") for s in frame.sources]
    lamps = torch.stack(lit) if lit else sky.color.new_zeros((0, 3))
    sources = torch.cat((lamps / math.pi, sky.hemispheres))[:, None]
    again = albedos * albedos / (1 - albedos / 2)  # third and later bounces follow the second
    # A metal mirrors surfaces of other colors: at the second bounce, the mean color of non-metals.
    metallic = torch.stack([p.metallic for p in frame.shading_inputs])[:, None]
    plain = (1 - metallic) + 1e-6
    common = (albedos * plain).sum(0) / plain.sum(0)
    again = torch.lerp(again, albedos * common / (1 - common / 2), metallic)
    emission = torch.stack([p.emission for p in frame.shading_inputs])
    return RadianceTable(torch.cat((sources * albedos, sources * again)), emission, sky.coefficients(), albedos)


def _behind(frame: RenderState, table: RadianceTable, gathered: IndirectLight, material: int, part: slice) -> Tensor:
    """Radiance (3, n) seen through the samples `part` of a glass material."""
    ior = frame.shading_inputs[material].ior
    here = float(ior.detach())

    def picture_at(side: int) -> Tensor:
        hits, ambient = frame.cache.behind(material, side, part, max(here + side * _BENT, 1.0), frame.sources)
        world = frame.sky.seen(hits.toward) * (frame.sky.color * frame.sky.reaches("transmission"))[:, None]
        return hits.image(table, ambient(gathered.gather_points).T) + world * hits.open

    straight = picture_at(0)
    if not needs_gradient(ior):
        return straight
    with torch.no_grad():
        # The gradient is a finite difference, because refracted rays may jump over edges.
        # Differences are those of x / (1 + x), so that a bright light which comes into view does not dominate.
        low, high = (light / (1 + light) for light in (picture_at(-1), picture_at(1)))
        slope = (high - low) * (1 + straight) ** 2 / (here + _BENT - max(here - _BENT, 1.0))
    return straight + slope * (ior - ior.detach())


@dataclass(frozen=True)
class RenderState:
    """The state of one render: camera, samples, lights, world, materials, fog."""

    view: View  # the camera
    cache: ViewCache  # what has been traced for the camera
    view_samples: ViewSamples  # the samples as the camera sees them
    lamps: list[LightSource]  # the lights: the scene's, the environment's suns, glowing surfaces
    sky: Sky  # the world
    shading_inputs: list[ShadingInputs]  # of every material
    fog: FogMedium  # the medium

    @functools.cached_property
    def sources(self) -> list[LightSource]:
        """The lights that indirect light uses: one for each cluster of lights that share shadows."""
        return self.cache.clusters.sources(self.lamps)

    @property
    def owners(self) -> dict[str, Tensor]:
        """Owner -> color (3,) of its light, see `colors_by_owner`."""
        return colors_by_owner(self.lamps, self.sky)

    def only(self, owner: str) -> RenderState:
        """A copy that is lit only by one owner, "light/NAME" or "world" ("" for none), and by glowing surfaces."""
        dark = torch.zeros_like(self.sky.color)
        lamps = [lamp if lamp.owner in (owner, "") else replace(lamp, color=dark) for lamp in self.lamps]
        sky = self.sky if owner == "world" else replace(self.sky, color=dark, backdrop_color=dark)
        return replace(self, lamps=lamps, sky=sky)


def colors_by_owner(lamps: Sequence[LightSource], sky: Sky) -> dict[str, Tensor]:
    """Owner of light, "light/NAME" or "world" -> color (3,) of its light, power or strength included."""
    return {**{lamp.owner: lamp.color for lamp in lamps if lamp.owner}, "world": sky.color}


def mirror_weight(inputs: ShadingInputs) -> Tensor:
    """Weight () of mirror reflection: 1 - roughness of a metal, else 0; in steps of 1/4: each change retraces rays."""
    smooth = (1 - inputs.roughness.detach()) * (inputs.metallic.detach() > 0.5)
    return (smooth * 4).ceil() / 4


def sharp(inputs: ShadingInputs) -> Tensor:
    """() bool: True if a material's reflections are so sharp that every pixel needs several samples."""
    shines = (inputs.metallic > 0) | (inputs.specular > 0) | (inputs.transmission > 0)
    coated = (inputs.coat > _LEAST_COAT) & (inputs.coat_roughness < _SMOOTH)
    return (coated | (shines & (inputs.roughness < _SMOOTH))).reshape(())


def glass_transmittance(inputs: ShadingInputs) -> Tensor:
    """Gray transmittance () of one surface of a material's glass; in steps, because each change retraces shadows.

    Cycles finds light through glass by chance, as caustics. Here the light goes straight on, which is right on average.
    At each surface, a Principled BSDF tints the light with the root of its base color (kernel/svm/closure.h).
    """
    solid = inputs.transmission * (1 - inputs.metallic)
    through = solid * (1 - albedo.f0_of(inputs.ior)) * luminance(inputs.base.clamp(0, 1)).sqrt()
    return (through.detach() * _GLASS_STEPS).round().reshape(()) / _GLASS_STEPS
