# SPDX-License-Identifier: Apache-2.0
"""The proxy renderer: an exported scene and a set of values in, pictures out, gradients back."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import torch
from torch import Tensor

from ..scene import SceneData
from ..schema import FAMILIES
from .camera import view_of
from .environment import Environment, Sky, sky_of
from .film import Film
from .indirect import GLOSSY, Table
from .lights import Lamp, lamps_of
from .principled import Light, Paint, Reflected, paint_of, shade
from .settings import Settings
from .view_cache import Sight, ViewCache
from .visibility import Geometry

_FILM_KEYS = tuple(key for key, p in FAMILIES.items() if p.group == "film")


@dataclass(frozen=True)
class Render:
    """One picture.

    Attributes:
        display: (H, W, 3) as shown, sRGB-encoded in [0, 1].
        linear: (H, W, 3) scene-linear Rec.709 before grade and view transform.
        mask: (H, W) share of each pixel that the subject covers.
        depth: (H, W) distance along the rays in meters; infinite where nothing is hit.
    """

    display: Tensor
    linear: Tensor
    mask: Tensor
    depth: Tensor


class Proxy:
    """Renders one scene at one size, again and again.

    Rays are traced only when the camera, or a lamp, has moved since the last render.

    Args:
        scene: The exported scene.
        size: Width and height in pixels.
        device: Where to compute; rays are traced on the CPU.
        seed: For the jitter of shadow and bounce rays.
    """

    def __init__(self, scene: SceneData, size: tuple[int, int], device: str = "cpu", seed: int = 0) -> None:
        self.scene, self.size, self.seed = scene, size, seed
        self.device = torch.device(device)
        self.geometry = Geometry(scene, self.device)
        self.environment = Environment(scene, self.device)
        self.film = Film(scene.film, size, device)
        self._cache: ViewCache | None = None

    def render(self, values: Mapping[str, Tensor]) -> Render:
        """Renders the scene.

        Args:
            values: Parameters by key, each (C,); missing ones take the scene's value. The pictures are
                differentiable in every one of them.
        """
        settings = Settings(self.scene, values, self.device)
        view = view_of(self.scene, settings, self.size)
        lamps, sky = lamps_of(self.scene, settings), sky_of(self.environment, settings)
        paints = [paint_of(m, settings) for m in self.scene.materials]
        if self._cache is None or self._cache.signature != view.signature():
            self._cache = ViewCache(self.scene, self.geometry, view, self.seed)
        cache = self._cache
        radiance = self._radiance(cache, cache.sight(view), lamps, sky, paints)
        linear = cache.samples.resolve(radiance).view(3, *self.size[::-1]).permute(1, 2, 0)
        film = {key: settings.color(key) for key in _FILM_KEYS if settings.has(key)}
        return Render(self.film.develop(linear, film), linear, cache.mask, cache.depth)

    def _radiance(
        self, cache: ViewCache, sight: Sight, lamps: list[Lamp], sky: Sky, paints: list[Paint]
    ) -> Tensor:
        """Radiance (3, N + B) of all samples: surfaces in the order of their materials, then background."""
        colors = torch.stack([lamp.color for lamp in lamps]) if lamps else torch.zeros((0, 3))
        beams = [cache.beam(i, lamp, sight) for i, lamp in enumerate(lamps)]
        irradiance, glossy, mirror = cache.indirect.gather(_table(cache, colors, sky, paints))
        if beams:
            irradiance = irradiance + colors.T @ torch.stack([beam.irradiance for beam in beams])
        sharp, blurred, behind = cache.worlds(sky, sight)
        open_glossy, open_mirror = cache.indirect.open_sky
        tint = sky.color[:, None]
        images = mirror + tint * (sharp * open_mirror), glossy + tint * (blurred * open_glossy)
        pieces = []
        for material, start, stop in cache.samples.slices:
            part = slice(start, stop)
            incoming = Light(
                irradiance=irradiance[:, part],
                lamps=colors,
                highlights=[beam.highlight.pick(part) for beam in beams],
                view=sight.basis[:, part],
                reflected=Reflected((0.0, GLOSSY, 1.0), [*(i[:, part] for i in images), irradiance[:, part] / math.pi]),
                behind=None,
            )
            pieces.append(shade(paints[material], incoming, cache.texture(material, sight.surface.uv[:, part])))
        return torch.cat((*pieces, behind * tint), 1)


def _table(cache: ViewCache, colors: Tensor, sky: Sky, paints: list[Paint]) -> Table:
    """Radiances of what secondary rays meet."""
    albedos = [p.base * mean * (1 - p.transmission) for p, mean in zip(paints, cache.mean_texture, strict=True)]
    glow = torch.stack([p.emission for p in paints])
    return Table.of(torch.stack(albedos).clamp_max(1.0), glow, colors, sky.mean, sky.coefficients())
