# SPDX-License-Identifier: Apache-2.0
"""The world as a light: radiance by direction, sharp or blurred, irradiance, and its suns.

A GGX lobe of reflected light is round if the surface is seen head on. At grazing angles the lobe becomes narrow across the plane
of reflection, keeps its length along that plane, and tilts away from the surface: a light on the horizon makes an upright streak
on a floor. A few round lobes, one above the other in that plane, approximate the long lobe, as in filtered importance sampling
(Krivanek and Colbert 2008), here with fixed directions.

Cycles samples an environment by importance. Its visible shadows come from small bright parts: a window, a light, the sun. These are
taken out of the image as suns, lights with sharp shadows. The rest stays smooth light from all around.
"""

import functools
import math
from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor
from torch.nn.functional import grid_sample, interpolate, max_pool2d, pad

from ...color.constants import LUMINANCE_WEIGHTS
from ...color.tensors import trilinear
from ...scene import Light, SceneData
from ...scene.values import RenderValues
from ...schema.orbit import IDENTITY
from ..geometry.vectors import dot, tangents, texels, unit
from ..material import albedo
from ..material.albedo import mirrored, unshadowed, visible_normals
from .light_types import SunLight

_ROUGH_HEIGHT, _BLURRED_HEIGHT, _SEARCH_HEIGHT, _SHARP_HEIGHT = 48, 96, 128, 512  # rows of copies of the image
_SOFT = 0.5  # roughness by which the world is blurred where only few directions are looked up
SATIN, GLOSSY = 0.2, 0.4  # roughness of reflections between the mirror image and the diffuse light
_FIRST_BLUR, _BLUR_STEP, _BLURS = 0.1, 0.1, 6  # roughness of the first blurred image, step, number
_ROUGH = 0.3  # roughness from which lobes are so long that they need more parts
_TAP_SIDE = 64  # squared: microfacet normals per integral
_NARROWEST = 0.25  # least width of a round lobe over the long lobe's length: narrower ones are visible singly
_MOST, _TRIED = 3, 6  # number of suns at most, and of candidates
_REGION = 0.25  # least brightness of a sun's texels, relative to its brightest one
_WIDE = math.radians(12.0)  # diameter from which a sun is too large to pass for a disc in a mirror
_LEAST_SHARE = 0.12  # least irradiance from a sun over that from an even world of the same mean radiance
_LEAST_CONTRAST = 3.0  # least radiance of a sun, as a disc, relative to the mean of the world
_RADII = (3.0, 6.0, 12.0, 20.0)  # degrees around a peak within which a sun may lie
_MOST_OF = 0.8  # share of the light around a peak that a sun's radius contains


@dataclass(frozen=True)
class EnvironmentSun:
    """A bright part of the world's image, approximated by a disc."""

    toward: Tensor  # (3,) unit vector to it, before the image is turned
    color: Tensor  # (3,) irradiance on a surface that faces it, of its light above the surroundings
    angle: float  # its diameter in radians, as a disc

    @property
    def wide(self) -> bool:
        """True if reflections show the sun as a part of the image, not as the highlight of a disc."""
        return self.angle > _WIDE


