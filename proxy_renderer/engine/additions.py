# SPDX-License-Identifier: Apache-2.0
"""Gives a scene what the words ask for and it lacks: lights, and a backdrop of its own."""

from __future__ import annotations

from collections.abc import Sequence

from ..optimize.context import scene_words
from ..planning.lights.backdrop import asks_for_backdrop
from ..planning.lights.glow import glows
from ..planning.lights.lacking import lacking
from ..planning.types import PlanContext
from ..prompt.lexicon.user_words import default_vocabulary
from ..prompt.parser import parse
from ..scene import SceneData
from ..schema import VibeError


def with_additions(scenes: Sequence[SceneData], prompt: str) -> list[SceneData]:
    """The shots, with what is on standby for them and the words ask for.

    Args:
        scenes: One or several shots. The first decides on lights for all; a backdrop is for all of them or for none.
        prompt: What the artist typed; where nothing in it is understood offline, nothing is added.
    """
    first, vocabulary = scenes[0], default_vocabulary()
    try:
        parsed = parse(prompt, scene_words(*scenes), vocabulary)
    except VibeError:
        return list(scenes)
    context = PlanContext(
        camera_azimuth=first.value("camera/azimuth")[0],
        glows=glows(first),
        light_types={light.name: light.type for light in first.lights},
    )
    roles = {light.name: light.role for light in first.standby.lights}
    instances = dict(first.instances)
    names = lacking(parsed, instances, context, roles, vocabulary)
    parts = asks_for_backdrop(parsed, instances, context, vocabulary)
    if parts and all(scene.may_be_parted for scene in scenes):
        scenes = [scene.parted() for scene in scenes]
    return [scene.with_lights(names) for scene in scenes] if names else list(scenes)
