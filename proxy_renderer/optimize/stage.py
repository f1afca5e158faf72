# SPDX-License-Identifier: Apache-2.0
"""The stage of a vibe: the words, read once against the scene, and the scene with the lights that the words ask for."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

from ..claims.claim import Claim
from ..claims.from_goals import claims_of
from ..goals.relative import compares, further
from ..goals.resolve import Goals, goals_or_why
from ..goals.written import WrittenGoals
from ..planning.acting import goals_without_rig
from ..planning.advice import OfflineAdvisor
from ..planning.support import asks_for_backdrop, missing_lights
from ..planning.types import LightPlan
from ..rigs.chosen import chosen_rig
from ..rigs.lighting import OFF, Lighting, lighting
from ..scene import SceneData
from ..schema import Instance, VibeError, matches, sentences
from ..schema.added_lights import ADDED_LIGHTS, light_name
from ..schema.light_links import LINKED, LightLink
from ..schema.messages import Options
from ..words.lexicon.rigs import rig_table
from ..words.lexicon.vocabulary import default_vocabulary
from ..words.parser import Understood
from ..words.types import SaidLink
from .scene_words import described

_SPARE = {light_name(part, "AREA") for part in ("key", "fill", "rim", "kicker", "bounce")}
"""Lights that single words may need, as "rim light", if they ask for no rig; the last two if the scene already has such a light."""
_ADDED = ("rim light", "fill light")  # targets of words about a light that a further sentence adds


@dataclass(frozen=True)
class StagedScenes:
    """The scenes and goals of a vibe."""

    scenes: list[SceneData]  # the shots, with the lights that the words ask for and the scene lacks
    understood: Understood  # the words, read against the scene
    goals: Goals | VibeError  # the words' wishes; if nothing is understood, the error that says why
    lighting: Lighting | None = None  # the rig that the words ask for, set up; None if they ask for none

    @property
    def plan(self) -> LightPlan | None:
        """The rig's plan."""
        return self.lighting.plan if self.lighting else None

    @property
    def advisor(self) -> OfflineAdvisor:
        """The planner of these goals."""
        return OfflineAdvisor(self.goals, self.plan)

    def claims(self, goals: Goals) -> tuple[Claim, ...]:
        """The claims of goals about the image, including those about the rig's light."""
        lit = goals_without_rig(goals, self.plan) if self.plan else goals
        return claims_of(lit, default_vocabulary())


def set_stage(
    scenes: Sequence[SceneData],
    prompt: str,
    new_lights: bool = True,
    target: Sequence[str] = (),
    written: WrittenGoals | None = None,
    goes_on: bool = False,
) -> StagedScenes:
    """The shots with the rig that the words ask for; without a rig, with standby lights and a backdrop that single words need.

    If nothing in the prompt is understood offline, nothing is added. The first of several shots decides on lights for all; a backdrop
    is added to all or to none. Raises VibeError if a target, as "copper=Cup", names nothing in the scene.

    Args:
        new_lights: Whether lights may be added.
        written: Goals that replace those of the prompt.
        goes_on: Whether the prompt is a further sentence, whose goals are relative to the present image.
    """
    prompt, factor, compared = sentences.plain(prompt) if goes_on else (prompt, 0.0, "")
    anew = goes_on and new_lights and sentences.adds_light(prompt)
    understood = Understood(prompt, described(*scenes), target)
    if anew and (added := _about_added(understood)):
        understood = Understood(prompt, described(*scenes), [*target, *added])
    scenes = [scene.with_copies(understood.scene.copies) for scene in scenes]
    goals = written.within(understood.scene) if written else goals_or_why(understood)
    if isinstance(goals, VibeError):
        return StagedScenes(list(scenes), understood, goals)
    vocabulary = default_vocabulary()
    if goes_on:
        goals = further(goals, vocabulary, factor, compared)
    if chosen := chosen_rig(goals, rig_table(), vocabulary, anew):
        rig = lighting(scenes, goals.parsed, chosen, new_lights)
        return StagedScenes(rig.scenes, understood, goals, rig)

    # No rig: lights and a backdrop that single words need
    first = scenes[0]
    spare = [ADDED_LIGHTS[light.name] for light in first.standby.lights if light.name in _SPARE]
    roles = {light.name: light.role for light in spare}
    instances = dict(first.instances)
    names = missing_lights(goals, instances, understood.scene, roles, vocabulary) if new_lights else []
    parts = asks_for_backdrop(goals, instances, understood.scene, vocabulary)
    if parts and all(scene.may_have_backdrop for scene in scenes):
        scenes = [scene.with_backdrop() for scene in scenes]
    scenes = [scene.with_lights(names) if names else scene for scene in scenes]
    if goes_on:  # the added lights are off in the image that the sentence goes on from
        scenes = [replace(scene, instances=_unlit(scene.instances, names)) for scene in scenes]
    return StagedScenes(list(scenes), understood, goals)


def _about_added(understood: Understood) -> list[str]:
    """Targets for colors of light without a target of their own: in "another rim light, warm" the added light is warm."""
    added = [word.target for word in understood.words if word.target in _ADDED]
    if len(added) != 1:
        return []
    vocabulary = default_vocabulary()
    tones = {
        a.word
        for a in understood.parsed.attributes
        if a.kind == "tone" and not (a.cause or compares(a, (), vocabulary))
    }
    return [f"{w.key}={added[0]}" for w in understood.words if w.text in tones and not w.thing]


def _unlit(instances: Mapping[str, Instance], names: Collection[str]) -> dict[str, Instance]:
    """Parameters in which the power of the named lights is nearly zero."""
    power = {k: i for k, i in instances.items() if i.owner in names and i.parameter.family == "light/power"}
    return {**instances, **{key: replace(i, value=(OFF * i.reference,)) for key, i in power.items()}}


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
                link = LightLink(light, said.only, objects)
                scenes[number] = scenes[number].with_link(link, f"'{said.text}'")
    return replace(stage, scenes=scenes)


def _lights(said: SaidLink, scene: SceneData, stage: StagedScenes) -> list[str]:
    """The lights of a scene that a link's words mean: those that they name and added ones of the role, else all of the role."""
    playing = stage.lighting.parts if stage.lighting else {}
    added = [x.name for x in scene.lights if x.added and playing.get(x.name, x.role) == said.role]
    own = [x.name for x in scene.lights if not x.added and x.name in said.lights]
    parts = [name for name, part in playing.items() if part == said.role]
    return [*own, *added] or parts or [x.name for x in scene.lights if x.role == said.role]


def _is_locked(light: str, options: Options) -> bool:
    held = bool(options.groups) and LINKED.group not in options.groups
    return held or matches(f"light/{light}/{LINKED.name}", options.lock)