def split_suns(picture: Tensor) -> tuple[Tensor, Tensor, list[EnvironmentSun]]:
    """An equirectangular image (1, 3, H, W) without narrow suns, that without any sun, and the suns, wide ones last."""
    height = min(_SEARCH_HEIGHT, picture.shape[2])
    small = interpolate(picture, (height, 2 * height), mode="area")[0].flatten(1)
    toward, solid = texels(height, 2 * height, picture.device)
    fine, _ = texels(picture.shape[2], picture.shape[3], picture.device)
    weights = picture.new_tensor(LUMINANCE_WEIGHTS)
    mean = float(weights @ small @ solid) / (4 * math.pi)
    flat = picture[0].flatten(1)
    found: list[tuple[float, EnvironmentSun, Tensor]] = []
    for _ in range(_TRIED):
        peak = _middle(weights @ small, toward, solid)
        radius, level = _extent(small, toward, solid, peak, weights)
        excess = _excess(small, toward, peak, radius, level)
        if not float(weights @ excess @ solid) > 0:
            break
        part = _excess(flat, fine, peak, radius, level)
        small, flat = small - excess, flat - part
        # A disc with the centroid and second moment of the texels' luminous irradiance (T,).
        light = weights @ excess * solid
        center = toward @ light
        center = center / center.norm()
        moment = float((torch.arccos((center @ toward).clamp(-1.0, 1.0)) ** 2) @ light / light.sum())
        sun = EnvironmentSun(center, excess @ solid, 2 * math.sqrt(2 * moment))
        bright = float(weights @ sun.color)
        radiance = bright / (math.pi * max(sun.angle / 2, 1e-4) ** 2)
        if bright > _LEAST_SHARE * math.pi * mean and radiance > _LEAST_CONTRAST * mean:
            found.append((bright, sun, part.view_as(picture)))
    kept = sorted(found, key=lambda row: -row[0])[:_MOST]
    nothing = torch.zeros_like(picture)
    rest = sum((part for _, _, part in kept), nothing)
    discs = sum((part for _, sun, part in kept if not sun.wide), nothing)
    return picture - discs, picture - rest, sorted((sun for _, sun, _ in kept), key=lambda sun: sun.wide)


def _middle(light: Tensor, toward: Tensor, solid: Tensor) -> Tensor:
    """Direction (3,) to the middle of the bright region around the brightest of T texels, by luminance `light` (T,)."""
    height = round(math.sqrt(len(light) / 2))
    brightest = int(light.argmax())
    bright = light >= light[brightest] * _REGION
    bright &= toward[:, brightest] @ toward > math.cos(math.radians(2 * _RADII[-1]))
    region = torch.zeros_like(bright)
    region[brightest] = True
    for _ in range(2 * height):  # as far as a region can reach
        wide = pad(region.to(light.dtype).view(1, 1, height, -1), (1, 1, 0, 0), mode="circular")
        grown = (max_pool2d(wide, 3, 1, (1, 0)).flatten() > 0) & bright
        if torch.equal(grown, region):
            break
        region = grown
    middle = toward @ (light * solid * region)
    return middle / middle.norm().clamp_min(1e-20)


def _extent(small: Tensor, toward: Tensor, solid: Tensor, peak: Tensor, weights: Tensor) -> tuple[float, Tensor]:
    """Cosine of the least radius in `_RADII` that contains most of a peak's light, and the color (3,) of the ring around it."""
    candidates = []
    for degrees in _RADII:
        radius = math.cos(math.radians(degrees))
        cosine = peak @ toward
        ring = (cosine < radius) & (cosine > math.cos(math.radians(1.3 * degrees + 1.0)))
        # Where texels are too large for a ring, nothing stands out from its surroundings.
        level = small[:, ring].median(1).values if bool(ring.any()) else small.max(1).values
        light = weights @ _excess(small, toward, peak, radius, level) @ solid
        candidates.append((float(light), radius, level))
    most = max(light for light, _, _ in candidates)
    return next((radius, level) for light, radius, level in candidates if light >= _MOST_OF * most)


def _excess(picture: Tensor, toward: Tensor, peak: Tensor, radius: float, level: Tensor) -> Tensor:
    """Light (3, T) by which texels exceed a `level` (3,); 0 for texels outside `radius`, a cosine, around `peak`."""
    near = (peak @ toward > radius).to(picture.dtype)
    return (picture - level[:, None]).clamp_min(0.0) * near


