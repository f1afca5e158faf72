# SPDX-License-Identifier: Apache-2.0
"""Procedural meshes to learn looks on: a seed gives one shape of one of the families below.

A shape is a list of parts that may overlap; what matters to a look is its surface, not its topology.
"""

from collections.abc import Callable

import numpy as np
import trimesh

from lab.train.pictures.surfaces import (
    Shape,
    box,
    ellipsoid,
    flat,
    grid,
    merge,
    moved,
    revolve,
    smooth,
    smooth_sides,
    tube,
)

Random = np.random.Generator


def shape(seed: int) -> Shape:
    """The shape of ``seed``, standing on z = 0, centered in x and y, inside a unit-radius sphere or so."""
    rng = np.random.default_rng(seed)
    whole = merge(FAMILIES[seed % len(FAMILIES)](rng))
    if rng.random() < 0.2:
        whole = moved(whole, trimesh.transformations.random_rotation_matrix(rng.random(3))[:3, :3])
    points = whole.triangles.reshape(-1, 3)
    low, high = points.min(0), points.max(0)
    center = np.array([*(low + high)[:2] / 2, low[2]])
    scale = 2.0 / np.linalg.norm(high - low)
    return Shape(((whole.triangles - center) * scale).astype(np.float32), whole.normals.astype(np.float32))


def superquadric(rng: Random) -> list[Shape]:
    """From pillows over spheres to stars."""
    e1, e2 = rng.uniform(0.2, 2.2, 2)
    u, v = np.meshgrid(np.linspace(-np.pi / 2, np.pi / 2, 40), np.linspace(-np.pi, np.pi, 72), indexing="ij")

    def power(x: np.ndarray, e: float) -> np.ndarray:
        return np.sign(x) * np.abs(x) ** e

    points = np.stack(
        [
            power(np.cos(u), e1) * power(np.cos(v), e2),
            power(np.cos(u), e1) * power(np.sin(v), e2),
            power(np.sin(u), e1),
        ],
        -1,
    )
    return [grid(points * rng.uniform(0.5, 1.2, 3))]


def lathe(rng: Random) -> list[Shape]:
    """Vases, bottles, bowls, goblets, columns."""
    knots = rng.uniform(0.15, 1.0, rng.integers(4, 8))
    t = np.linspace(0, 1, 60)
    radius = np.interp(t, np.linspace(0, 1, len(knots)), knots)
    radius = np.convolve(np.pad(radius, 6, "edge"), np.hanning(13) / np.hanning(13).sum(), "valid")
    height = rng.uniform(0.8, 3.0) * t
    inner = np.concatenate([[0.0], radius, radius[::-1] * 0.92, [0.0]])
    levels = np.concatenate([[0.0], height, height[::-1], [height[-1] * 0.1]])
    return [revolve(inner, levels)]


def bent(rng: Random) -> list[Shape]:
    """A box, cylinder or cone that was twisted, tapered and bent."""
    base = [
        trimesh.creation.box((1, 1, 2)),
        trimesh.creation.cylinder(0.6, 2.0, sections=rng.integers(5, 40)),
        trimesh.creation.cone(0.8, 2.0, sections=rng.integers(4, 40)),
    ][rng.integers(3)]
    base = base.subdivide_to_size(0.16)
    x, y, z = base.vertices.T
    scale, twist = 1 + rng.uniform(-0.4, 0.4) * z, rng.uniform(-1.2, 1.2) * z
    x, y = scale * (np.cos(twist) * x - np.sin(twist) * y), scale * (np.sin(twist) * x + np.cos(twist) * y)
    base.vertices = np.stack([x + rng.uniform(-0.4, 0.4) * z**2, y, z], -1)
    return [flat(base) if rng.random() < 0.6 else smooth(base)]


def blob(rng: Random) -> list[Shape]:
    """A lump with soft bumps."""
    mesh = trimesh.creation.icosphere(4)
    bump = np.zeros(len(mesh.vertices))
    for _ in range(rng.integers(4, 14)):
        direction = rng.normal(size=3)
        direction /= np.linalg.norm(direction)
        bump += rng.uniform(-0.25, 0.45) * np.exp(-(1 - mesh.vertices @ direction) * rng.uniform(2, 12))
    mesh.vertices = mesh.vertices * (1 + bump)[:, None] * rng.uniform(0.6, 1.2, 3)
    return [smooth(mesh)]


