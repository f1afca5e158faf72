# SPDX-License-Identifier: Apache-2.0
"""The light that emitting surfaces give to the subject."""

import math

import numpy as np

from ..scene import SceneData
from ..words.types import Glow


def glowing(scene: SceneData) -> list[str]:
    """Names of the materials that emit light, in the order of the scene's materials."""
    lit = {i.owner for i in scene.instances.values() if i.parameter.name == "emission" and i.value[0] > 0}
    return [material.name for material in scene.materials if material.name in lit]


def glows(scene: SceneData) -> dict[str, Glow]:
    """Material -> the light that it gives to a white surface at the subject, for each emitting material that has faces.

    The light is the sum of area x |cosine| / (pi d^2) over the material's triangles, 1 at most. The distance d is at
    least half the subject's height. Occlusion is ignored.
    """
    mesh, pivot = scene.mesh, np.array(scene.pivot)
    names = glowing(scene)
    near = (0.5 * float(scene.references.get("subject_height", 0.0))) ** 2
    found: dict[str, Glow] = {}
    for number, material in enumerate(scene.materials):
        faces = np.flatnonzero(mesh.material == number)
        if material.name not in names or not len(faces):
            continue
        objects = {scene.objects[o].name for o in np.flatnonzero(np.bincount(mesh.object[faces])).tolist()}
        # Of very many triangles every `step`-th stands for `step` of them.
        step = max(len(faces) // 50_000, 1)
        corners = mesh.vertices[mesh.faces[faces[::step]]].astype(float)
        # The length of a normal is the area that its triangle stands for.
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) * (step / 2.0)
        way = corners.mean(1) - pivot
        square = np.maximum((way**2).sum(1), max(near, 1e-12))
        light = np.abs((normal * way).sum(1)) / (math.pi * square**1.5)
        x, y, _ = (way * light[:, None]).sum(0)
        computed = material.maps.get("emission_color")
        color = computed.image.reshape(-1, 3).mean(0).tolist() if computed else (1.0, 1.0, 1.0)
        levels = material.maps.get("emission")
        strength = float(levels.image[..., 0].mean()) if levels else 1.0
        azimuth = math.degrees(math.atan2(x, -y))
        total = min(float(light.sum()), 1.0)  # a glow all around gives a white surface its own radiance
        found[material.name] = Glow(total, azimuth, tuple(sorted(objects)), tuple(color), strength)
    return found
