# SPDX-License-Identifier: GPL-3.0-or-later
"""Prepares a scene for a vibe: adds what is missing, and copies materials that the subject shares. Revert undoes it."""

from __future__ import annotations

import functools
from collections.abc import Iterable, Sequence
from math import pi, radians, tan

import bpy
import numpy as np
from bpy.types import Material, Object, Scene
from mathutils import Matrix, Vector

from ..core import compat, rendered
from ..core.journal import Journal
from ..core.schema_import import schema
from . import scene_context, snapshot
from .geometry.meshes import array
from .light_types import LIGHT_TYPES
from .nodes import backgrounds, layers, owned
from .nodes.trails import active_links
from .orbits import orbit_matrix

_PLACES = {
    "key": (-40.0, 40.0, 0.4, 1.2),
    "fill": (50.0, 15.0, 0.8, 0.3),
    "rim": (155.0, 45.0, 0.3, 2.0),
    "kicker": (-155.0, 30.0, 0.3, 1.0),
    "accent": (90.0, 20.0, 0.4, 0.6),
    "practical": (60.0, 20.0, 0.1, 0.5),
    "background": (175.0, 20.0, 0.6, 0.6),
    "top": (0.0, 80.0, 1.0, 0.8),
    "bounce": (0.0, -40.0, 0.8, 0.3),
}
"""Part of an added light -> its first values: azimuth from the camera and elevation (degrees), size in multiples of its
distance, and the radiance that a white surface has when it faces the light."""
OURS = {"key": "Vibe Key", "fill": "Vibe Fill", "rim": "Vibe Rim"}
"""Role of a light that a scene lacks -> name of the light that is added for it."""
_LEAST_LIGHT = 0.1  # radiance above which a white surface at the subject counts as lit
LIGHT_TYPE = "AREA"  # the type of a light that is added for a role


def prepare_scene(scene: Scene, subject: Sequence[Object] = ()) -> None:
    """Adds a missing world, camera, light and materials, recorded in the snapshot; a world of several scenes is copied.

    They are placed for the subject; for all meshes if `subject` is empty.
    """
    about = list(subject) or scene_context.meshes(scene)
    low, high = scene_context.bounds(scene, about)
    with snapshot.transaction(scene) as journal:
        shown = rendered.world(scene)
        if shown is None:
            world = owned.new(journal, "worlds", "Vibe World")
            compat.enable_nodes(world)
            rendered.set_world(scene, world, journal.set)
        elif rendered.world_users(shown) > 1:  # a copy in place of a world that other scenes use too
            rendered.set_world(scene, journal.copy("worlds", shown), journal.set)
        if scene.camera is None:
            _add_camera(journal, scene, low, high)
        lights = rendered.lights(scene) or rendered.instanced_lights(scene)
        if not (lights or _light_of_surfaces(scene, (low + high) / 2.0) > _LEAST_LIGHT):
            key = add_light(journal, scene, "Vibe Key", low, high)
            if _is_lit(scene):
                key.data.energy = 0.0  # a scene that its world lights keeps its look
        for obj in about if not rendered.override_lock(scene) else ():
            _add_material(journal, obj)
    rendered.layer(scene).update()


def _add_camera(journal: Journal, scene: Scene, low: Vector, high: Vector) -> None:
    """Adds a camera that sees the box between corners `low` and `high`, world space; makes it the scene's camera."""
    data = owned.new(journal, "cameras", "Vibe Camera")
    camera = owned.new(journal, "objects", "Vibe Camera", data)
    # The lens angle is that of the image's longer side; all has to fit into the shorter side too.
    sides = (scene.render.resolution_x, scene.render.resolution_y)
    distance = 1.2 * (high - low).length / 2.0 / tan(data.angle / 2.0) * (max(sides) / min(sides))
    data.clip_end = max(data.clip_end, 10.0 * distance)
    data.clip_start = min(data.clip_start, 0.01 * distance)
    camera.matrix_world = orbit_matrix((low + high) / 2.0, 25.0, 15.0, distance)
    scene.collection.objects.link(camera)
    journal.set(scene, "camera", camera)


