# SPDX-License-Identifier: Apache-2.0
"""The G-buffer: what the camera sees in every pixel, whoever rendered the picture."""

from dataclasses import dataclass

import torch
from torch import Tensor

from ..scene import SceneData
from .geometry.camera import View
from .geometry.samples import pixel_centers
from .geometry.visibility import RayGeometry
from .surface.view_cache import ViewCache


@dataclass(frozen=True)
class GBuffer:
    """Surfaces that the camera sees."""

    subject: Tensor  # (H, W) share of each pixel that the subject covers
    material: Tensor  # (H, W) int64, number of the material in the pixel's middle; -1 for the world
    materials: tuple[str, ...]  # names of the materials by number
    normal: Tensor  # (H, W, 3) unit normals, x to the right, y up, z towards the camera; zero for the world
    transmittance: Tensor  # (H, W) share of light that fog lets through from what is seen
    pattern: Tensor  # (H, W) luminance of textured base colors relative to their material's mean; else 1
    # names of the materials of the surroundings, which the subject may wear too: words for it do not paint
    # them
    surrounding: tuple[str, ...] = ()
    # (H, W, 3) a gray surface in the place of what is seen, as shown: its color is that of the light; black for the
    # world; None where that is not known
    gray: Tensor | None = None


def gbuffer_of(
    scene: SceneData, geometry: RayGeometry, view: View, cache: ViewCache, transmittance: Tensor, gray: Tensor
) -> GBuffer:
    """The G-buffer of a traced view, with the transmittance (H, W) of the fog before what is seen, and gray (H, W, 3) there."""
    hits, shape = cache.samples.center_hits, cache.depth.shape
    with torch.no_grad():
        still = view.detached()
        _, toward = still.rays(pixel_centers(view.size).to(geometry.device))
        surface = geometry.surface(hits, toward)
        normal = torch.where(hits.hit, still.rotation.T @ surface.normal, 0.0)
        material = torch.where(hits.hit, surface.material, -1)
    return GBuffer(
        subject=cache.mask,
        material=material.view(shape),
        materials=tuple(m.name for m in scene.materials),
        normal=normal.T.reshape(*shape, 3),
        transmittance=transmittance,
        pattern=cache.pattern(),
        gray=gray,
        surrounding=tuple(m.name for m in scene.materials if m.role != "subject"),
    )
