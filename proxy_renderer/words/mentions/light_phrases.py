# SPDX-License-Identifier: Apache-2.0
"""The lights that a prompt describes one by one: "a hard key from the left, warm, and a cold rim from behind" are two."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from ..lexicon.rigs import RigTable
from ..lexicon.spelling import singular
from ..lexicon.vocabulary import Vocabulary
from ..tokens import Token
from .passage import LIGHTS, Passage

_ROLES = ("fill", "rim")
_WHITE = "white"


@dataclass
class LightPhrases:
    """The lights that a prompt describes one by one.

    Attributes:
        of: Place of an item -> the numbers, from 1, of the lights that it belongs to; items that belong to none are left out.
        roles: Number of a light -> "fill" or "rim", where its name says so.
        gone: Places of items that describe what is to be replaced.
    """

    of: dict[int, tuple[int, ...]] = field(default_factory=dict)
    roles: dict[int, str] = field(default_factory=dict)
    gone: set[int] = field(default_factory=set)

    def role(self, place: int) -> str:
        """The role of the light that an item belongs to; "" if none is said."""
        return next((self.roles[n] for n in self.of.get(place, ()) if n in self.roles), "")


def light_phrases(passage: Passage, vocabulary: Vocabulary, rigs: RigTable) -> LightPhrases:
    """The lights of a prompt.

    A light is described from the words that lead its name up to the next light or the next thing, and goes on in parts of the
    sentence that name nothing: "a softbox from the left, large and warm". "Both" and "all" speak of every light before them.

    Args:
        rigs: Names of setups that are lights.
    """
    reader = _PhraseReader(passage, vocabulary, rigs)
    for places in _segments(passage, vocabulary):
        reader.read(places)
    return reader.found


class _PhraseReader:
    """Reads the segments of a prompt one after the other, and remembers which lights are spoken of.

    Args:
        rigs: Names of setups that are lights.

    Attributes:
        found: The lights so far.
    """

    def __init__(self, passage: Passage, vocabulary: Vocabulary, rigs: RigTable) -> None:
        self.found = LightPhrases()
        self._passage, self._vocabulary, self._rigs = passage, vocabulary, rigs
        self._number = 0  # of the last light
        self._several = False  # whether lights were counted before they are described
        self._spoken_of: tuple[int, ...] = ()  # lights that words say something of now
        self._counted: list[int] = []  # places of what is said of lights that are counted: "two rim lights"
        self._listed: list[int] = []  # the numbers of these lights

    def read(self, places: list[int]) -> None:
        """Takes the next segment."""
        items = [self._passage.items[place] for place in places]
        goes_on = all(_goes_on(item, self._rigs, self._vocabulary) for item in items)
        expected = self._several or bool(self._spoken_of)
        if _counts_lights(items):  # "two lights only: a pink one ..."
            self._several, self._spoken_of = True, ()
        elif _exchanges(items, self._vocabulary) and _is_followed(places, self._passage, self._vocabulary):
            self.found.gone |= {*places}
            self._spoken_of = ()
        elif _has_head(items, self._vocabulary, self._rigs, expected):
            self._begin(places, items)
        elif self._counted and goes_on and any(item.color for item in items):
            self._tell_apart(places)
        elif not goes_on:
            self._spoken_of = ()
        elif self._spoken_of and any(item.text in self._vocabulary.words["together"] for item in items):
            self._spoken_of = tuple(range(1, self._number + 1))
        if self._spoken_of:  # "cup, warm light, pale blue": a color there may be a thing's
            theirs = (p for p in places if p in self.found.of or _may_be_of_light(self._passage.items[p]))
            self.found.of |= dict.fromkeys(theirs, self._spoken_of)

    def _begin(self, places: list[int], items: list[Token]) -> None:
        """A light is named."""
        self._number += 1
        self._spoken_of = (self._number,)
        self.found.of |= dict.fromkeys(places, self._spoken_of)
        is_counted = any(_is_counted(item, self._vocabulary) for item in items)
        self._counted, self._listed = (places if is_counted else []), []
        if role := next((item.noun for item in items if item.noun in _ROLES), ""):
            self.found.roles[self._number] = role

    def _tell_apart(self, places: list[int]) -> None:
        """One of the counted lights gets a color: "two rims from behind: orange on the left, blue on the right"."""
        self._number += bool(self._listed)
        self._listed.append(self._number)
        self._spoken_of = (self._number,)
        self.found.of |= dict.fromkeys(places, self._spoken_of)
        self.found.of |= dict.fromkeys(self._counted, tuple(self._listed))
        if role := self.found.roles.get(self._listed[0], ""):
            self.found.roles[self._number] = role


def _segments(passage: Passage, vocabulary: Vocabulary) -> Iterator[list[int]]:
    """Places of the items, parted where a clause begins and at words that join or end a description.

    A comma between adjectives parts nothing: "a small, hard lamp".
    """
    part: list[int] = []
    for place, item in enumerate(passage.items):
        begins = place in passage.starts and not _awaits_a_noun([passage.items[p] for p in part])
        exchanged = item.text in vocabulary.words["exchanged"] and _exchanges(
            [passage.items[p] for p in part], vocabulary
        )
        if part and (begins or exchanged or _parts(item, vocabulary)):
            yield part
            part = []
        part.append(place)
    if part:
        yield part


def _awaits_a_noun(items: Sequence[Token]) -> bool:
    """Whether words end with an article and adjectives: "as a crisp"."""
    articles = [n for n, item in enumerate(items) if "article" in item.lists and "definite" not in item.lists]
    last = max(articles, default=len(items))
    tail = items[last + 1 :]
    return bool(tail) and all((i.adjective or i.color) and not (i.noun or i.scene) for i in tail)


def _is_counted(item: Token, vocabulary: Vocabulary) -> bool:
    """Whether a word says how many lights there are: "two rim lights"."""
    first, *others = item.text.split()
    return "count" in item.lists or (bool(others) and first in vocabulary.lists["count"])


def _parts(item: Token, vocabulary: Vocabulary) -> bool:
    return "joiner" in item.lists or item.text in vocabulary.words["consequence"]


def _exchanges(items: Sequence[Token], vocabulary: Vocabulary) -> bool:
    """Whether words say that one thing takes the place of another: "replace the lamp"."""
    return any(item.text in vocabulary.words["exchanges"] for item in items)


def _is_followed(places: Sequence[int], passage: Passage, vocabulary: Vocabulary) -> bool:
    """Whether the next word says what comes in the place of what was spoken of: "replace the lamp with ..."."""
    following = passage.items[places[-1] + 1 : places[-1] + 2]
    return any(item.text in vocabulary.words["exchanged"] for item in following)


def _counts_lights(items: Sequence[Token]) -> bool:
    """Whether words only say how many lights there are."""
    lights = any(item.noun == "light" for item in items)
    return lights and any("count" in item.lists for item in items) and not any(i.names_a_look for i in items)


def _has_head(items: Sequence[Token], vocabulary: Vocabulary, rigs: RigTable, several: bool) -> bool:
    """Whether words name a light, and do not say that there is none."""
    heads = [n for n, item in enumerate(items) if _is_head(item, vocabulary, rigs, several)]
    return bool(heads) and not any("negation" in item.lists for item in items[: heads[0]])


def _is_head(item: Token, vocabulary: Vocabulary, rigs: RigTable, several: bool) -> bool:
    """Whether an item names a light."""
    if several and item.text in vocabulary.words["one_of_them"]:
        return True
    if item.noun in LIGHTS:
        return True
    if vocabulary.slot(item.entry) != "lighting":
        return False
    if any(vocabulary.nouns.get(singular(word)) in LIGHTS for word in item.text.split()):
        return True  # "light behind"
    return rigs.is_a_light(item.entry, item.text)


def _may_be_of_light(item: Token) -> bool:
    return item.color is None or item.text.endswith(_WHITE)


def _names_a_setup(item: Token, rigs: RigTable) -> bool:
    return item.entry in rigs.rigs and item.entry not in rigs.modifiers


def _goes_on(item: Token, rigs: RigTable, vocabulary: Vocabulary) -> bool:
    """Whether an item names no other thing and no setup, so that it may go on about the light before it."""
    known = item.names_a_look or item.filler or item.lists or item.strength is not None
    if not known or _names_a_setup(item, rigs):
        return False
    rest = "others" in item.lists and item.text not in vocabulary.words["together"]
    return item.noun in ("", "glow") and not (item.scene or rest or "action" in item.lists)
