# SPDX-License-Identifier: Apache-2.0
"""Facts about a scene that plans need: its image, what the camera sees, and how much room its lights have."""

import math
from dataclasses import replace

import numpy as np
import torch
from torch import Tensor

from ..color import arrays
from ..color.tensors import lab_from_srgb
from ..guidance import regions
from ..render.geometry.camera import view_of
from ..render.geometry.samples import pixel_centers
from ..render.geometry.visibility import RayGeometry
from ..render.lights.light_types import AreaLight, light_sources
from ..render.proxy import Proxy, Render
from ..scene import SceneData
from ..scene.values import RenderValues
from ..schema import Values
from ..schema.parameters import Region
from ..words.types import LightDescription, PictureStats, SceneDescription

_GRID = 64  # rays along each side of the image
_KEPT = 0.8  # share of the distance to the nearest surface up to which a light may grow


def described_now(
    known: SceneDescription, proxy: Proxy, values: dict[str, Values], picture: Render | None
) -> SceneDescription:
    """The `known` description of a scene, updated to its current values, its added lights and backdrop, and the proxy's image."""
    scene, stats = proxy.scene, None
    world, materials = _coverage(proxy, values)
    backdrop = scene.world.image if scene.world.backdrop is None else scene.world.backdrop
    if picture is not None:
        lab, mask = lab_from_srgb(picture.display.detach()).cpu(), picture.mask.detach().cpu()
        masks: dict[Region, Tensor] = {"subject": mask, "surroundings": 1.0 - mask}
        means = {region: tuple(regions.mean(lab, where).tolist()) for region, where in masks.items()}
        spread = torch.quantile(lab[..., 0].flatten(), torch.tensor([0.05, 0.5, 0.95]))
        stats = PictureStats(lab=means, percentiles=tuple(spread.tolist()))
    return replace(
        known,
        added_lights=light_descriptions(scene, added=True),
        camera_azimuth=values["camera/azimuth"][0] if "camera/azimuth" in values else 0.0,
        world_share=world,
        material_share=materials,
        backdrop_luminance=mean_luminance(backdrop),
        values=values,
        picture=stats,
    )


def light_descriptions(scene: SceneData, added: bool) -> dict[str, LightDescription]:
    """Name -> description of the lights that the words have added to a scene, or else of its own lights."""
    found = {}
    for light in (light for light in scene.lights if light.added == added):
        orbit, camera = f"light/{light.name}/azimuth", "camera/azimuth"
        known = orbit in scene.instances and camera in scene.instances
        turn = scene.value(orbit)[0] - scene.value(camera)[0] if known else None
        found[light.name] = LightDescription(light.type, light.role, turn, stops=light.exposure)
    return found


def mean_luminance(image: np.ndarray | None) -> float:
    """Mean luminance over the sphere of an environment image; 0.5 as a neutral value without one."""
    return 0.5 if image is None else arrays.sphere_luminance(image)


def _coverage(proxy: Proxy, values: dict[str, Values]) -> tuple[float | None, dict[str, float]]:
    """Shares of the camera's view: the world's of the surroundings (None if there are none), and each material's of its region."""
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


@torch.no_grad()
def light_sizes(scene: SceneData, geometry: RayGeometry) -> dict[str, float]:
    """Key of a light's size -> the size in meters at which the light nearly touches a surface; at least its present size."""
    widest: dict[str, float] = {}
    for source in light_sources(scene, RenderValues(scene, {}, geometry.device)):
        key = f"light/{source.light.name}/size"
        if source.at_infinity or key not in scene.instances:
            continue
        # (3, n) from the middle of the light to points of its outline, in meters
        if isinstance(source, AreaLight):
            u, v = source.half_axes()
            half = torch.cat((u, v, u + v, u - v), 1)
        else:
            half = torch.eye(3, device=source.position.device) * source.size
        arms = torch.cat((half, -half), 1)
        length = arms.norm(dim=0)
        origin = source.position[:, None].expand_as(arms)
        free = geometry.nearest(origin, arms / length, "shadow").distance
        growth = max(float((_KEPT * free / length).min()), 1.0)
        widest[key] = min(widest.get(key, math.inf), growth * scene.value(key)[0])
    return widest
