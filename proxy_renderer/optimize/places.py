# SPDX-License-Identifier: Apache-2.0
"""Where objects are in the picture, for words that pick one of several: "the left ball", "the big one"."""

from __future__ import annotations

import numpy as np
import torch

from ..render.geometry.camera import view_of
from ..scene import SceneData
from ..scene.values import RenderValues

_SIDE = 100  # pixels of the square picture that places are measured in
Place = tuple[float, float, float]


def places(scene: SceneData) -> dict[str, Place]:
    """Of each object before the camera: x (-1 left, 1 right), y (0 near, 1 far), and its share of the picture's width.

    Args:
        scene: With the artist's values. An object that reaches behind the camera, such as a floor, has no place.
    """
    view = view_of(scene, RenderValues(scene, {}, "cpu"), (_SIDE, _SIDE))
    mesh, seen = scene.mesh, {}
    corners = torch.from_numpy(mesh.vertices.astype(np.float32)).T
    depth = -(view.rotation.T @ (corners - view.position[:, None]))[2].detach().numpy()
    across = view.project(corners)[0].detach().numpy() / _SIDE
    order = np.argsort(mesh.object, kind="stable")
    ends = np.searchsorted(mesh.object[order], np.arange(len(scene.objects) + 1))
    for number, thing in enumerate(scene.objects):
        own = np.unique(mesh.faces[order[ends[number] : ends[number + 1]]])
        if len(own) and depth[own].min() > view.clip[0]:
            low, high = across[own].min(), across[own].max()
            seen[thing.name] = (float(low + high - 1.0), float(depth[own].mean()), float(high - low))
    far = max((place[1] for place in seen.values()), default=1.0)
    return {name: (x, y / far, width) for name, (x, y, width) in seen.items()}
