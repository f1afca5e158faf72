# SPDX-License-Identifier: Apache-2.0
"""Facts about a scene that words and plans need: names, structures such as walls, looks, what the camera sees, room for lights."""

import math
import weakref
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import torch
from torch import Tensor

from ..color import arrays
from ..color.floats import srgb_from_linear
from ..color.tensors import lab_from_srgb
from ..guidance import regions
from ..planning.glow import glowing, glows
from ..render.geometry.camera import view_of
from ..render.geometry.samples import pixel_centers
from ..render.geometry.visibility import RayGeometry
from ..render.lights.light_types import AreaLight, light_sources
from ..render.material.inputs import geometry_of
from ..render.proxy import Proxy, Render
from ..scene import SceneData, SceneMesh
from ..scene.data import Material
from ..scene.values import RenderValues
from ..schema import Values
from ..schema.parameters import Region
from ..words.types import LightDescription, MaterialLook, PictureStats, SceneDescription

_SIDE = 64  # rays along each side of the image
# z of normals: level surfaces have more, upright ones less (absolute), parts of a roof more
_LEVEL, _UPRIGHT, _SLOPED = 0.9, 0.25, 0.2
_FLAT = 0.15  # largest standard deviation of z over a roof
_MOST, _SOME = 0.75, 0.5  # share of a material's pixels that have to fit: for most structures; for some
_LEAST = 0.02  # least share of the image that a structure fills
_CLEAR = 2.0  # how many times larger than the second candidate a structure has to be
_ALONE = 0.9  # share of the level pixels around the subject above which the ground is also its support
_NEAR = 0.08  # share of the scene's height within which two heights count as one
_WALL = 0.4  # least size of one of several walls, relative to the largest
_TALL, _HIGH = 0.4, 0.6  # shares of the scene's height: least height of a wall; height at which roofs begin
_KEPT = 0.8  # share of the distance to the nearest surface up to which a light may grow


def described(*scenes: SceneData) -> SceneDescription:
    """Description of a scene, or of all its shots together, for words and plans, before any change."""
    objects: dict[str, Region] = {}
    materials: dict[str, Region] = {}
    worn: dict[str, list[str]] = {}
    lights: dict[str, LightDescription] = {}
    textures: dict[str, float] = {}  # mean luminance
    for scene in scenes:
        # Lights that the words have added are left out: the prompt is read as if they were not there.
        lights |= light_descriptions(scene, added=False)
        objects |= {o.name: "subject" if o.subject else "surroundings" for o in scene.objects}
        materials |= {m.name: "subject" if m.role == "subject" else "surroundings" for m in scene.materials}
        textured = [(m.name, m.texture.image) for m in scene.materials if m.texture is not None]
        textures |= {name: float(arrays.luminance(image).mean()) for name, image in textured}
        count = len(scene.materials)
        pairs = np.flatnonzero(np.bincount(scene.mesh.object * count + scene.mesh.material))
        for o, m in (divmod(pair, count) for pair in pairs.tolist()):
            names = worn.setdefault(scene.objects[o].name, [])
            names += [scene.materials[m].name] * (scene.materials[m].name not in names)
    first, rays, looks = scenes[0], _rays(scenes[0]), present_looks(scenes[0])
    dark = {name for name, look in looks.items() if not look.glows}  # emitters with a black color among them
    subjects = [name for name, region in objects.items() if region == "subject"]
    around = rays.count - sum(first.objects[o].subject for o in rays.object.tolist())
    return SceneDescription(
        subject=subjects[0] if len(subjects) == 1 else "",
        objects=objects,
        materials=materials,
        object_materials={name: tuple(worn.get(name, ())) for name in objects},
        lights=lights,
        glows=tuple(dict.fromkeys(n for scene in scenes for n in glowing(scene) if n not in dark)),
        looks=looks,
        # the sky is visible if the world fills 5 % of the surroundings
        sky=around > 0 and rays.count - len(rays.object) >= 0.05 * around,
        emitters={name: glow for scene in reversed(scenes) for name, glow in glows(scene).items()},
        camera_azimuth=first.value("camera/azimuth", (0.0,))[0],
        view=first.film.view,
        environment_luminance=mean_luminance(first.world.image),
        texture_luminance=textures,
    )


