# SPDX-License-Identifier: Apache-2.0
"""The effects of wishes in a scene, the stages in which they are applied, and the goals that remain next to a rig."""

from collections.abc import Iterator
from dataclasses import replace

from ..color.floats import lab_from_srgb
from ..goals.resolve import Goals, Lost, contradicts
from ..goals.wish import Wish
from ..words.lexicon.entries import Effect
from ..words.lexicon.quantities import quantities
from ..words.lexicon.vocabulary import default_vocabulary
from .owners import Owners
from .types import LightPlan

_LIT = ("direction", "hardness", "light_color", "key_to_rest", "brightness")  # quantities that a rig decides
STAGES = 3  # number of stages, see `stage_of`
Act = tuple[Wish, Effect]  # an effect, with the wish that it comes from


def acts(goals: Goals, owners: Owners) -> list[Act]:
    """(wish, effect) for each effect of the words' wishes, in the order of the prompt."""
    found, vocabulary = list[Act](), default_vocabulary()
    for wish in (wish for wish in goals.wishes if not wish.of_picture):
        color, kind, effects = wish.attribute.color, wish.attribute.kind, wish.effects
        if color and effects and kind == "surroundings" and owners.world_is_hidden():
            # Surfaces hide the world: the color is painted on them alone.
            light = lab_from_srgb(color)[0]
            hidden = "hidden_white" if light > 93.0 else "hidden_pale" if light > 80.0 else "hidden"
            effects = vocabulary.painted[hidden]
        elif color and effects and kind == "world":
            effects = vocabulary.painted[kind]
        found += [(wish, effect) for effect in effects]
    return found


def goals_without_rig(goals: Goals, light: LightPlan) -> Goals:
    """Goals without the wishes that a rig, `light`, replaces, and with the rig's own wishes for the image as `shown`.

    Words that ask for the rig, and moods, lose their effects on light and their claims. Grade words keep their effects
    on the film. Wishes that moods imply keep all other effects at half strength. Wishes that contradict the rig's light
    are overridden: those of a reference image, and those of words that are not about light.
    """
    if not (light.served or light.shown):
        return goals
    every = (*goals.wishes, *(each.wish for each in goals.lost))
    lit = [wish for wish in every if wish.attribute in light.served and wish.quantity in _LIT]
    beaten = {id(w): first for w in goals.wishes for first in (*lit, *light.shown) if _outshone(w, first, light)}
    left = []
    for wish in (wish for wish in goals.wishes if id(wish) not in beaten):
        served = wish.attribute in light.served
        if served or wish.implied:
            sheds = "light/", "world/", "volume/", "film/vignette", "film/exposure"  # families that a rig sets itself
            keeps = not served or wish.attribute.slot == "grade"
            effects = tuple(e for e in wish.effects if keeps and not e.family.startswith(sheds))
            strength = wish.strength * (0.5 if wish.implied else 1.0)
            wish = replace(wish, effects=effects, claims=(), strength=strength)
        left.append(wish)
    lost = tuple(Lost(wish, beaten[id(wish)]) for wish in goals.wishes if id(wish) in beaten)
    return replace(goals, wishes=tuple(left), lost=(*goals.lost, *lost), shown=light.shown)


def _outshone(wish: Wish, served: Wish, light: LightPlan) -> bool:
    """True if a rig's wish, `served`, overrides another wish: the light of an "old" well in moonlight is not warm."""
    if wish.of_picture or served in light.shown:
        return wish.of_picture and contradicts(served, wish)
    about_light = wish.attribute.slot == "lighting" or wish.attribute.color or wish.attribute in light.served
    return not about_light and wish.quantity in _LIT and contradicts(served, wish)


def grade_of(light: LightPlan) -> Iterator[Act]:
    """The rig's effects on the film, each with a wish of the word that it belongs to."""
    for attribute, effect in light.grade:
        quantity = quantities().of_parameter(effect.owner, effect.family, effect.mode)
        yield Wish(attribute, quantity, effects=(effect,), strength=attribute.strength), effect


def is_usual(wish: Wish, effect: Effect) -> bool:
    """True if an effect describes what a place usually has: the sky of a garden is blue, but not at night."""
    return wish.attribute.slot == "setting" and effect.weak and effect.priority > 1


def stage_of(effect: Effect) -> int:
    """The stage, 0 to 2, in which an effect is applied: after those that it depends on."""
    if effect.color == "own":
        return 2
    # Shares of the key's light depend on the key, and the world's strength depends on its color.
    return 1 if effect.mode == "share" or effect.family == "world/strength" else 0
