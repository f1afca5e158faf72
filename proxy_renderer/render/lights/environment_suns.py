# SPDX-License-Identifier: Apache-2.0
"""Suns of an environment image: its small bright parts, taken out and treated as lights, so that their shadows are sharp.

Cycles samples an environment by importance. Its visible shadows come from small bright parts: a window, a light, the sun. The
rest stays smooth light from all around.
"""

import math
from dataclasses import dataclass

import torch
from torch import Tensor
from torch.nn.functional import interpolate, max_pool2d, pad

from ...color.constants import LUMINANCE_WEIGHTS
from ...scene import Light
from ...schema.orbit import IDENTITY
from ..geometry.vectors import tangents, texels
from .light_types import SunLight

_MOST, _TRIED = 3, 6  # number of suns at most, and of candidates
_REGION = 0.25  # least brightness of a sun's texels, relative to its brightest one
_WIDE = math.radians(12.0)  # diameter from which a sun is too large to pass for a disc in a mirror
_LEAST_SHARE = 0.12  # least irradiance from a sun over that from an even world of the same mean radiance
_LEAST_CONTRAST = 3.0  # least radiance of a sun, as a disc, relative to the mean of the world
_RADII = (3.0, 6.0, 12.0, 20.0)  # degrees around a peak within which a sun may lie
_MOST_OF = 0.8  # share of the light around a peak that a sun's radius contains
_SEARCH_HEIGHT = 128


@dataclass(frozen=True)
class EnvironmentSun:
    """A bright part of an image, as a disc."""

    toward: Tensor  # (3,) unit vector to it, before the image is turned
    color: Tensor  # (3,) irradiance on a surface that faces it, without that from its surroundings' level
    angle: float  # its diameter in radians, as a disc

    @property
    def wide(self) -> bool:
        """True if reflections show the sun as a part of the image, not as the highlight of a disc."""
        return self.angle > _WIDE

    def lamp(self, number: int, tint: Tensor, turn: Tensor, hidden: tuple[str, ...] = ()) -> SunLight:
        """The sun as a light, in a world of color `tint` (3,), turned by `turn` () radians and `hidden` from kinds of rays."""
        c, s, zero, one = turn.cos(), turn.sin(), torch.zeros_like(turn), torch.ones_like(turn)
        rows = torch.stack((c, s, zero)), torch.stack((-s, c, zero)), torch.stack((zero, zero, one))
        across, up = tangents(self.toward[:, None])
        axes = torch.stack(rows) @ torch.cat((across, up, self.toward[:, None]), 1)
        light = Light(f"world/{number}", "SUN", IDENTITY, (0.0, 0.0, 0.0), hidden=hidden)
        place, size = torch.zeros_like(self.toward), torch.full_like(turn.detach(), self.angle)
        return SunLight(light, self.color * tint, place, axes, size, pictured=self.wide, owner="world")


def split(picture: Tensor) -> tuple[Tensor, Tensor, list[EnvironmentSun]]:
    """Splits an equirectangular image (1, 3, H, W): the image without narrow suns, without any sun, and the suns, the wide ones last."""
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
    """Direction (3,) to the middle of the bright region around the brightest of T texels."""
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
    """Light (3, T) of texels above a level (3,), around a peak; 0 for texels outside the radius, which is given as a cosine."""
    near = (peak @ toward > radius).to(picture.dtype)
    return (picture - level[:, None]).clamp_min(0.0) * near
