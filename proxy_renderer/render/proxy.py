# SPDX-License-Identifier: Apache-2.0
"""The proxy renderer: an exported scene and a set of values in, pictures out, gradients back."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import torch
from torch import Tensor

from ..scene import SceneData
from ..schema import FAMILIES, VibeError
from . import albedo
from .camera import View, view_of
from .color import luma
from .correction import Correction
from .cycles import CyclesPicture
from .emitters import Emitters
from .environment import Environment, Sky, sky_of
from .far import Table
from .film import Film
from .fog import Fog
from .indirect import Gathered
from .lights import Lamp, lamps_of
from .lobes import Light, Reflected
from .paint import Paint, paint_of, used
from .prefilter import GLOSSY, SATIN
from .principled import shade
from .settings import Settings, wanted
from .vectors import within
from .view_cache import Beam, Sight, ViewCache
from .visibility import Geometry
from .volume import DIRECTIONS, Volume

_FILM_KEYS = tuple(key for key, p in FAMILIES.items() if p.group == "film")
_BENT = 0.02
"""Difference of IOR over which refracted pictures are compared."""
_SMOOTH = 0.25
"""Roughness below which reflections are sharp."""
_LEAST_COAT = 0.05


@dataclass(frozen=True)
class Render:
    """One picture.

    Attributes:
        display: (H, W, 3) as shown, sRGB-encoded in [0, 1].
        linear: (H, W, 3) scene-linear Rec.709 before grade and view transform.
        alpha: (H, W) coverage where the film is transparent, else None; `linear` is multiplied with it,
            and `display` stands on black.
        mask: (H, W) share of each pixel that the subject covers.
        depth: (H, W) distance along the rays in meters; infinite where nothing is hit.
    """

    display: Tensor
    linear: Tensor
    mask: Tensor
    depth: Tensor
    alpha: Tensor | None = None


class Proxy:
    """Renders one scene at one size, again and again.

    Rays are traced only when the camera, or a lamp, has moved since the last render.

    Args:
        scene: The exported scene.
        size: Width and height in pixels.
        device: Where to compute; rays are traced on the CPU.
        seed: For the jitter of shadow and bounce rays.
        fine: Whether reflections in smooth surfaces are antialiased, by the values that a camera is first
            rendered with. For pictures to look at; loops do without.

    Attributes:
        correction: What a picture of Cycles has taught; None for the proxy as it is. See `anchor`.
    """

    def __init__(
        self, scene: SceneData, size: tuple[int, int], device: str = "cpu", seed: int = 0, fine: bool = False
    ) -> None:
        self.scene, self.size, self.seed, self.fine = scene, size, seed, fine
        self.device = torch.device(device)
        self.geometry = Geometry(scene, self.device)
        self.environment = Environment(scene, self.device)
        self.film = Film(scene.film, size, device)
        self.volume = Volume(self.geometry.clear)
        self.emitters = Emitters(self.geometry, self._near)
        self.correction: Correction | None = None
        self._cache: ViewCache | None = None

    def render(self, values: Mapping[str, Tensor]) -> Render:
        """Renders the scene.

        Args:
            values: Parameters by key, each (C,); missing ones take the scene's value. The pictures are
                differentiable in every one of them.
        """
        frame, settings = self._frame(values)
        radiance = self._light(frame)
        fits = self.correction is not None and self.correction.fits(frame.view)
        if self.correction and not fits:
            known = frame.owners, frame.view, frame.cache
            corrected = self.correction.samples(
                radiance[:3], *known, lambda: self._before(values, frame.cache)
            )
            radiance = torch.cat((corrected, radiance[3:]))
        picture, mask = _resolve(frame, radiance)
        if self.correction and fits:
            picture = torch.cat((self.correction.pixels(picture[:3], frame.owners), picture[3:]))
        channels = picture.view(-1, *self.size[::-1])
        linear, alpha = channels[:3].permute(1, 2, 0), channels[3] if len(channels) > 3 else None
        film = {key: settings.color(key) for key in _FILM_KEYS if settings.has(key)}
        return Render(self.film.develop(linear, film, alpha), linear, mask, frame.cache.depth, alpha)

    def anchor(self, values: Mapping[str, Tensor], picture: CyclesPicture) -> Correction:
        """Corrects all renders from now on by what Cycles makes of these values.

        A proxy of another size can be given the correction as well.

        Args:
            values: As for `render`.
            picture: Cycles' picture of them, of the proxy's size.

        Raises:
            VibeError: The picture has another size.
        """
        if picture.size != self.size:
            raise VibeError(
                f"Cycles' picture has {picture.size} pixels instead of {self.size}.", "Ask for that size."
            )
        with torch.no_grad():
            frame, _ = self._frame(values)
            whole, colors = self._picture(frame), frame.owners
            glow = self._picture(frame.only(""))
            parts = {owner: self._picture(frame.only(owner)) - glow for owner in colors}
            self.correction = Correction.of(picture, whole, parts, colors, values, frame.view, frame.cache)
        return self.correction

    def _before(self, values: Mapping[str, Tensor], cache: ViewCache) -> Tensor:
        """The anchor's values at the samples (3, N) that the camera of these values takes."""
        assert self.correction is not None
        lit = {k: v for k, v in self.correction.values.items() if not k.startswith("camera/")}
        camera = {k: v.detach() for k, v in values.items() if k.startswith("camera/")}
        return self._light(self._frame({**lit, **camera}, cache)[0])[:3]

    def _frame(self, values: Mapping[str, Tensor], cache: ViewCache | None = None) -> tuple[Frame, Settings]:
        """All that a render at these values is made of; with the samples of another render, if given."""
        settings = Settings(self.scene, values, self.device)
        view = view_of(self.scene, settings, self.size)
        paints = [paint_of(m, settings) for m in self.scene.materials]
        cache = cache or self._cache_of(view, paints)
        sky = sky_of(self.environment, settings)
        lamps = [*lamps_of(self.scene, settings), *sky.lamps, *self.emitters.lamps(paints)]
        frame = Frame(
            view=view,
            cache=cache,
            sight=cache.sight(view),
            lamps=lamps,
            sky=sky,
            paints=paints,
            fog=Fog(self.scene, settings),
        )
        return frame, settings

    def _cache_of(self, view: View, paints: list[Paint]) -> ViewCache:
        """What is traced for a view; anew if it, a mirror or a glass has changed, or something begun to glow."""
        metals = torch.stack([_mirroring(p) for p in paints])
        if self.geometry.let_through(torch.stack([_glassy(p) for p in paints])):
            self._cache, self.volume = None, Volume(self.geometry.clear)
            self.emitters = Emitters(self.geometry, self._near)
        if self.emitters.notice(paints):
            self._cache = None
        lamps = len(self.scene.lights) + len(self.environment.suns) + len(self.emitters.lamps(paints))
        kept = self._cache
        if kept is None or kept.signature != view.signature() or not torch.equal(kept.metals, metals):
            smooth = torch.stack([_smooth(p) & self.fine for p in paints])
            shape = metals, smooth, lamps, self.emitters.materials
            kept = self._cache = ViewCache(self.scene, self.geometry, view, *shape, self.seed)
        return kept

    def _picture(self, frame: Frame) -> Tensor:
        """The proxy's own linear picture (3, P)."""
        return _resolve(frame, self._light(frame))[0][:3]

    def _light(self, frame: Frame) -> Tensor:
        """Radiance of all samples as the camera gets it: (3 or, with a transparent film, 4, N)."""
        radiance = self._radiance(frame, frame.view)
        return self._through_fog(frame, frame.view, radiance) if frame.fog.active else radiance

    def _radiance(self, frame: Frame, view: View) -> Tensor:
        """Radiance (3, N + B) of all samples: surfaces in the order of their materials, then background.

        A transparent film has a fourth row: how much of what is behind it a sample covers.
        """
        cache, sight, sky = frame.cache, frame.sight, frame.sky
        beams = [cache.beam(i, lamp, sight, view) for i, lamp in enumerate(frame.lamps)]
        if frame.fog.active:
            beams = [beam.through(frame.fog) for beam in beams]
        table = _table(frame)
        gathered = cache.indirect.following(self._gather(frame, table), table, frame.lamps)
        irradiance = gathered.irradiance
        bare = sum(1 for lamp in frame.lamps if not lamp.pictured)
        if beams[bare:]:
            irradiance = irradiance + frame.colors[bare:].T @ _irradiances(beams[bare:])
        around = irradiance / math.pi
        beams = beams[:bare]
        if beams:
            irradiance = irradiance + frame.colors[:bare].T @ _irradiances(beams)
        *levels, behind = cache.worlds(sky, sight)
        tint = sky.color[:, None]
        knots, images = _images(gathered, [level * tint for level in levels], around)
        # One split backs up as one concatenation; a slice for every material would as a picture of zeros each.
        sizes = [stop - start for _, start, stop in cache.samples.slices]
        shares = zip(*(field.split(sizes, 1) for field in (irradiance, *images)), strict=True)
        pieces = []
        for (material, start, stop), (lit, *seen) in zip(cache.samples.slices, shares, strict=True):
            part, paint = slice(start, stop), frame.paints[material]
            incoming = Light(
                irradiance=lit,
                lamps=frame.colors[:bare],
                highlights=[beam.part(part) for beam in beams],
                view=sight.basis[:, part],
                reflected=Reflected(knots, seen),
                behind=_behind(frame, table, gathered, material, part) if used(paint.transmission) else None,
            )
            varying = dict(cache.inputs(material, part, sight))
            texture = varying.pop("base_color", None)
            pieces.append(shade(paint.varied(varying), incoming, texture))
        if not self.scene.film.transparent:
            return torch.cat((*pieces, behind * tint), 1)
        shown = torch.cat((*pieces, torch.zeros_like(behind)), 1)
        return torch.cat((shown, cache.covered))

    @property
    def _near(self) -> float:
        """A typical distance of what is seen, meters."""
        return float(self.scene.references.get("view_distance", self.geometry.size))

    def _gather(self, frame: Frame, table: Table) -> Gathered:
        """Indirect light."""
        if not frame.fog.active:
            return frame.cache.indirect.gather(table)
        murk = frame.cache.murk(self._near).gather(frame.fog, frame.lamps, frame.sky)
        return frame.cache.indirect.gather_through(table, frame.fog, murk)

    def _through_fog(self, frame: Frame, view: View, radiance: Tensor) -> Tensor:
        """Adds the light that fog scatters to the eye, takes what it extinguishes."""
        sky, samples = frame.sky, frame.cache.samples
        world = sky.color[:, None] * sky.soft(DIRECTIONS.to(self.device))
        haze = self.volume.scatter(frame.fog, view, self._near, frame.lamps, world)
        light, passing = haze.look_up(samples.place, samples.hits.distance)
        lit = radiance[:3] * passing + light
        return lit if len(radiance) == 3 else torch.cat((lit, 1 - passing * (1 - radiance[3:])))


