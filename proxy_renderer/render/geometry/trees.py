# SPDX-License-Identifier: Apache-2.0
"""Triangles in Embree's trees. Building one takes longer than many rays through it: each is built once, when needed."""

import functools
import hashlib
import weakref
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

import numpy as np
import torch
from embreex import rtcore_scene
from embreex.mesh_construction import TriangleMesh

from ...scene import SceneMesh

RAYS = ("camera", "diffuse", "glossy", "transmission", "shadow")  # an object may be hidden from them

_SHARE = 8192  # rays that are worth a thread

_pool = functools.cache(ThreadPoolExecutor)


TraceResult = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]
"""Ends of N rays: triangles (N,), -1 for a miss; the weights u and v, and distances, float32."""


class TriangleTree:
    """The triangles of a mesh with indices `members` (n,), ready for rays."""

    def __init__(self, mesh: SceneMesh, members: np.ndarray) -> None:
        self._mesh, self._members = weakref.ref(mesh), members

    @property
    def count(self) -> int:
        """Number of triangles."""
        return len(self._members)

    @functools.cached_property
    def _embree(self) -> rtcore_scene.EmbreeScene:
        mesh = self._mesh()
        assert mesh is not None  # whoever traces has it
        faces = mesh.faces[self._members]
        used = np.zeros(len(mesh.vertices), bool)
        used[faces] = True
        number = np.cumsum(used, dtype=np.int32) - 1
        scene = rtcore_scene.EmbreeScene()
        TriangleMesh(scene, mesh.vertices[used], np.ascontiguousarray(number[faces], np.int32))
        scene.run(np.zeros((1, 3), np.float32), np.ones((1, 3), np.float32))  # the first ray builds the tree
        return scene

    def _run(self, *rays: np.ndarray, **how: Any) -> Any:
        """Embree's answer for rays (N, …), by as many threads as torch has: it lets go of Python's lock."""
        threads = min(torch.get_num_threads(), len(rays[0]) // _SHARE)
        if threads < 2:
            return self._embree.run(*rays, **how)
        parts = zip(*(np.array_split(each, threads) for each in rays), strict=True)
        answers = list(_pool(torch.get_num_threads()).map(lambda part: self._embree.run(*part, **how), parts))
        if isinstance(answers[0], dict):
            return {name: np.concatenate([each[name] for each in answers]) for name in answers[0]}
        return np.concatenate(answers)

    def nearest(self, origin: np.ndarray, toward: np.ndarray, before: TraceResult | None) -> TraceResult:
        """The nearest hits of rays (N, 3), those that another tree gave among them."""
        if before is None:
            answer = self._run(origin, toward, output=1)
        else:
            answer = self._run(origin, toward, before[3], query="INTERSECT", output=1)
        met = answer["primID"] >= 0
        triangle = self._members[answer["primID"].clip(0)]
        u, v, distance = answer["u"], answer["v"], answer["tfar"]
        if before is None:
            return np.where(met, triangle, -1), u, v, np.where(met, distance, np.float32(1e30))
        triangle, u, v, distance = (
            np.where(met, new, old) for new, old in zip((triangle, u, v, distance), before, strict=True)
        )
        return triangle, u, v, distance

    def blocks(self, origin: np.ndarray, toward: np.ndarray, distance: np.ndarray) -> np.ndarray:
        """(N,) bool: rays (N, 3) that meet a triangle before a distance (N,)."""
        return self._run(origin, toward, distance, query="OCCLUDED") >= 0


_trees: weakref.WeakKeyDictionary[SceneMesh, dict[bytes, TriangleTree]] = weakref.WeakKeyDictionary()


def tree_of(mesh: SceneMesh, members: np.ndarray) -> TriangleTree:
    """The tree of some triangles (n,) of a mesh: all that trace the same ones share it, as long as the mesh lives."""
    key = hashlib.blake2b(members.tobytes(), digest_size=16).digest()
    trees = _trees.setdefault(mesh, {})
    return trees.setdefault(key, TriangleTree(mesh, members))


@dataclass(frozen=True)
class TriangleClass:
    """Triangles that all rays treat alike."""

    tree: TriangleTree  # the triangles
    hidden: frozenset[str]  # kinds of rays that pass them, of `RAYS`
    clear: bool  # whether they may let light through
    material: int  # the glowing material of them all, which casts no shadow in its own light; -1 for others


def classes_of(
    mesh: SceneMesh, hidden: list[frozenset[str]], clear: np.ndarray, apart: frozenset[int]
) -> list[TriangleClass]:
    """Sorts the triangles of a mesh into classes by what objects are `hidden` from, `clear` (M,) materials, and those `apart`."""
    kinds = list(dict.fromkeys(hidden))
    kind = np.array([kinds.index(h) for h in hidden])
    own = np.array([m if m in apart else -1 for m in range(len(clear))])
    names = len(clear) + 1
    code = (kind[mesh.object] * 2 + clear[mesh.material]) * names + own[mesh.material] + 1
    classes = []
    for number in np.flatnonzero(np.bincount(code)).tolist():
        rest, material = divmod(number, names)
        tree = tree_of(mesh, np.flatnonzero(code == number))
        classes.append(TriangleClass(tree, kinds[rest // 2], bool(rest % 2), material - 1))
    return sorted(classes, key=lambda c: -c.tree.count)
