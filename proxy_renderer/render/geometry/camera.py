# SPDX-License-Identifier: Apache-2.0
"""The camera: rays through pixels, projection of points, both differentiable; rays cut into segments for fog.

Vectors are planar, (3, N), here and in all shading code: broadcasting scalars of samples over components is then
contiguous, which is several times faster on a CPU than (N, 3).
"""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, replace

import torch
from jaxtyping import Float
from torch import Tensor

from ...scene import SceneData
from ...scene.values import RenderValues, needs_gradient
from .vectors import dot, unit


def direction(azimuth: Float[Tensor, ""], elevation: Float[Tensor, ""]) -> Float[Tensor, " 3"]:
    """Unit vector (3,) from the subject to a place at angles () in degrees; `schema.orbit.direction` in torch."""
    a, e = torch.deg2rad(azimuth), torch.deg2rad(elevation)
    return torch.stack((e.cos() * a.sin(), -e.cos() * a.cos(), e.sin()))


def frame(azimuth: Float[Tensor, ""], elevation: Float[Tensor, ""]) -> Float[Tensor, "3 3"]:
    """Rotation (3, 3) of a camera at angles () in degrees, columns right, up, back; `schema.orbit.frame` in torch."""
    a = torch.deg2rad(azimuth)
    z = direction(azimuth, elevation)
    x = torch.stack((a.cos(), a.sin(), torch.zeros_like(a)))
    return torch.stack((x, torch.linalg.cross(z, x), z), 1)


@dataclass(frozen=True)
class View:
    """A camera's pose and lens for one render."""

    position: Float[Tensor, " 3"]  # (3,) in meters
    rotation: Float[Tensor, "3 3"]  # (3, 3), columns right, up, back
    scale: Float[Tensor, ""]  # () meters per unit of `extent`: at a depth of 1 m; at all depths if orthographic
    orthographic: bool  # True if rays are parallel
    size: tuple[int, int]  # width and height in pixels
    extent: tuple[float, float]  # width and height of the image; 1 is the side that the field of view spans
    shift: tuple[float, float]  # lens shift to the right and up, in units of `extent`
    clip: tuple[float, float]  # depths of the near and the far plane, meters

    @property
    def moving(self) -> bool:
        """True if gradients with respect to the camera are wanted."""
        return needs_gradient(self.position, self.rotation, self.scale)

    def detached(self) -> View:
        """The same view without gradients."""
        position, rotation, scale = (x.detach() for x in (self.position, self.rotation, self.scale))
        return replace(self, position=position, rotation=rotation, scale=scale)

    def signature(self) -> tuple[float, ...]:
        """Position, rotation, scale and size as numbers, which change when the rays do."""
        flat = torch.cat((self.position, self.rotation.flatten(), self.scale[None])).detach()
        return (*flat.tolist(), *map(float, self.size))

    def rays(self, pixel: Float[Tensor, "2 n"]) -> tuple[Float[Tensor, "3 n"], Float[Tensor, "3 n"]]:
        """Origins and unit directions, (3, N) each, of rays through pixels (2, N): x right, y down, centers at .5."""
        width, height = self.size
        x = ((pixel[0] / width - 0.5) * self.extent[0] + self.shift[0]) * self.scale
        y = ((0.5 - pixel[1] / height) * self.extent[1] + self.shift[1]) * self.scale
        right, up, back = self.rotation.unbind(1)
        across = right[:, None] * x + up[:, None] * y
        if self.orthographic:
            return self.position[:, None] + across, -back[:, None].expand_as(across)
        toward = across - back[:, None]
        return self.position[:, None].expand_as(toward), unit(toward)

    def span(self, toward: Float[Tensor, "3 n"]) -> tuple[Float[Tensor, " n"], Float[Tensor, " n"]]:
        """Distances (N,) to the near and (N,) to the far plane along rays with unit directions (3, N), in meters."""
        slant = 1.0 / -dot(self.rotation[:, 2:3], toward).clamp_max(-1e-6)
        return slant * self.clip[0], slant * self.clip[1]

    def project(self, points: Float[Tensor, "3 n"]) -> Float[Tensor, "2 n"]:
        """Pixel positions (2, N), as in `rays`, of world points (3, N), which must lie in front of the camera."""
        x, y, z = (self.rotation.T @ (points - self.position[:, None])).unbind(0)
        depth = self.scale if self.orthographic else (-z).clamp_min(1e-6) * self.scale
        u = ((x / depth - self.shift[0]) / self.extent[0] + 0.5) * self.size[0]
        v = (0.5 - (y / depth - self.shift[1]) / self.extent[1]) * self.size[1]
        return torch.stack((u, v))


def view_of(scene: SceneData, settings: RenderValues, size: tuple[int, int]) -> View:
    """View of a render of `size` (width, height): orbit and field of view from `settings`, the rest from `scene`."""
    camera = scene.camera
    azimuth, elevation = settings.scalar("camera/azimuth"), settings.scalar("camera/elevation")
    pivot = torch.tensor(scene.pivot, device=settings.device)
    position = pivot + settings.scalar("camera/distance", 1.0) * direction(azimuth, elevation)
    residual = torch.tensor(camera.residual, device=settings.device)
    width, height = size[0] * scene.pixel_aspect, float(size[1])
    spanned = {"HORIZONTAL": width, "VERTICAL": height}.get(camera.sensor_fit, max(width, height))
    orthographic = camera.type == "ORTHO"
    if orthographic:
        scale = torch.tensor(float(camera.ortho_scale), device=settings.device)
    else:
        scale = 2.0 * torch.tan(torch.deg2rad(settings.scalar("camera/fov", 40.0)) / 2)
    extent = width / spanned, height / spanned
    rotation = frame(azimuth, elevation) @ residual
    return View(position, rotation, scale, orthographic, size, extent, camera.shift, camera.clip)


@dataclass(frozen=True)
class RaySegments:
    """A grid of rays, (rows, columns), each cut into S segments."""

    start: Tensor  # (3, rows, columns) origins, meters
    toward: Tensor  # (3, rows, columns) unit directions
    cuts: Tensor  # (S + 1, rows or 1, columns or 1) distances of the segments' ends from the origins, meters
    signature: Hashable  # changes when the rays do

    @staticmethod
    def of(view: View, coarse: int, cuts: Tensor) -> RaySegments:
        """Camera rays through the centers of blocks of `coarse` x `coarse` pixels, with segments between the `cuts`."""
        columns, rows = (max(1, round(n / coarse)) for n in view.size)
        y, x = torch.meshgrid(torch.arange(rows) + 0.5, torch.arange(columns) + 0.5, indexing="ij")
        pixel = torch.stack((x * (view.size[0] / columns), y * (view.size[1] / rows))).flatten(1)
        start, toward = (part.view(3, rows, columns) for part in view.rays(pixel.to(view.position)))
        return RaySegments(start, toward, cuts, (view.signature(), float(cuts[-1])))

    @property
    def middles(self) -> Tensor:
        """Middles (3, S, rows, columns) of the segments."""
        return self.start[:, None] + self.toward[:, None] * ((self.cuts[1:] + self.cuts[:-1]) / 2)