def add_light(journal: Journal, scene: Scene, name: str, low: Vector, high: Vector) -> Object:
    """Adds the light `name` of `ADDED_LIGHTS` to their collection; it lights the box from corner `low` to `high`."""
    what = schema.added_lights.ADDED_LIGHTS[name]
    azimuth, elevation, size, brightness = _PLACES[what.part]
    data = owned.new(journal, "lights", name, what.type)
    light = owned.new(journal, "objects", name, data)
    pivot, kind = (low + high) / 2.0, LIGHT_TYPES[what.type]
    front = schema.orbit.angles(scene.camera.matrix_world.translation - pivot)[0] if scene.camera else 0.0
    toward = Vector(schema.orbit.direction(front + azimuth, elevation))
    # No wall may block the light: it stands at four fifths of the way from the box's surface to the wall.
    distance, gap = added_light_distance(low, high), 1.01 * (high - low).length / 2.0
    start, graph = pivot + gap * toward, rendered.depsgraph(scene)
    hit, wall, *_ = scene.ray_cast(graph, start, toward, distance=max(distance - gap, 1e-3))
    if hit:
        distance = (wall - pivot).length - 0.2 * (wall - start).length
    setattr(data, kind.extent_property, size * distance if kind.has_position else radians(0.526))
    data.energy = brightness * schema.radiometry.unit_energy(what.type, distance if kind.has_position else 1.0)
    light.visible_camera = False
    # a sun's place has no effect: at the pivot, its card turns with it around the subject
    light.matrix_world = orbit_matrix(pivot, front + azimuth, elevation, 0.0 if what.pattern else distance)
    if what.part == "background" and kind.has_position:
        # turned away from the subject and down: it lights the wall behind it, and the floor at the wall
        light.matrix_world = light.matrix_world @ Matrix.Rotation(pi + radians(35.0), 4, "X")
    collection = owned.find_owned(scene.collection.children, schema.added_lights.COLLECTION)
    if collection is None:
        collection = owned.new(journal, "collections", schema.added_lights.COLLECTION)
        scene.collection.children.link(collection)
    collection.objects.link(light)
    if what.pattern:
        collection.objects.link(_add_card(journal, light, what.pattern, card_size(low, high)))
    return light


def card_size(low: Vector, high: Vector) -> float:
    """Size in meters of the card of a light with a pattern: half the diagonal of the box that the light is for."""
    return (high - low).length / 2.0


def _add_card(journal: Journal, light: Object, pattern: str, size: float) -> Object:
    """Adds the card of a light: a patterned mesh in front of the light, turned with it, seen by shadow rays only."""
    lights = schema.added_lights
    quads = lights.card(pattern, size)
    mesh = owned.new(journal, "meshes", lights.CARD)
    mesh.from_pydata([(*c, 0.0) for q in quads for c in q], [], [range(4 * i, 4 * i + 4) for i in range(len(quads))])
    card = owned.new(journal, "objects", lights.CARD, mesh)
    card.parent = light
    card.location = (0.0, 0.0, lights.CARD_AWAY * size)
    for ray in ("camera", "diffuse", "glossy", "transmission", "volume_scatter"):
        setattr(card, f"visible_{ray}", False)
    return card


def added_light_distance(low: Vector, high: Vector) -> float:
    """The distance of an added light from the center of the box that it lights, meters."""
    return 1.5 * max((high - low).length, 1e-3)


def _is_lit(scene: Scene) -> bool:
    """True if the world lights the scene: its radiance is above `_LEAST_LIGHT`, or nodes compute it."""
    for layer in backgrounds.layers_of_part(rendered.world(scene), backgrounds.LIGHT):
        color, strength = layer.shader.input("Color"), layer.shader.input("Strength")
        if color and strength:
            computed = active_links(color) or active_links(strength)
            if computed or max(color.default_value[:3]) * strength.default_value > _LEAST_LIGHT:
                return True
    return False


def _add_material(journal: Journal, obj: Object) -> None:
    """Adds a material to an object that has none and may be changed."""
    data = obj.data
    if _materials_of(obj) or data.library or data.override_library or not hasattr(data, "materials"):
        return
    material = owned.new(journal, "materials", f"Vibe {obj.name}", role="material")
    compat.enable_nodes(material)
    if obj.material_slots:
        journal.set(obj.material_slots[0], "material", material)
    else:
        journal.append_material(data, material)


