# SPDX-License-Identifier: Apache-2.0
"""Typed records of one exported scene. Lengths in meters, angles in radians, colors linear Rec.709."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from ..schema import PARAMETERS, Instance, Values, material_copies
from ..schema.light_links import LightLink
from ..schema.orbit import Matrix, Vector

Array = np.ndarray
_LINKED = ("tint", "recolor", "rotation", "backdrop_color", "backdrop_tint", "backdrop_strength")


@dataclass(frozen=True)
class Camera:
    """The constant part of the camera; its orbit and field of view are parameters."""

    name: str
    type: str  # "PERSP" or "ORTHO"
    residual: Matrix  # rotation relative to looking straight at the pivot; keeps off-center aims
    ortho_scale: float  # extent of an orthographic image along the side in `sensor_fit`, meters
    shift: tuple[float, float]  # lens shift, in parts of the longer side
    sensor_fit: str  # "AUTO", "HORIZONTAL" or "VERTICAL": the side that the field of view spans
    clip: tuple[float, float]  # near and far distances
    aperture: float = 0.0  # radius of the lens, meters; 0 without depth of field
    focus_distance: float = 10.0  # depth that is in focus, meters
    focus_point: Vector | None = None  # a point in focus in place of the distance


@dataclass(frozen=True)
class Light:
    """The constant part of a light; its power, color, size and orbit are parameters."""

    name: str
    type: str  # Blender's name of its type, of those in `render.lights.light_types`
    residual: Matrix  # rotation relative to pointing straight at the pivot, as for the camera
    position: Vector  # world space
    shape: str = "SQUARE"  # for area lights "SQUARE", "RECTANGLE", "DISK" or "ELLIPSE"
    aspect: float = 1.0  # height over width of an area light, its object's scale included
    spot_size: float = 0.785398  # full opening angle of a spot
    spot_blend: float = 0.15  # softness of a spot's rim, in [0, 1]
    shadow: bool = True  # whether it casts shadows
    normalize: bool = True  # whether the power is independent of the light's size
    soft_falloff: bool = True  # whether a point or spot counts as a disc, not as a sphere, close by
    exposure: float = 0.0  # stops on top of the power
    use_temperature: bool = False
    spread: float = 3.141593  # opening angle of an area light's emission; pi for a plain one
    role: str = "other"  # "key", "fill", "rim" or "other"
    tint: Vector = (1.0, 1.0, 1.0)  # what the light's own nodes multiply its color by
    scale: float = 1.0  # what its object's scale multiplies the width of an area light by
    added: bool = False  # True for a light that the artist's scene lacks and the words ask for
    card: float = 0.0  # size of the card with a pattern (gobo) in its light, meters; 0 for none, or not on standby
    # True for an instance of a light: it stays at `position`, turned by `residual` alone, without an orbit. Instances
    # with the same name share their other values.
    fixed: bool = False
    unlit: tuple[int, ...] = ()  # indices of objects that light linking keeps its light from
    hidden: tuple[str, ...] = ()  # kinds of rays to which it is invisible: "diffuse", "glossy", "transmission"


@dataclass(frozen=True)
class Texture:
    """An image that a material's input reads."""

    image: Array  # (H, W, C) float32, row 0 at the bottom
    extension: str = "REPEAT"  # "REPEAT", "EXTEND" or "CLIP"
    # of a texture baked from the exported camera: left, bottom, right and top of the part of the camera's image
    # that the texture covers, in [0, 1]. None for a texture over UVs.
    window: tuple[float, float, float, float] | None = None
    # for a flat surface: the 2 x 4 matrix from points (x, y, z, 1), world space, to places in the image, [0, 1]
    plane: tuple[tuple[float, ...], ...] | None = None


@dataclass(frozen=True)
class Material:
    """A material that the camera sees."""

    name: str
    role: str  # "subject" or "surroundings"
    alpha: float = 1.0  # opacity, or the mean of the map "alpha"
    constants: Mapping[str, Any] = field(default_factory=dict)  # Principled inputs that no vibe changes
    texture: Texture | None = None  # base color, where nodes compute it; parameters tint it
    # other inputs that nodes compute: "alpha", "normal" (world space, n / 2 + 1 / 2), "far" (a flat surface's
    # base color, outside the camera's view as well), and parameters by name
    maps: Mapping[str, Texture] = field(default_factory=dict)


@dataclass(frozen=True)
class MeshObject:
    """An object, and whether it belongs to the subject."""

    name: str
    subject: bool
    # kinds of rays that pass it: "camera", "diffuse", "glossy", "transmission", "shadow"; "film" of a holdout
    hidden: tuple[str, ...] = ()


