# SPDX-License-Identifier: Apache-2.0
"""Wishes for the look of a reference image, and plans for these wishes, with or without words."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import replace
from functools import cache, cached_property
from pathlib import Path
from typing import Any

import torch
from torch import Tensor

from ..claims.measures import MEASURES
from ..goals.relative import FACTS
from ..goals.resolve import Goals
from ..goals.wish import Wish
from ..planning.advice import NO_PROMPTS, Advice, Advisor
from ..planning.picture_ranges import UNTOUCHED, plan_with_picture
from ..planning.types import Plan, PlanEntry
from ..render.film import Film
from ..render.surface.view_cache import GBuffer
from ..scene import SceneData
from ..schema import Instance, VibeError
from ..schema.options.table import TRAITS, Options
from ..schema.parameters import PICTURE
from ..words.lexicon.entries import Effect, parse_effect, read_wishes
from ..words.lexicon.quantities import ClaimText
from ..words.lexicon.vocabulary import default_vocabulary
from ..words.types import Attribute, Parsed, Part, SceneDescription
from . import light_probe, statements
from .files import ReferencePicture, read_reference
from .regions import PictureRegions, regions_of


class Reference:
    """The reference image, with the name of its file."""

    def __init__(self, picture: ReferencePicture, name: str, options: Options) -> None:
        self.picture, self.name, self._only = picture, name, options.like_only
        # True if it shows the artist's scene; None until `compare` is called
        self.same: bool | None = True if options.like_same else None

    @classmethod
    def of(cls, options: Options, scene: SceneData) -> Reference | None:
        """The image that the options name, or None; linear ones get the view transform. VibeError if unreadable."""
        if not options.like:
            return None
        path = Path(options.like)
        picture = read_reference(path)
        if picture.linear is not None:
            height, width = picture.linear.shape[:2]
            keys = [key for key in ("film/exposure", "film/gamma") if key in scene.instances]
            values = {key: torch.tensor(scene.instances[key].value) for key in keys}
            shown = Film(scene.film, (width, height)).show(torch.from_numpy(picture.linear), values)
            picture = replace(picture, display=shown.numpy())
        return cls(picture, path.name, options)

    @cached_property
    def display(self) -> Tensor:
        """(H, W, 3) as shown, sRGB-encoded."""
        return torch.from_numpy(self.picture.display)

    @property
    def traits(self) -> tuple[str, ...]:
        """The traits to take over: those that the artist chose, else all, but materials only from an image of the same scene."""
        return self._only or (TRAITS if self.same else TRAITS[:-1])

    def compare(self, rendered: Tensor) -> None:
        """Sets `same`, once: True if the reference shows the scene of the artist's own image `rendered` (H, W, 3)."""
        if self.same is None and not self.probe:
            self.same = statements.is_same(self.display, rendered)

    def wishes(self, instances: Collection[Instance], seen: Callable[[], GBuffer]) -> list[Wish]:
        """Wishes for the image's effects and measures, then for each statement; `seen` returns the scene's G-buffer."""
        if self.probe:
            return self._wishes(self.name, light_probe.effects_of(self.probe))
        regions = regions_of(self.picture.display, self.picture.alpha)
        if self.same:
            said = statements.statements_by_place(self.display, self.picture.alpha, seen())
        else:
            said = [each for each in statements.statements_of(regions) if each.trait in self.traits]
        measures = {each.claim.measure for each in said}
        effects = effects_of(instances, self.traits, measures, bool(self.same))
        found = self._wishes(self.name, [*map(str, effects), *map(str, _facts(regions))])
        for each in said:
            found += self._wishes(f"{self.name}: {each.word}", [str(each.claim)], each.material)
        return found

    def _wishes(self, word: str, texts: list[str], material: str = "") -> list[Wish]:
        """Wishes from `texts` (effects and claims), by quantity; `word` names them; `material`: their target, or ""."""
        said = _attribute(word, self.name, material)
        return [Wish(said, w.quantity, effects=w.effects, claims=w.claims) for w in read_wishes(texts)]

    @cached_property
    def probe(self) -> light_probe.LightProbe | None:
        """The light of a linear panorama; None for other images."""
        linear = self.picture.linear
        return light_probe.probe(linear) if self.picture.panorama and linear is not None else None