def described_now(
    known: SceneDescription, proxy: Proxy, values: dict[str, Values], picture: Render | None
) -> SceneDescription:
    """The `known` description of a scene, updated by current values, added lights, backdrop and the proxy's image."""
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
    """Name -> description of each light that the words have added to the scene, or of its own lights if not `added`."""
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
    """The world's share of the surroundings' pixels (None without surroundings); material -> share of its region's."""
    scene, geometry = proxy.scene, proxy.geometry
    cameras = {k: torch.tensor(v) for k, v in values.items() if k.startswith("camera/")}
    view = view_of(scene, RenderValues(scene, cameras, geometry.device), (_SIDE, _SIDE))

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
    """Key of a light's size -> size in meters at which the light nearly touches a surface, never below the present."""
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
        free = geometry.nearest(source.position[:, None].expand_as(arms), arms / length, "shadow").distance
        growth = max(float((_KEPT * free / length).min()), 1.0)
        widest[key] = min(widest.get(key, math.inf), growth * scene.value(key)[0])
    return widest


@dataclass(frozen=True)
class _Rays:
    """The n hits of a coarse grid of rays from the camera."""

    count: int  # number of all rays, hits or not
    material: np.ndarray  # (n,) number of the material that is hit
    object: np.ndarray  # (n,) number of the object
    height: np.ndarray  # (n,) z of the hit, meters
    slope: np.ndarray  # (n,) z of the unit normal that faces the camera


# Mesh in use -> folder of the last job with this mesh, and the rays of the job's camera
_met: weakref.WeakKeyDictionary[SceneMesh, tuple[Path, _Rays]] = weakref.WeakKeyDictionary()


def present_looks(scene: SceneData) -> dict[str, MaterialLook]:
    """Name of every material -> its look in the scene as exported."""
    rays = _rays(scene)
    structures, looks = _structures(scene, rays), {}
    for number, material in enumerate(scene.materials):
        on = rays.object[rays.material == number]
        worn = {scene.objects[o].name: float((on == o).sum()) / rays.count for o in np.unique(on).tolist()}
        glow = _glow(scene, material)
        looks[material.name] = MaterialLook(
            color=glow or _color(scene, material),
            glows=bool(glow),
            share=len(on) / rays.count,
            worn=worn,
            structures=frozenset(part for part, owners in structures.items() if number in owners),
        )
    return looks


def _rays(scene: SceneData) -> _Rays:
    """The hits of the camera's rays, traced once for each job folder: in a scene of trees this takes long."""
    mesh = scene.mesh
    job, rays = _met.get(mesh, (None, None))
    if rays is not None and job == scene.folder:
        return rays
    view = view_of(scene, RenderValues(scene, {}, "cpu"), (_SIDE, _SIDE)).detached()
    origin, toward = view.rays(pixel_centers(view.size))
    hits = geometry_of(scene, torch.device("cpu")).first_hits(origin, toward, "camera")
    met = hits.hit.numpy()
    triangle = hits.triangle.numpy()[met]
    height = (origin + toward * hits.distance).numpy()[2, met]
    corners = mesh.vertices[mesh.faces[triangle]].astype(float)
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True) + 1e-20
    away = np.sign((normal * toward.numpy().T[met]).sum(1))
    rays = _Rays(_SIDE**2, mesh.material[triangle], mesh.object[triangle], height, -away * normal[:, 2])
    _met[mesh] = scene.folder, rays
    return rays


