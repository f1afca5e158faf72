# SPDX-License-Identifier: Apache-2.0
"""Short captions for the encoder, one region each, and what each region must not look like (paper, 3.5).

Contrastive encoders mix up attributes of two things in one sentence, and do not understand "no". So each region has
a caption of its own, negatives are positive descriptions of the mistake, and negated words are left out.
"""

from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import groupby

from ..words.attributes import color_class
from ..words.lexicon.entries import VocabularyEntry
from ..words.lexicon.user_words import default_vocabulary
from ..words.lexicon.vocabulary import Vocabulary
from ..words.types import Attribute, Parsed

_MOST = 5  # words per caption: short ones are understood better
_BEFORE = {"finish": 1, "color": 2, "material": 3}  # slot -> place before a noun; others come first
_OF_MATTER = ("color", "finish", "material", "setting")
_OF_ALL = ("lighting", "atmosphere", "grade", "mood")
_KINDS = {"subject": ("subject", "highlight", "glow"), "surroundings": ("surroundings", "sky")}
"""Region -> kinds of things whose matter is seen there."""
_ALL = {"subject": "silhouette", "surroundings": "fog"}  # region -> what is all that is seen of it
_UNNAMED = {"subject": "object", "surroundings": "background"}  # region -> what it is called otherwise
_COLORED = ("light", "fill", "rim", "shadow", "highlight", "glow", "ambience")
"""Kinds of things that a color needs beside it to be understood: "blue shadows"."""


@dataclass(frozen=True)
class Prompts:
    """What the encoder is asked, region by region (equations 5 and 6); never negations."""

    subject: str  # short caption of the subject alone
    surroundings: str  # short caption of the surroundings alone; "" when the words leave them open
    whole: str  # caption of the whole picture
    subject_negatives: tuple[str, ...] = ()  # what it must not look like: swaps, antonyms, positively worded
    surroundings_negatives: tuple[str, ...] = ()  # likewise for the surroundings
    whole_negatives: tuple[str, ...] = ()  # likewise for the whole picture: "thick fog" for "no fog"


def compose(
    parsed: Parsed, overruled: Collection[Attribute] = (), vocabulary: Vocabulary | None = None
) -> Prompts:
    """Captions and negatives of a parsed prompt."""
    captions = _Captions(vocabulary or default_vocabulary())
    meant = [a for a in parsed.attributes if a not in overruled]
    said = [a for a in meant if not a.negated and not a.cause]
    mine, theirs = ([a for a in said if _is_of(region, a)] for region in _KINDS)
    noun, backdrop = (_called(region, parsed) for region in _KINDS)
    things: dict[
        str, list[Attribute]
    ] = {}  # those that have materials of their own: "a white cup, a black table"
    for attribute in mine:
        things.setdefault((attribute.owners and attribute.thing) or noun, []).append(attribute)
    foreground = ", ".join(captions.caption(a, name) for name, a in (things or {noun: []}).items())
    background = captions.caption(theirs, backdrop) if theirs else ""
    whole = [a for a in said if a.region == "whole" or a.slot in _OF_ALL]
    looks = [captions.words(a) for a in whole if a not in mine and a not in theirs][:_MOST]
    return Prompts(
        foreground,
        background,
        ", ".join(dict.fromkeys(filter(None, (foreground, background, *looks)))),
        captions.mistakes(mine, theirs, noun),
        captions.mistakes(theirs, mine, backdrop),
        captions.unwanted(meant),
    )


def _called(region: str, parsed: Parsed) -> str:
    """What the prompt calls the first thing of a region."""
    name = next((o.name for o in parsed.objects if o.region == region), region)
    return _UNNAMED[region] if name in ("", region) else name


def _is_of(region: str, attribute: Attribute) -> bool:
    """Whether a word describes the matter of a region, the colors of fog and sky included."""
    whole = _ALL[region] in (attribute.kind, attribute.entry)
    return whole or (attribute.kind in _KINDS[region] and attribute.slot in _OF_MATTER)


class _Captions:
    """Words for the encoder."""

    def __init__(self, vocabulary: Vocabulary) -> None:
        self.vocabulary, self.entries = vocabulary, vocabulary.entries

    def words(self, attribute: Attribute) -> str:
        """What the encoder is told for a word: its expansion, with the intensity kept."""
        entry = self.entries.get(attribute.entry)
        if attribute.color or not entry:
            return _color(attribute)
        if attribute.shades:
            return attribute.english or attribute.word
        degree = "slightly " if attribute.strength < 0.8 else "very " if attribute.strength > 1.3 else ""
        return degree + entry.phrase

    def caption(self, attributes: Iterable[Attribute], noun: str) -> str:
        """ "a glossy teal dolphin": what fits before the noun stands there, longer phrases follow it."""
        before: list[str] = []
        after: list[str] = []
        # No "studio studio"
        said = (a for a in attributes if a.slot != "setting" or (a.english or a.word) not in noun)
        for attribute in sorted(said, key=lambda a: _BEFORE.get(a.slot, 0)):
            adjective, _, more = self.words(attribute).partition(", ")
            long = adjective.count(" ") > 1 and not attribute.color
            (after if long else before).append(adjective)
            after += filter(None, [more])
            if len(before) + len(after) == _MOST:
                break
        words = " ".join(dict.fromkeys([*before, noun])).split()
        front = " ".join(word for word, _ in groupby(words))
        article = "an" if front[:1] in {*"aeiou"} else "a"
        return ", ".join(dict.fromkeys([f"{article} {front}", *after]))

    def mistakes(self, own: list[Attribute], other: list[Attribute], noun: str) -> tuple[str, ...]:
        """What must not happen to a region: the other region's colors and matter, and its own words' opposites."""
        mine = {a.entry for a in own}
        swapped = (a for a in other if a.slot in ("color", "material") and a.entry not in mine)
        negatives = [self.caption([a], noun) for a in swapped]
        meant = {pair for name in mine & self.entries.keys() for pair in self.entries[name].classes.items()}
        opposites = (self._opposite(a) for a in own if a.slot in _OF_MATTER)
        negatives += [
            f"a {opposite.phrase.partition(',')[0]} {noun}"
            for opposite in opposites
            if opposite and meant.isdisjoint(opposite.classes.items())
        ]
        return tuple(dict.fromkeys(negatives))

    def unwanted(self, attributes: list[Attribute]) -> tuple[str, ...]:
        """For the whole picture: what negated words describe, and the opposites of the others."""
        wanted = {self.words(a) for a in attributes if not a.negated}
        negatives = (text for a in attributes for text in self._denied(a))
        return tuple(n for n in dict.fromkeys(negatives) if n not in wanted)

    def _denied(self, attribute: Attribute) -> Iterator[str]:
        if attribute.negated:
            yield self.words(replace(attribute, strength=1.0, shades=()))
        elif attribute.region == "whole" and not attribute.cause and (opposite := self._opposite(attribute)):
            yield opposite.phrase

    def _opposite(self, attribute: Attribute) -> VocabularyEntry | None:
        entry = self.entries.get(attribute.entry)
        return self.vocabulary.opposite(entry) if entry else None


def _color(attribute: Attribute) -> str:
    """A color by its name and its kind, "crimson red": encoders know few of the thousand names that colors have."""
    kind, name = color_class(attribute), attribute.entry
    if attribute.kind in _COLORED:
        return f"{name} {attribute.thing}"
    return name if kind in name.replace("gray", "grey") else f"{name} {kind}"