class Environment:
    """The constant part of the world: its image, prepared for look-ups; images are (1, 3, H, W + 2), wrapped at both sides."""

    def __init__(self, scene: SceneData, device: torch.device) -> None:
        image, seen = scene.world.image, scene.world.backdrop
        self.hidden, self.horizon = scene.world.hidden, scene.world.horizon
        self.suns: list[EnvironmentSun] = []  # bright parts of the image, not in `soft` and `harmonics`
        self.whole: Tensor | None = None  # None for a plain color
        self.backdrop = None if seen is None else _padded(_sharp(seen, device))  # seen by the camera; None for a color
        self.sharp = self.blurred = self.soft = torch.zeros(0, device=device)
        if scene.world.kind != "environment" or image is None:
            # (9, 3) spherical harmonics of the radiance: a plain color has only the first.
            white = torch.full((1, 3), 2 * math.sqrt(math.pi), device=device)
            self.harmonics = torch.cat((white, torch.zeros((8, 3), device=device)))
            return
        sharp = _sharp(image, device)
        shown, rest, self.suns = split_suns(sharp)
        small = interpolate(rest, (_ROUGH_HEIGHT, 2 * _ROUGH_HEIGHT), mode="area")[0]
        grid, solid = texels(_ROUGH_HEIGHT, 2 * _ROUGH_HEIGHT, device)
        self.harmonics = harmonics(grid).mul(solid) @ small.flatten(1).T
        self.whole, self.sharp = _padded(sharp), _padded(shown)  # without narrow suns
        if self.backdrop is None and _shares_picture(scene):
            self.backdrop = self.whole
        self.blurred = blurred_stack(shown)
        self.soft = _padded(blurred(small, _SOFT)[None])


