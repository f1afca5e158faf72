# SPDX-License-Identifier: Apache-2.0
"""Where objects are in the picture, for words that pick one of several: "the left ball", "the big one"."""

from __future__ import annotations

import numpy as np
import torch

from ..planning.lights.glow import glowing
from ..prompt.types import LightWords, SceneWords
from ..render.geometry.camera import view_of
from ..scene import SceneData
from ..scene.data import Light
from ..scene.values import RenderValues
from ..schema.spec import Region
from .present_looks import present_looks, sees_sky

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


def scene_words(*scenes: SceneData) -> SceneWords:
    """The names in the scene, or in all shots of it, that a prompt may mean."""
    objects: dict[str, Region] = {}
    materials: dict[str, Region] = {}
    worn: dict[str, list[str]] = {}
    lights: dict[str, LightWords] = {}
    for scene in scenes:
        # lights that the words have added are no names that the prompt may mean: it is read as before they were there
        lights |= {light.name: _light_words(scene, light) for light in scene.lights if not light.added}
        objects |= {o.name: "subject" if o.subject else "surroundings" for o in scene.objects}
        materials |= {m.name: "subject" if m.role == "subject" else "surroundings" for m in scene.materials}
        pairs = np.unique(np.stack([scene.mesh.object, scene.mesh.material], 1), axis=0)
        for o, m in pairs.tolist():
            names = worn.setdefault(scene.objects[o].name, [])
            names += [scene.materials[m].name] * (scene.materials[m].name not in names)
    looks = present_looks(scenes[0]) if scenes else {}
    dark = {name for name, look in looks.items() if not look.glows}  # with a strength, but a black color
    subjects = [name for name, region in objects.items() if region == "subject"]
    return SceneWords(
        subject=subjects[0] if len(subjects) == 1 else "",
        objects=objects,
        materials=materials,
        object_materials={name: tuple(worn.get(name, ())) for name in objects},
        lights=lights,
        glows=tuple(dict.fromkeys(n for scene in scenes for n in glowing(scene) if n not in dark)),
        places=places(scenes[0]) if scenes else {},
        looks=looks,
        sky=not scenes or sees_sky(scenes[0]),
    )


def _light_words(scene: SceneData, light: Light) -> LightWords:
    orbit, camera = f"light/{light.name}/azimuth", "camera/azimuth"
    known = orbit in scene.instances and camera in scene.instances
    turn = scene.value(orbit)[0] - scene.value(camera)[0] if known else None
    return LightWords(light.type, light.role, turn)
