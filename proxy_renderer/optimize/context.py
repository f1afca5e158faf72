# SPDX-License-Identifier: Apache-2.0
"""What the language side is told about the scene and its current picture."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import torch
from torch import Tensor

from ..color import arrays
from ..color.tensors import lab_from_srgb
from ..guidance import regions
from ..guidance.encoder import Encoder
from ..planning.glow import glowing, glows
from ..prompt.types import LightDescription, PictureStats, SceneDescription
from ..render.geometry.camera import view_of
from ..scene import SceneData
from ..scene.values import RenderValues
from ..schema import Values
from ..schema.messages import Options
from ..schema.spec import Region
from . import headroom
from .places import places
from .present_looks import present_looks, sees_sky

if TYPE_CHECKING:
    from ..render.proxy import Proxy, Render

_GRID = 64  # rays along each side of the picture
_LARGEST, _LEAST = 256, 192
"""Greatest longer side of the pictures inside the loop, in pixels, and the least however small the encoder's are."""
_OF_A_PICTURE = 128  # the same where a picture says what is wanted: nothing so fine is read off it


def described(*scenes: SceneData) -> SceneDescription:
    """The scene, or all shots of it, as words and plans know it before any change."""
    objects: dict[str, Region] = {}
    materials: dict[str, Region] = {}
    worn: dict[str, list[str]] = {}
    lights: dict[str, LightDescription] = {}
    for scene in scenes:
        # lights that the words have added are no names that the prompt may mean: it is read as before they were there
        lights |= _lights(scene, added=False)
        objects |= {o.name: "subject" if o.subject else "surroundings" for o in scene.objects}
        materials |= {m.name: "subject" if m.role == "subject" else "surroundings" for m in scene.materials}
        pairs = np.unique(np.stack([scene.mesh.object, scene.mesh.material], 1), axis=0)
        for o, m in pairs.tolist():
            names = worn.setdefault(scene.objects[o].name, [])
            names += [scene.materials[m].name] * (scene.materials[m].name not in names)
    looks = present_looks(scenes[0]) if scenes else {}
    dark = {name for name, look in looks.items() if not look.glows}  # with a strength, but a black color
    subjects = [name for name, region in objects.items() if region == "subject"]
    return SceneDescription(
        subject=subjects[0] if len(subjects) == 1 else "",
        objects=objects,
        materials=materials,
        object_materials={name: tuple(worn.get(name, ())) for name in objects},
        lights=lights,
        glows=tuple(dict.fromkeys(n for scene in scenes for n in glowing(scene) if n not in dark)),
        places=places(scenes[0]) if scenes else {},
        looks=looks,
        sky=not scenes or sees_sky(scenes[0]),
        emitters={name: glow for scene in reversed(scenes) for name, glow in glows(scene).items()},
        camera_azimuth=scenes[0].value("camera/azimuth", (0.0,))[0] if scenes else 0.0,
        view=scenes[0].film.view if scenes else "AgX",
        environment_luminance=_mean_luminance(scenes[0].world.image if scenes else None),
        texture_luminance={
            m.name: float(arrays.luminance(m.texture.image).mean())
            for scene in scenes
            for m in scene.materials
            if m.texture is not None
        },
    )


def described_now(
    known: SceneDescription, proxy: Proxy, values: dict[str, Values], picture: Render
) -> SceneDescription:
    """A scene with its current values, what they look like, and the lights and the backdrop that it got.

    Args:
        proxy: Of the shot that plans are made for.
        values: Current values by key in schema units.
        picture: The proxy's picture of them.
    """
    scene = proxy.scene
    world, materials = coverage(scene, *_look(proxy, values))
    backdrop = scene.world.image if scene.world.backdrop is None else scene.world.backdrop
    return replace(
        known,
        added_lights=_lights(scene, added=True),
        camera_azimuth=values["camera/azimuth"][0] if "camera/azimuth" in values else 0.0,
        world_share=world,
        material_share=materials,
        backdrop_luminance=_mean_luminance(backdrop),
        values=values,
        picture=picture_stats(picture),
    )


def _lights(scene: SceneData, added: bool) -> dict[str, LightDescription]:
    """The lights of a scene that the words have added, or its own."""
    lights = [light for light in scene.lights if light.added == added]
    limits = headroom.elevations(scene) if lights else {}
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


def picture_size(resolution: tuple[int, int], longest: int) -> tuple[int, int]:
    """Width and height of the artist's picture, scaled so that the longer side has this many pixels.

    Args:
        resolution: The artist's width and height, pixels.
        longest: Of the result's sides, pixels.
    """
    factor = longest / max(resolution)
    width, height = (max(round(n * factor), 1) for n in resolution)
    return width, height


def inner_size(scene: SceneData, options: Options, encoder: Encoder) -> tuple[int, int]:
    """Width and height of the pictures inside the loop; the prediction has the full size.

    Crops are at least three quarters of the picture, so one and a half times what the encoder looks at is enough;
    but highlights and shadows have to be there, however little it looks at.

    Args:
        options: `size` is the most that the artist wants.
        encoder: `size` is what it looks at.
    """
    enough = max(_LEAST, encoder.size * 3 // 2) if not options.like else _OF_A_PICTURE
    return picture_size(scene.resolution, min(options.size, _LARGEST, enough))
