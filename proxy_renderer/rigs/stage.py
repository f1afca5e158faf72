# SPDX-License-Identifier: Apache-2.0
"""The stage: points of the subject and its surroundings that the camera sees, and the light from a place that reaches them."""

import itertools
import math
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import torch
from torch import Tensor

from ..color import arrays
from ..color.floats import luminance
from ..render.geometry.camera import view_of
from ..render.geometry.samples import pixel_centers
from ..render.geometry.visibility import RayGeometry
from ..scene import Material, SceneData
from ..scene.values import RenderValues
from ..schema import orbit
from ..words.names import plain_name

_GRID = 40  # rays along each side of the picture
_MOST = 400  # most points of the subject, and of its surroundings, at which light is measured


@dataclass(frozen=True)
class Points:
    """Places on surfaces that the camera sees."""

    position: Tensor  # (3, N), world space, just above the surface
    normal: Tensor  # (3, N), towards the camera
    albedo: Tensor  # (N,), the mean of a texture
    mirrored: Tensor  # (3, N), unit directions of the camera's rays after a reflection
    polished: Tensor  # (N,) bool, level and smooth surfaces, which mirror as water does

    def __len__(self) -> int:
        return self.position.shape[1]


class LightStage:
    """Surfaces that the camera of one shot sees, and the light that gets to them."""

    def __init__(self, scene: SceneData, geometry: RayGeometry) -> None:
        self.scene, self.geometry = scene, geometry
        self.pivot = torch.tensor(scene.pivot, dtype=torch.float32)
        points, mine = _seen(scene, geometry)
        # points of the subject, and of the rest; all points for one of these that has hardly any
        parts = (part if int(part.sum()) >= 8 else torch.ones_like(part) for part in (mine, ~mine))
        chosen = (part.nonzero()[:, 0] for part in parts)
        some = [x if len(x) <= _MOST else x[torch.linspace(0, len(x) - 1, _MOST).long()] for x in chosen]
        self.subject, self.around = (Points(*(v[..., x].contiguous() for v in vars(points).values())) for x in some)
        if len(self.subject):
            self.middle = self.subject.position.median(1).values  # (3,) of the subject
            away = (self.subject.position - self.middle[:, None]).norm(dim=0)
            radius = float(torch.quantile(away, 0.85))
        else:
            self.middle, radius = self.pivot, 0.0
        view = float(scene.references.get("view_distance", 1.0))
        self.radius = max(radius, 0.02 * view)  # of the subject, meters
        self.front = scene.value("camera/azimuth")[0]  # azimuth of the camera, degrees, as in `schema.orbit`

    def place(self, azimuth: float, elevation: float, radii: float) -> Tensor:
        """Place (3,) at a distance in subject radii, an azimuth from the camera and an elevation, both in degrees."""
        return self.middle + radii * self.radius * self._toward(azimuth, elevation)

    def _toward(self, azimuth: float, elevation: float) -> Tensor:
        return torch.tensor(orbit.direction(self.front + azimuth, elevation), dtype=torch.float32)

    def orbit_of(self, place: Tensor) -> tuple[float, float, float]:
        """Azimuth, elevation (degrees) and distance (meters) of a place, as a light's parameters have them."""
        offset = (place - self.pivot).tolist()
        azimuth, elevation = orbit.angles(offset)
        return azimuth, max(min(elevation, 88.0), -88.0), max(math.dist(offset, (0, 0, 0)), 1e-3)

    def reached(self, points: Points, place: Tensor) -> Tensor:
        """Share (N,) of light from a place (3,) that reaches points: what nothing blocks, times the cosine there."""
        offset = place[:, None] - points.position
        distance = offset.norm(dim=0).clamp_min(1e-6)
        return self.lit(points, offset / distance, distance)

    def mirrors(self, place: Tensor, size: float) -> float:
        """Share of the visible points that mirror, for the camera, a light of a diameter (meters) at a place (3,)."""
        count, shown = 0, 0
        for points in (self.subject, self.around):
            offset = place[:, None] - points.position
            along = (offset * points.mirrored).sum(0)
            beside = (offset - along * points.mirrored).norm(dim=0)
            shown += int((points.polished & (along > 0.0) & (beside < size / 2.0)).sum())
            count += len(points)
        return shown / max(count, 1)

    def sunlit(self, points: Points, azimuth: float, elevation: float) -> Tensor:
        """Share (N,) as in `reached`, but for a sun at an azimuth from the camera and an elevation, in degrees."""
        toward = self._toward(azimuth, elevation)[:, None].expand_as(points.position).contiguous()
        return self.lit(points, toward, torch.full((len(points),), 1e30))

    @cached_property
    def openness(self) -> float:
        """Share of the sky's light that reaches the visible points: 1 on a plain, 0 in a closed room."""
        clear, all_of_it = 0.0, 0.0
        sky = itertools.product((self.subject, self.around), range(-180, 180, 45), (14.0, 32.0, 60.0))
        for points, azimuth, elevation in sky:
            facing = (points.normal * self._toward(azimuth, elevation)[:, None]).sum(0).clamp_min(0.0)
            clear += float(self.sunlit(points, azimuth, elevation).sum())
            all_of_it += float(facing.sum())
        return clear / max(all_of_it, 1e-6)

    def lit(self, points: Points, toward: Tensor, distance: Tensor) -> Tensor:
        """Share (N,) as in `clear`, times the cosine at the surface."""
        return self.clear(points, toward, distance) * (points.normal * toward).sum(0).clamp_min(0.0)

    def clear(self, points: Points, toward: Tensor, distance: Tensor) -> Tensor:
        """Share (N,) of light that is not blocked on its way to points, from directions (3, N) over distances (N,)."""
        device = self.geometry.device
        return self.geometry.clear(points.position.to(device), toward.to(device), distance.to(device)).cpu()

    @cached_property
    def things(self) -> list[tuple[frozenset[str], Tensor, float]]:
        """For each object: the words of its name, the middle (3,) of its box, and half the box's diagonal."""
        mesh, found = self.scene.mesh, []
        order = np.argsort(mesh.object, kind="stable")
        ends = np.bincount(mesh.object, minlength=len(self.scene.objects)).cumsum()[:-1]
        for thing, mine in zip(self.scene.objects, np.split(order, ends), strict=True):
            if len(faces := mesh.faces[mine]):
                words = frozenset(word.removesuffix("s") for word in plain_name(thing.name).split())
                found.append((words, *_box(mesh.vertices[faces.ravel()])))
        return found

    def parts_of(self, materials: Collection[str]) -> Iterator[tuple[Tensor, float]]:
        """For each object with one of the materials: middle (3,) and half diagonal of the box around their faces."""
        mesh = self.scene.mesh
        numbers = [n for n, material in enumerate(self.scene.materials) if material.name in materials]
        wearing = np.isin(mesh.material, numbers).nonzero()[0]
        owner = mesh.object[wearing]
        for thing in np.flatnonzero(np.bincount(owner)):
            yield _box(mesh.vertices[mesh.faces[wearing[owner == thing]].ravel()])


