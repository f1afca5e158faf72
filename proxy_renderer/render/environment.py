# SPDX-License-Identifier: Apache-2.0
"""The world as a light: what a ray that leaves the scene sees, sharp, blurred, or as irradiance, and its suns as lamps."""

from __future__ import annotations

import math
from dataclasses import dataclass

import torch
from torch import Tensor
from torch.nn.functional import grid_sample, interpolate

from ..scene import SceneData
from .directions import texels
from .lights import Lamp
from .settings import Settings
from .suns import Sun, without_suns

ROUGHNESS = (0.0, 0.15, 0.3, 0.5, 0.75, 1.0)
"""Roughness of the blurred copies of an environment picture."""
_BLURRED_HEIGHT = 48
_SHARP_HEIGHT = 512


class Environment:
    """The parts of the world that no vibe changes.

    Attributes:
        levels: One picture (1, 3, H, W) per entry of `ROUGHNESS`; empty for a plain color.
        whole: The picture with its suns; None for a plain color. `levels` and `harmonics` are without.
        suns: Its bright parts.
        harmonics: (9, 3) spherical harmonics of the radiance; a plain color has only the first.
    """

    def __init__(self, scene: SceneData, device: torch.device) -> None:
        self.levels: list[Tensor] = []
        self.suns: list[Sun] = []
        self.whole: Tensor | None = None
        image = scene.world.image
        if scene.world.kind != "environment" or image is None:
            white = torch.full((1, 3), 2 * math.sqrt(math.pi), device=device)
            self.harmonics = torch.cat((white, torch.zeros((8, 3), device=device)))
            return
        picture = torch.from_numpy(image).to(device).permute(2, 0, 1)[None]
        size = (min(_SHARP_HEIGHT, picture.shape[2]), min(2 * _SHARP_HEIGHT, picture.shape[3]))
        sharp = interpolate(picture, size, mode="area")
        self.whole = _padded(sharp)
        sharp, self.suns = without_suns(sharp)
        small = interpolate(sharp, (_BLURRED_HEIGHT, 2 * _BLURRED_HEIGHT), mode="area")[0].flatten(1)
        grid, solid = texels(_BLURRED_HEIGHT, 2 * _BLURRED_HEIGHT, device)
        self.harmonics = harmonics(grid).mul(solid) @ small.T
        self.levels = [_padded(sharp)]
        for roughness in ROUGHNESS[1:]:
            blurred = small @ _blur(grid, solid, roughness)
            self.levels.append(_padded(blurred.view(1, 3, _BLURRED_HEIGHT, -1)))


