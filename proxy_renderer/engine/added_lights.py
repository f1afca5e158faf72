# SPDX-License-Identifier: Apache-2.0
"""Gives a scene the lights that the words ask for and that it lacks."""

from __future__ import annotations

from collections.abc import Sequence

from ..optimize.context import scene_words
from ..planning.lights.glow import glows
from ..planning.lights.lacking import lacking
from ..prompt.lexicon.user_words import default_vocabulary
from ..prompt.parser import parse
from ..prompt.types import PlanContext
from ..scene import SceneData
from ..schema import VibeError


def with_added_lights(scenes: Sequence[SceneData], prompt: str) -> list[SceneData]:
    """The shots, with those of their lights on standby that the words ask for; the first shot decides for all.

    Args:
        scenes: One or several shots.
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
    names = lacking(parsed, dict(first.instances), context, roles, vocabulary)
    return [scene.with_lights(names) for scene in scenes] if names else list(scenes)
