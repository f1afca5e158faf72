# SPDX-License-Identifier: Apache-2.0
"""The stage of a vibe: the words, read once against the scene, and the scene with the lights that the words ask for."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from ..claims.claim import Claim
from ..claims.from_goals import claims_of
from ..goals.further import further
from ..goals.relative import compares
from ..goals.resolve import Goals, goals_or_why
from ..goals.written import WrittenGoals
from ..planning.acting import goals_without_rig
from ..planning.advice import OfflineAdvisor
from ..planning.support import asks_for_backdrop, missing_lights
from ..planning.types import LightPlan
from ..rigs.chosen import chosen_rig
from ..rigs.combined import added_to_scene
from ..rigs.lighting import OFF, Lighting, lighting
from ..scene import SceneData
from ..schema import VibeError, matches, sentences
from ..schema.added_lights import ADDED_LIGHTS, light_name
from ..schema.light_links import LINKED, LightLink
from ..schema.messages import Options
from ..words.lexicon.rigs import rig_table
from ..words.lexicon.vocabulary import default_vocabulary
from ..words.parser import Understood
from ..words.types import Attribute, SaidLink, SceneDescription
from .scene_facts import described

_SPARE = {light_name(part, "AREA") for part in ("key", "fill", "rim", "kicker", "bounce")}
"""Lights that single words such as "rim light" may need without a rig; the last two if the scene has such a light."""


@dataclass(frozen=True)
class StagedScenes:
    """The scenes and goals of a vibe."""

    scenes: list[SceneData]  # the shots, with the lights that the words ask for and the scene lacks
    understood: Understood  # the words, read against the scene
    goals: Goals | VibeError  # the words' wishes; if nothing is understood, the error that says why
    lighting: Lighting | None = None  # the rig that the words ask for, set up; None if they ask for none

    @property
    def plan(self) -> LightPlan | None:
        """The plan of the rig's lights; None without a rig."""
        return self.lighting.plan if self.lighting else None

    @property
    def advisor(self) -> OfflineAdvisor:
        """The planner for these goals and the rig."""
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
    """The shots with the lights and the backdrop that the words ask for, as a rig or one by one.

    Args:
        scenes: The shots. The first decides on lights for all; a backdrop is added to all shots or to none.
        prompt: The words; with `goes_on` a further sentence, whose goals are relative to the present image.
        target: "WORD=NAME" each: the object, material or light in the scene that a word means, as "copper=Cup".
        written: Goals that replace those of the prompt.

    Raises:
        VibeError: A target names nothing in the scene, or a further sentence only describes the present image.
    """
    prompt, factor, compared = sentences.plain(prompt) if goes_on else (prompt, 0.0, "")
    anew = goes_on and new_lights and sentences.adds_light(prompt)
    understood = Understood(prompt, described(*scenes), target)
    if anew and (added := _about_added(understood)):
        understood = Understood(prompt, described(*scenes), [*target, *added])
    staged = [scene.with_copies(understood.scene.copies) for scene in scenes]
    goals = written.within(understood.scene) if written else goals_or_why(understood)
    if isinstance(goals, VibeError):
        return StagedScenes(staged, understood, goals)
    vocabulary = default_vocabulary()
    if goes_on:
        goals = further(goals, vocabulary, understood.scene, factor, compared)
        if not (goals.wishes or goals.lost or goals.parsed.links):
            problem = " ".join([f"Nothing in '{prompt}' can be changed.", *goals.parsed.notes])
            return StagedScenes(staged, understood, VibeError(problem, sentences.SAY_WHAT))
    chosen = chosen_rig(goals, rig_table(), vocabulary, anew)
    if chosen and goes_on and _names_only_a_source(chosen.served):
        chosen = replace(chosen, rig=added_to_scene(chosen.rig))
    if chosen:
        rig = lighting(staged, goals.parsed, chosen, new_lights)
        return StagedScenes(rig.scenes, understood, goals, rig)
    scenes = _with_needed(staged, goals, understood.scene, new_lights, goes_on)
    return StagedScenes(scenes, understood, goals)


