# SPDX-License-Identifier: Apache-2.0
"""Traces views of shapes once, so that training shades them again and again under other looks.

A view holds everything that does not depend on the look: per pixel what is seen, its normal, distance,
ambient occlusion, shadows of five light sides, each as a hard and as a soft light, and whether the
mirror ray meets the subject itself.
"""

import os
import shutil
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene
from scipy.ndimage import uniform_filter

from lab.heads.attributes import ATTRIBUTES
from lab.train.pictures.shapes import Random, shape
from lab.train.pictures.surfaces import Shape, grid
from proxy_renderer.schema.orbit import direction, frame

VOID, SUBJECT, STAGE = 0, 1, 2
FAR = 8.0
"""Distance at which nothing is seen, in camera distances."""
SIDES = {
    "left": (-72, 22, 28, 14),
    "front": (0, 18, 32, 15),
    "right": (72, 22, 28, 14),
    "back": (180, 30, 30, 15),
    "top": (0, 180, 78, 8),
}
"""Light side → azimuth ± spread, elevation ± spread, in degrees relative to the camera."""
SOFT_CONE = np.radians(24.0)
_SOFT_RAYS, _AO_RAYS = 10, 10
_TRIES, _ENOUGH = 4, 0.06
_OFFSET = 2e-3


def fields(size: int) -> dict[str, tuple[tuple[int, ...], str]]:
    """Name → (shape, dtype) of what one view of ``size``² pixels stores."""
    return {
        "kind": ((size, size), "uint8"),
        "normal": ((3, size, size), "float16"),
        "depth": ((size, size), "float16"),
        "occlusion": ((size, size), "uint8"),
        "shadow": ((len(SIDES), 2, size, size), "uint8"),
        "mirror": ((size, size), "uint8"),
        "camera": ((3, 3), "float32"),
        "tangent": ((), "float32"),
        "lights": ((len(SIDES), 3), "float32"),
    }


def build(folder: Path, views: int, shapes: int, first_seed: int, size: int, workers: int) -> None:
    """Traces a bank and moves it into place when it is whole.

    Args:
        folder: Of the bank; replaced if it exists.
        shapes: How many different subjects they show, in turn.
        first_seed: Of the first shape; the others have the numbers after it.
        size: Side of a view, pixels.
    """
    part = folder.with_name(folder.name + ".part")
    shutil.rmtree(part, ignore_errors=True)
    part.mkdir(parents=True)
    for name, (dims, kind) in fields(size).items():
        np.lib.format.open_memmap(part / f"{name}.npy", "w+", kind, (views, *dims)).flush()
    jobs = [(part, i, first_seed + i % shapes, size) for i in range(views)]
    # A fresh process each: a fork of one in which torch has started its threads can hang.
    with ProcessPoolExecutor(workers, get_context("spawn")) as pool:
        for done, _ in enumerate(pool.map(_fill, jobs, chunksize=8) if workers > 1 else map(_fill, jobs), 1):
            if done % 100 == 0:
                print(f"{done} of {views} views", flush=True)
    shutil.rmtree(folder, ignore_errors=True)
    os.replace(part, folder)


def load(folder: Path) -> dict[str, np.ndarray]:
    """The bank's fields as memory-mapped arrays (views, ...)."""
    return {path.stem: np.load(path, mmap_mode="r") for path in sorted(folder.glob("*.npy"))}


def _fill(job: tuple[Path, int, int, int]) -> None:
    folder, index, seed, size = job
    view = trace(shape(seed), np.random.default_rng([seed, index]), size)
    for name, value in view.items():
        np.load(folder / f"{name}.npy", mmap_mode="r+")[index] = value