@dataclass(frozen=True)
class Frame:
    """All that one render is made of."""

    view: View
    cache: ViewCache
    sight: Sight
    lamps: list[Lamp]
    sky: Sky
    paints: list[Paint]
    fog: Fog

    @functools.cached_property
    def colors(self) -> Tensor:
        """(L, 3) colors of the lamps."""
        return (
            torch.stack([lamp.color for lamp in self.lamps])
            if self.lamps
            else self.sky.color.new_zeros((0, 3))
        )

    @property
    def owners(self) -> dict[str, Tensor]:
        """Owner, "light/NAME" or "world", to the color (3,) of its light."""
        return {**{lamp.owner: lamp.color for lamp in self.lamps if not lamp.glow}, "world": self.sky.color}

    def only(self, owner: str) -> Frame:
        """The same with the light of one owner, "" for none, besides what surfaces emit."""
        dark = torch.zeros_like(self.sky.color)
        return replace(
            self,
            lamps=[lamp if lamp.owner in (owner, "") else replace(lamp, color=dark) for lamp in self.lamps],
            sky=self.sky if owner == "world" else replace(self.sky, color=dark),
        )


def _irradiances(beams: list[Beam]) -> Tensor:
    return torch.stack([beam.irradiance for beam in beams])


_GLASS_STEPS = 8
"""Steps in which light through glass changes: shadows are traced again at each."""