def _light_of_surfaces(scene: Scene, place: Vector) -> float:
    """Radiance that emitting meshes give to a white surface at `place`, unoccluded; the sum stops at `_LEAST_LIGHT`."""
    total, of = 0.0, rendered.layer(scene)
    glow = functools.cache(lambda material: layers.emitted_radiance(material) if material else 0.0)
    for thing, _, matrix in rendered.instances(scene):
        strengths = [glow(m) for m in rendered.worn(thing, of)] if thing.type == "MESH" else []
        if not any(strengths):
            continue
        # The sum of radiance x min(area / (2 pi d^2), 1) over the mesh's faces: half of them count as facing away.
        faces, rotation, offset = thing.data.polygons, np.array(matrix)[:3, :3], np.array(matrix)[:3, 3]
        area = array(faces, "area", (len(faces),), float)
        index = array(faces, "material_index", (len(faces),), np.int32)
        way = array(faces, "center", (len(faces), 3), float) @ rotation.T + offset - np.array(place)
        scale = abs(np.linalg.det(rotation)) ** (2.0 / 3.0)
        strength = np.array(strengths)[np.clip(index, 0, len(strengths) - 1)]
        factor = np.minimum(0.5 * scale * area / (pi * np.maximum((way**2).sum(1), 1e-6)), 1.0)
        total += float((strength * factor).sum())
        if total > _LEAST_LIGHT:
            break
    return total


def shared_materials(subject: Sequence[Object]) -> dict[Material, list[Object]]:
    """Editable material of the subject -> objects outside the subject, of any scene, that use the material too."""
    inside, theirs = set(subject), {m for obj in subject for m in _materials_of(obj) if m.is_editable}
    users: dict[Material, list[Object]] = {}
    for obj in bpy.data.objects:
        if obj in inside or not obj.users_scene or owned.is_unseen(obj):
            continue
        for material in theirs.intersection(_materials_of(obj)):
            users.setdefault(material, []).append(obj)
    return users


EVERYTHING = frozenset({"subject"})
"""The names to give to `described_materials` if words may describe the whole subject."""


def described_materials(shared: dict[Material, list[Object]], names: frozenset[str]) -> dict[Material, list[Object]]:
    """The entries of `shared` whose material is in `names` or on an object in `names`; all entries for `EVERYTHING`."""
    if names >= EVERYTHING:
        return shared
    worn = {m for obj in bpy.data.objects if obj.name in names for m in _materials_of(obj)}
    return {m: users for m, users in shared.items() if m in worn or m.name in names}


def separate_materials(scene: Scene, subject: Sequence[Object]) -> None:
    """Replaces the subject's shared materials by copies, recorded in the scene's snapshot."""
    inside = set(subject)
    with snapshot.transaction(scene) as journal:
        for material in shared_materials(subject):
            twin = journal.copy("materials", material)
            for obj in subject:
                if obj.is_editable:
                    _replace_material(journal, obj, inside, material, twin)


def add_copies(journal: Journal, scene: Scene, names: Iterable[str]) -> None:
    """Adds the material copies in `names` ("Paint (on Chair.*)") that the file lacks, and puts each on its objects."""
    known = {material.name_full: material for material in bpy.data.materials}
    for name in sorted({*names} - known.keys()):
        source, who = schema.material_copies.copied(name)
        editable = [o for o in scene.objects if o.is_editable and known.get(source) in _materials_of(o)]
        wearers = {o for o in editable if schema.material_copies.is_worn_by(who, o.name)}
        if not who or not wearers:
            continue
        twin = journal.copy("materials", known[source])
        twin.name = name
        for obj in sorted(wearers, key=lambda o: o.name):
            _replace_material(journal, obj, wearers, known[source], twin)


def _materials_of(obj: Object) -> set[Material]:
    return {slot.material for slot in obj.material_slots if slot.material}


def _replace_material(journal: Journal, obj: Object, inside: set[Object], old: Material, new: Material) -> None:
    """Replaces a material in an object's slots; a mesh that objects outside `inside` also use keeps its material."""
    for slot in obj.material_slots:
        if slot.material != old:
            continue
        others = (other for other in bpy.data.objects if other.data == obj.data and other not in inside)
        if slot.link == "DATA" and (not obj.data.is_editable or any(others)):
            journal.set(slot, "link", "OBJECT")
        journal.set(slot, "material", new)
