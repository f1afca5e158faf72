# SPDX-License-Identifier: Apache-2.0
"""The interface of all types of light, and what lights with a position have in common.

Formulas follow Cycles (kernel/light, scene/light.cpp). Irradiance and intensity are per unit of `LightSource.color`, so that they
stay the same while only power, color or temperature change.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar, Self

import torch
from jaxtyping import Bool, Float, Int
from torch import Tensor

from ...color.tensors import blackbody
from ...scene import Light, SceneData
from ...scene.values import RenderValues, needs_gradient
from ..geometry.camera import RaySegments, direction, frame
from ..geometry.vectors import PointSet, dot, tangents, within

Vectors = Float[Tensor, "3 n"]
Numbers = Float[Tensor, " n"]
POINT_RADIUS = 1e-3  # least angular radius of a light, radians: points have no highlight in a mirror


@dataclass(frozen=True)
class DirectIrradiance(PointSet):
    """Light that reaches N points from one light, unshadowed, per unit of its color."""

    toward: Vectors  # (3, N) unit vectors to the light's center
    distance: Numbers  # (N,) to the light's center in meters; infinite for suns
    irradiance: Numbers  # (N,) on the surface, cosine included
    frontal: Numbers  # (N,) on a surface that faces the light: radiance times solid angle
    solid_angle: Numbers  # (N,) that the light fills, steradians


@dataclass(frozen=True)
class SegmentLight:
    """Light that reaches the S segments of rays from one light, unshadowed, per unit of its color."""

    points: Float[Tensor, "3 ..."]  # (3, S · parts, …) points that halve the light of each part
    toward: Float[Tensor, "3 ..."]  # (3, S · parts, …) unit vectors from there to the light
    distance: Float[Tensor, "*n"]  # (S · parts, …) to the light in meters; infinite for suns
    irradiance: Float[Tensor, "*n"]  # (S · parts, …) mean over a part, on a surface that faces the light


@dataclass(frozen=True)
class LightSource(ABC):
    """A light in one render. A type of light is a subclass; by default it is round and has a position and a power."""

    light: Light  # the scene's record
    color: Float[Tensor, " 3"]  # (3,) power or strength times color, temperature and exposure
    position: Float[Tensor, " 3"]  # (3,) in meters; for suns the pivot, which nothing depends on
    axes: Float[Tensor, "3 3"]  # (3, 3) columns x, y, z of the light; it shines along -z
    size: Float[Tensor, ""]  # () radius, width or angle, see `read_size`
    pictured: bool = field(default=False, kw_only=True)  # whether reflections show its image, not a highlight
    shadowless: int = field(default=-1, kw_only=True)  # index of a material that casts no shadow in its light; or -1
    # owner of the parameters that its color depends on: "light/NAME" or "world"; "" for what surfaces emit
    owner: str = field(default="", kw_only=True)

    energy_name: ClassVar[str] = "power"  # the parameter of its energy: "power" in watts, "strength" in W/m²
    at_infinity: ClassVar[bool] = False  # whether all its light comes from one direction, with no distance
    segment_parts: ClassVar[int] = 1  # number of parts into which its light in a segment of fog is cut

    @classmethod
    def of(cls, light: Light, scene: SceneData, values: RenderValues, **more: Any) -> Self:
        """A scene's light at the values of one render; `more` are further fields of the subclass."""
        key = f"light/{light.name}/"
        azimuth, elevation = values.scalar(key + "azimuth"), values.scalar(key + "elevation")
        color = values.color(key + "color", 1.0) * (values.scalar(key + cls.energy_name, 1.0) * 2.0**light.exposure)
        temperature = values.scalar(key + "temperature", 6500.0)
        if light.use_temperature or needs_gradient(temperature) or float(temperature.detach()) != 6500.0:
            color = color * blackbody(temperature)
        if light.tint != (1.0, 1.0, 1.0):
            color = color * torch.tensor(light.tint, device=values.device)
        pivot = torch.tensor(scene.pivot, device=values.device)
        distance = 0.0 if cls.at_infinity else values.scalar(key + "distance", 1.0)
        size = cls.read_size(light, values)
        axes = torch.tensor(light.residual, device=values.device)
        if light.fixed:
            position = torch.tensor(light.position, device=values.device)
        else:
            axes = frame(azimuth, elevation) @ axes
            position = pivot + distance * direction(azimuth, elevation)
        return cls(light, color, position, axes, within(size, 0.0, math.inf), owner=f"light/{light.name}", **more)

    @staticmethod
    def read_size(light: Light, values: RenderValues) -> Float[Tensor, ""]:
        """Radius of a point or spot and width of an area light in meters, angular diameter of a sun in radians: ()."""
        return values.scalar(f"light/{light.name}/size") * light.scale

    def toward(self, points: Vectors) -> tuple[Vectors, Numbers]:
        """Unit vectors (3, N) from points (3, N) to the light's center, and distances (N,) in meters."""
        return offsets(self.position, points)[:2]

    @abstractmethod
    def irradiance(self, points: Vectors, normals: Vectors) -> DirectIrradiance:
        """Unshadowed light at points (3, N) with unit normals (3, N)."""

    @abstractmethod
    def shadow_targets(self, direct: DirectIrradiance, uv: Float[Tensor, "2 n"]) -> tuple[Vectors, Numbers]:
        """Unit directions (3, N) and distances (N,) of shadow rays to points on the light, from uv (2, N) in [0, 1)."""

    @abstractmethod
    def in_scattering(self, segments: RaySegments, parts: int) -> SegmentLight:
        """Unshadowed light that reaches fog along rays; segments are divided into `parts` where the light varies along them."""

    def half_sides(self) -> tuple[Float[Tensor, "3 1"], Float[Tensor, "3 1"]] | None:
        """Half the sides, (3, 1) each, of a rectangular outline; None for a round one."""
        return None

    def lights(self, objects: Int[Tensor, " n"]) -> Bool[Tensor, " n"]:
        """(N,) bool, True for points on objects (N,) that get its light: light linking may leave objects out."""
        return ~torch.isin(objects, objects.new_tensor(self.light.unlit))

    def reaches(self, ray: str) -> bool:
        """True if surfaces' rays of a kind, such as "glossy", meet the light."""
        return ray not in self.light.hidden

    @property
    def shines(self) -> bool:
        """True if it gives light, or its color is being learned."""
        return self.color.requires_grad or bool(self.color.any())

    @property
    def placement(self) -> dict[str, Tensor]:
        """Name of each field that shadows depend on -> its value: position, axes, size."""
        return {"position": self.position, "axes": self.axes, "size": self.size}

    @property
    def moving(self) -> bool:
        """True if gradients with respect to its placement are wanted."""
        return needs_gradient(*self.placement.values())

    def signature(self) -> tuple[float, ...]:
        """Numbers that change when its placement does."""
        return tuple(torch.cat([part.detach().flatten() for part in self.placement.values()]).tolist())

    def detached(self) -> Self:
        """The same light without gradients."""
        parts: dict[str, Any] = {name: part.detach() for name, part in self.placement.items()}
        return replace(self, color=self.color.detach(), **parts)