def _mirroring(paint: Paint) -> Tensor:
    """How much like a mirror () a material is where other surfaces show it, in coarse steps; 0 if it is no metal."""
    smooth = (1 - paint.roughness.detach()) * (paint.metallic.detach() > 0.5)
    return (smooth * 4).ceil() / 4


def _smooth(paint: Paint) -> Tensor:
    """Whether () a material shows reflections sharp enough for several samples in every pixel."""
    shines = (paint.metallic > 0) | (paint.specular > 0) | (paint.transmission > 0)
    coated = (paint.coat > _LEAST_COAT) & (paint.coat_roughness < _SMOOTH)
    return (coated | (shines & (paint.roughness < _SMOOTH))).reshape(())


def _glassy(paint: Paint) -> Tensor:
    """Share () of light that passes a surface of a material's glass, in coarse steps and grey.

    Cycles finds such light by chance, as caustics. Here it goes straight on, which is right on average. A
    Principled BSDF tints it with the root of its base color at each surface (kernel/svm/closure.h).
    """
    solid = paint.transmission * (1 - paint.metallic)
    through = solid * (1 - albedo.f0_of(paint.ior)) * luma(paint.base.clamp(0, 1)).sqrt()
    return (through.detach() * _GLASS_STEPS).round().reshape(()) / _GLASS_STEPS


