# SPDX-License-Identifier: Apache-2.0
"""What the words of a prompt wish: effects, in the order in which they can be decided."""

from __future__ import annotations

from dataclasses import replace

from ..color.floats import chroma, lab_from_srgb
from ..color.shades import hue_apart, warm
from ..prompt.lexicon.entries import OWNERS, Effect
from ..prompt.lexicon.vocabulary import Vocabulary
from ..prompt.types import Attribute, Parsed
from ..schema import FAMILIES, Values
from ..schema.means import may_serve
from .owners import Owners

_PALE, _WHITE = 80.0, 93.0  # L* of pale and of white surroundings
_HIDDEN = 60.0  # degrees of hue between a thing and its light from which neither looks as named
_MAIN = 1  # priority of what a word is mainly about
_WHITE_LIGHT = (5500.0, 7500.0)  # kelvins between which light is neither warm nor cool
_TINTED = 8.0  # chroma from which light has a color
_OPPOSED = 0.5  # cosine with cool light from which a color is no warm one
STAGES = 3
"""How many there are, see `stage_of`."""


class Wishes:
    """Attributes with what they ask for."""

    def __init__(self, parsed: Parsed, vocabulary: Vocabulary, owners: Owners) -> None:
        self._parsed, self._vocabulary, self._owners = parsed, vocabulary, owners

    def all(self) -> list[tuple[Attribute, Effect]]:
        """Each with its attribute, in the order of the prompt."""
        wishes = [(a, e) for a in self._shared_out() for e in self.effects(a) if _may_act(e, a)]
        strong = [(a, e) for a, e in wishes if not e.weak]
        if any(a.slot == "lighting" and not a.cause and e.name == "temperature" for a, e in strong):
            # "Street lamps on a rainy night": a light that is named is not the neon that such nights have.
            wishes = [w for w in wishes if not (w[0].cause and w[1].family == "light/color")]
        gels = [a.color for a, _ in wishes if a.color and a.kind == "light" and not a.of_one_light]
        return [(a, e) for a, e in wishes if a.of_one_light or not any(_opposes(e, gel) for gel in gels)]

    def _said(self) -> list[Attribute]:
        return [a for a in self._parsed.attributes if a not in self._parsed.overruled]

    def _shared_out(self) -> list[Attribute]:
        """What is not overruled; the world has the color of a light that is told apart and that the scene lacks."""
        said = self._said()
        gels = [a for a in said if a.color and a.kind == "light" and not a.role and not a.cause]
        shared: dict[int, Attribute] = {}
        if any(a.lamp for a in gels):
            shared = {
                id(a): replace(a, kind="world")
                for a in gels
                if a.lamp and not self._owners.lights.numbered[a.lamp]
            }
        elif gels and self._would_hide(gels[0], said):
            shared = {id(gels[0]): replace(gels[0], role="others")}
        return [shared.get(id(a), a) for a in said]

    def _one_light(self) -> bool:
        return len(self._owners.lights.every) <= len(self._owners.lights.key)

    def _would_hide(self, gel: Attribute, said: list[Attribute]) -> bool:
        """Whether a color of light, without a direction, leaves nothing of the subject's: "orange pumpkin, purple light".

        The key then stays for the one, and the other lights get the other.
        """
        entries = [self._vocabulary.entries[a.entry] for a in said if not a.color and not a.cause]
        directed = any(
            e.owner in ("light", "key") and e.name == "azimuth" for n in entries for e in n.effects
        )
        colors = [a.color for a in said if a.color and a.kind == "subject" and not a.negated]
        if directed or not colors or self._one_light():
            return False
        assert gel.color
        return all(c and hue_apart(c, gel.color) > _HIDDEN for c in colors)

    def effects(self, attribute: Attribute) -> list[Effect]:
        """What a word does; negated, what it forbids or the mild opposite."""
        if attribute.color:
            kind = attribute.kind
            if kind == "surroundings" and self._owners.world_is_hidden():
                light = lab_from_srgb(attribute.color)[0]
                kind = "hidden_white" if light > _WHITE else "hidden_pale" if light > _PALE else "hidden"
            return [] if attribute.negated else list(self._vocabulary.painted.get(kind, ()))
        entry = self._vocabulary.entries[attribute.entry]
        if not attribute.negated:
            return list(entry.effects)
        if entry.never:
            return list(entry.never)
        if entry.opposite:
            return list(self._vocabulary.entries[entry.opposite].effects)
        return [
            Effect(e.owner, e.name, "", (n,), (n,)) for e in entry.effects if (n := _neutral(e)) is not None
        ]


def _may_act(effect: Effect, attribute: Attribute) -> bool:
    """Whether an effect is a means that its word has: no mood paints."""
    return may_serve(OWNERS[effect.owner], attribute.slot, attribute.cause)


def is_usual(attribute: Attribute, effect: Effect) -> bool:
    """Whether a place only usually has it: the sky of a garden is blue, but not at night."""
    return attribute.slot == "setting" and effect.weak and effect.priority > _MAIN


def _opposes(effect: Effect, gel: Values) -> bool:
    """Whether what a word is not mainly about makes light warm that is said to be blue, or cool that is said to be orange."""
    if effect.name != "temperature" or effect.mode or effect.priority <= _MAIN:
        return False
    kelvin, lab = (effect.lower[0] + effect.upper[0]) / 2, lab_from_srgb(gel)
    asks = 1 if kelvin < _WHITE_LIGHT[0] else -1 if kelvin > _WHITE_LIGHT[1] else 0
    return chroma(lab) > _TINTED and asks * warm(*lab[1:]) < -_OPPOSED


def stage_of(effect: Effect) -> int:
    """What has to wait for what; the least comes first.

    The world's strength for its color and for the key, glows for surfaces.
    """
    if effect.color == "own":
        return 2
    return 1 if effect.mode == "share" or effect.family == "world/strength" else 0


def _neutral(effect: Effect) -> float | None:
    """The value at which an effect does nothing, where a parameter has one."""
    measured = effect.mode == "" and len(effect.lower) == 1 and OWNERS[effect.owner] != "light"
    return FAMILIES[effect.family].default if measured else None