def offsets(position: Tensor, points: Tensor) -> tuple[Tensor, Tensor, Tensor]:
    """From points (3, N) to a place (3,): unit vectors (3, N), distances (N,) in meters, and their squares (N,)."""
    offset = position[:, None] - points
    squared = dot(offset, offset).clamp_min(1e-8)
    distance = squared.sqrt()
    return offset / distance, distance, squared


def disc_offsets(toward: Tensor, solid_angle: Tensor, uv: Tensor) -> Tensor:
    """Offsets (3, N) from a disc's middle to points on the disc, by `uv` (2, N) in [0, 1).

    The disc faces the lit point from distance 1, in the direction `toward` (3, N), and fills a solid angle (N,).
    """
    radius, angle = uv[0].sqrt(), 2 * math.pi * uv[1]
    x, y = radius * angle.cos(), radius * angle.sin()
    across, up = tangents(toward)
    return (across * x + up * y) * (solid_angle / math.pi).sqrt()


def clipped_sphere(cosine: Tensor, sine2: Tensor) -> Tensor:
    """Cosine (N,) by which a sphere lights a surface if only its part above the surface's horizon counts.

    `cosine` (N,) is that between the normal and the sphere's middle, `sine2` (N,) the squared sine of the sphere's angular
    radius. The result is `cosine` where the sphere is fully above the horizon, 0 where it is below, and in between a smooth blend
    that meets both ends with the right slope (Hill and Heitz, "Real-Time Area Lighting", 2016).
    """
    sine = sine2.clamp_min(1e-8).sqrt()
    t = (cosine / sine).clamp(-1.0, 1.0)
    partial = sine * (1 + t) * (1 + t) / 4
    return torch.where(cosine > sine, cosine, partial)


def equiangular(
    segments: RaySegments,
    position: Tensor,
    softness: Tensor,
    back: Tensor | None,
    parts: int,
    intensity: Callable[[Tensor], Tensor],
) -> SegmentLight:
    """Light from a place (3,) along rays, integrated analytically (equiangular sampling: Kulla and Fajardo 2012).

    The parts of a segment subtend equal angles at the light, and so get equal light. `softness` (), meters, is added to
    the ray's distance from the light as a root sum of squares: about the effect of averaging over the light's size. A
    flat light shines opposite to `back` (3,); None for lights that shine to all sides. `intensity` maps unit vectors
    (3, n) towards the light to the light's intensity (n,) in the opposite directions.
    """
    to_light = position.view(3, 1, 1) - segments.start
    closest = (to_light * segments.toward).sum(0)
    aside = (to_light * to_light).sum(0) - closest * closest
    aside = (aside.clamp_min(0) + softness * softness + 1e-6).sqrt()
    cuts = segments.cuts
    if back is not None:
        # Ends of segments behind a flat light, which shines to one side only, are moved to its plane.
        z = back.view(3, 1, 1)
        slope = (z * segments.toward).sum(0)  # above 0 from the lit side to the dark one
        plane = (z * to_light).sum(0) / torch.where(slope.abs() < 1e-6, 1e-6, slope)
        cuts = torch.where(slope > 0, torch.minimum(cuts, plane), torch.maximum(cuts, plane))
    angle = torch.atan((cuts - closest) / aside)[:, None]
    step = angle[1:] - angle[:-1]
    part = (torch.arange(parts, device=aside.device) + 0.5).view(-1, 1, 1) / parts
    middle = closest + aside * torch.tan(angle[:-1] + step * part)
    spans = (segments.cuts[1:] - segments.cuts[:-1])[:, None]
    mean_inverse_square = (step / (aside * spans).clamp_min(1e-12)).expand_as(middle).flatten(0, 1)
    points = segments.start[:, None] + segments.toward[:, None] * middle.flatten(0, 1)
    offset = position.view(3, 1, 1, 1) - points
    distance = (offset * offset).sum(0).clamp_min(1e-8).sqrt()
    toward = offset / distance
    strength = intensity(toward.flatten(1)).view(distance.shape) * mean_inverse_square
    return SegmentLight(points, toward, distance, strength)
