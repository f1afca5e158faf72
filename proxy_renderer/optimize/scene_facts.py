# SPDX-License-Identifier: Apache-2.0
"""Facts of a scene that plans need: what it looks like, what the camera sees of it, and how much room its lights have."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import product

import numpy as np
import torch
from torch import Tensor

from ..color import arrays
from ..color.tensors import lab_from_srgb
from ..guidance import regions
from ..planning.ranges import clip
from ..planning.types import PlanEntry
from ..render.geometry.camera import view_of
from ..render.geometry.samples import pixel_centers
from ..render.geometry.visibility import Hits, RayGeometry
from ..render.lights.light_source import LightSource
from ..render.lights.light_types import LIGHT_TYPES, AreaLight, light_sources
from ..render.proxy import Proxy, Render
from ..scene import Light, SceneData
from ..scene.values import RenderValues
from ..schema import Instance, Values, orbit
from ..schema.parameters import Region
from ..words.types import LightDescription, PictureStats, SceneDescription

_GRID = 64  # rays along each side of the picture
_KEPT = 0.8  # share of the way to a floor, a ceiling or a wall that a light may go: it has a size
_WALL = "a wall stands where the words want the lamp"
_PLACE = ("azimuth", "elevation", "distance", "power")
_NEAREST = 0.3  # share of its distance to the subject that a light keeps at least, see `schema.parameters`
_PARTS = 16  # surfaces of the subject that a ray from its middle passes, at most
_FLAT = 1e-12  # twice the area, seen from above, below which a triangle is a wall


def described_now(
    known: SceneDescription, proxy: Proxy, values: dict[str, Values], picture: Render | None
) -> SceneDescription:
    """A scene with its current values by key in schema units, the lights and the backdrop that it got, and the proxy's image of them."""
    scene = proxy.scene
    world, materials = _coverage(proxy, values)
    backdrop = scene.world.image if scene.world.backdrop is None else scene.world.backdrop
    return replace(
        known,
        added_lights=light_descriptions(scene, added=True),
        camera_azimuth=values["camera/azimuth"][0] if "camera/azimuth" in values else 0.0,
        world_share=world,
        material_share=materials,
        backdrop_luminance=mean_luminance(backdrop),
        values=values,
        picture=None if picture is None else _picture_stats(picture),
    )


def light_descriptions(scene: SceneData, added: bool) -> dict[str, LightDescription]:
    """The lights of a scene that the words have added, or its own."""
    lights = [light for light in scene.lights if light.added == added]
    limits = light_elevations(scene) if lights else {}
    found = {}
    for light in lights:
        orbit, camera = f"light/{light.name}/azimuth", "camera/azimuth"
        known = orbit in scene.instances and camera in scene.instances
        turn = scene.value(orbit)[0] - scene.value(camera)[0] if known else None
        ends = limits.get(light.name, (-90.0, 90.0))
        found[light.name] = LightDescription(
            light.type, light.role, turn, stops=light.exposure, elevations=ends
        )
    return found


def mean_luminance(image: np.ndarray | None) -> float:
    """Mean luminance over the sphere of a linked environment; 0.5, which says nothing, without one."""
    return 0.5 if image is None else arrays.sphere_luminance(image)


def _picture_stats(picture: Render) -> PictureStats:
    lab, mask = lab_from_srgb(picture.display.detach()).cpu(), picture.mask.detach().cpu()
    means: dict[Region, Tensor] = {
        "subject": regions.mean(lab, mask),
        "surroundings": regions.mean(lab, 1.0 - mask),
    }
    spread = torch.quantile(lab[..., 0].flatten(), torch.tensor([0.05, 0.5, 0.95]))
    return PictureStats(
        lab={region: tuple(m.tolist()) for region, m in means.items()}, percentiles=tuple(spread.tolist())
    )