@dataclass(frozen=True)
class Sky:
    """The world in one render."""

    environment: Environment  # its constant part
    color: Tensor  # (3,) color or tint, times strength
    turn: Tensor  # () rotation of the image around the vertical, radians
    backdrop_color: Tensor  # (3,) `color` of what the camera sees
    backdrop_turn: Tensor  # () `turn` of what the camera sees
    horizon: Tensor | None = None  # (3,) tint at the horizon, which fades towards the top; None for none

    @property
    def plain(self) -> bool:
        """True if the world has one color in all directions."""
        return self.environment.whole is None

    def reaches(self, ray: str) -> bool:
        """True if a kind of rays meets the world."""
        return ray not in self.environment.hidden

    def signature(self) -> tuple[float, ...]:
        """Numbers that change when the uncolored radiance in any direction does."""
        return () if self.plain else (float(self.turn.detach()),)

    def mirror(self, toward: Tensor) -> Tensor:
        """Uncolored radiance (3, N) in unit directions (3, N) without narrow suns, which mirrors show as highlights."""
        return self._radiance(self.environment.sharp, toward, self.turn)

    def soft(self, toward: Tensor) -> Tensor:
        """Uncolored, blurred radiance (3, N) around unit directions (3, N), without suns."""
        return self._radiance(self.environment.soft, toward, self.turn)

    def reflected(self, mirrored: Tensor, normal: Tensor, view: Tensor, roughness: float) -> Tensor:
        """Uncolored radiance (3, N) of the world that a surface of one `roughness` reflects.

        `mirrored` and `normal` are unit vectors (3, N), `view` (7, N) is `albedo.basis` of the cosine to the viewer.
        """
        if self.plain:
            return torch.ones_like(mirrored)
        leans, widths = torch.einsum("pkb,bn->pkn", taps(roughness).to(view), view)
        upwards = normal - mirrored * dot(normal, mirrored)
        height, width = self.environment.blurred.shape[3], self.environment.blurred.shape[4] - 2
        parts = []
        for lean, round_roughness in zip(leans, widths, strict=True):
            x, y = _place(unit(mirrored + upwards * lean), self.turn)[0, 0].unbind(1)
            level = (round_roughness - _FIRST_BLUR) / (_BLUR_STEP * (_BLURS - 1) / 2) - 1
            # In `trilinear`, -1 and 1 are the middles of the outermost texels.
            where = torch.stack((x * (width / (width + 1)), y * (height / max(height - 1, 1)), level), 1)
            parts.append(trilinear(self.environment.blurred, where))
        return torch.stack(parts).mean(0)

    def seen(self, toward: Tensor) -> Tensor:
        """Uncolored radiance (3, N) of the world itself in unit directions (3, N), suns included."""
        return self._radiance(self.environment.whole, toward, self.turn)

    def backdrop(self, toward: Tensor) -> Tensor:
        """Uncolored radiance (3, N) that the camera sees behind everything, in unit directions (3, N)."""
        return self._radiance(self.environment.backdrop, toward, self.backdrop_turn)

    def backdrop_tint(self, height: Tensor) -> Tensor:
        """Color (3, N), or (3, 1) if even, that multiplies `backdrop` at heights (N,) in the image, 0 bottom, 1 top."""
        if self.horizon is None:
            return self.backdrop_color[:, None]
        share = ((height - self.environment.horizon) / (1.0 - self.environment.horizon)).clamp(0.0, 1.0)
        smooth = share * share * (3.0 - 2.0 * share)
        return self.backdrop_color[:, None] * (self.horizon[:, None] + (1.0 - self.horizon[:, None]) * smooth)

    def _radiance(self, picture: Tensor | None, toward: Tensor, turn: Tensor) -> Tensor:
        """Radiance (3, N) of a turned image in directions (3, N); 1 if there is no image."""
        if picture is None or not picture.numel():
            return torch.ones_like(toward)
        width = picture.shape[-1] - 2
        place = _place(toward, turn) * toward.new_tensor((width / (width + 2), 1.0))
        return grid_sample(picture, place, padding_mode="border", align_corners=False)[0, :, 0]

    @property
    def lamps(self) -> list[SunLight]:
        """The suns of the world's image, as lights."""
        c, s, zero, one = self.turn.cos(), self.turn.sin(), torch.zeros_like(self.turn), torch.ones_like(self.turn)
        rows = torch.stack((c, s, zero)), torch.stack((-s, c, zero)), torch.stack((zero, zero, one))
        lamps = []
        for number, sun in enumerate(self.environment.suns):
            axes = torch.stack(rows) @ torch.cat((*tangents(sun.toward[:, None]), sun.toward[:, None]), 1)
            light = Light(f"world/{number}", "SUN", IDENTITY, (0.0, 0.0, 0.0), hidden=self.environment.hidden)
            place = torch.zeros_like(sun.toward), axes, torch.full_like(self.turn.detach(), sun.angle)
            lamps.append(SunLight(light, sun.color * self.color, *place, pictured=sun.wide, owner="world"))
        return lamps

    def coefficients(self) -> Tensor:
        """Spherical harmonics (9, 3) of the colored, turned world."""
        base = self.environment.harmonics * self.reaches("diffuse")
        if self.plain:
            return base * self.color
        rows = list(base.unbind(0))
        for sine, cosine, order in ((1, 3, 1), (5, 7, 1), (4, 8, 2)):
            c, s = (order * self.turn).cos(), (order * self.turn).sin()
            rows[cosine], rows[sine] = rows[cosine] * c + rows[sine] * s, rows[sine] * c - rows[cosine] * s
        return torch.stack(rows) * self.color

    @property
    def hemispheres(self) -> Tensor:
        """(2, 3) irradiance from the world, over pi, on surfaces that face up and down (Ramamoorthi and Hanrahan 2001)."""
        h = self.environment.harmonics * self.color * self.reaches("diffuse")
        even, odd = 0.282095 * h[0] + 0.315392 * 2 / 4 * h[6], 0.488603 * 2 / 3 * h[2]
        return torch.stack((even + odd, even - odd)).clamp_min(0.0)


def has_own_backdrop(scene: SceneData) -> bool:
    """True if what the camera sees of the world has a color and a strength of its own."""
    return "world/backdrop_strength" in scene.instances