def _with_needed(
    scenes: list[SceneData], goals: Goals, words: SceneDescription, new_lights: bool, goes_on: bool
) -> list[SceneData]:
    """The shots with the standby lights and the backdrop that single words need."""
    roles = {x.name: ADDED_LIGHTS[x.name].role for x in scenes[0].standby.lights if x.name in _SPARE}
    instances = dict(scenes[0].instances)
    names = missing_lights(goals, instances, words, roles) if new_lights else []
    parts = asks_for_backdrop(goals, instances, words)
    if parts and all(scene.may_have_backdrop for scene in scenes):
        scenes = [scene.with_backdrop() for scene in scenes]
    scenes = [scene.with_lights(names) if names else scene for scene in scenes]
    for n, scene in enumerate(scenes if goes_on else ()):
        # The added lights are off in the image that the sentence goes on from.
        power = {k: i for k, i in scene.instances.items() if i.owner in names and i.parameter.family == "light/power"}
        off = {key: replace(i, value=(OFF * i.reference,)) for key, i in power.items()}
        scenes[n] = replace(scene, instances={**scene.instances, **off})
    return scenes


def _names_only_a_source(served: Iterable[Attribute]) -> bool:
    """True if all rigs that the words name are sources of light, as a candle: none is an hour, a style or a place."""
    rigs = rig_table().rigs
    kinds = {rigs[a.entry].kind for a in served if a.entry in rigs and not rigs[a.entry].adds}
    return kinds == {"source"}


def _about_added(understood: Understood) -> list[str]:
    """Targets "WORD=NAME" for colors of light without one: in "another rim light, warm" the added light is warm."""
    added = [word.target for word in understood.words if word.target in ("rim light", "fill light")]
    if len(added) != 1:
        return []
    tones = [a for a in understood.parsed.attributes if a.kind == "tone" and not a.cause]
    said = {tone.word for tone in tones if not compares(tone, (), default_vocabulary())}
    return [f"{w.key}={added[0]}" for w in understood.words if w.text in said and not w.thing]


def linked(stage: StagedScenes, options: Options) -> StagedScenes:
    """The stage with the light links that the words ask for; lights that the artist has locked are left out."""
    if isinstance(stage.goals, VibeError):
        return stage
    notes, scenes = stage.goals.parsed.notes, list(stage.scenes)
    held = bool(options.groups) and LINKED.group not in options.groups
    for said in stage.goals.parsed.links:
        names = {name for scene in scenes for name in _lights(said, scene, stage)}
        free = {name for name in names if not (held or matches(f"light/{name}/{LINKED.name}", options.lock))}
        if not free:
            why = "it is locked" if names else f"there is no {said.role} light"
            notes.append(f"'{said.text}' is not used: {why}.")
        for number, scene in enumerate(scenes):
            objects = tuple(o.name for o in scene.objects if o.name in said.objects)
            for light in (x.name for x in scene.lights if x.name in free and objects):
                scenes[number] = scenes[number].with_link(LightLink(light, said.only, objects), f"'{said.text}'")
    return replace(stage, scenes=scenes)


def _lights(said: SaidLink, scene: SceneData, stage: StagedScenes) -> list[str]:
    """Names of the lights of a scene that the words of a link mean.

    They are lights that the words name, and added ones of the words' role; without such, all lights of this role.
    """
    playing = stage.lighting.parts if stage.lighting else {}
    added = [x.name for x in scene.lights if x.added and playing.get(x.name, x.role) == said.role]
    own = [x.name for x in scene.lights if not x.added and x.name in said.lights]
    parts = [name for name, part in playing.items() if part == said.role]
    return [*own, *added] or parts or [x.name for x in scene.lights if x.role == said.role]
