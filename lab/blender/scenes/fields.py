# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes from formulas, in numpy: each gives vertices (V, 3), quads (F, 4) and uvs (F, 4, 2). No bpy here."""

from __future__ import annotations

import math
import random

import numpy as np

MeshArrays = tuple[np.ndarray, np.ndarray, np.ndarray]
_AROUND = (False, True)  # a grid whose rows are closed


def _grid(rows: int, columns: int, closed: tuple[bool, bool] = (False, False)) -> np.ndarray:
    """Quads (F, 4) between the points of a grid, which may be closed either way."""
    i, j = np.meshgrid(
        np.arange(rows if closed[0] else rows - 1), np.arange(columns if closed[1] else columns - 1), indexing="ij"
    )
    down, right = (i + 1) % rows, (j + 1) % columns
    quads = [i * columns + j, i * columns + right, down * columns + right, down * columns + j]
    return np.stack(quads, -1).reshape(-1, 4)


def _unit(rows: int, columns: int) -> np.ndarray:
    """The points' places (rows * columns, 2) in the unit square."""
    v, u = np.meshgrid(np.linspace(0, 1, rows), np.linspace(0, 1, columns), indexing="ij")
    return np.stack([u, v], -1).reshape(-1, 2)


def _uvs(rows: int, columns: int, closed: tuple[bool, bool] = (False, False)) -> np.ndarray:
    """The unit square laid over `_grid`: a place (F, 4, 2) for every corner; where it closes, 1 meets 0."""
    down, across = (rows if closed[0] else rows - 1), (columns if closed[1] else columns - 1)
    i, j = np.meshgrid(np.arange(down), np.arange(across), indexing="ij")
    corners = [(j, i), (j + 1, i), (j + 1, i + 1), (j, i + 1)]
    return np.stack([np.stack([u / across, v / down], -1) for u, v in corners], -2).reshape(-1, 4, 2)


def lathe(profile: np.ndarray, steps: int = 96, subdivisions: int = 4) -> MeshArrays:
    """A surface of revolution around z; corners of the profile are rounded (Catmull-Rom).

    Args:
        profile: (P, 2), radius and height.
        subdivisions: Rows between two points of the profile.
    """
    padded = np.concatenate([profile[:1], profile, profile[-1:]])
    t = np.linspace(0, 1, subdivisions, endpoint=False)[:, None]
    pieces = []
    for a, b, c, d in zip(padded, padded[1:], padded[2:], padded[3:], strict=False):
        pieces.append(b + 0.5 * t * (c - a + t * (2 * a - 5 * b + 4 * c - d + t * (3 * (b - c) + d - a))))
    curve = np.concatenate([*pieces, profile[-1:]])
    radius, height = np.maximum(curve[:, 0], 0.0), curve[:, 1]
    angle = np.linspace(0, 2 * math.pi, steps, endpoint=False)
    places = np.stack(
        [radius[:, None] * np.cos(angle), radius[:, None] * np.sin(angle), np.repeat(height[:, None], steps, 1)], -1
    )
    return places.reshape(-1, 3), _grid(len(curve), steps, _AROUND), _uvs(len(curve), steps, _AROUND)


def drape(side: int) -> MeshArrays:
    """A cloth over a ball of radius 0.8: on it, then falling in folds."""
    uv = _unit(side, side)
    x, y = (3.6 * (uv - 0.5)).T
    r, angle = np.hypot(x, y), np.arctan2(y, x)
    on = np.sqrt(np.clip(0.81 - np.minimum(r, 0.9) ** 2, 0, None)) + 0.8
    fold = 0.12 * np.clip(r - 0.75, 0, 1) * np.sin(9 * angle + 2 * np.sin(3 * angle))
    falling = 1.25 * np.exp(-1.6 * np.clip(r - 0.55, 0, None)) + fold
    z = _blend(on, falling, (r - 0.5) / 0.3)
    return np.stack([x * 0.8, y * 0.8, np.maximum(z, 0.03)], -1), _grid(side, side), _uvs(side, side)


def _blend(a: np.ndarray, b: np.ndarray, t: np.ndarray) -> np.ndarray:
    t = np.clip(t, 0, 1)
    t = t * t * (3 - 2 * t)
    return a * (1 - t) + b * t


def curtain(side: int) -> MeshArrays:
    """A hanging sheet with folds that open downwards."""
    uv = _unit(side, side)
    x, z = 2.6 * (uv[:, 0] - 0.5), 2.2 * uv[:, 1]
    depth = (0.06 + 0.12 * (1 - uv[:, 1])) * np.sin(22 * uv[:, 0] + 1.5 * np.sin(5 * uv[:, 0] + 2 * uv[:, 1]))
    return np.stack([x, depth, z], -1), _grid(side, side), _uvs(side, side)