def _coverage(proxy: Proxy, values: dict[str, Values]) -> tuple[float | None, dict[str, float]]:
    """The world's share of the surroundings (None if there are none), and each material's share of its region, as the camera sees them."""
    scene, geometry = proxy.scene, proxy.geometry
    cameras = {k: torch.tensor(v) for k, v in values.items() if k.startswith("camera/")}
    view = view_of(scene, RenderValues(scene, cameras, geometry.device), (_GRID, _GRID))

    # Materials and subjects that a coarse grid of rays meets
    hits = geometry.first_hits(*view.rays(pixel_centers(view.size).to(geometry.device)), "camera")
    triangle, hit = hits.triangle.cpu().clamp_min(0), hits.hit.cpu()
    material = torch.where(hit, geometry.material.cpu()[triangle].long(), -1)
    subjects = torch.tensor([o.subject for o in scene.objects])
    subject = subjects[geometry.object.cpu()[triangle].long()] & hit

    around, shares = int((~subject).sum()), {}
    for index, m in enumerate(scene.materials):
        region = subject if m.role == "subject" else ~subject
        shares[m.name] = float((region & (material == index)).sum()) / max(int(region.sum()), 1)
    return (float((material < 0).sum()) / around if around else None), shares


def light_elevations(scene: SceneData) -> dict[str, tuple[float, float]]:
    """Light -> lowest and highest elevation in degrees; none for a light that is beyond already, which the artist has placed."""
    below, above = _heights(scene)
    ranges = {}
    for light in (light for light in scene.lights if not light.fixed):
        limits = _limits(light, scene.pivot, below, above)
        if limits != (-90.0, 90.0):
            ranges[light.name] = limits
    return ranges


@torch.no_grad()
def light_sizes(scene: SceneData, geometry: RayGeometry) -> dict[str, float]:
    """Key of a light's size -> the size in meters at which it meets a surface where it stands; no less than it has."""
    widest: dict[str, float] = {}
    for source in light_sources(scene, RenderValues(scene, {}, geometry.device)):
        key = f"light/{source.light.name}/size"
        if source.at_infinity or key not in scene.instances:
            continue
        arms = _arms(source)
        length = arms.norm(dim=0)
        origin = source.position[:, None].expand_as(arms)
        free = geometry.nearest(origin, arms / length, "shadow").distance
        growth = max(float((_KEPT * free / length).min()), 1.0)
        widest[key] = min(widest.get(key, math.inf), growth * scene.value(key)[0])
    return widest


def nearer_lights(
    scene: SceneData, geometry: RayGeometry, plan: Mapping[str, PlanEntry]
) -> dict[str, PlanEntry]:
    """Other entries for lights that a wall would hide where words want them: nearer and weaker, or without room as they stand."""
    found: dict[str, PlanEntry] = {}
    for light in (light for light in scene.lights if not light.fixed):
        azimuth, elevation, distance, power = keys = [f"light/{light.name}/{name}" for name in _PLACE]
        if not plan.keys() >= {*keys} or not plan[azimuth].is_named:
            continue
        turn, tilt, off = (scene.value(key)[0] for key in keys[:3])
        turns, tilts = _ends(plan[azimuth], turn), _ends(plan[elevation], tilt)
        asked = [*product(turns, tilts), (sum(turns) / 2, sum(tilts) / 2)]
        here, *there = _free(scene, geometry, [(turn, tilt), *asked])
        share = min(there) / off
        if here <= _KEPT * off or share >= 1.0:
            continue
        if share < _NEAREST or scene.instances[distance].locked:
            found |= {azimuth: _held(turn, _WALL), elevation: _held(tilt, _WALL)}
            continue
        found[distance] = _held(share * off, f"nearer: {_WALL}")
        if not scene.instances[power].locked:
            found[power] = _dimmed(plan[power], scene.instances[power], share**2)
    return found


def _ends(entry: PlanEntry, artist: float) -> tuple[float, float]:
    """The range that words name; twice the artist's value where they name none."""
    return (entry.lower[0], entry.upper[0]) if entry.is_named else (artist, artist)