@cache
def _attribute(word: str, name: str, material: str) -> Attribute:
    """The attribute of statements with one word; cached, because written goals list attributes by identity."""
    owners = (material,) if material else ()
    return Attribute(word, name, PICTURE, "whole", "whole", owners=owners, thing=material)


def _facts(regions: PictureRegions) -> Iterator[ClaimText]:
    """Claims of weight 0 that record measures of the image and, if one is found, of its subject."""
    parts: tuple[Part, ...] = ("picture", "subject") if regions.subject else ("picture",)
    for part in parts:
        where = regions.region(part)
        for measure in FACTS if where is not None else ():
            own = MEASURES[measure].take(regions.picture, where).tolist()
            yield ClaimText(part, measure, tuple(own), tuple(own), weight=0.0)


# Plans for an image in the place of words, and for words with it


class LikeAdvisor:
    """Adds the image's wishes to those of `words`, the words' advisor or None; `seen` returns the scene's G-buffer."""

    def __init__(self, reference: Reference, words: Advisor | None, seen: Callable[[], GBuffer]) -> None:
        self._reference, self._words, self._seen = reference, words, seen
        self._wishes: list[Wish] = []

    def advise(self, display: Any, instances: Mapping[str, Instance], scene: SceneDescription) -> Advice:
        """As `Advisor.advise`. Raises VibeError if no word of the prompt is known, or the picture can change nothing."""
        if self._words is None:  # with words, the image is only their starting point
            self._reference.compare(display)
            plan = Plan({key: PlanEntry.kept(each, UNTOUCHED) for key, each in instances.items()})
            advice = Advice(Goals(Parsed("")), NO_PROMPTS, plan, source="the picture")
        else:
            advice = self._words.advise(display, instances, scene)
        self._wishes = self._wishes or self._reference.wishes(instances.values(), self._seen)
        goals = advice.goals.with_picture(self._wishes)
        plan = plan_with_picture(advice.plan, goals, instances, default_vocabulary())
        moving = {key for key, entry in plan.items() if entry.priority is not None}
        if not (moving or self._words):
            remedy = "Unlock something, allow more groups, or name more in --like-only."
            raise VibeError("Nothing that the picture speaks of may change in this scene.", remedy)
        name = self._reference.name
        if self._reference.probe:
            note = light_probe.summary_of(self._reference.probe, name)
        elif self._reference.same:
            note = f"{name} shows this very scene: it is compared place by place."
        else:
            note = f"{name} shows something else: its look is taken over, not its content."
        # Parameters that stay because an image does not determine them
        families = {i.parameter.family for key, i in instances.items() if key not in moving and not i.locked}
        stays = (f"{family}: {why}" for family, why in _TABLES["stays"].items() if family in families)
        notes = (*plan.notes, note, *(f"Kept as you have it, {text}." for text in stays))
        return replace(advice, goals=goals, plan=Plan(dict(plan), notes))


_TABLES = tomllib.loads(Path(__file__).with_name("like.toml").read_text("utf-8"))


def _effects(table: str) -> dict[str, Effect]:
    return {effect.family: effect for effect in map(parse_effect, _TABLES[table])}


def effects_of(
    instances: Collection[Instance], traits: Collection[str], measures: Collection[str], same: bool
) -> list[Effect]:
    """Effects that an image may have on parameters, for the `traits` to take over.

    For an image of another scene (`same` is False), effects that need a measure not among `measures` are left out.
    """
    table = _effects("another_scene")
    free = {i.parameter.family for i in instances if not i.locked}
    if same:
        table |= _effects("same_scene")
        table.pop("film/grade_exposure")
    elif free & {"light/color", "world/color"} and {"light", "palette"} & {*traits}:
        table |= _effects("beside_light")
    found = []
    for family, effect in table.items():
        group, need = family.partition("/")[0], "" if same else _TABLES["needs"].get(family, "")
        colors = group in ("light", "world") or family == "film/saturation"  # they serve the palette, too
        serves = _TABLES["traits"][group] in traits or ("palette" in traits and colors)
        if serves and need in ("", *measures):
            found.append(effect)
    return found