def _shares_picture(scene: SceneData) -> bool:
    """True if the camera sees the same image that lights the scene, with the same rotation."""
    tinted = not has_own_backdrop(scene) or "world/backdrop_tint" in scene.instances
    return scene.world.backdrop is None and tinted


def sky_of(environment: Environment, settings: RenderValues) -> Sky:
    """The world at a render's values."""
    still = torch.zeros((), device=settings.device)
    if environment.whole is None:
        color, turn = settings.color("world/color", 0.0), still
    else:
        color, turn = settings.color("world/tint", 1.0), torch.deg2rad(settings.scalar("world/rotation"))
    color = color * settings.scalar("world/strength", 1.0)
    if not has_own_backdrop(settings.scene):
        return Sky(environment, color, turn, color, turn)
    kind = "color" if environment.backdrop is None else "tint"
    backdrop = settings.color(f"world/backdrop_{kind}", 1.0) * settings.scalar("world/backdrop_strength", 1.0)
    turned = turn if _shares_picture(settings.scene) else still
    key = "world/backdrop_horizon"
    horizon = settings.color(key, 1.0) if key in settings.scene.instances else None
    return Sky(environment, color, turn, backdrop, turned, horizon)


def harmonics(toward: Tensor) -> Tensor:
    """Real spherical harmonics (9, N) of unit directions (3, N) (Ramamoorthi and Hanrahan 2001)."""
    x, y, z = toward.unbind(0)
    one = torch.full_like(x, 0.282095)  # the rows are those of 1, y, z, x, xy, yz, 3z² - 1, xz, x² - y²
    linear = 0.488603 * y, 0.488603 * z, 0.488603 * x
    mixed = 1.092548 * x * y, 1.092548 * y * z, 0.315392 * (3 * z * z - 1)
    return torch.stack((one, *linear, *mixed, 1.092548 * x * z, 0.546274 * (x * x - y * y)))


def _place(toward: Tensor, turn: Tensor) -> Tensor:
    """Places (1, 1, N, 2) for `grid_sample` of directions (3, N), turned by `turn` (): Blender's equirectangular mapping."""
    x, y, z = toward.unbind(0)
    across = (x * x + y * y).clamp_min(1e-12)
    angle = torch.atan2(y, torch.where(across > 1e-11, x, x + 1e-5)) + turn
    u = -angle / math.pi
    u = u - 2 * torch.floor((u.detach() + 1) / 2)
    v = torch.atan2(z, across.sqrt()) / (math.pi / 2)
    return torch.stack((u, v), -1)[None, None]


def _sharp(image: np.ndarray, device: torch.device) -> Tensor:
    """An equirectangular image (H, W, 3) as (1, 3, h, w), downsampled if it has more than `_SHARP_HEIGHT` rows."""
    picture = torch.from_numpy(image).to(device).permute(2, 0, 1)[None]
    size = (min(_SHARP_HEIGHT, picture.shape[2]), min(2 * _SHARP_HEIGHT, picture.shape[3]))
    return interpolate(picture, size, mode="area")


def _padded(picture: Tensor) -> Tensor:
    """Adds a wrapped column on both sides, so that bilinear look-ups are seamless."""
    return torch.cat((picture[..., -1:], picture, picture[..., :1]), -1).contiguous()


def blurred_stack(picture: Tensor) -> Tensor:
    """L blurred copies (1, 3, L, H, W + 2) of an equirectangular image (1, 3, H, W), with wrapped columns at both sides."""
    height = min(_BLURRED_HEIGHT, picture.shape[2])
    small = interpolate(picture, (height, 2 * height), mode="area")[0]
    return _padded(torch.stack([blurred(small, _FIRST_BLUR + _BLUR_STEP * level) for level in range(_BLURS)], 1))[None]