def _held(value: float, reason: str) -> PlanEntry:
    return PlanEntry((value,), (value,), None, reason)


def _dimmed(entry: PlanEntry, power: Instance, share: float) -> PlanEntry:
    """A range of powers, times a share; of a power that no word touches, that share of the artist's."""
    was = _held(power.value[0], f"dimmer, for it comes nearer: {_WALL}") if entry.priority is None else entry
    lower, upper = clip((share * was.lower[0],), (share * was.upper[0],), power)
    return replace(was, lower=lower, upper=upper)


def _free(scene: SceneData, geometry: RayGeometry, angles: Sequence[tuple[float, float]]) -> list[float]:
    """Meters in each direction (azimuth, elevation) up to which a light lights the subject: infinite in the open, 0 in a wall."""
    toward = torch.tensor([orbit.direction(*each) for each in angles], device=geometry.device).T
    origin = torch.tensor(scene.pivot, device=geometry.device)[:, None].expand_as(toward)
    mine = torch.tensor([o.subject for o in scene.objects], device=geometry.device)[geometry.object]
    hits = geometry.nearest(origin, toward, "shadow")
    skin = torch.zeros_like(hits.distance)
    for _ in range(_PARTS):
        own = hits.hit & mine[hits.triangle]
        if not own.any():
            break
        skin = torch.where(own, hits.distance, skin)
        further = geometry.onward(hits, origin, toward, "shadow").parts
        hits = Hits(*(torch.where(own, new, old) for new, old in zip(further, hits.parts, strict=True)))
    free = _KEPT * hits.distance
    return torch.where(free > skin, free, 0.0).tolist()


def _arms(source: LightSource) -> Tensor:
    """(3, n) from the middle of a light to its outline."""
    if isinstance(source, AreaLight):
        u, v = source.half_axes()
        half = torch.cat((u, v, u + v, u - v), 1)
    else:
        half = torch.eye(3, device=source.position.device) * source.size
    return torch.cat((half, -half), 1)


def _limits(
    light: Light, pivot: tuple[float, float, float], below: float, above: float
) -> tuple[float, float]:
    offset = np.subtract(light.position, pivot)
    distance = float(np.linalg.norm(offset))
    if LIGHT_TYPES[light.type].at_infinity:
        return (0.0 if math.isfinite(below) else -90.0), 90.0
    if distance == 0:
        return -90.0, 90.0
    low, high = (math.degrees(math.asin(min(_KEPT * h / distance, 1.0))) for h in (below, above))
    return -low if -below < offset[2] else -90.0, high if offset[2] < above else 90.0


_ALL_SIDES = 0b11110000


def _heights(scene: SceneData) -> tuple[float, float]:
    """Distances from the pivot straight down and up to the surroundings; infinite where there are none."""
    mesh, pivot = scene.mesh, np.array(scene.pivot)
    # Triangles that may lie above or below it: some of their corners are on either side, along both axes
    side = mesh.vertices[:, :2] <= pivot[:2].astype(np.float32)
    sides = np.packbits(np.concatenate([side, ~side], 1), axis=1)[:, 0]
    a, b, c = sides[mesh.faces].T
    around = ~np.array([o.subject for o in scene.objects])[mesh.object] & (a | b | c == _ALL_SIDES)
    corners = mesh.vertices[mesh.faces[around]].astype(float) - pivot
    a, b, c = corners[:, :, :2].transpose(1, 0, 2)
    areas = np.stack([_cross(b, c), _cross(c, a), _cross(a, b)], 1)
    total = areas.sum(1, keepdims=True)
    hit = (np.abs(total[:, 0]) > _FLAT) & ((areas * np.sign(total)).min(1) >= 0)
    heights = (areas[hit] / total[hit] * corners[hit, :, 2]).sum(1)
    below, above = -heights[heights < 0], heights[heights > 0]
    return float(below.min(initial=math.inf)), float(above.min(initial=math.inf))


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Twice the signed area of triangles (0, a, b) in the plane."""
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
