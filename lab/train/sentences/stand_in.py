# SPDX-License-Identifier: Apache-2.0
"""A labeled scene for the reader and the planner, as if Blender had exported it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from lab.train.sentences.labels import LabeledScene
from proxy_renderer.scene.data import plain_instances
from proxy_renderer.schema import Instance, radiometry
from proxy_renderer.words.types import Glow, LightDescription, SceneDescription

STANDBY = {"Vibe Key": "key", "Vibe Fill": "fill", "Vibe Rim": "rim"}
"""Lights that a scene gets if words ask for them, with their roles."""
_KEY, _GLOW, _LAMP = 1.0, 0.6, 0.2  # radiance of a white surface that faces the light
_SKY = 0.5  # of the surroundings' pixels that show the world, where the camera sees it
_MIDDLE = 0.5  # how far away the subject is, as places in labeled scenes count


@dataclass(frozen=True)
class SceneStandIn:
    """A labeled scene in the terms of the reader and the planner.

    Attributes:
        scene: Its names and what the planner knows about it.
        instances: Its parameters by key.
    """

    scene: SceneDescription
    instances: dict[str, Instance]

    def with_lights(self, names: list[str]) -> SceneStandIn:
        """The scene with some of the lights on standby in it.

        Args:
            names: Keys of `STANDBY`.
        """
        if not names:
            return self
        added = plain_instances([(name, "AREA", STANDBY[name]) for name in names], ())
        theirs = {key: i for key, i in added.items() if i.owner in names}
        lights = {name: LightDescription("AREA", STANDBY[name]) for name in names}
        return SceneStandIn(replace(self.scene, added_lights=lights), self.instances | theirs)


def stand_in(scene: LabeledScene) -> SceneStandIn:
    """A labeled scene as the reader and the planner see it.

    Args:
        scene: The scene. Its key light is the brightest, or else the first one that is named.
    """
    mine = scene.materials_of("subject")
    described = SceneDescription(
        subject=scene.subject[0] if len(scene.subject) == 1 else "",
        objects={name: "subject" if name in scene.subject else "surroundings" for name in scene.objects},
        materials={name: "subject" if name in mine else "surroundings" for name in scene.materials},
        object_materials=scene.objects,
        lights={x.name: LightDescription(x.type, x.role, x.turn, x.lights) for x in scene.lights},
        glows=scene.glows,
        groups=_groups(scene),
        emitters={name: _glow(scene, name) for name in scene.glows},
        world_share=_SKY if scene.sky else 0.0 if scene.materials_of("surroundings") else None,
    )
    return SceneStandIn(described, _instances(scene, described))


def _groups(scene: LabeledScene) -> dict[str, tuple[str, ...]]:
    """The objects of each collection, and the children of each parent."""
    children: dict[str, tuple[str, ...]] = {}
    for child, parent in scene.parents.items():
        itself = (parent,) if parent in scene.objects else ()
        children[parent] = (*children.get(parent, itself), child)
    return children | scene.collections


def _instances(scene: LabeledScene, described: SceneDescription) -> dict[str, Instance]:
    lights = [(light.name, light.type, light.role) for light in scene.lights]
    instances = plain_instances(lights, described.materials.items())
    main = next((x.name for x in scene.lights if x.role == "key"), lights[0][0] if lights else "")
    values: dict[str, float] = {}
    for light in scene.lights:
        power = "strength" if light.type == "SUN" else "power"
        bright = _KEY if light.name == main else _LAMP
        values[f"light/{light.name}/{power}"] = bright * radiometry.unit_energy(light.type)
        values[f"light/{light.name}/azimuth"] = light.turn
    values |= {f"material/{name}/emission": 1.0 for name in scene.glows}
    return instances | {key: replace(instances[key], value=(value,)) for key, value in values.items()}


def _glow(scene: LabeledScene, material: str) -> Glow:
    shown = tuple(name for name, worn in scene.objects.items() if material in worn)
    places = [scene.places[name] for name in shown if name in scene.places]
    x, y = (sum(place[i] for place in places) / max(len(places), 1) for i in (0, 1))
    azimuth = math.degrees(math.atan2(x, _MIDDLE - y)) if places else 0.0
    return Glow(_GLOW, azimuth, shown)