def furniture(rng: Random) -> list[Shape]:
    """Tables, chairs, shelves, benches."""
    w, d, h, leg = (rng.uniform(0.5, 1.4), rng.uniform(0.4, 1.0), rng.uniform(0.4, 1.0), rng.uniform(0.05, 0.12))
    parts = [box((-w, -d, h), (w, d, h + rng.uniform(0.05, 0.2)))]
    for x in (-w, w - leg):
        parts += [box((x, y, 0), (x + leg, y + leg, h)) for y in (-d, d - leg)]
    if rng.random() < 0.6:
        top = h + rng.uniform(0.5, 1.2)
        parts.append(box((-w, d - leg, h), (w, d, top)))
        if rng.random() < 0.5:
            parts += [box((x, -d, h), (x + leg, d, h + 0.35)) for x in (-w, w - leg)]
    if rng.random() < 0.3:
        parts.append(ellipsoid((0, 0, h + 0.4), tuple(rng.uniform(0.15, 0.35, 3))))
    return parts


def tree(rng: Random) -> list[Shape]:
    """Bare, leafy or conifer."""
    parts: list[Shape] = []
    leafy = rng.random()
    if leafy < 0.3:
        levels = rng.integers(3, 6)
        for k in range(levels):
            r, z = 0.9 * (1 - k / (levels + 0.5)), 0.5 + 0.45 * k
            parts.append(revolve(np.array([0, r, 0.02]), np.array([z, z, z + 0.8])))
        return [*parts, tube(np.array([[0, 0, 0], [0, 0, 0.4], [0, 0, 0.8]]), np.full(3, 0.12))]

    def branch(start: np.ndarray, direction: np.ndarray, length: float, radius: float, depth: int) -> None:
        bend = rng.normal(0, 0.15, 3)
        t = np.linspace(0, 1, 6)[:, None]
        path = start + length * (direction * t + bend * t**2)
        parts.append(tube(path, radius * (1 - 0.45 * t[:, 0]), 8))
        if depth == 0:
            if leafy > 0.6:
                parts.append(ellipsoid(tuple(path[-1]), tuple(rng.uniform(0.15, 0.4, 3))))
            return
        for _ in range(rng.integers(2, 4)):
            turn = direction + rng.normal(0, 0.55, 3) + [0, 0, 0.15]
            branch(path[-1], turn / np.linalg.norm(turn), length * rng.uniform(0.6, 0.8), radius * 0.55, depth - 1)

    branch(np.zeros(3), np.array([0, 0, 1.0]), 1.0, rng.uniform(0.08, 0.16), 4 if leafy < 0.6 else 3)
    return parts


def animal(rng: Random) -> list[Shape]:
    """A body, a head, legs, a tail, ears."""
    length, girth, leg = rng.uniform(0.6, 1.1), rng.uniform(0.28, 0.5), rng.uniform(0.3, 0.9)
    z = leg + girth * 0.6
    head = np.array([length * 1.15, 0, z + rng.uniform(0.1, 0.8)])
    size = rng.uniform(0.2, 0.36)
    parts = [ellipsoid((0, 0, z), (length, girth, girth * rng.uniform(0.8, 1.1)))]
    parts += [
        ellipsoid(tuple(head), (size * 1.2, size, size)),
        ellipsoid((head[0] + size, 0, head[2] - 0.05), (size * 0.6,) * 3),
    ]
    parts.append(tube(np.linspace([length * 0.6, 0, z], head, 6), np.linspace(girth * 0.7, size * 0.7, 6)))
    for x in (-0.6 * length, 0.6 * length):
        for y in (-0.5 * girth, 0.5 * girth):
            parts.append(tube(np.linspace([x, y, z], [x, y, 0], 5), np.linspace(0.14, 0.09, 5)))
    parts += [ellipsoid((head[0] - 0.05, s * size * 0.6, head[2] + size), (0.06, 0.07, size * 0.6)) for s in (-1, 1)]
    t = np.linspace(0, 1, 8)[:, None]
    parts.append(
        tube(
            np.array([-length, 0, z]) + t * [-0.5, 0, 0] + t**2 * [0, 0, rng.uniform(-0.4, 0.8)], 0.08 - 0.05 * t[:, 0]
        )
    )
    return parts


def swimmer(rng: Random) -> list[Shape]:
    """A fish or whale: a bent spindle with fins."""
    t = np.linspace(0, 1, 30)
    path = np.stack(
        [2.4 * t - 1.2, 0.2 * np.sin(2 * t + rng.uniform(0, 3)), 0.8 + rng.uniform(-0.7, 0.7) * (t - 0.5) ** 2], -1
    )
    radius = rng.uniform(0.25, 0.5) * np.sin(np.pi * t**0.7) ** 0.8 + 0.03
    tail, back = path[0], path[16] + [0, 0, radius[16]]
    spread = rng.uniform(0.2, 0.45)
    fins = [ellipsoid(tuple(tail + np.array([0, s * spread * 0.7, 0])), (0.16, spread, 0.04)) for s in (-1, 1)]
    if rng.random() < 0.5:
        fins = [ellipsoid(tuple(tail + np.array([0, 0, s * spread * 0.7])), (0.16, 0.04, spread)) for s in (-1, 1)]
    fins += [ellipsoid(tuple(path[20] + [0, s * 0.5, -0.15]), (0.14, 0.35, 0.05)) for s in (-1, 1)]
    return [tube(path, radius, 24), *fins, ellipsoid(tuple(back), (0.2, 0.04, 0.22))]