@dataclass(frozen=True)
class Sky:
    """The world in one render.

    Attributes:
        environment: Its constant part.
        color: (3,) color or tint, times strength.
        turn: () rotation of the picture around the vertical, radians.
    """

    environment: Environment
    color: Tensor
    turn: Tensor

    @property
    def plain(self) -> bool:
        """Whether it looks the same everywhere."""
        return not self.environment.levels

    def signature(self) -> tuple[float, ...]:
        """Numbers that change when what a direction sees does, color and strength aside."""
        return () if self.plain else (float(self.turn.detach()),)

    def levels(self, toward: Tensor, roughness: tuple[float, ...]) -> list[Tensor]:
        """Uncolored radiance (3, N) in unit directions (3, N), one per level of `ROUGHNESS` asked for."""
        if self.plain:
            return [torch.ones_like(toward) for _ in roughness]
        place = self._place(toward)
        return [_look_up(self.environment.levels[ROUGHNESS.index(r)], place) for r in roughness]

    def seen(self, toward: Tensor) -> Tensor:
        """Uncolored radiance (3, N) of the world itself in unit directions (3, N), suns included."""
        whole = self.environment.whole
        return torch.ones_like(toward) if whole is None else _look_up(whole, self._place(toward))

    @property
    def lamps(self) -> list[Lamp]:
        """The suns in its picture."""
        return [sun.lamp(i, self.color, self.turn) for i, sun in enumerate(self.environment.suns)]

    def _place(self, toward: Tensor) -> Tensor:
        """Blender's equirectangular mapping of turned directions: (1, 1, N, 2) for grid_sample."""
        x, y, z = toward.unbind(0)
        across = (x * x + y * y).clamp_min(1e-12)
        angle = torch.atan2(y, torch.where(across > 1e-11, x, x + 1e-5)) + self.turn
        u = -angle / math.pi
        u = u - 2 * torch.floor((u.detach() + 1) / 2)
        v = torch.atan2(z, across.sqrt()) / (math.pi / 2)
        return torch.stack((u, v), -1)[None, None]

    def coefficients(self) -> Tensor:
        """Spherical harmonics (9, 3) of the colored, turned world."""
        base = self.environment.harmonics
        if self.plain:
            return base * self.color
        rows = list(base.unbind(0))
        for sine, cosine, order in ((1, 3, 1), (5, 7, 1), (4, 8, 2)):
            c, s = (order * self.turn).cos(), (order * self.turn).sin()
            rows[cosine], rows[sine] = rows[cosine] * c + rows[sine] * s, rows[sine] * c - rows[cosine] * s
        return torch.stack(rows) * self.color

    @property
    def halves(self) -> Tensor:
        """(2, 3) light of the world on surfaces that face up and down: irradiance over pi.

        Ramamoorthi and Hanrahan's convolution with the cosine (2001), which the rotation does not change.
        """
        h = self.environment.harmonics * self.color
        even, odd = 0.282095 * h[0] + 0.315392 * 2 / 4 * h[6], 0.488603 * 2 / 3 * h[2]
        return torch.stack((even + odd, even - odd)).clamp_min(0.0)


def sky_of(environment: Environment, settings: Settings) -> Sky:
    """The world at a render's values."""
    strength = settings.scalar("world/strength", 1.0)
    if environment.levels:
        turn = torch.deg2rad(settings.scalar("world/rotation"))
        return Sky(environment, settings.color("world/tint", 1.0) * strength, turn)
    color = settings.color("world/color", 0.0)
    return Sky(environment, color * strength, torch.zeros((), device=settings.device))


def harmonics(toward: Tensor) -> Tensor:
    """Real spherical harmonics up to degree 2, (9, N), of unit directions (3, N).

    Order: 1, y, z, x, xy, yz, 3z^2 - 1, xz, x^2 - y^2 (Ramamoorthi and Hanrahan 2001).
    """
    x, y, z = toward.unbind(0)
    one = torch.full_like(x, 0.282095)
    linear = 0.488603 * y, 0.488603 * z, 0.488603 * x
    mixed = 1.092548 * x * y, 1.092548 * y * z, 0.315392 * (3 * z * z - 1)
    return torch.stack((one, *linear, *mixed, 1.092548 * x * z, 0.546274 * (x * x - y * y)))


def _blur(toward: Tensor, solid: Tensor, roughness: float) -> Tensor:
    """(T, T) weights that average a picture over the reflected GGX lobe seen head on (n = v = r)."""
    alpha2 = roughness**4
    cosine = (toward.T @ toward).clamp(-1.0, 1.0)
    half2 = (1 + cosine) / 2  # squared cosine between the normal and the half vector
    lobe = cosine.clamp_min(0.0) / (half2 * (alpha2 - 1) + 1) ** 2
    weights = lobe * solid[:, None]
    return weights / weights.sum(0, keepdim=True)


def _padded(picture: Tensor) -> Tensor:
    """Adds a wrapped column on both sides, so that bilinear look-ups are seamless."""
    return torch.cat((picture[..., -1:], picture, picture[..., :1]), -1).contiguous()


def _look_up(picture: Tensor, place: Tensor) -> Tensor:
    width = picture.shape[-1] - 2
    place = place * place.new_tensor((width / (width + 2), 1.0))
    return grid_sample(picture, place, padding_mode="border", align_corners=False)[0, :, 0]
