# SPDX-License-Identifier: Apache-2.0
"""Hits of rays on triangles, by Embree. Hits are constants; gradients pass only through `RayGeometry.follow`."""

from __future__ import annotations

import functools
import hashlib
import weakref
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import torch
from embreex import rtcore_scene
from embreex.mesh_construction import TriangleMesh
from torch import Tensor

from ...scene import SceneMesh
from .vectors import PointSet, cross, dot, unit

RAYS = ("camera", "diffuse", "glossy", "transmission", "shadow")  # kinds of rays; an object may be hidden from some

_SHARE = 8192  # least number of rays per thread
_GRAZING = 0.3  # cosine below which gradients of hits are damped
_LAYERS = 8  # transparent surfaces that a ray passes at most: Cycles' default of transparent bounces

_pool = functools.cache(ThreadPoolExecutor)

TraceResult = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]
"""Hits of N rays, (N,) each: triangle index, -1 for a miss; barycentric weights u and v, and distance, float32."""


class TriangleTree:
    """Embree's tree of some triangles of a mesh, those with the indices `members` (n,); built for the first ray."""

    def __init__(self, mesh: SceneMesh, members: np.ndarray) -> None:
        self._mesh, self.members = weakref.ref(mesh), members

    @functools.cached_property
    def _embree(self) -> rtcore_scene.EmbreeScene:
        mesh = self._mesh()
        assert mesh is not None  # callers that trace keep the mesh alive
        faces = mesh.faces[self.members]
        used = np.zeros(len(mesh.vertices), bool)
        used[faces] = True
        number = np.cumsum(used, dtype=np.int32) - 1
        scene = rtcore_scene.EmbreeScene()
        TriangleMesh(scene, mesh.vertices[used], np.ascontiguousarray(number[faces], np.int32))
        scene.run(np.zeros((1, 3), np.float32), np.ones((1, 3), np.float32))  # the first ray builds the tree
        return scene

    def run(self, *rays: np.ndarray, **how: Any) -> Any:
        """Embree's result for N rays: an array (N,), or with `output=1` a dict of arrays.

        `rays` has arrays (N, …): origins, directions, and optionally distances; `how` are Embree's options. Large
        batches use as many threads as torch has, because Embree releases Python's lock.
        """
        threads = min(torch.get_num_threads(), len(rays[0]) // _SHARE)
        if threads < 2:
            return self._embree.run(*rays, **how)
        parts = zip(*(np.array_split(each, threads) for each in rays), strict=True)
        answers = list(_pool(torch.get_num_threads()).map(lambda part: self._embree.run(*part, **how), parts))
        if isinstance(answers[0], dict):
            return {name: np.concatenate([each[name] for each in answers]) for name in answers[0]}
        return np.concatenate(answers)

    def nearest(self, origin: np.ndarray, toward: np.ndarray, before: TraceResult | None) -> TraceResult:
        """Nearest hits of rays (N, 3) on this tree, or the nearer hits `before` on other trees, if any."""
        if before is None:
            answer = self.run(origin, toward, output=1)
        else:
            answer = self.run(origin, toward, before[3], query="INTERSECT", output=1)
        u, v = answer["u"], answer["v"]
        new = self.members[answer["primID"].clip(0)], u, v, answer["tfar"]
        pairs = zip(new, before or (-1, u, v, np.float32(1e30)), strict=True)
        triangle, u, v, distance = (np.where(answer["primID"] >= 0, *pair) for pair in pairs)
        return triangle, u, v, distance


_trees: weakref.WeakKeyDictionary[SceneMesh, dict[bytes, TriangleTree]] = weakref.WeakKeyDictionary()
"""Mesh -> hash of a tree's triangles -> the tree, which is made once and shared as long as the mesh exists."""


@dataclass(frozen=True)
class TriangleClass:
    """Triangles that are hidden from the same rays, and are all opaque or all possibly transparent."""

    tree: TriangleTree  # the triangles
    hidden: frozenset[str]  # kinds of `RAYS` that pass the triangles unhindered
    clear: bool  # True if the triangles may let light through
    material: int  # material of all triangles if it is set apart (see `RayGeometry.set_apart`), else -1


def classes_of(
    mesh: SceneMesh, hidden: list[frozenset[str]], clear: np.ndarray, apart: frozenset[int]
) -> list[TriangleClass]:
    """Sorts the triangles of a mesh into classes, the largest class first.

    `hidden` has the kinds of `RAYS` that each object is hidden from, `clear` (M,) bool marks materials that may let
    light through. Both are the same for all triangles of a class. Each material of `apart` has classes of its own.
    """
    kinds = list(dict.fromkeys(hidden))
    kind = np.array([kinds.index(h) for h in hidden])
    own = np.array([m if m in apart else -1 for m in range(len(clear))])
    names = len(clear) + 1
    code = (kind[mesh.object] * 2 + clear[mesh.material]) * names + own[mesh.material] + 1
    classes, trees = [], _trees.setdefault(mesh, {})
    for number in np.flatnonzero(np.bincount(code)).tolist():
        rest, material = divmod(number, names)
        members = np.flatnonzero(code == number)
        key = hashlib.blake2b(members.tobytes(), digest_size=16).digest()
        tree = trees.setdefault(key, TriangleTree(mesh, members))
        classes.append(TriangleClass(tree, kinds[rest // 2], bool(rest % 2), material - 1))
    return sorted(classes, key=lambda c: -len(c.tree.members))


@dataclass(frozen=True)
class Hits(PointSet):
    """Hits of N rays on triangles."""

    triangle: Tensor  # (N,) int64, -1 for a miss
    u: Tensor  # (N,) barycentric weight of the triangle's second corner
    v: Tensor  # (N,) barycentric weight of the triangle's third corner
    distance: Tensor  # (N,), infinite for a miss

    @property
    def hit(self) -> Tensor:
        """(N,) bool: rays that hit a triangle."""
        return self.triangle >= 0


Opacity = Callable[..., Tensor]
"""Maps a `Surface` of N points to alpha (N,); with `by_camera=True` as the camera sees it (`MaterialOpacity.at`)."""

_on_device: weakref.WeakKeyDictionary[SceneMesh, dict[torch.device, tuple[Any, ...]]] = weakref.WeakKeyDictionary()
"""Mesh -> device -> corners, normals, UVs, materials, objects and size; all renderers of the mesh share them."""


class RayGeometry:
    """The scene's triangles, ready for rays and for look-ups. Rays are traced on the CPU, whatever the device.

    `hidden` has the kinds of `RAYS` that each object is hidden from. `clear` (M,) bool marks materials that are not
    opaque everywhere, `glassy` (M,) bool those with transmission in the scene. Both count as transparent, even where
    `glass` is 0.

    Attributes:
        corners: (3, F, 3) positions: corner, triangle, component.
        normals: (3, F, 3) shading normals, with the same axes.
        uvs: (3, F, 2), with the same axes.
        material, object: (F,) int64 indices.
        opacity: Function that returns the alpha of surface points; None if all materials are opaque.
        glass: (M,) share of light that passes through one surface of each material's glass; 0 without glass.
        size: Diagonal of the bounding box in meters; offsets and tolerances are relative to it.
    """

    def __init__(
        self, mesh: SceneMesh, hidden: list[frozenset[str]], opacity: Opacity, clear: Tensor, glassy: Tensor
    ) -> None:
        self.device = device = clear.device
        arrays = _on_device.setdefault(mesh, {})
        if device not in arrays:  # on the CPU, they share the mesh's memory where possible
            places = mesh.vertices[mesh.faces]
            fields = (torch.from_numpy(each).to(device).transpose(0, 1) for each in (places, mesh.normals, mesh.uvs))
            owners = (torch.from_numpy(each).to(device, torch.int64) for each in (mesh.material, mesh.object))
            arrays[device] = *fields, *owners, float(np.linalg.norm(places.max((0, 1)) - places.min((0, 1))))
        self.corners, self.normals, self.uvs, self.material, self.object, self.size = arrays[device]
        self.opacity = opacity if bool(clear[self.material].any()) else None
        self.glass = torch.zeros(len(clear), device=device)
        self._mesh, self._hidden, self._clear = mesh, hidden, clear | glassy.to(device)
        self._apart: frozenset[int] = frozenset()
        self._sort()

    def let_through(self, glass: Tensor) -> bool:
        """Sets `glass` (M,), the transmittance of each material's glass; returns True if `glass` has changed."""
        if torch.equal(glass, self.glass):
            return False
        self.glass = glass
        self._sort()
        return True

    def set_apart(self, materials: set[int]) -> None:
        """Gives each of the materials classes of its own, so that shadow rays can ignore one (`without` in `clear`)."""
        if not materials <= self._apart:
            self._apart |= materials
            self._sort()

    def _sort(self) -> None:
        clear = self._clear | (self.glass > 0)
        self._classes = classes_of(self._mesh, self._hidden, clear.cpu().numpy(), self._apart)
        self._filter = any(c.clear for c in self._classes)

    def visible_to(self, ray: str) -> Tensor:
        """(F,) bool: triangles that are not hidden from a kind of `RAYS`."""
        return torch.tensor([ray not in hidden for hidden in self._hidden], device=self.device)[self.object]

    def first_hits(self, origin: Tensor, toward: Tensor, ray: str, numbers: Tensor | None = None) -> Hits:
        """First hits of rays of a kind of `RAYS`, from origins (3, N) in unit directions (3, N).

        A transparent surface stops only its share of the rays; the others go on to their next hit. A ray's number in
        `numbers` (N,), by default its index, decides if it stops, so that results repeat.
        """
        hits = self.nearest(origin, toward, ray)
        if not self._filter:
            return hits
        index = torch.arange(origin.shape[1], device=self.device)
        numbers = index if numbers is None else numbers
        chance = numbers.double().mul(0.6180339887498949).frac().float()  # evenly spread, the same every time
        for _ in range(_LAYERS):
            current = hits.pick(index)
            stopping = self.stopping(self.surface(current, toward[:, index]), toward[:, index])
            index = index[current.hit & (stopping <= chance[index])]
            if not len(index):
                break
            further = self.onward(hits.pick(index), origin[:, index], toward[:, index], ray)
            pairs = zip(vars(hits).values(), vars(further).values(), strict=True)
            hits = Hits(*(part.index_copy(0, index, new) for part, new in pairs))
        return hits

    def onward(self, hits: Hits, origin: Tensor, toward: Tensor, ray: str) -> Hits:
        """Hits on the next surfaces behind the `hits` of rays; distances still count from the rays' origins."""
        start = hits.distance + 1e-5 * (self.size + hits.distance)
        further = self.nearest(origin + toward * start, toward, ray)
        return replace(further, distance=further.distance + start)

    def nearest(self, origin: Tensor, toward: Tensor, ray: str, among: Sequence[TriangleClass] | None = None) -> Hits:
        """Nearest hits of rays (3, N) of a kind, transparent surfaces included; `among`: classes to meet, or all."""
        rays, met = (_rows(origin), _rows(toward)), None
        for each in self._classes if among is None else among:
            if ray not in each.hidden:
                met = each.tree.nearest(*rays, met)
        if met is None:
            none = torch.zeros(origin.shape[1], device=self.device)
            return Hits(torch.full_like(none, -1, dtype=torch.int64), none, none, none + torch.inf)
        triangle = torch.from_numpy(met[0]).to(self.device, torch.int64)
        u, v, distance = (torch.from_numpy(p).to(self.device) for p in met[1:])
        return Hits(triangle, u, v, torch.where(triangle >= 0, distance, torch.inf))

    def clear(self, origin: Tensor, toward: Tensor, distance: Tensor, without: int = -1, ray: str = "shadow") -> Tensor:
        """Share (N,) of light that passes from origins (3, N) in unit directions (3, N) over `distance` (N,) meters.

        `without` is a material that blocks no light, set apart before (see `set_apart`); -1 for none.
        """
        passing = torch.ones(origin.shape[1], device=self.device)
        blocking = [c for c in self._classes if ray not in c.hidden and (without < 0 or c.material != without)]
        limit = distance.clamp_max(1e30).cpu().numpy().astype(np.float32)
        rays = _rows(origin), _rows(toward)
        for solid in (c.tree for c in blocking if not c.clear):
            passing[torch.from_numpy(solid.run(*rays, limit, query="OCCLUDED") >= 0).to(self.device)] = 0.0
        # Transparent surfaces along the rays reduce the share.
        veils = [c for c in blocking if c.clear]
        if not veils:
            return passing
        index = (passing > 0).nonzero()[:, 0]
        start = torch.zeros_like(passing)
        for _ in range(_LAYERS):
            if not len(index):
                break
            way = toward[:, index]
            near = self.nearest(origin[:, index] + way * start[index], way, ray, veils)
            reach = start[index] + near.distance
            met = near.hit & (reach < distance[index])
            index, reach = index[met], reach[met]
            hits = replace(near.pick(met), distance=reach)
            passing[index] *= 1 - self.stopping(self.surface(hits, toward[:, index]), toward[:, index])
            start[index] = reach + 1e-5 * (self.size + reach)
            index = index[passing[index] > 1e-3]
        return passing

    def stopping(self, surface: Surface, toward: Tensor) -> Tensor:
        """Share (N,) of light along rays (3, N) that surface points stop; glass stops more at its rim."""
        solid = 1.0 if self.opacity is None else self.opacity(surface)
        through = self.glass[surface.material] * dot(surface.normal, toward).abs()
        return solid * (1 - through)

    def surface(self, hits: Hits, toward: Tensor) -> Surface:
        """The surface points at the hits of rays (3, N); misses get finite values of triangle 0, to be ignored."""
        weights = torch.stack((1 - hits.u - hits.v, hits.u, hits.v))
        return self.interpolate(hits.triangle.clamp_min(0), torch.where(hits.hit, weights, 1 / 3), toward)

    def follow(self, hits: Hits, origin: Tensor, toward: Tensor) -> Surface:
        """The surface points where differentiable rays (3, N) meet the planes of the triangles that they hit.

        All rays must hit. The barycentric weights are those of Moeller and Trumbore (1997). Hits of grazing rays move
        fast over the surface: their gradients, which would be huge, are damped.
        """
        a, b, c = (self.corners[k, hits.triangle].T for k in range(3))
        e1, e2, offset = b - a, c - a, origin - a
        p = cross(toward, e2)
        q = cross(offset, e1)
        determinant = dot(e1, p)
        flat = determinant.abs() < 1e-12
        inverse = torch.where(flat, 0.0, 1 / torch.where(flat, 1.0, determinant))
        facet = unit(cross(e1, e2), 1e-15)
        damping = (dot(facet, toward.detach()).abs() / _GRAZING).clamp_max(1.0) ** 2
        u, v = dot(offset, p) * inverse, dot(toward, q) * inverse
        u, v = (torch.lerp(weight.detach(), weight, damping) for weight in (u, v))  # the same, with damped gradients
        return self.interpolate(hits.triangle, torch.stack((1 - u - v, u, v)), toward)

    def interpolate(self, triangle: Tensor, weights: Tensor, toward: Tensor) -> Surface:
        """The surface points at barycentric weights (3, N) of triangles (N,), with normals that face rays (3, N)."""
        a, b, c = (self.corners[k, triangle].T for k in range(3))
        facet = unit(cross(b - a, c - a), 1e-15)
        position = a * weights[0] + b * weights[1] + c * weights[2]
        normal = unit(sum((self.normals[k, triangle].T * weights[k] for k in range(3)), torch.zeros_like(a)))
        back = torch.where(dot(facet, toward) > 0, -1.0, 1.0)
        facet, normal = facet * back, facing(normal * back, toward)
        uv = sum((self.uvs[k, triangle].T * weights[k] for k in range(3)), torch.zeros_like(a[:2]))
        return Surface(position, normal, facet, uv, self.material[triangle], self.object[triangle])

    def lifted(self, surface: Surface) -> Tensor:
        """Origins (3, N) just above a surface, for rays that must not meet it again at once."""
        return surface.position + surface.facet * (1e-5 * (self.size + surface.position.abs().amax(0)))


@dataclass(frozen=True)
class Surface(PointSet):
    """N surface points."""

    position: Tensor  # (3, N)
    normal: Tensor  # (3, N) unit shading normals, on the viewer's side
    facet: Tensor  # (3, N) unit normals of the triangles, on the viewer's side
    uv: Tensor  # (2, N)
    material: Tensor  # (N,) int64
    object: Tensor  # (N,) int64


def facing(normal: Tensor, toward: Tensor) -> Tensor:
    """Unit normals (3, N), bent just enough that rays (3, N) meet them from outside; else the surface would be dark."""
    return unit(normal - toward * (0.02 + dot(normal, toward)).clamp_min(0.0))


def sphere_points(count: int, copies: int, generator: torch.Generator) -> Tensor:
    """Evenly spread points (2, copies, count) in [0, 1)^2: R2 sequence (Roberts 2018), each copy shifted at random."""
    index = torch.arange(1, count + 1, dtype=torch.float64)
    base = torch.stack((index * 0.7548776662466927, index * 0.5698402909980532))
    shift = torch.rand((2, copies, 1), generator=generator, dtype=torch.float64)
    return ((base[:, None, :] + shift) % 1.0).to(torch.float32)


def shared_points(count: int, turn: Tensor, generator: torch.Generator) -> Tensor:
    """Points (2, copies, count) in [0, 1)^2, all from one R2 sequence (see `sphere_points`) with one random shift.

    A copy whose number in `turn` (copies,) is t takes the t-th group of `count` points of the sequence. Copies of
    different turns add up to one evenly spread set, so that averages over them have little noise.
    """
    points = sphere_points(count * (int(turn.max()) + 1 if len(turn) else 0), 1, generator).to(turn.device)
    return points.view(2, -1, count)[:, turn]


def _rows(vectors: Tensor) -> np.ndarray:
    return np.ascontiguousarray(vectors.detach().cpu().numpy().T, np.float32)