def _box(corners: np.ndarray) -> tuple[Tensor, float]:
    """The middle (3,) of the box around points (N, 3), and half its diagonal."""
    low, high = corners.min(0), corners.max(0)
    return torch.from_numpy((low + high) / 2).float(), float(np.linalg.norm(high - low)) / 2


def _seen(scene: SceneData, geometry: RayGeometry) -> tuple[Points, Tensor]:
    """Points that a grid of camera rays meets, and (N,) bool: those of the subject."""
    device = geometry.device
    view = view_of(scene, RenderValues(scene, {}, device), (_GRID, _GRID))
    origin, toward = view.rays(pixel_centers(view.size).to(device))
    hits = geometry.first_hits(origin, toward, "camera")
    kept = hits.hit
    surface = geometry.surface(hits.pick(kept), toward[:, kept])
    subjects = torch.tensor([o.subject for o in scene.objects], device=device)
    material = surface.material.cpu()
    albedo = torch.tensor([_albedo(scene, each) for each in scene.materials])
    rough = torch.tensor([scene.value(f"material/{each.name}/roughness", (1.0,))[0] for each in scene.materials])
    normal, seen = surface.normal.cpu(), toward[:, kept].cpu()
    mirrored = seen - 2.0 * (seen * normal).sum(0) * normal
    polished = (rough < 0.25)[material] & (normal[2] > 0.95)
    points = Points(geometry.lifted(surface).cpu(), normal, albedo[material], mirrored, polished)
    return points, subjects[surface.object].cpu()


def _albedo(scene: SceneData, material: Material) -> float:
    key = f"material/{material.name}/"
    if material.texture is not None:
        tint = luminance(scene.value(key + "tint", (1.0, 1.0, 1.0)))
        return float(arrays.luminance(material.texture.image[..., :3]).mean()) * tint
    return luminance(scene.value(key + "base_color", (0.5, 0.5, 0.5)))
