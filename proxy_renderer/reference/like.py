# SPDX-License-Identifier: Apache-2.0
"""A reference image, its wishes, their effects, and plans for it in the place of words or with them."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import replace
from functools import cache, cached_property
from pathlib import Path
from typing import Any

import numpy as np
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
from ..words.lexicon.user_words import default_vocabulary
from ..words.types import Attribute, Parsed, Part, SceneDescription
from . import light_probe, statements
from .files import ReferencePicture, read_reference
from .regions import PictureRegions, regions_of


class Reference:
    """The picture that a look is taken from, named by its file."""

    def __init__(self, picture: ReferencePicture, name: str, options: Options) -> None:
        self.picture, self.name, self._only = picture, name, options.like_only
        # whether it shows the artist's scene; None before the artist's own image was seen
        self.same: bool | None = True if options.like_same else None

    @classmethod
    def of(cls, options: Options, scene: SceneData) -> Reference | None:
        """The picture that the options name, or None, linear light as the scene shows its own; raises VibeError if unreadable."""
        if not options.like:
            return None
        path = Path(options.like)
        picture = read_reference(path)
        if picture.linear is not None:
            picture = replace(picture, display=_shown(picture.linear, scene))
        return cls(picture, path.name, options)

    @cached_property
    def display(self) -> Tensor:
        """(H, W, 3) as shown, sRGB-encoded."""
        return torch.from_numpy(self.picture.display)

    @property
    def traits(self) -> tuple[str, ...]:
        """The traits that are taken over: what was asked for, else all but materials, which only a picture of this scene tells."""
        return self._only or (TRAITS if self.same else TRAITS[:-1])

    def compare(self, rendered: Tensor) -> None:
        """Finds out, once, whether it shows the same scene as the artist's own image (H, W, 3)."""
        if self.same is None and not self.probe:
            self.same = statements.is_same(self.display, rendered)

    def wishes(self, instances: Collection[Instance], seen: Callable[[], GBuffer]) -> list[Wish]:
        """Wishes for what may change and what the picture has, then one for each statement; `seen` is asked for only of the same scene."""
        if self.probe:
            return self._wishes(self.name, light_probe.effects_of(self.probe))
        if self.same:
            said = statements.statements_by_place(self.display, self.picture.alpha, seen())
        else:
            said = [each for each in statements.statements_of(self._regions) if each.trait in self.traits]
        measures = {each.claim.measure for each in said}
        effects = effects_of(instances, self.traits, measures, bool(self.same))
        found = self._wishes(self.name, [*map(str, effects), *map(str, self._facts())])
        for each in said:
            found += self._wishes(f"{self.name}: {each.word}", [str(each.claim)], each.material)
        return found

    def _wishes(self, word: str, texts: list[str], material: str = "") -> list[Wish]:
        said = _word(word, self.name, material)
        found = read_wishes(texts)
        return [Wish(said, each.quantity, effects=each.effects, claims=each.claims) for each in found]

    @cached_property
    def probe(self) -> light_probe.LightProbe | None:
        """The light of a panorama; None for a picture that has a frame."""
        linear = self.picture.linear
        return light_probe.probe(linear) if self.picture.panorama and linear is not None else None

    @cached_property
    def _regions(self) -> PictureRegions:
        return regions_of(self.picture.display, self.picture.alpha)

    def _facts(self) -> Iterator[ClaimText]:
        """Claims of what the picture itself has, as far as a flat picture tells."""
        parts: tuple[Part, ...] = ("picture", "subject") if self._regions.subject else ("picture",)
        for part in parts:
            where = self._regions.region(part)
            for measure in FACTS if where is not None else ():
                own = MEASURES[measure].take(self._regions.picture, where).tolist()
                yield ClaimText(part, measure, tuple(own), tuple(own), weight=0.0)


@cache
def _word(word: str, name: str, material: str) -> Attribute:
    """The one word for all that is said with it."""
    owners = (material,) if material else ()
    return Attribute(word, name, PICTURE, "whole", "whole", owners=owners, thing=material)


def _shown(linear: np.ndarray, scene: SceneData) -> np.ndarray:
    keys = [key for key in ("film/exposure", "film/gamma") if key in scene.instances]
    values = {key: torch.tensor(scene.instances[key].value) for key in keys}
    film = Film(scene.film, (linear.shape[1], linear.shape[0]))
    return film.show(torch.from_numpy(linear), values).numpy()


# Plans for an image in the place of words, and for words with it


class LikeAdvisor:
    """Adds a picture's wishes to those of words, where there is an advisor for them; `seen` is what the camera sees."""

    def __init__(self, reference: Reference, words: Advisor | None, seen: Callable[[], GBuffer]) -> None:
        self._reference, self._words, self._seen = reference, words, seen
        self._wishes: list[Wish] = []

    def advise(self, display: Any, instances: Mapping[str, Instance], scene: SceneDescription) -> Advice:
        """As `Advisor.advise`. Raises VibeError if no word of the prompt is known, or the picture can change nothing."""
        if self._words is None:  # beside words it is no goal, but where they start from
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
        notes = (*plan.notes, self._found(), *kept_values(instances, moving))
        return replace(advice, goals=goals, plan=Plan(dict(plan), notes))

    def _found(self) -> str:
        name, same = self._reference.name, self._reference.same
        if self._reference.probe:
            return light_probe.summary_of(self._reference.probe, name)
        if same:
            return f"{name} shows this very scene: it is compared place by place."
        return f"{name} shows something else: its look is taken over, not its content."