def knot(rng: Random) -> list[Shape]:
    """Rings, springs and torus knots."""
    t = np.linspace(0, 2 * np.pi, 160)
    p, q = [(1, 0), (2, 3), (3, 2), (2, 5), (1, 4)][rng.integers(5)]
    r = 1 + 0.4 * np.cos(q * t)
    path = np.stack([r * np.cos(p * t), r * np.sin(p * t), 0.4 * np.sin(q * t)], -1)
    if rng.random() < 0.3:
        path = np.stack([np.cos(4 * t), np.sin(4 * t), t * 0.35], -1)
    turn = trimesh.transformations.random_rotation_matrix(rng.random(3))[:3, :3]
    return [moved(tube(path, np.full(len(t), rng.uniform(0.1, 0.3)), 18), turn)]


def vessel(rng: Random) -> list[Shape]:
    """A pot, jug or mug: a lathe with a handle and perhaps a spout and a lid."""
    t = np.linspace(0, 1, 40)
    radius = rng.uniform(0.5, 0.9) + rng.uniform(-0.3, 0.4) * np.sin(np.pi * t) + rng.uniform(-0.2, 0.2) * t
    h = rng.uniform(0.7, 1.8)
    parts = [
        revolve(
            np.concatenate([[0], radius, radius[::-1] * 0.9, [0]]), np.concatenate([[0], h * t, h * t[::-1], [0.1]])
        )
    ]
    a = np.linspace(-1.2, 1.2, 16)
    grip = np.stack([radius[20] + 0.45 * np.cos(a), 0 * a, h / 2 + 0.35 * h * np.sin(a)], -1)
    parts.append(tube(grip, np.full(16, rng.uniform(0.05, 0.11))))
    if rng.random() < 0.5:
        s = np.linspace(0, 1, 10)
        spout = np.stack([-radius[15] - 0.6 * s, 0 * s, h * (0.3 + 0.6 * s**1.5)], -1)
        parts.append(tube(spout, 0.18 - 0.09 * s))
    if rng.random() < 0.5:
        parts += [ellipsoid((0, 0, h), (radius[-1], radius[-1], 0.18)), ellipsoid((0, 0, h + 0.22), (0.12,) * 3)]
    return parts


def crystal(rng: Random) -> list[Shape]:
    """Rocks and gems: hulls of points, one or a cluster."""
    parts = []
    for _ in range(rng.integers(1, 5)):
        points = rng.normal(size=(rng.integers(8, 40), 3)) * rng.uniform(0.3, 1.0, 3)
        hull = trimesh.convex.convex_hull(points)
        parts.append(moved(flat(hull), np.eye(3), tuple(rng.uniform(-0.6, 0.6, 3))))
    return parts


def machine(rng: Random) -> list[Shape]:
    """Stacked boxes, drums and balls: buildings, robots, engines, vehicles."""
    parts, z = [], 0.0
    for _ in range(rng.integers(2, 6)):
        w, d, h = rng.uniform(0.25, 0.9, 3)
        x, y = rng.uniform(-0.25, 0.25, 2)
        kind = rng.integers(3)
        if kind == 0:
            parts.append(box((x - w, y - d, z), (x + w, y + d, z + h)))
        elif kind == 1:
            drum = trimesh.creation.cylinder(w, h, sections=40)
            parts.append(moved(Shape(*smooth_sides(drum)), np.eye(3), (x, y, z + h / 2)))
        else:
            parts.append(ellipsoid((x, y, z + h / 2), (w, d, h / 2)))
        z += h * 0.95
    for s in (-1, 1):
        wheel = moved(
            Shape(*smooth_sides(trimesh.creation.cylinder(0.3, 0.15, sections=32))),
            np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0.0]]),
        )
        parts += [moved(wheel, np.eye(3), (x, s * 0.7, 0.3)) for x in (-0.5, 0.5)]
    return parts


FAMILIES: tuple[Callable[[Random], list[Shape]], ...] = (
    superquadric, lathe, bent, blob, furniture, tree, animal, swimmer, knot, vessel, crystal, machine,
)  # fmt: skip