@dataclass(frozen=True)
class WorldData:
    """The world."""

    kind: str  # "color" or "environment"
    image: Array | None = None  # (H, W, 3) equirectangular light of an environment, without tint and strength
    backdrop: Array | None = None  # the image that the camera sees, if it differs from `image`; likewise
    hidden: tuple[str, ...] = ()  # kinds of rays that do not see the world
    horizon: float = 0.0  # height of the horizon in the image: 0 at the bottom, 1 at the top


@dataclass(frozen=True)
class FogBounds:
    """The place of the fog: its `kind` ("none", "box" or "world"), the box that it fills, and the subject's base height."""

    kind: str
    center: Vector
    half_size: Vector
    base: float


@dataclass(frozen=True)
class FilmSettings:
    """Settings by which Blender displays the image: OCIO configuration, display, view, look and others."""

    ocio: str
    display: str
    view: str
    look: str
    transparent: bool
    working_space: str  # of linear colors; "" for the configuration's own
    fonts: str = ""  # the folder of Blender's fonts, "" if not known
    gain: float = 1.0  # what the renderer multiplies its light with: Cycles' film exposure
    white_balance: tuple[Vector, ...] = ()  # rows of a matrix for linear colors, before the view; () for none
    # what the artist's compositor makes of colors: (S, S, S, 3), indexed by blue, green, red, on the log axis of
    # `radiometry.TABLE_TOE`; None if it changes no color, or if a pixel depends on more than its own color
    compositor: Array | None = None


@dataclass(frozen=True, eq=False)
class SceneMesh:
    """All triangles of the scene in world space; compared by identity, so that results can be cached by mesh."""

    vertices: Array  # (V, 3) float32
    faces: Array  # (F, 3) int32 into `vertices`
    normals: Array  # (F, 3, 3) float32, one per corner
    uvs: Array  # (F, 3, 2) float32
    material: Array  # (F,) int32 into the scene's materials
    object: Array  # (F,) int32 into the scene's objects


@dataclass(frozen=True)
class Standby:
    """Additions that the words may ask for: lights that the scene lacks, a backdrop of its own."""

    lights: tuple[Light, ...] = ()
    instances: Mapping[str, Instance] = field(default_factory=dict)  # parameters of lights and backdrop


