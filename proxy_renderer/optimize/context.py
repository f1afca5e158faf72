# SPDX-License-Identifier: Apache-2.0
"""What the language side is told about the scene and its current picture."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import torch
from torch import Tensor

from ..color import arrays
from ..color.tensors import lab_from_srgb
from ..guidance import regions
from ..planning.lights.glow import glows
from ..planning.types import PictureStats, PlanContext
from ..render.geometry.camera import view_of
from ..scene import SceneData
from ..scene.values import RenderValues
from ..schema import Values
from ..schema.spec import Region
from . import headroom

if TYPE_CHECKING:
    from ..render.proxy import Proxy, Render

_GRID = 64  # rays along each side of the picture


def plan_context(proxy: Proxy, values: dict[str, Values], picture: Render) -> PlanContext:
    """What the planner knows: the scene, where its values are now, and what that looks like.

    Args:
        proxy: Of the shot that plans are made for.
        values: Current values by key in schema units.
        picture: The proxy's picture of them.
    """
    scene = proxy.scene
    world, materials = coverage(scene, *_look(proxy, values))
    textures = {m.name: m.texture.image for m in scene.materials if m.texture is not None}
    return PlanContext(
        camera_azimuth=values["camera/azimuth"][0] if "camera/azimuth" in values else 0.0,
        view=scene.film.view,
        light_types={light.name: light.type for light in scene.lights},
        glows=glows(scene),
        added_lights=tuple(light.name for light in scene.lights if light.added),
        light_stops={light.name: light.exposure for light in scene.lights if light.exposure},
        light_elevations=headroom.elevations(scene),
        world_share=world,
        material_share=materials,
        environment_luminance=_mean_luminance(scene.world.image),
        backdrop_luminance=_mean_luminance(
            scene.world.image if scene.world.backdrop is None else scene.world.backdrop
        ),
        texture_luminance={name: float(arrays.luminance(image).mean()) for name, image in textures.items()},
        values=values,
        picture=picture_stats(picture),
    )


def _mean_luminance(image: np.ndarray | None) -> float:
    """Mean luminance over the sphere of a linked environment; 0.5, which says nothing, without one."""
    return 0.5 if image is None else arrays.sphere_luminance(image)


def picture_stats(picture: Render) -> PictureStats:
    """Mean colors of the regions, and how the lightness of the whole picture is spread."""
    lab = lab_from_srgb(picture.display.detach()).cpu()
    mask = picture.mask.detach().cpu()
    means: dict[Region, Tensor] = {
        "subject": regions.mean(lab, mask),
        "surroundings": regions.mean(lab, 1.0 - mask),
    }
    spread = torch.quantile(lab[..., 0].flatten(), torch.tensor([0.05, 0.5, 0.95]))
    return PictureStats(
        lab={region: tuple(m.tolist()) for region, m in means.items()},
        percentiles=tuple(spread.tolist()),
    )


def _look(proxy: Proxy, values: dict[str, Values]) -> tuple[Tensor, Tensor]:
    """What a coarse grid of rays meets.

    Returns:
        (rays,) index of the material, -1 for the world, and whether it is on the subject.
    """
    scene, geometry = proxy.scene, proxy.geometry
    cameras = {k: torch.tensor(v) for k, v in values.items() if k.startswith("camera/")}
    view = view_of(scene, RenderValues(scene, cameras, geometry.device), (_GRID, _GRID))
    y, x = torch.meshgrid(torch.arange(_GRID), torch.arange(_GRID), indexing="ij")
    hits = geometry.first_hits(
        *view.rays(torch.stack((x.flatten(), y.flatten())).to(geometry.device) + 0.5), "camera"
    )
    triangle, hit = hits.triangle.cpu().clamp_min(0), hits.hit.cpu()
    material = torch.where(hit, geometry.material.cpu()[triangle].long(), -1)
    subjects = torch.tensor([o.subject for o in scene.objects])
    return material, subjects[geometry.object.cpu()[triangle].long()] & hit


def coverage(scene: SceneData, material: Tensor, mine: Tensor) -> tuple[float | None, dict[str, float]]:
    """What the camera sees, of rays as in `_look`.

    Returns:
        The share of the surroundings that is the world (None if there are no surroundings), and the
        share of its region, subject or surroundings, that each material covers.

    Args:
        material: (rays,) index of the material that each ray meets, -1 for the world.
        mine: (rays,) whether it meets the subject.
    """
    around = int((~mine).sum())
    shares = {}
    for index, m in enumerate(scene.materials):
        region = mine if m.role == "subject" else ~mine
        shares[m.name] = float((region & (material == index)).sum()) / max(int(region.sum()), 1)
    return (float((material < 0).sum()) / around if around else None), shares