def _effects(*texts: str) -> dict[str, Effect]:
    """Family -> what a picture may do to its values, written as in the vocabulary; a bare range holds the artist's value too."""
    return {effect.family: effect for effect in map(parse_effect, texts)}


_ANOTHER_SCENE = _effects(
    "lights/power times 0.0625..16 !0", "lights/strength times 0.0625..16 !0", "lights/color 0.08..1 !1",
    "lights/azimuth plus -75..75 !3", "lights/elevation plus -35..35 !3",
    "world/strength 0..4 !1", "world/color 0..1 !1", "world/tint 0.05..2 !1",
    "world/backdrop_strength 0..4 !1", "world/backdrop_color 0..1 !1", "world/backdrop_tint 0.05..2 !1",
    "volume/density 0..2 !2", "volume/color 0.1..1 !3",
    "film/grade_exposure -2..2 !2", "film/lift 0.9..1.1 !2", "film/midtone 0.75..1.3 !2", "film/gain 0.7..1.3 !2",
    "film/contrast 0.7..1.4 !2", "film/saturation 0..1.4 !2", "film/grade_gamma 0.6..1.7 !3", "film/vignette 0..1 !3",
    "material/base_color 0..1 !2", "material/tint 0.05..2 !2",
)  # fmt: skip
"""For a picture of another scene."""
_NEEDS = {
    "light/azimuth": "from_right", "light/elevation": "from_above", "volume/density": "veil", "volume/color": "veil",
    "film/vignette": "vignette",
}  # fmt: skip
"""Family -> the measure that such a picture has to claim for it."""

_SAME_SCENE = _ANOTHER_SCENE | _effects(
    "lights/power times 0.01..100 !0", "lights/strength times 0.01..100 !0", "lights/color 0..1 !1",
    "lights/temperature 1500..15000 !1", "lights/size times 0.1..10 !3", "lights/angle 0..60 !3",
    "lights/azimuth plus -180..180 !0", "lights/elevation -20..89 !0",
    "world/strength 0..10 !1", "world/rotation plus -180..180 !1",
    "volume/density 0..4 !2", "volume/color 0..1 !3", "volume/falloff 0..4 !3",
    "film/exposure plus -4..4 !2", "film/lift 0.7..1.3 !3", "film/midtone 0.6..1.5 !3", "film/gain 0.5..1.6 !3",
    "film/contrast 0.5..2 !2", "film/saturation 0..2 !2", "film/vignette 0..1 !3", "film/glare 0..1 !4",
    "material/roughness 0..1 !4", "material/metallic 0..1 !5",
)  # fmt: skip
"""The same for a picture of the artist's scene. What does the same as exposure, in the compositor, stays."""
_TRAITS = {"light": "light", "world": "light", "volume": "air", "film": "grade", "material": "materials"}
"""Group of parameters -> the trait of a picture that they serve."""

_BESIDE_LIGHT = _effects(
    "film/lift 0.98..1.08 !2", "film/midtone 0.85..1.2 !2", "film/gain 0.8..1.25 !2",
    "film/contrast 0.7..1.3 !2",
)  # fmt: skip
"""The grade where the light's color may change, too: what tints gray things is light. A grade that cancels it tints paint, and
a lift that cuts off more colors the shadows."""

_STAYS = {
    "film/exposure": "exposure looks like more or less light in the scene",
    "film/gamma": "gamma looks like the grade's own",
    "light/temperature": "a warm lamp looks like one of a warm color",
    "light/size": "how soft shadows are cannot be told from a flat picture",
    "light/distance": "a lamp that is nearer looks like a stronger one",
    "volume/anisotropy": "where fog scatters looks like more or less of it",
}
"""Families that stay as the artist has them, and why."""


def effects_of(
    instances: Collection[Instance], traits: Collection[str], measures: Collection[str], same: bool
) -> list[Effect]:
    """The effects that a picture lets act for traits that are taken over, where these measures are claimed of an image like it."""
    table = dict(_SAME_SCENE if same else _ANOTHER_SCENE)
    free = {i.parameter.family for i in instances if not i.locked}
    if same:
        table.pop("film/grade_exposure")
    elif free & {"light/color", "world/color"} and {"light", "palette"} & {*traits}:
        table |= _BESIDE_LIGHT
    return [
        effect
        for family, effect in table.items()
        if _serves(family, traits) and (same or _NEEDS.get(family, "") in ("", *measures))
    ]


def kept_values(instances: Mapping[str, Instance], entries: Collection[str]) -> tuple[str, ...]:
    """Sentences on the families that stay because a picture cannot tell them."""
    families = {i.parameter.family for key, i in instances.items() if key not in entries and not i.locked}
    said = (f"{family}: {why}" for family, why in _STAYS.items() if family in families)
    return tuple(f"Kept as you have it, {text}." for text in said)


def _serves(family: str, traits: Collection[str]) -> bool:
    """True if values of a family serve what is taken over; the colors of light serve a palette, too."""
    group = family.partition("/")[0]
    colors = group in ("light", "world") or family == "film/saturation"
    return _TRAITS[group] in traits or ("palette" in traits and colors)