def _glow(scene: SceneData, material: Material) -> Values | None:
    """The sRGB color with which a material's glow is displayed, clipped to 1; None if it does not glow."""
    strength = float(np.mean(scene.value(f"material/{material.name}/emission", 0.0)))
    emitted = scene.value(f"material/{material.name}/emission_color", (0.0, 0.0, 0.0))
    if computed := material.maps.get("emission_color"):
        emitted = tuple(computed.image[..., :3].reshape(-1, 3).mean(0).tolist())
    brightest = max(emitted)
    if strength * brightest < 0.05:  # too faint to be seen as a glow
        return None
    # Clipping makes a strong glow paler than its emission color; one above 4 looks no paler.
    clipped = max(min(strength * brightest, 4.0), 1.0) / brightest
    return srgb_from_linear([min(clipped * c, 1.0) for c in emitted])


def _color(scene: SceneData, material: Material) -> Values | None:
    """The base color of a material in sRGB, or the mean of its tinted texture; None if it is unknown."""
    if material.texture is not None:
        mean = material.texture.image[..., :3].reshape(-1, 3).mean(0)
        tint = scene.value(f"material/{material.name}/tint", (1.0, 1.0, 1.0))
        return srgb_from_linear([float(m * t) for m, t in zip(mean, tint, strict=True)])
    base = scene.value(f"material/{material.name}/base_color", ())
    return srgb_from_linear(base) if len(base) == 3 else None


def _structures(scene: SceneData, rays: _Rays) -> dict[str, list[int]]:
    """Structure, as "ground" -> [index of its material], if one is clearly the largest; "walls" -> several indices."""
    if not len(rays.height):
        return {}
    # The lowest 3 % and the highest 1 % do not count, as a hole in the ground.
    low, high = np.quantile(rays.height, (0.03, 0.99)).tolist()
    tall = max(high - low, 1e-6)
    mine = np.array([thing.subject for thing in scene.objects])[rays.object]
    stands = float(rays.height[mine].min()) if mine.any() and not mine.all() else low
    found: dict[str, dict[int, float]] = {}
    for number in np.unique(rays.material).tolist():
        own = rays.material == number
        share = float(own.sum()) / rays.count
        if share >= _LEAST:
            for part in _parts(rays.height[own], rays.slope[own], (low, tall, stands)):
                found.setdefault(part, {})[number] = share
    clear = {}
    for part, shares in found.items():
        best, *others = sorted(shares, key=lambda number: -shares[number])
        if not others or shares[best] >= _CLEAR * shares[others[0]]:
            clear[part] = [best]
    around = rays.material[(rays.slope > _LEVEL) & ~mine]
    if "ground" in clear and (around == clear["ground"]).sum() > _ALONE * len(around):
        clear.setdefault("support", clear["ground"])  # nothing else can be the "table" of a prompt
    shares = found.get("wall", {})
    walls = [number for number, share in shares.items() if share > _WALL * max(shares.values())]
    return {**clear, "walls": walls} if len(walls) > 1 else clear


def _parts(height: np.ndarray, slope: np.ndarray, scene: tuple[float, float, float]) -> Iterator[str]:
    """Structures that a material may be, by the `height` in meters and `slope` (z of the normal) of its n pixels."""
    low, tall, stands = scene  # lowest height, extent upward, and height that the subject stands on
    level = height[slope > _LEVEL]
    if len(level) > _MOST * len(height) and abs(np.median(level) - low) < _NEAR * tall:
        yield "ground"
    if len(level) > _SOME * len(height) and abs(np.median(level) - stands) < _NEAR * tall:
        yield "support"
    upright = height[np.abs(slope) < _UPRIGHT]
    if len(upright) > _MOST * len(height) and np.ptp(upright) > _TALL * tall:
        yield "wall"
    roof = (slope > _SLOPED) & (height > low + _HIGH * tall)
    flat = roof.any() and slope[roof].std() < _FLAT
    if flat and roof.sum() > _MOST * len(height) and np.quantile(height, 0.9) > low + 0.8 * tall:
        yield "roof"
    if (slope < -_LEVEL).sum() > _SOME * len(height) and np.median(height) > low + _HIGH * tall:
        yield "ceiling"