def leaves(chance: random.Random, count: int) -> MeshArrays:
    """Bent blades that grow out of a pot's middle at height 0.5."""
    steps = 10
    t = np.linspace(0, 1, steps)
    width = 0.15 * np.sin(math.pi * np.clip(t, 0.02, 0.98)) ** 0.8
    vertices: list[np.ndarray] = []
    faces: list[np.ndarray] = []
    for i in range(count):
        turn, length = 2.4 * i + chance.uniform(-0.3, 0.3), chance.uniform(0.8, 1.5)
        lean = chance.uniform(0.15, 1.0)
        out = length * (lean * t + 0.25 * t * t)
        up = 0.5 + length * (t - 0.55 * lean * t * t)
        side = np.array([-math.sin(turn), math.cos(turn), 0.0])
        middle = np.stack([out * math.cos(turn), out * math.sin(turn), up], -1)
        blade = np.stack([middle - width[:, None] * side, middle + width[:, None] * side], 1)
        faces.append(_grid(steps, 2) + 2 * steps * i)
        vertices.append(blade.reshape(-1, 3))
    return np.concatenate(vertices), np.concatenate(faces), np.tile(_uvs(steps, 2), (count, 1, 1))


def branches(chance: random.Random) -> MeshArrays:
    """A bare tree of tapering branches, five generations."""
    vertices: list[np.ndarray] = []
    faces: list[np.ndarray] = []

    def grow(start: np.ndarray, toward: np.ndarray, length: float, thick: float, depth: int) -> None:
        end = start + length * toward
        across = np.cross(toward, (0.3, 0.9, 0.1))
        across /= np.linalg.norm(across)
        other = np.cross(toward, across)
        angle = np.linspace(0, 2 * math.pi, 8, endpoint=False)[:, None]
        circle = np.cos(angle) * across + np.sin(angle) * other
        faces.append(_grid(2, 8, _AROUND) + 16 * len(vertices))
        vertices.append(np.concatenate([start + thick * circle, end + 0.7 * thick * circle]))
        if depth:
            for _ in range(3):
                bend = np.array([chance.gauss(0, 0.5), chance.gauss(0, 0.5), chance.gauss(0.15, 0.25)])
                step = toward + bend
                grow(end, step / np.linalg.norm(step), length * chance.uniform(0.62, 0.82), 0.65 * thick, depth - 1)

    grow(np.array([0.0, 0.0, -0.02]), np.array([0.0, 0.0, 1.0]), 0.75, 0.11, 5)
    count = len(vertices)
    return np.concatenate(vertices), np.concatenate(faces), np.tile(_uvs(2, 8, _AROUND), (count, 1, 1))


def knot(along: int, around: int) -> MeshArrays:
    """A tube along a (2, 3) torus knot."""
    t = np.linspace(0, 2 * math.pi, along, endpoint=False)

    def curve(s: np.ndarray) -> np.ndarray:
        r = 0.62 + 0.27 * np.cos(3 * s)
        return np.stack([r * np.cos(2 * s), 0.45 * np.sin(3 * s), r * np.sin(2 * s)], -1)

    ahead = curve(t + 1e-3) - curve(t - 1e-3)
    ahead /= np.linalg.norm(ahead, axis=1, keepdims=True)
    up = curve(t)
    side = np.cross(ahead, up)
    side /= np.linalg.norm(side, axis=1, keepdims=True)
    other = np.cross(ahead, side)
    angle = np.linspace(0, 2 * math.pi, around, endpoint=False)[None, :, None]
    ripple = 0.16 + 0.012 * np.sin(8 * angle + 60 * t[:, None, None])
    places = curve(t)[:, None] + ripple * (np.cos(angle) * side[:, None] + np.sin(angle) * other[:, None])
    places[..., 2] += 1.07
    return places.reshape(-1, 3), _grid(along, around, (True, True)), _uvs(along, around, (True, True))


def _sphere(around: int, rings: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Unit directions (rings, around, 3) from top to bottom, faces, uvs."""
    polar = np.linspace(0, math.pi, rings)
    turn = np.linspace(0, 2 * math.pi, around, endpoint=False)
    p, t = np.meshgrid(polar, turn, indexing="ij")
    toward = np.stack([np.sin(p) * np.cos(t), np.sin(p) * np.sin(t), np.cos(p)], -1)
    uvs = _uvs(rings, around, _AROUND) * (1, -1) + (0, 1)  # v upwards
    return toward, _grid(rings, around, _AROUND)[:, ::-1], uvs[:, ::-1]


def sphere(around: int, rings: int, radius: float) -> MeshArrays:
    """A ball around the origin.

    Args:
        rings: Rows of vertices from pole to pole.
    """
    toward, faces, uvs = _sphere(around, rings)
    return radius * toward.reshape(-1, 3), faces, uvs


def rock(chance: random.Random, around: int, rings: int) -> MeshArrays:
    """A sphere with bumps of many sizes.

    Args:
        rings: Rows of vertices from pole to pole.
    """
    toward, faces, uvs = _sphere(around, rings)
    bumps = np.zeros(toward.shape[:2])
    for i in range(60):
        wave = np.array([chance.gauss(0, 1) for _ in range(3)])
        frequency = 1.6 * 1.055**i
        bumps += 0.16 / frequency * np.sin(frequency * (toward @ wave) + chance.uniform(0, 6.3))
    places = 0.85 * (1 + bumps)[..., None] * toward * (1.1, 1.0, 0.95)
    places[..., 2] -= places[..., 2].min() + 0.03
    return places.reshape(-1, 3), faces, uvs
