# SPDX-License-Identifier: GPL-3.0-or-later
"""Scene context: a scene's camera, lights, materials and world, with their roles and the scene's lengths."""

from __future__ import annotations

import functools
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

from bpy.types import Light, Material, Object, Scene
from mathutils import Matrix, Vector

from ..core import rendered
from ..core.schema_import import schema
from .light_types import type_of
from .nodes import layers, owned, trails


@dataclass(frozen=True)
class Owner:
    """An owner of parameters: a camera, light, material or world, or the scene for fog and film."""

    name: str  # its name in keys; "" for a camera, world, fog or film
    thing: Any  # its data-block
    role: str = ""  # "subject" or "surroundings" for materials; "key", "fill" or "rim" for lights
    locked: str = ""  # the reason why none of its values may change; "" if they may
    lengths: dict[str, float] = field(default_factory=dict)  # of a light: see `light_lengths`


@dataclass(frozen=True)
class SceneContext:
    """A scene, its subject, and the pivot of its orbits."""

    scene: Scene
    subject: Sequence[Object]  # the objects that the image is about
    pivot: Vector  # the center of the subject's bounding box, world space, which cameras and lights orbit
    everything: bool = False  # whether materials that the camera does not see count too
    poses: dict[Object, Any] = field(default_factory=dict)  # object -> its `Pose`, which all slots of the object share

    def __post_init__(self) -> None:
        rendered.layer(self.scene).update()  # matrices and collections of objects that have changed

    @functools.cached_property
    def instanced_lights(self) -> list[tuple[Object, Matrix]]:
        """Result of `rendered.instanced_lights`, cached, because a scene may have thousands of instances."""
        return rendered.instanced_lights(self.scene)

    @functools.cached_property
    def first_lights(self) -> dict[Light, Object]:
        """Light data -> the first of the lights that share it."""
        return {light.data: light for light in reversed(rendered.lights(self.scene))}


def meshes(scene: Scene) -> list[Object]:
    """The rendered objects with a surface, sorted by name; without Vibe Render's fog box and cards."""
    objects = [o for o in rendered.shown(scene) if o.type in rendered.GEOMETRY and not owned.is_unseen(o)]
    return sorted(objects, key=lambda o: o.name_full)


def materials(scene: Scene, subject: Sequence[Object], everything: bool = False) -> dict[Material, str]:
    """Material -> role, "subject" or "surroundings", if the camera sees it or it emits light, or with `everything`."""
    chosen, to_clip = set(subject), None if everything else rendered.frustum(scene)
    of = rendered.layer(scene)
    roles: dict[Material, str] = {}
    used: dict[tuple[int, int], list[Material]] = {}
    glow = functools.cache(layers.emitted_radiance)
    for thing, parent, matrix in rendered.instances(scene):
        original = thing.original
        if original.type not in rendered.GEOMETRY or owned.is_unseen(original):
            continue
        role = "subject" if original in chosen or parent in chosen else "surroundings"
        key = original.as_pointer(), thing.data.as_pointer()
        if key not in used:
            used[key] = [m for m in rendered.worn(thing, of) if m]
        # Of thousands of instances that have the same materials, one in the frame is enough.
        new = [m for m in used[key] if roles.get(m) not in ("subject", role)]
        # Outside the frame, only materials that emit light count.
        if new and not (to_clip is None or rendered.in_frame(to_clip, thing, matrix)):
            new = [m for m in new if glow(m) > 0.0]
        roles.update(dict.fromkeys(new, role))
    return dict(sorted(roles.items(), key=lambda pair: pair[0].name_full))


def bounds(scene: Scene, objects: Iterable[Object]) -> tuple[Vector, Vector]:
    """World-space corners (least, greatest) of the box around evaluated objects; a box from -1 to 1 without objects."""
    graph = rendered.depsgraph(scene)
    evaluated = [obj.evaluated_get(graph) for obj in objects]
    corners = [each.matrix_world @ Vector(corner) for each in evaluated for corner in each.bound_box]
    corners = [c for c in corners if all(map(math.isfinite, c))]
    if not corners:
        return Vector((-1.0, -1.0, -1.0)), Vector((1.0, 1.0, 1.0))
    return Vector(map(min, zip(*corners, strict=True))), Vector(map(max, zip(*corners, strict=True)))