def trace(subject: Shape, rng: Random, size: int) -> dict[str, np.ndarray]:
    """One view of a subject from a random camera on a random stage.

    A subject that fills little of the picture is traced again, a few times; the view with most of it counts.

    Args:
        subject: The shape, z up.
        size: Side of the view, pixels.

    Returns:
        The fields of `fields`.
    """
    best: dict[str, np.ndarray] = {}
    for _ in range(_TRIES):
        yaw = rng.uniform(0, 2 * np.pi)
        turn = np.array([[np.cos(yaw), -np.sin(yaw), 0], [np.sin(yaw), np.cos(yaw), 0], [0, 0, 1]])
        placed = Shape(subject.triangles @ turn.T.astype(np.float32), subject.normals @ turn.T.astype(np.float32))
        view = _trace(placed, rng, size)
        if not best or _coverage(view) > _coverage(best):
            best = view
        if _coverage(best) > _ENOUGH:
            break
    return best


def _coverage(view: dict[str, np.ndarray]) -> float:
    return float((view["kind"] == SUBJECT).mean())


def _trace(subject: Shape, rng: Random, size: int) -> dict[str, np.ndarray]:
    camera, tangent, origin, rays = _camera(subject, rng, size)
    stage = [None, _floor(rng), _cyclorama(rng)][rng.choice(3, p=[0.2, 0.4, 0.4])]
    parts = [subject] if stage is None else [subject, stage]
    everything, alone = _scene(parts), _scene([subject])

    hit = everything.run(np.broadcast_to(origin, rays.shape).astype(np.float32), rays, output=1)
    hit_rays = hit["geomID"] >= 0
    which, face = hit["geomID"][hit_rays], hit["primID"][hit_rays]
    weights = np.stack([1 - hit["u"] - hit["v"], hit["u"], hit["v"]], -1)[hit_rays]
    normals = np.concatenate([p.normals for p in parts])
    start = np.cumsum([0] + [len(p.normals) for p in parts])
    normal = np.einsum("nc,ncd->nd", weights, normals[start[which] + face])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True) + 1e-9
    ray = rays[hit_rays]
    geometric = hit["Ng"][hit_rays] / (np.linalg.norm(hit["Ng"][hit_rays], axis=1, keepdims=True) + 1e-12)
    geometric *= -np.sign((geometric * ray).sum(1, keepdims=True))
    normal *= np.where((normal * geometric).sum(1, keepdims=True) < 0, -1.0, 1.0)
    point = (origin + hit["tfar"][hit_rays][:, None] * ray + _OFFSET * geometric).astype(np.float32)

    lights = np.stack([
        direction(azimuth + rng.uniform(-spread, spread), elevation + rng.uniform(-tilt, tilt))
        for azimuth, spread, elevation, tilt in (SIDES[side] for side in ATTRIBUTES["light_side"])
    ])  # fmt: skip

    def image(values: np.ndarray, empty: float) -> np.ndarray:
        out = np.full((size * size, *values.shape[1:]), empty, np.float32)
        out[hit_rays] = values
        return out.reshape(size, size, *values.shape[1:])

    def light(ways: np.ndarray, reach: float = 1e3) -> np.ndarray:  # the cyclorama's wall shades nothing
        free = alone.run(point, ways.astype(np.float32), np.full(len(point), reach, np.float32), query="OCCLUDED")
        return (free != 0).astype(np.float32)

    shadow = np.zeros((len(lights), 2, size, size))
    for k, towards in enumerate(lights):
        shadow[k, 0] = image(light(np.broadcast_to(towards, point.shape)), 1.0)
        soft = np.mean([light(_cone(rng, towards, len(point))) for _ in range(_SOFT_RAYS)], 0)
        shadow[k, 1] = uniform_filter(image(soft, 1.0), 3)
    free = np.mean([light(_hemisphere(rng, normal), 0.8) for _ in range(_AO_RAYS)], 0)
    mirror = ray - 2 * (ray * normal).sum(1, keepdims=True) * normal
    blocked = alone.run(point, mirror.astype(np.float32), query="OCCLUDED") == 0
    return {
        "kind": image(which + 1.0, VOID),
        "normal": np.moveaxis(image(normal, 0.0), -1, 0),
        "depth": image(np.minimum(hit["tfar"][hit_rays] / np.linalg.norm(origin - _pivot(subject)), FAR), FAR),
        "occlusion": np.rint(255 * uniform_filter(image(free, 1.0), 3)),
        "shadow": np.rint(255 * shadow),
        "mirror": image(blocked, 0.0),
        "camera": camera,
        "tangent": np.float32(tangent),
        "lights": lights,
    }


