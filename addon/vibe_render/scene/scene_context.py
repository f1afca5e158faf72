# SPDX-License-Identifier: GPL-3.0-or-later
"""Scene context: a scene's camera, lights, materials and world, with their roles and the scene's lengths."""

from __future__ import annotations

import functools
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

import bpy
from bpy.types import Light, Material, Object, Scene
from mathutils import Matrix, Vector

from ..core.schema_import import schema
from .light_types import type_of
from .nodes import layers, owned

GEOMETRY = {"MESH", "CURVE", "SURFACE", "FONT", "META", "CURVES", "POINTCLOUD"}


@dataclass(frozen=True)
class Owner:
    """An owner of parameters."""

    name: str  # its name in keys; "" for what a scene has one of
    thing: Any  # its data-block
    role: str = ""  # "subject" or "surroundings" for materials; "key", "fill" or "rim" for lights
    # its own lengths, by the names of the schema's REFERENCES
    lengths: dict[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class SceneContext:
    """A scene, its subject, and the pivot of its orbits."""

    scene: Scene
    subject: Sequence[Object]  # the objects that the picture is about
    pivot: Vector  # the center of their bounding box, world space, which cameras and lights orbit
    everything: bool = False  # whether materials that the camera does not see count too
    # the poses that have been read, by object; the coordinates of one share it
    poses: dict[Object, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        layer(self.scene).update()  # matrices and memberships of what has changed just now

    @functools.cached_property
    def instanced_lights(self) -> list[tuple[Object, Matrix]]:
        """See `instanced_lights`; asked once, for there may be thousands of instances to go through."""
        return instanced_lights(self.scene)

    @functools.cached_property
    def first_lights(self) -> dict[Light, Object]:
        """By light data, the first of the lights that share it."""
        return {light.data: light for light in reversed(lights(self.scene))}


def layer(scene: Scene) -> bpy.types.ViewLayer:
    """The first view layer that is rendered."""
    return next((each for each in scene.view_layers if each.use), scene.view_layers[0])


def visible(scene: Scene, obj: Object) -> bool:
    """Whether a render shows the object (its own flags, its collections', its view layer's)."""
    hidden = obj.hide_render or all(c.hide_render for c in obj.users_collection)
    return not hidden and obj.name in layer(scene).objects


def shown(scene: Scene) -> set[Object]:
    """The objects that a render shows, see `visible`; of thousands, much faster than asking each."""
    collections = (*bpy.data.collections, *(each.collection for each in bpy.data.scenes))
    open_ones = {o for c in collections if not c.hide_render for o in c.objects}
    here = filter(None, layer(scene).objects)  # what was removed just now is there as None
    return {o for o in here if not o.hide_render and o in open_ones}


def depsgraph(scene: Scene) -> bpy.types.Depsgraph:
    """The evaluated scene, up to date."""
    chosen = layer(scene)
    chosen.update()
    return chosen.depsgraph


def lights(scene: Scene) -> list[Object]:
    """The lights that a render sees, by name; those whose place is not a number light nothing."""
    objects = [o for o in scene.objects if o.type == "LIGHT" and visible(scene, o) and has_finite_place(o)]
    return sorted(objects, key=lambda o: o.name_full)


def instanced_lights(scene: Scene) -> list[tuple[Object, Matrix]]:
    """The lights that instances of collections and geometry nodes show, with their matrices, as often as shown."""
    found = []
    for item in depsgraph(scene).object_instances:
        if item.is_instance and item.object.type == "LIGHT":
            instancer = item.parent.original if item.parent else None
            original, matrix = item.object.original, item.matrix_world.copy()
            finite = all(math.isfinite(v) for row in matrix for v in row)
            if finite and not original.hide_render and not (instancer and instancer.hide_render):
                found.append((original, matrix))
    return found


def has_finite_place(obj: Object) -> bool:
    """Whether an object's place is finite; broken drivers and constraints leave it otherwise."""
    return all(math.isfinite(v) for row in obj.matrix_world for v in row)


def meshes(scene: Scene) -> list[Object]:
    """The objects with a surface that a render sees, by name; fog boxes of ours are none."""
    objects = [o for o in shown(scene) if o.type in GEOMETRY and not owned.is_unseen(o)]
    return sorted(objects, key=lambda o: o.name_full)


def materials(scene: Scene, subject: Sequence[Object], everything: bool = False) -> dict[Material, str]:
    """The materials that the camera sees, those of instances too, with their role: subject or surroundings.

    Those outside the frame are left out, unless they glow, or `everything` is set.
    """
    graph = depsgraph(scene)
    chosen, to_clip = set(subject), None if everything else frustum(scene)
    roles: dict[Material, str] = {}
    used: dict[tuple[int, int], list[Material]] = {}
    glow = functools.cache(layers.emitted_radiance)
    for item in graph.object_instances:
        if item.object.type not in GEOMETRY or not item.show_self:
            continue
        original, parent = item.object.original, item.parent and item.parent.original
        if (parent or original).hide_render or owned.is_unseen(original):
            continue
        role = "subject" if original in chosen or parent in chosen else "surroundings"
        key = original.as_pointer(), item.object.data.as_pointer()
        if key not in used:
            slots = [slot.material for slot in item.object.material_slots]
            slots += getattr(item.object.data, "materials", None) or []
            used[key] = [m.original for m in slots if m]
        # Of thousands of instances that have the same materials, one in the frame is enough.
        new = [m for m in used[key] if roles.get(m) not in ("subject", role)]
        if new and not (to_clip is None or in_frame(to_clip, item)):
            new = [m for m in new if glow(m) > 0.0]
        roles.update(dict.fromkeys(new, role))
    return dict(sorted(roles.items(), key=lambda pair: pair[0].name_full))


def frustum(scene: Scene) -> Matrix | None:
    """World space to the clip space of the scene's camera; None if there is none."""
    camera, render = scene.camera, scene.render
    if camera is None or camera.type != "CAMERA":
        return None
    projection = camera.calc_matrix_camera(
        layer(scene).depsgraph,
        x=render.resolution_x,
        y=render.resolution_y,
        scale_x=render.pixel_aspect_x,
        scale_y=render.pixel_aspect_y,
    )
    return projection @ camera.matrix_world.normalized().inverted()


def in_frame(to_clip: Matrix, item: bpy.types.DepsgraphObjectInstance) -> bool:
    """Whether a bounding box reaches into the camera's view; conservative."""
    to_clip = to_clip @ item.matrix_world
    corners = [to_clip @ Vector((*corner, 1.0)) for corner in item.object.bound_box]
    sides = [(axis, sign) for axis in range(3) for sign in (1.0, -1.0)]
    return not any(all(sign * c[axis] > c.w for c in corners) for axis, sign in sides)


def bounds(scene: Scene, objects: Iterable[Object]) -> tuple[Vector, Vector]:
    """World-space corners (least, greatest) of the evaluated objects; a unit box if there are none."""
    graph = depsgraph(scene)
    corners = []
    for obj in objects:
        evaluated = obj.evaluated_get(graph)
        corners += [evaluated.matrix_world @ Vector(c) for c in evaluated.bound_box]
    corners = [c for c in corners if all(map(math.isfinite, c))]
    if not corners:
        return Vector((-1.0, -1.0, -1.0)), Vector((1.0, 1.0, 1.0))
    return Vector(map(min, zip(*corners, strict=True))), Vector(map(max, zip(*corners, strict=True)))


def scene_lengths(context: SceneContext) -> dict[str, float]:
    """The scene-wide lengths that the schema's bounds are multiples of (see schema.REFERENCES)."""
    low, high = bounds(context.scene, context.subject or meshes(context.scene))
    height = max(high.z - low.z, 1e-3)
    camera = context.scene.camera
    view = (camera.matrix_world.translation - context.pivot).length if camera else 3.0 * height
    view = max(view, 1e-3)
    return {
        "view_distance": view,
        "per_view_distance": 1.0 / view,
        "subject_height": height,
        "per_subject_height": 1.0 / height,
    }


def owners(context: SceneContext, group: str) -> list[Owner]:
    """Everything in the scene that has the parameters of a group."""
    scene = context.scene
    if group == "camera":
        return [Owner("", scene.camera)] if scene.camera and scene.camera.type == "CAMERA" else []
    if group == "light":
        distances = _light_distances(context)
        return [
            Owner(o.name_full, o, role, light_lengths(distances[o]))
            for o, role in light_roles(context).items()
        ]
    if group == "material":
        return [
            Owner(m.name_full, m, role)
            for m, role in materials(scene, context.subject, context.everything).items()
        ]
    if group == "world":
        return [Owner("", scene.world)] if scene.world else []
    return [Owner("", scene)]


def light_lengths(distance: float) -> dict[str, float]:
    """The lengths of a light, by the names of the schema's REFERENCES."""
    return {"light_distance": distance, "light_distance_squared": distance * distance}


def _light_distances(context: SceneContext) -> dict[Object, float]:
    """Distances of the lights from the pivot, meters; never 0.

    Lights that only instances show follow those of the scene: one for each data-block, with its nearest instance.
    """
    distances = {
        o: max((o.matrix_world.translation - context.pivot).length, 1e-3) for o in lights(context.scene)
    }
    here = {o.data for o in distances}
    first: dict[Light, Object] = {}
    for obj, matrix in context.instanced_lights:
        if obj.data not in here:
            owner = first.setdefault(obj.data, obj)
            distance = max((matrix.translation - context.pivot).length, 1e-3)
            distances[owner] = min(distances.get(owner, math.inf), distance)
    return distances


def light_roles(context: SceneContext) -> dict[Object, str]:
    """Assigns roles to the lights: "rim" from behind the subject, the brightest other one "key", the rest "fill".

    Lights that only instances show follow those of the scene, one for each data-block.
    """
    distances = _light_distances(context)
    rims = {o for o in lights(context.scene) if _from_behind(o, context)}
    front = [o for o in distances if o not in rims] or [*distances]
    key = max(front, key=lambda o: _brightness(o, distances[o]), default=None)
    return {o: "key" if o is key else "rim" if o in rims else "fill" for o in distances}


def _from_behind(obj: Object, context: SceneContext) -> bool:
    """Whether a light shines from behind the subject, as the camera sees it."""
    camera, pivot = context.scene.camera, context.pivot
    front = Vector(schema.orbit.direction(0.0, 0.0))
    view = (camera.matrix_world.translation - pivot if camera else front).xy
    offset = type_of(obj).offset(obj, pivot, obj.matrix_world.to_3x3().normalized())
    light = (offset.normalized() if offset.length > 1e-6 else Vector((0.0, 0.0, 1.0))).xy
    if view.length < 1e-6 or light.length < 0.2:  # straight above is nobody's back
        return False
    return view.normalized().dot(light.normalized()) < -0.2


def _brightness(obj: Object, distance: float) -> float:
    """Radiance that the light gives to a white diffuse surface at a distance that faces it."""
    data: Light = obj.data
    power = data.energy * max(data.color)
    return schema.radiometry.radiance(type_of(obj).name, power, distance, getattr(data, "exposure", 0.0))
