# SPDX-License-Identifier: Apache-2.0
"""Look words that no noun claims: they are the subject's, the picture's, or of two colors one is the surroundings'."""

from __future__ import annotations

from dataclasses import replace

from ..color.floats import chroma, lab_from_srgb
from .lexicon.vocabulary import Vocabulary
from .things import Thing, Word
from .types import Attribute

BOUND_SLOTS = ("finish", "material", "color", "setting")
"""Slots whose words wait for the noun that they describe; the others describe the whole picture."""
_TONED = ("muted", "faded", "dusty", "dull", "smoky", "murky", "stormy", "moody")
"""Shades that pictures have rather than things."""
_LIT = (*_TONED, "cold", "cool", "icy", "warm", "gloomy")
"""Shades that light has too, where what is said before is about light or air."""
_VIVID = 20.0  # chroma of colors that light may have
_CLEAR = 0.02  # density of air that has no color


class Unclaimed:
    """Collects them while a text is read, and decides at its end.

    Args:
        attributes: All that are bound so far; what is decided changes them in place.
        things: Nouns met so far.
        vocabulary: What words mean.
    """

    def __init__(self, attributes: list[Attribute], things: list[Thing], vocabulary: Vocabulary) -> None:
        self._attributes, self._things, self._vocabulary = attributes, things, vocabulary
        self._loose: list[int] = []
        self._clauses: list[range] = []  # the same, by clause
        self._opening: list[Word] = []  # colors that the text begins with
        self._pair: list[int] = []  # two colors in a clause of their own

    def add(self, first: int, words: list[Word]) -> None:
        """Words that were bound to the subject for want of a noun: the attributes from the first one on."""
        colors = [w for w in words if w.token.color]
        self._opening += [] if first else colors
        self._clauses.append(range(first, len(self._attributes)))
        self._loose += self._clauses[-1]
        vivid = [w for w in colors if w.token.color and chroma(lab_from_srgb(w.token.color)) > _VIVID]
        if len(vivid) == len(words) == 2 and words[0].barred:
            self._pair = list(range(first, len(self._attributes)))

    def share_out(self, several: bool) -> None:
        """Gives colors to subject, surroundings or picture.

        Args:
            several: Whether the scene has several subjects, none of which can be meant.
        """
        for clause in self._clauses:
            self._light_up(clause)
            self._surround(clause)
        placed = bool(self._things) or any(
            a.region == "surroundings" and not a.cause for a in self._attributes
        )
        named = any(thing.kind == "subject" for thing in self._things)
        if self._pair and not named and self._has_lights_of_two_colors():
            self._color_the_lights()
        elif len(self._opening) == 2 and self._opening[0].barred and not (several or placed):
            self._paint_the_rest(self._opening[1])
        else:
            self._tint_the_picture(several)

    def _light_up(self, clause: range) -> None:
        """ "Wet streets, blue neon": a glow that no thing has is the lights', and so is its color."""
        found = [self._attributes[i] for i in clause]
        twins = {a.entry: f"{a.entry} light" for a in found if a.slot == "material"}
        twins = {entry: twin for entry, twin in twins.items() if twin in self._vocabulary.entries}
        for i, attribute in zip(clause, found, strict=True):
            lit = replace(attribute, region="whole", kind="light", thing="lights")
            if attribute.entry in twins:
                self._attributes[i] = replace(lit, entry=twins[attribute.entry], slot="lighting")
            elif twins and attribute.color:
                self._attributes[i] = lit

    def _surround(self, clause: range) -> None:
        """ "Gold vase, black marble": of what the subject cannot be as well, the surroundings are made."""
        rest = [a for i, a in enumerate(self._attributes) if i not in self._loose and not a.cause]
        made = any(self._is_made(a) and a.region == "subject" and not a.negated for a in rest)
        ends = bool(clause) and self._is_made(self._attributes[clause[-1]])  # "porcelain skin" does not
        if made and ends and not any(a.region == "surroundings" for a in self._attributes):
            for i in clause:
                self._attributes[i] = _around(self._attributes[i])

    def _is_made(self, attribute: Attribute) -> bool:
        """Whether it says what a thing is made of, and not just that it glows."""
        entry = self._vocabulary.entries.get(attribute.entry)
        effects = entry.effects if entry and entry.slot == "material" else ()
        return any(e.name in ("base_color", "roughness") for e in effects)

    def _has_lights_of_two_colors(self) -> bool:
        asked = (
            {e.owner for e in self._vocabulary.entries[a.entry].effects if e.family == "light/color"}
            for a in self._attributes
            if not a.color and not a.negated
        )
        return any({"key", "others"} <= owners for owners in asked)

    def _color_the_lights(self) -> None:
        """ "Neon noir, pink and cyan": where words ask for lights of two colors, those are theirs."""
        for i in self._pair:
            lit = replace(self._attributes[i], slot="color", region="whole", kind="light", thing="lights")
            self._attributes[i] = lit

    def _paint_the_rest(self, word: Word) -> None:
        """ "Black and gold": one thing cannot be both, but a picture can."""
        index = next(i for i in self._loose if self._attributes[i].word == word.text)
        self._attributes[index] = replace(
            _around(self._attributes[index]),
            entry=word.token.name or word.token.text,
            slot="color",
            color=word.token.color,
            shades=(),
        )

    def _tint_the_picture(self, several: bool) -> None:
        """A color in a prompt that speaks of a mood alone tints the picture, unless the prompt begins with it."""
        for i in self._loose:
            attribute = self._attributes[i]
            plural = attribute.word.endswith("s") and not attribute.entry.endswith("s")  # "muted greens"
            lit = i > 0 and self._tells_of_light(attribute, self._attributes[i - 1])
            if attribute.color and (plural or lit):
                self._attributes[i] = _tint(attribute)
        loose = [self._attributes[i] for i in self._loose if self._attributes[i].color]
        rest = [a for a in self._attributes if a not in loose and not a.cause]
        if any(a.slot in BOUND_SLOTS or a.kind == "subject" for a in rest) or self._things:
            return
        air = next((a for a in rest if self._fills_the_air(a)), None)
        airy = air or any(a.slot == "mood" for a in rest)
        for i in self._loose:
            attribute = self._attributes[i]
            toned = bool(set(attribute.entry.split()[:-1]) & set(_TONED))
            first = not air and len(self._opening) == 1 and self._opening[0].text == attribute.word
            spread = several and not (
                first and rest
            )  # "green, soft light" of several things is about the things
            if attribute.color and ((airy and not first) or toned or spread):
                self._attributes[i] = _tint(attribute)
            if attribute.color and air:  # "underwater, murky green": so is the water
                said = replace(attribute, region="whole", kind=air.kind, thing=air.thing)
                self._attributes.append(said)

    def _tells_of_light(self, attribute: Attribute, before: Attribute) -> bool:
        """Whether a color goes on about the light or the air: "a cottage at dusk, cold blue"."""
        color, shaded = attribute.color, not set(attribute.word.split()[:-1]).isdisjoint(_LIT)
        lit = color is not None and chroma(lab_from_srgb(color)) > _VIVID and shaded
        return lit and before.kind in ("light", "fog", "sky") and not before.color

    def _fills_the_air(self, attribute: Attribute) -> bool:
        if attribute.slot != "atmosphere" or attribute.negated:
            return False
        effects = self._vocabulary.entries[attribute.entry].effects
        return any(e.name == "density" and e.lower[0] > _CLEAR for e in effects)


def _tint(attribute: Attribute) -> Attribute:
    return replace(attribute, region="whole", kind="ambience", thing="tint")


def _around(attribute: Attribute) -> Attribute:
    return replace(attribute, region="surroundings", kind="surroundings", thing="surroundings")
