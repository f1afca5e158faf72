# SPDX-License-Identifier: Apache-2.0
"""Lights of a render: what they are, where they stand, how bright they are, in Blender's calibration."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import torch
from torch import Tensor

from ...color.blackbody import blackbody
from ...scene import Light, SceneData
from ...scene.values import Settings, wanted
from ..geometry.camera import direction, frame
from ..geometry.vectors import dot, length, tangents, within
from ..geometry.visibility import Geometry


@dataclass(frozen=True)
class Glow:
    """How a glowing surface differs from a point that shines to all sides alike.

    Attributes:
        form: (3, 3) symmetric: the root of w.form.w is how brightly it shines to the unit vector w and to -w.
        lean: (3,) what it shines more to w than to -w, as a factor of w.
        blockers: The scene without it.
    """

    form: Tensor
    lean: Tensor
    blockers: Geometry

    def toward(self, way: Tensor) -> Tensor:
        """Intensity (N,) to unit vectors (3, N), 1 on average."""
        even = dot(way, self.form @ way).clamp_min(1e-12).sqrt()
        return (even + self.lean @ way).clamp_min(0.0)


@dataclass(frozen=True)
class Lamp:
    """A light in one render.

    Attributes:
        light: The scene's record.
        color: (3,) power or strength times color, temperature and exposure.
        position: (3,) in meters; for suns the pivot, which nothing depends on.
        axes: (3, 3) columns x, y, z of the lamp; it shines along -z.
        size: () radius of a point or spot, width of an area light, angle of a sun in radians.
        of_world: Whether it is a bright part of the world's picture.
        glow: What it is as a part of a glowing surface; None for a lamp.
        wide: Whether it is a large part of the world's picture.
    """

    light: Light
    color: Tensor
    position: Tensor
    axes: Tensor
    size: Tensor
    of_world: bool = False
    glow: Glow | None = None
    wide: bool = False

    @property
    def owner(self) -> str:
        """Whose parameters its color depends on: "light/NAME" or "world"; "" for what surfaces emit."""
        if self.glow:
            return ""
        return "world" if self.of_world else f"light/{self.light.name}"

    @property
    def pictured(self) -> bool:
        """Whether reflections show its image, so that it has no highlight."""
        return self.wide or self.glow is not None

    @property
    def moving(self) -> bool:
        """Whether gradients with respect to its place, direction or size are wanted."""
        return wanted(self.position, self.axes, self.size)

    @property
    def round(self) -> bool:
        """Whether its outline is a disc rather than a rectangle."""
        return self.light.type != "AREA" or self.light.shape in ("DISK", "ELLIPSE")

    @property
    def focused(self) -> bool:
        """Whether an area light shines into a narrower cone than a plain one."""
        return self.light.type == "AREA" and self.light.spread / 2 <= math.pi / 2 - 1e-3

    @property
    def area(self) -> Tensor:
        """Area () of an area light in square meters."""
        rectangle = self.size * self.size * self.light.aspect
        return (rectangle * (math.pi / 4 if self.round else 1.0)).clamp_min(1e-8)

    def signature(self) -> tuple[float, ...]:
        """Numbers that change when anything that shadows depend on does."""
        parts = torch.cat((self.position, self.axes.flatten(), self.size[None]))
        return tuple(parts.detach().tolist())

    def detached(self) -> Lamp:
        """The same lamp without gradients."""
        return replace(
            self,
            color=self.color.detach(),
            position=self.position.detach(),
            axes=self.axes.detach(),
            size=self.size.detach(),
        )


def lamps_of(scene: SceneData, settings: Settings) -> list[Lamp]:
    """All lights of the scene at the render's values."""
    return [_lamp(light, scene, settings) for light in scene.lights]


def _lamp(light: Light, scene: SceneData, settings: Settings) -> Lamp:
    key = f"light/{light.name}/"
    sun = light.type == "SUN"
    azimuth, elevation = settings.scalar(key + "azimuth"), settings.scalar(key + "elevation")
    power = settings.scalar(key + ("strength" if sun else "power"), 1.0)
    tint = settings.color(key + "color", 1.0) * (power * 2.0**light.exposure)
    temperature = settings.scalar(key + "temperature", 6500.0)
    if light.use_temperature or wanted(temperature) or float(temperature.detach()) != 6500.0:
        tint = tint * blackbody(temperature)
    if light.tint != (1.0, 1.0, 1.0):
        tint = tint * torch.tensor(light.tint, device=settings.device)
    pivot = torch.tensor(scene.pivot, device=settings.device)
    distance = 0.0 if sun else settings.scalar(key + "distance", 1.0)
    size = (
        torch.deg2rad(settings.scalar(key + "angle")) if sun else settings.scalar(key + "size") * light.scale
    )
    axes = frame(azimuth, elevation) @ torch.tensor(light.residual, device=settings.device)
    position = pivot + distance * direction(azimuth, elevation)
    return Lamp(light, tint, position, axes, within(size, 0.0, math.inf))


def half_axes(lamp: Lamp) -> tuple[Tensor, Tensor]:
    """Half the sides of an area light, (3, 1) each; a disc counts as a square of the same area."""
    half = lamp.size / 2 * (math.sqrt(math.pi) / 2 if lamp.round else 1.0)
    return lamp.axes[:, 0:1] * half, lamp.axes[:, 1:2] * (half * lamp.light.aspect)


def outline(lamp: Lamp, toward: Tensor, distance: Tensor, solid: Tensor, uv: Tensor) -> tuple[Tensor, Tensor]:
    """Points on a lamp to which shadow rays go.

    Args:
        lamp: The lamp.
        toward: (3, N) unit vectors to its center.
        distance: (N,) to its center.
        solid: (N,) its solid angle.
        uv: (2, N) in [0, 1), stratified.

    Returns:
        Unit directions (3, N) and distances (N,).
    """
    if lamp.light.type == "AREA" and not lamp.round:
        u, v = half_axes(lamp)
        offset = u * (2 * uv[0] - 1) + v * (2 * uv[1] - 1)
    else:
        radius, angle = uv[0].sqrt(), 2 * math.pi * uv[1]
        x, y = radius * angle.cos(), radius * angle.sin()
        if lamp.light.type == "AREA":
            offset = lamp.axes[:, 0:1] * (x * lamp.size / 2)
            offset = offset + lamp.axes[:, 1:2] * (y * lamp.size / 2 * lamp.light.aspect)
        else:
            reach = torch.where(distance.isinf(), torch.ones_like(distance), distance)
            across, up = tangents(toward)
            offset = (across * x + up * y) * (solid / math.pi).sqrt() * reach
    reach = torch.where(distance.isinf(), torch.ones_like(distance), distance)
    target = toward * reach + offset
    away = length(target)
    return target / away, torch.where(distance.isinf(), distance, away)