def _pivot(subject: Shape) -> np.ndarray:
    points = subject.triangles.reshape(-1, 3)
    return (points.min(0) + points.max(0)) / 2


def _camera(subject: Shape, rng: Random, size: int) -> tuple[np.ndarray, float, np.ndarray, np.ndarray]:
    """Frame (3, 3), tangent of half the field of view, position and ray directions (size², 3)."""
    pivot = _pivot(subject)
    tangent = np.tan(np.radians(rng.uniform(22, 55)) / 2)
    axes = np.array(frame(0.0, rng.uniform(-4, 40) if rng.random() < 0.9 else rng.uniform(40, 75)))
    spread = np.abs((subject.triangles.reshape(-1, 3) - pivot) @ axes).max(0)
    distance = max(spread[0], spread[1]) / (tangent * rng.uniform(0.65, 1.08)) + spread[2]
    drift = rng.uniform(-0.2, 0.2, 2) * tangent * distance
    origin = pivot + axes @ np.array([*drift, distance])
    origin[2] = max(origin[2], 0.08)
    x, y = np.meshgrid(pixel_grid(size), -pixel_grid(size))
    rays = np.stack([x * tangent, y * tangent, -np.ones_like(x)], -1).reshape(-1, 3) @ axes.T
    rays /= np.linalg.norm(rays, axis=1, keepdims=True)
    return axes, tangent, origin, rays.astype(np.float32)


def pixel_grid(size: int) -> np.ndarray:
    """Pixel centers along one axis, in -1..1."""
    return (np.arange(size) + 0.5) * 2 / size - 1


def _floor(rng: Random) -> Shape:
    far = 60.0
    return grid(np.array([[[-far, -far, 0], [far, -far, 0]], [[-far, far, 0], [far, far, 0.0]]]))


def _cyclorama(rng: Random) -> Shape:
    """A floor that curves up into a wall behind the subject."""
    wall, radius = rng.uniform(1.5, 4.0), rng.uniform(0.4, 1.2)
    bend = np.linspace(0, np.pi / 2, 24)
    y = np.concatenate([[-40.0], wall - radius + radius * np.sin(bend), [wall]])
    z = np.concatenate([[0.0], radius - radius * np.cos(bend), [40.0]])
    sides = np.array([-60.0, 60.0])
    return grid(np.stack(np.broadcast_arrays(sides[None, :], y[:, None], z[:, None]), -1))


def _scene(parts: list[Shape]) -> EmbreeScene:
    scene = EmbreeScene()
    for part in parts:
        TriangleMesh(scene, part.triangles.astype(np.float32))
    return scene


def _cone(rng: Random, towards: np.ndarray, count: int) -> np.ndarray:
    """Directions spread over a round light, (count, 3)."""
    across = np.cross(towards, [0.31, 0.77, 0.55])
    across /= np.linalg.norm(across)
    angle, radius = rng.uniform(0, 2 * np.pi, count), np.tan(SOFT_CONE) * np.sqrt(rng.random(count))
    offset = np.cos(angle)[:, None] * across + np.sin(angle)[:, None] * np.cross(towards, across)
    ways = towards + radius[:, None] * offset
    return ways / np.linalg.norm(ways, axis=1, keepdims=True)


def _hemisphere(rng: Random, normal: np.ndarray) -> np.ndarray:
    """Cosine-weighted directions about each normal, (n, 3)."""
    ball = rng.normal(size=normal.shape)
    ways = normal + 0.999 * ball / np.linalg.norm(ball, axis=1, keepdims=True)
    return ways / np.linalg.norm(ways, axis=1, keepdims=True)