def scene_lengths(context: SceneContext) -> dict[str, float]:
    """Name in `schema.REFERENCES` -> scene-wide length (m or 1/m), of which bounds of parameters are multiples."""
    low, high = bounds(context.scene, context.subject or meshes(context.scene))
    height = max(high.z - low.z, 1e-3)
    camera = context.scene.camera
    view = (camera.matrix_world.translation - context.pivot).length if camera else 3.0 * height
    view = max(view, 1e-3)
    lengths = {"view_distance": view, "per_view_distance": 1.0 / view}
    return lengths | {"subject_height": height, "per_subject_height": 1.0 / height}


def owners(context: SceneContext, group: str) -> list[Owner]:
    """The owners of a group's parameters in the scene, such as its lights for "light"; empty if there are none."""
    scene = context.scene
    if group == "camera":
        return [Owner("", scene.camera)] if scene.camera and scene.camera.type == "CAMERA" else []
    if group == "light":
        found, distances = [], _light_distances(context)
        for light, role in light_roles(context).items():
            # A light that is only in a background set must be left alone.
            behind = [each for each in rendered.scenes(scene)[1:] if each in light.users_scene]
            only_there = behind and scene not in light.users_scene
            lock = f'it is in the background set "{behind[0].name}"' if only_there else ""
            found.append(Owner(light.name_full, light, role, lock, light_lengths(distances[light])))
        return found
    if group == "material":
        roles, lock = materials(scene, context.subject, context.everything), rendered.override_lock(scene)
        return [Owner(material.name_full, material, role, lock) for material, role in roles.items()]
    world = rendered.world(scene)
    if group == "world":
        return [Owner("", world)] if world else []
    if group == "volume" and not trails.world_volume(world):
        # A box of fog would get the material that overrides all others.
        return [Owner("", scene, locked=rendered.override_lock(scene))]
    return [Owner("", scene)]


def light_lengths(distance: float) -> dict[str, float]:
    """Name in `schema.REFERENCES` -> length of a light, here its distance from the pivot (m), and the square (m²)."""
    return {"light_distance": distance, "light_distance_squared": distance * distance}


def _light_distances(context: SceneContext) -> dict[Object, float]:
    """Light -> distance from the pivot in meters, never 0; for instanced lights, from the nearest instance."""
    own = rendered.lights(context.scene)
    distances = {light: max((light.matrix_world.translation - context.pivot).length, 1e-3) for light in own}
    # After the scene's own lights come those that only instances show: one for each data-block, at its nearest instance.
    here = {o.data for o in distances}
    first: dict[Light, Object] = {}
    for obj, matrix in context.instanced_lights:
        if obj.data not in here:
            owner = first.setdefault(obj.data, obj)
            distance = max((matrix.translation - context.pivot).length, 1e-3)
            distances[owner] = min(distances.get(owner, math.inf), distance)
    return distances


def light_roles(context: SceneContext) -> dict[Object, str]:
    """Light -> role: "rim" if it shines from behind the subject, "key" for the brightest other one, else "fill"."""
    distances = _light_distances(context)
    rims = {o for o in rendered.lights(context.scene) if _from_behind(o, context)}
    front = [o for o in distances if o not in rims] or [*distances]

    def brightness(light: Object) -> float:
        """Radiance that the light gives to a white diffuse surface at the pivot that faces it."""
        data, kind = light.data, type_of(light).name
        power, exposure = data.energy * max(data.color), data.exposure
        return schema.radiometry.radiance(kind, power, distances[light], exposure)

    key = max(front, key=brightness, default=None)
    return {o: "key" if o is key else "rim" if o in rims else "fill" for o in distances}


def _from_behind(obj: Object, context: SceneContext) -> bool:
    """True if a light shines from behind the subject, as the camera sees it."""
    camera, pivot = context.scene.camera, context.pivot
    front = Vector(schema.orbit.direction(0.0, 0.0))
    view = (camera.matrix_world.translation - pivot if camera else front).xy
    offset = type_of(obj).offset(obj, pivot, obj.matrix_world.to_3x3().normalized())
    light = (offset.normalized() if offset.length > 1e-6 else Vector((0.0, 0.0, 1.0))).xy
    if view.length < 1e-6 or light.length < 0.2:  # a light straight above is not behind
        return False
    return view.normalized().dot(light.normalized()) < -0.2