@dataclass(frozen=True)
class SceneData:
    """Everything that the engine knows about a scene."""

    folder: Path
    resolution: tuple[int, int]  # width and height of the artist's render in pixels
    pixel_aspect: float  # width of a pixel over its height
    pivot: Vector  # center of the orbits, and of the subject's bounding box
    references: Mapping[str, float]  # scene-wide lengths that bounds are multiples of
    camera: Camera
    lights: tuple[Light, ...]
    materials: tuple[Material, ...]
    objects: tuple[MeshObject, ...]
    world: WorldData
    volume: FogBounds
    film: FilmSettings
    mesh: SceneMesh
    instances: Mapping[str, Instance]  # every parameter of this scene by key, with the artist's value
    standby: Standby = field(default_factory=Standby)  # lights, and a backdrop, that it may get
    bounces: int = 4  # diffuse bounces of the artist's render; only whether it is 0 matters
    # key -> value, of materials outside the frame whose light may reach into it
    unseen: Mapping[str, Values] = field(default_factory=dict)
    # key of an added light link (see `LightLink`) -> the words that ask for it
    links: Mapping[str, str] = field(default_factory=dict)

    def with_lights(self, names: Collection[str]) -> SceneData:
        """The scene with those standby lights (see `Standby`) that have one of the names."""
        lights = tuple(replace(light, added=True) for light in self.standby.lights if light.name in names)
        theirs = {key: i for key, i in self.standby.instances.items() if i.owner in names}
        return replace(self, lights=(*self.lights, *lights), instances={**self.instances, **theirs})

    def with_link(self, link: LightLink, said: str) -> SceneData:
        """The scene with a light link added (see `LightLink`); `said` are the words that ask for it, in quotes."""
        named = {number for number, thing in enumerate(self.objects) if thing.name in link.objects}
        others, lights = set(range(len(self.objects))) - named, []
        for light in self.lights:
            unlit = others if link.only else named.union(light.unlit)
            lights.append(replace(light, unlit=tuple(sorted(unlit))) if light.name == link.light else light)
        return replace(self, lights=tuple(lights), links={**self.links, link.key: said})

    def with_copies(self, copies: Mapping[str, Collection[str]]) -> SceneData:
        """The scene with copies of materials; `copies`: name of each copy -> names of the objects that get it."""
        if not copies:
            return self
        materials, instances = {m.name: m for m in self.materials}, dict(self.instances)
        number, worn = {name: n for n, name in enumerate(materials)}, self.mesh.material.copy()
        for name, things in copies.items():
            source = material_copies.copied(name)[0]
            wears = np.array([o.name in things for o in self.objects])[self.mesh.object]
            wears &= worn == number.get(source, -1)
            if wears.any():
                worn[wears] = number[name] = len(number)
                materials[name] = replace(materials[source], name=name)
                for i in [*instances.values()]:
                    if (i.parameter.group, i.owner) == ("material", source):
                        instances[i.parameter.key(name)] = replace(i, owner=name)
        # a material is the subject's if the subject still shows it
        mine = np.array([o.subject for o in self.objects])[self.mesh.object]
        roles = {n: "subject" if mine[worn == i].any() else "surroundings" for n, i in number.items()}
        for key, i in instances.items():
            if i.parameter.group == "material":
                instances[key] = replace(i, role=roles.get(i.owner, i.role))
        dressed = tuple(replace(m, role=roles[m.name]) for m in materials.values())
        return replace(self, materials=dressed, mesh=replace(self.mesh, material=worn), instances=instances)

    @property
    def may_have_backdrop(self) -> bool:
        """True if the world may get a backdrop: a color and a strength of its own for the camera."""
        return any(i.parameter.group == "world" for i in self.standby.instances.values())

    def with_backdrop(self) -> SceneData:
        """The scene with its standby backdrop (see `Standby`), which starts out like the world."""
        theirs = {key: i for key, i in self.standby.instances.items() if i.parameter.group == "world"}
        return replace(self, instances={**self.instances, **theirs})

    def with_card(self, name: str, corners: Array) -> SceneData:
        """The scene with an object `name`, a light's card (gobo) that only shadow rays see.

        `corners` are those of the card's quads, (Q, 4, 3) in world space.
        """
        mesh, count = self.mesh, len(corners)
        first = len(mesh.vertices) + 4 * np.arange(count)[:, None]
        faces = np.concatenate([first + np.array([0, 1, 2]), first + np.array([0, 2, 3])]).astype(np.int32)
        quads = corners.astype(np.float32)
        facet = np.cross(quads[:, 1] - quads[:, 0], quads[:, 2] - quads[:, 0])
        facet = np.tile(facet / np.linalg.norm(facet, axis=1, keepdims=True), (2, 1)).astype(np.float32)
        solid = next((i for i, m in enumerate(self.materials) if m.alpha == 1.0 and "alpha" not in m.maps), 0)
        more = SceneMesh(
            vertices=np.concatenate([mesh.vertices, quads.reshape(-1, 3)]),
            faces=np.concatenate([mesh.faces, faces]),
            normals=np.concatenate([mesh.normals, np.repeat(facet[:, None], 3, axis=1)]),
            uvs=np.concatenate([mesh.uvs, np.zeros((len(faces), 3, 2), np.float32)]),
            material=np.concatenate([mesh.material, np.full(len(faces), solid, np.int32)]),
            object=np.concatenate([mesh.object, np.full(len(faces), len(self.objects), np.int32)]),
        )
        shade = MeshObject(name, False, ("camera", "diffuse", "glossy", "transmission"))
        return replace(self, mesh=more, objects=(*self.objects, shade))

    def value(self, key: str, default: float | Values = 0.0) -> Values:
        """The artist's value of a parameter (also if `unseen`), one number per component; `default` without one."""
        if key in self.instances:
            return self.instances[key].value
        if key in self.unseen:
            return self.unseen[key]
        return default if isinstance(default, tuple) else (default,)


def plain_instances(
    lights: Iterable[tuple[str, str, str]], materials: Iterable[tuple[str, str]]
) -> dict[str, Instance]:
    """Every parameter by key at its default, for a scene that is only described: without linked textures or a backdrop.

    `lights` are (name, type, role), `materials` (name, role). Lengths are in multiples of the schema's references.
    """
    owners = {"light": [*lights], "material": [(name, "", role) for name, role in materials]}
    instances = [
        Instance(p, owner, (p.default,) * p.components, role=role)
        for p in PARAMETERS
        for owner, kind, role in owners.get(p.group, [("", "", "")])
        if p.name not in _LINKED and (not p.only or kind in p.only)
    ]
    return {i.key: i for i in instances}