def _resolve(frame: Frame, radiance: Tensor) -> tuple[Tensor, Tensor]:
    """Linear picture (3 or, with alpha, 4, P) and mask (H, W) from the radiance of all samples."""
    view, cache = frame.view, frame.cache
    picture, mask = cache.samples.resolve(radiance), cache.mask
    if view.moving:
        term = cache.outlines().term(view, torch.cat((radiance, cache.inside)), picture.shape[1])
        picture, mask = picture + term[:-1], mask + term[-1].view(mask.shape)
    return picture, mask


def _images(
    gathered: Gathered, worlds: Sequence[Tensor], around: Tensor
) -> tuple[tuple[float, ...], list[Tensor]]:
    """What surfaces of increasing roughness reflect: the roughnesses, and for each the radiance (3, N).

    Args:
        gathered: The light of surfaces.
        worlds: The world (3, N) in the mirror direction: sharp, a little blurred if it is a picture, and blurred.
        around: (3, N) what the roughest surface reflects.
    """
    sharp, blurred = worlds[0], worlds[-1]
    first = gathered.mirror + sharp * gathered.open_mirror
    last = gathered.glossy + blurred * gathered.open_glossy
    if len(worlds) == 2:
        return (0.0, GLOSSY, 1.0), [first, last, around]
    # Between the two, surfaces are half of either; the world has a level of its own.
    opening = (gathered.open_mirror + gathered.open_glossy) / 2
    between = (gathered.mirror + gathered.glossy) / 2 + worlds[1] * opening
    return (0.0, SATIN, GLOSSY, 1.0), [first, between, last, around]


def _table(frame: Frame) -> Table:
    """Radiances of what secondary rays meet."""
    rows = zip(frame.paints, frame.cache.mean_texture, strict=True)
    albedos = torch.stack([p.base * mean * (1 - p.transmission) for p, mean in rows])
    glow = torch.stack([p.emission for p in frame.paints])
    sky = frame.sky
    metallic = torch.stack([p.metallic for p in frame.paints])
    return Table.of(within(albedos, 0.0, 1.0), metallic, glow, frame.colors, sky.halves, sky.coefficients())


def _behind(frame: Frame, table: Table, gathered: Gathered, material: int, part: slice) -> Tensor:
    """Radiance (3, n) seen through a transparent material.

    Another IOR bends rays to other places, over edges too: its gradient is a secant between two traced pictures.
    """
    ior = frame.paints[material].ior
    here = float(ior.detach())

    def seen(side: int) -> Tensor:
        behind = frame.cache.behind(material, side, part, max(here + side * _BENT, 1.0), frame.lamps)
        world = frame.sky.seen(behind.toward) * frame.sky.color[:, None]
        return behind.far.image(table, behind.ambient(gathered.anchors).T) + world * behind.far.open

    straight = seen(0)
    if not wanted(ior):
        return straight
    with torch.no_grad():
        # Where a bright lamp comes into view, the picture saturates: the slope is that of x / (1 + x).
        low, high = (light / (1 + light) for light in (seen(-1), seen(1)))
        slope = (high - low) * (1 + straight) ** 2 / (here + _BENT - max(here - _BENT, 1.0))
    return straight + slope * (ior - ior.detach())
