# SPDX-License-Identifier: Apache-2.0
"""The effects of wishes that act in a scene: on what, in which order, and those that a rig leaves."""

from collections.abc import Iterator
from dataclasses import replace

from ..color.floats import lab_from_srgb
from ..goals.resolve import Goals, Lost, contradicts
from ..goals.wish import Wish
from ..words.lexicon.entries import Effect
from ..words.lexicon.quantities import quantities
from ..words.lexicon.vocabulary import Vocabulary
from .owners import Owners
from .types import LightPlan

_PALE, _WHITE = 80.0, 93.0  # L* of pale and of white surroundings
_MAIN = 1  # priority of what a word is mainly about
_LIT = ("direction", "hardness", "light_color", "key_to_rest", "brightness")  # of light: a rig gives them
_SHEDS = ("light/", "world/", "volume/", "film/vignette", "film/exposure")  # families that a rig sets itself
_BESIDE_LIGHT = 0.5  # strength of a mood's grade where a rig gives it its light
STAGES = 3  # how many there are, see `stage_of`
Act = tuple[Wish, Effect]  # an effect, with the wish that it serves and with what that describes in the scene


def acts(goals: Goals, vocabulary: Vocabulary, owners: Owners) -> list[Act]:
    """The effects of all wishes, in the order of the prompt."""
    wishes = (wish for wish in goals.wishes if not wish.of_picture)
    return [(wish, effect) for wish in wishes for effect in _effects(wish, vocabulary, owners)]


def _effects(wish: Wish, vocabulary: Vocabulary, owners: Owners) -> tuple[Effect, ...]:
    """The effects of a wish: a color of surroundings that hide the world is painted on them alone."""
    color, kind = wish.attribute.color, wish.attribute.kind
    if color and wish.effects and kind == "surroundings" and owners.world_is_hidden():
        light = lab_from_srgb(color)[0]
        hidden = "hidden_white" if light > _WHITE else "hidden_pale" if light > _PALE else "hidden"
        return vocabulary.painted[hidden]
    return vocabulary.painted[kind] if color and wish.effects and kind == "world" else wish.effects


def goals_without_rig(goals: Goals, light: LightPlan) -> Goals:
    """Goals in which a rig takes the place of what it stands for: it serves its words, and it alone sets the light of a mood.

    What an image has to show of it comes before a reference image. Of grade words what they do to the grade is left, and of moods half of that; the rig says what is to be seen of them.
    """
    if not (light.served or light.shown):
        return goals
    every = (*goals.wishes, *(each.wish for each in goals.lost))
    lit = [wish for wish in every if wish.attribute in light.served and wish.quantity in _LIT]
    beaten = {
        id(w): first for w in goals.wishes for first in (*lit, *light.shown) if _outshone(w, first, light)
    }
    left = tuple(_left(wish, light) for wish in goals.wishes if id(wish) not in beaten)
    lost = tuple(Lost(wish, beaten[id(wish)]) for wish in goals.wishes if id(wish) in beaten)
    return replace(goals, wishes=left, lost=(*goals.lost, *lost), shown=light.shown)


def _outshone(wish: Wish, served: Wish, light: LightPlan) -> bool:
    """True if a word that is about no light contradicts the light of a rig: an "old" well in moonlight is not lit warmly."""
    if wish.of_picture or served in light.shown:
        return wish.of_picture and contradicts(served, wish)
    about_light = wish.attribute.slot == "lighting" or wish.attribute.color or wish.attribute in light.served
    return not about_light and wish.quantity in _LIT and contradicts(served, wish)


def _left(wish: Wish, light: LightPlan) -> Wish:
    """The part of a wish that a rig leaves."""
    served = wish.attribute in light.served
    if not (served or wish.implied):
        return wish
    graded = tuple(e for e in wish.effects if not e.family.startswith(_SHEDS))
    if served and wish.attribute.slot != "grade":
        graded = ()
    strength = _BESIDE_LIGHT * wish.strength if wish.implied else wish.strength
    return replace(wish, effects=graded, claims=(), strength=strength)


def grade_of(light: LightPlan) -> Iterator[Act]:
    """The film's effects of a rig, with their wishes."""
    for attribute, effect in light.grade:
        quantity = quantities().of_parameter(effect.owner, effect.family, effect.mode)
        yield Wish(attribute, quantity, effects=(effect,), strength=attribute.strength), effect


def is_usual(wish: Wish, effect: Effect) -> bool:
    """True if a place only usually has it: the sky of a garden is blue, but not at night."""
    return wish.attribute.slot == "setting" and effect.weak and effect.priority > _MAIN


def stage_of(effect: Effect) -> int:
    """The stage of an effect, the least first: the world's strength for its color and for the key, glows for surfaces."""
    if effect.color == "own":
        return 2
    return 1 if effect.mode == "share" or effect.family == "world/strength" else 0