def blurred(picture: Tensor, roughness: float) -> Tensor:
    """An image (3, H, 2H) averaged over the reflected GGX lobe seen head on (n = v = r)."""
    # The lobe's weight depends on the two rows and on the distance between the two columns. Along rows, the average is therefore
    # a convolution: a product of Fourier series.
    height, width = picture.shape[1:]
    elevation = ((torch.arange(height, device=picture.device) + 0.5) / height - 0.5) * math.pi
    apart = torch.arange(width, device=picture.device) * (2 * math.pi / width)
    up, flat = elevation.sin(), elevation.cos()
    cosine = (up[:, None] * up)[..., None] + (flat[:, None] * flat)[..., None] * apart.cos()
    half2 = (1 + cosine) / 2  # squared cosine between the normal and the half vector
    lobe = cosine.clamp_min(0.0) / (half2 * (roughness**4 - 1) + 1) ** 2 * flat[:, None]
    lobe = lobe / lobe.sum((1, 2), keepdim=True)
    waves = torch.fft.rfft(lobe).real.to(torch.complex64)  # even in the distance: no sines
    return torch.fft.irfft(torch.einsum("ijw,cjw->ciw", waves, torch.fft.rfft(picture)), n=width)


@functools.cache
def taps(roughness: float) -> Tensor:
    """The K round lobes that approximate the long lobe of a roughness (see the module's docstring).

    Coefficients (2, K, 7) over `albedo.basis` of the viewer's cosine. The first row is each round lobe's tilt from the mirror
    direction towards the normal: its tangent, divided by the sine of the viewer's angle. The second is its roughness.
    """
    count = 2 if roughness < _ROUGH else 4
    return albedo.fit(torch.stack([_taps(cosine, roughness**2, count) for cosine in albedo.COSINES], -1))


def _taps(cosine: float, alpha: float, count: int) -> Tensor:
    """Tilt and roughness (2, K) of the K lobes of `taps` for one cosine of the viewer; `alpha` is roughness squared."""
    grid = (torch.arange(_TAP_SIDE) + 0.5) / _TAP_SIDE
    uv = torch.stack(torch.meshgrid(grid, grid, indexing="ij")).flatten(1)
    viewer = torch.full_like(uv[0], min(cosine, 0.999))
    toward, _ = mirrored(viewer, visible_normals(viewer, alpha, uv))
    weight = unshadowed(viewer, alpha, toward[2])
    sine = (1 - viewer * viewer).sqrt()
    lean = torch.atan2(viewer * toward[0] + sine * toward[2], viewer * toward[2] - sine * toward[0])
    order = lean.argsort()
    lean, weight, aside = lean[order], weight[order], toward[1].abs().asin()[order]
    # The long lobe is cut into parts with the same light, one above the other: one per round lobe.
    part = ((weight.cumsum(0) - weight / 2) * (count / weight.sum())).long().clamp_max(count - 1)
    parts = [part == k for k in range(count)]
    middle = torch.stack([(lean[p] * weight[p]).sum() / weight[p].sum() for p in parts])
    width = torch.stack([_median(aside[p], weight[p]) for p in parts])
    length = _median((lean - _median(lean, weight)).abs(), weight)
    width = torch.maximum(width, _NARROWEST * length)
    # A round lobe is as long as it is wide, so that the lobes' middles are closer together than the parts'.
    middle = middle.mean() + (middle - middle.mean()) * (1 - (width.mean() / length) ** 2).clamp_min(0.0).sqrt()
    # In slopes, half of a GGX lobe lies within alpha / sqrt(3) of a line through its middle.
    round_ = (math.sqrt(3) * (width / 2).tan()).sqrt()
    return torch.stack((middle.clamp_max(1.4).tan() / sine[0], round_))


def _median(values: Tensor, weights: Tensor) -> Tensor:
    """Median () of values (N,) with weights (N,)."""
    order = values.argsort()
    below = weights[order].cumsum(0)
    return values[order][torch.searchsorted(below, below[-1] / 2).clamp_max(len(values) - 1)]
