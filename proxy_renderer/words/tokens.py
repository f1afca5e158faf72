# SPDX-License-Identifier: Apache-2.0
"""Tokens: words and known phrases of a prompt with every role that they can play; colors and materials of several words."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from ..color.shades import shade
from ..schema import Values
from .lexicon.tinges import compound
from .lexicon.vocabulary import Vocabulary

TIES = ("link", "around", "joiner", "comparison", "exception")
"""Lists of words that only say how their neighbors belong together."""
ShadeArguments = tuple[float, float, float, float]
"""Arguments of `color.shade`."""


@dataclass
class Token:
    """One word or known phrase of the prompt.

    Attributes:
        text: As the prompt has it, normalized.
        entry: Vocabulary entry that it names; "" for none.
        color: sRGB of the color that it names.
        adjective: A key of the vocabulary's adjectives; "" for none.
        noun: Kind of thing that it names; "" for none.
        scene: It names a thing in the scene.
        strength: What it multiplies the next look word with, if it is an intensity.
        lists: Names of the grammar lists that it is in: "negation", "link", ...
        name: The spelling that the vocabulary knows.
        guess: It is misspelled, and this is the known word that is meant.
        unsure: Not known, but near to looks that are: it is not used, names no thing, and known words are offered for it.
        shades: What shade words before it do to a material's color, see `types.Attribute`.
        clause: Number of its clause.
        wished: It is part of a wish that values cannot fulfill: "remove the chair".
        presents: Of an object in a change phrase, its looks at present: red of "the roof from red to grey".
        change: Number of the change phrase that it is in, as its object or as a look that is wished of it; 0 for none.
    """

    text: str
    entry: str = ""
    color: Values | None = None
    adjective: str = ""
    noun: str = ""
    scene: bool = False
    strength: float | None = None
    lists: frozenset[str] = field(default_factory=frozenset)
    name: str = ""
    guess: str = ""
    unsure: bool = False
    shades: tuple[ShadeArguments, ...] = ()
    clause: int = 0
    wished: bool = False
    presents: tuple[Token, ...] = ()
    change: int = 0

    @property
    def known(self) -> bool:
        """Whether it plays any role."""
        return bool(self._names or self.scene or self.strength or self.lists)

    @property
    def ties(self) -> bool:
        """Whether it only says how its neighbors belong together: "of", "with", "than"."""
        return not (self.entry or self.lists.isdisjoint(TIES))

    @property
    def filler(self) -> bool:
        """Whether it says nothing: articles and the like."""
        return "stop" in self.lists and not self._names

    @property
    def names_a_look(self) -> bool:
        """Whether it can be a look word."""
        return bool(self.entry or self.color or self.adjective)

    @property
    def _names(self) -> bool:
        """Whether it is a look, or a kind of thing."""
        return bool(self.entry or self.color or self.adjective or self.noun)


def composed(words: list[str], vocabulary: Vocabulary) -> Token | None:
    """A color or material with the words that shift it: "warm golden", "very dark blue", "dark walnut"; None for others."""
    text, v = " ".join(words), vocabulary
    made_of = words[0] in v.colors and words[0] in v.synonyms  # "ruby red lips" are red
    if not made_of and (color := compound(words, v.colors)):
        return Token(text, color=color, name=text)
    led = [(leading, rest) for leading, rest in _led_by_shades(words, v) if text not in v.colors]
    found = [_shaded(leading, rest, v) for leading, rest in led]
    found += [_shaded_material(leading, rest, v) for leading, rest in led if text not in v.synonyms]
    return next(filter(None, found), None)


def _shaded(leading: list[str], rest: list[str], v: Vocabulary) -> Token | None:
    """A color with shade words before it: "very dark blue", "dusty rose"."""
    last = " ".join(rest)
    name = last if last in v.colors else last.removesuffix("s")
    color = v.colors.get(name) or compound(rest, v.colors)
    if color is None or v.slot(last) == "grade":  # "faded sepia" is no paler brown
        return None
    shades = _shades(leading, v)
    for arguments in shades:
        color = shade(color, *arguments)
    both = leading[-1] in v.words["lightness"] and last in v.adjectives
    return Token(
        " ".join([*leading, last]), color=color, adjective=last if both else "",
        name=" ".join([*leading, name]), shades=shades if both else (),
    )  # fmt: skip


def _shaded_material(leading: list[str], rest: list[str], v: Vocabulary) -> Token | None:
    """A material with its own color, lighter or darker: "dark oak", "very pale wood"."""
    name = " ".join(rest)
    entry = v.entry(name)
    lightened = leading[-1] in v.words["lightness"]
    if entry is None or not (lightened and entry.is_colored):
        return None
    return Token(" ".join([*leading, name]), entry.name, name=name, shades=_shades(leading, v))


def _led_by_shades(words: list[str], v: Vocabulary) -> Iterator[tuple[list[str], list[str]]]:
    """Shade words with their intensities, and what follows; "very dark blue" is darker than the dark blue of the list."""
    for split in range(1, len(words)):
        leading, rest = words[:split], words[split:]
        listed = " ".join(rest) in v.colors and rest[0] in v.shades
        if listed and all(v.intensity.get(w, 0) > 1 for w in leading):
            leading = rest[:1]
        if leading[-1] in v.shades and all(w in v.shades or w in v.intensity for w in leading):
            yield leading, rest


def _shades(leading: list[str], v: Vocabulary) -> tuple[ShadeArguments, ...]:
    """What shade words do, the one next to the color first."""
    pairs = [*zip(["", *leading], leading, strict=False)][::-1]
    return tuple(_shade(v.shades[w], v.intensity.get(before, 1.0)) for before, w in pairs if w in v.shades)


def _shade(row: dict[str, float], strength: float) -> ShadeArguments:
    """What one shade word does; "very" does the same to it again, "slightly" half of it."""
    strength = max(strength, strength**2)
    lightness = max(1 - (1 - row.get("lightness", 1.0)) * strength, 0.05)
    tinted = 1 - (1 - row.get("chroma", 1.0)) * strength
    return lightness, tinted, row.get("towards", 60.0), row.get("warmth", 0.0) * strength
