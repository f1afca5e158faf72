# SPDX-License-Identifier: Apache-2.0
"""Lights that words link to objects, in the scenes of a vibe: those that words name, and those that play the part that words say."""

from dataclasses import replace

from ..scene import SceneData
from ..schema import VibeError, matches
from ..schema.light_links import LINKED, LightLink
from ..schema.messages import Options
from ..words.types import SaidLink
from .stage import StagedScenes


def linked(stage: StagedScenes, options: Options) -> StagedScenes:
    """A stage with the light links that its words ask for; lights that the artist has locked are left out."""
    if isinstance(stage.goals, VibeError):
        return stage
    notes, scenes = stage.goals.parsed.notes, list(stage.scenes)
    for said in stage.goals.parsed.links:
        names = {name for scene in scenes for name in _lights(said, scene, stage)}
        free = {name for name in names if not _is_locked(name, options)}
        if not free:
            why = "it is locked" if names else f"there is no {said.role} light"
            notes.append(f"'{said.text}' is not used: {why}.")
        for number, scene in enumerate(scenes):
            objects = tuple(o.name for o in scene.objects if o.name in said.objects)
            for light in (x.name for x in scene.lights if x.name in free and objects):
                scenes[number] = scenes[number].with_link(
                    LightLink(light, said.only, objects), f"'{said.text}'"
                )
    return replace(stage, scenes=scenes)


def _lights(said: SaidLink, scene: SceneData, stage: StagedScenes) -> list[str]:
    """The lights of a scene that words mean: those of that name or else role, and those that are added for the words."""
    playing = stage.lighting.parts if stage.lighting else {}
    added = [x.name for x in scene.lights if x.added and playing.get(x.name, x.role) == said.role]
    own = [x.name for x in scene.lights if not x.added and x.name in said.lights]
    parts = [name for name, part in playing.items() if part == said.role]
    return [*own, *added] or parts or [x.name for x in scene.lights if x.role == said.role]


def _is_locked(light: str, options: Options) -> bool:
    groups = options.groups
    return matches(f"light/{light}/{LINKED.name}", list(options.lock)) or bool(
        groups and LINKED.group not in groups
    )
