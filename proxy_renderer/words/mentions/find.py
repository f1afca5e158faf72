# SPDX-License-Identifier: Apache-2.0
"""The places of a prompt where things, lights and parts of the picture are named."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from ..lexicon.vocabulary import Vocabulary
from ..tokens import Token
from .by_look import LookIndex
from .joined import joined
from .names import FITS, parts
from .nouns import Named, NounMention, fit_signs
from .passage import Passage
from .picked import with_picks
from .row import NounRow
from .scene import SceneIndex

_LONGEST = 3  # tokens of a name
_SURE = (*(f"{s} {way}" for s in ("material", "object", "group", "light") for way in FITS[:2]),)
_BY_LOOK = frozenset({"material exact", "by look"})
_NO_NOUNS = {"negation", "comparison", "exception", "action", "undo", "beyond"}


def mentions(passage: Passage, index: SceneIndex, vocabulary: Vocabulary) -> list[NounMention]:
    """All of a prompt, those of several nouns last."""
    finder = _Finder(passage, index, vocabulary)
    found = [*finder.single()]
    determiners = NounRow(passage, found, vocabulary).determiners()
    single = [mention for mention in found if mention.start not in determiners]
    single = with_picks(passage, single, index, vocabulary)
    spared = NounRow(passage, single, vocabulary).spared()
    single = [replace(mention, spared=mention.start in spared) for mention in single]
    lists = (joined(run, index.words) for run in NounRow(passage, single, vocabulary).joined())
    return [*single, *filter(None, lists)]


class _Finder:
    """Finds the nouns of a prompt."""

    def __init__(self, passage: Passage, index: SceneIndex, vocabulary: Vocabulary) -> None:
        self.passage, self.items, self.index, self.vocabulary = passage, passage.items, index, vocabulary
        self._looks = LookIndex(index.words, vocabulary)

    def single(self) -> Iterator[NounMention]:
        """One by one, the longest name first."""
        start = 0
        while start < len(self.items):
            found = self._at(start)
            if found and self.items[start].wished:
                found = _of_a_wish(found)
            if found:
                yield found
            start = found.end + 1 if found else start + 1

    def _at(self, start: int) -> NounMention | None:
        """The one that begins at an item."""
        if self.items[start].ties or self._is_done(start):
            return None
        for count in range(_LONGEST, 1, -1):
            if named := self._of_several(start, count):
                return self._mention(start, start + count - 1, self.items[start + count - 1].noun, named)
        token = self.items[start]
        if "others" in token.lists:
            return NounMention(start, start, token.text, "others")
        said = parts(token.name if token.scene and token.guess else token.text)
        if not said or not token.lists.isdisjoint(_NO_NOUNS):
            return None
        named = [] if self._is_of_the_next(start) else self._of_one(start, said)
        named += self._of_the_material_before(start, named)
        named = self._looks.own(named, self.index.objects(said))
        if seen := self._by_look(token, named):
            return self._mention(start, start, "", seen)
        noun = token.noun or "unknown" if token.presents else self._noun(start)
        return self._mention(start, start, noun, named) if named or noun else None

    def _by_look(self, token: Token, named: list[Named]) -> list[Named]:
        """What a noun means by its present look or its shape, which also tell apart what its name may mean."""
        things = [n for n in named if n.kind == "things"]
        if things and token.presents:
            return [replace(n, names=self._looks.narrowed(n.names, token.presents)) for n in things]
        if named:
            return []
        names = self._looks.meant(token.text, token.presents)
        return [Named("things", names, _BY_LOOK)] if names else []

    def _is_done(self, start: int) -> bool:
        """Whether a clause begins with what is to be done to a thing of the scene: "paint the crate" names no paint."""
        clause = [i for i in self.items[start:] if i.clause == self.items[start].clause]
        before = [i for i in self.passage.content(0, start) if i.clause == self.items[start].clause]
        if before or len(clause) < 3 or "definite" not in clause[1].lists:
            return False
        return bool(self.index.named(parts(clause[2].text)))

    def _is_of_the_next(self, start: int) -> bool:
        """Whether a look is said of the thing after it: "red" of "red leather seats" is no red lamp, nor "fabric" of "fabric curtain" a towel."""
        token = self.items[start]
        head = self._head_after(start)
        if head is None or not token.names_a_look or token.noun:
            return False
        if not token.entry:
            return True
        own, following = (self.index.named(parts(each.text)) for each in (token, head))
        meant = any(n.kind == "things" for n in following)
        if self._surely(own):
            return bool(self._surely(following)) and self.items[start + 1] is head
        return bool(self._surely(following)) or (meant and _translated(own))

    def _of_the_material_before(self, start: int, named: list[Named]) -> list[Named]:
        """What of a noun is of the material before it: of "glass cube" the cubes that wear glass."""
        before = self.items[max(start - 1, 0) : start]
        if not before or before[0].clause != self.items[start].clause or not before[0].entry:
            return []
        own = self.index.named(parts(before[0].text))
        things = [(n, m) for n in named for m in own if n.kind == m.kind == "things"]
        both = dict.fromkeys((n, n.names & m.names) for n, m in things)
        return [
            Named("things", names, n.signs | {"of the material before"})
            for n, names in both
            if names and names != n.names
        ]

    def _head_after(self, start: int) -> Token | None:
        """The noun that follows, with nothing but looks between."""
        for token in self.items[start + 1 :]:
            if token.clause != self.items[start].clause or token.ties or token.filler:
                return None
            if token.noun or self.index.named(parts(token.text)):
                return token
            if not (token.names_a_look or token.strength):
                return None
        return None

    def _mention(self, start: int, end: int, noun: str, named: list[Named]) -> NounMention:
        """A noun with the light that it means: "key light" the key, "light" light in general ("")."""
        text, roles = " ".join(i.text for i in self.items[start : end + 1]), self.vocabulary.roles
        last = self.items[end]
        role = next((roles[word] for word in last.text.split() if word in roles), "")
        role = last.noun if last.noun in ("fill", "rim") else role
        return NounMention(start, end, text, noun, role, tuple(named))

    def _of_several(self, start: int, count: int) -> list[Named]:
        """What some tokens in a row name for sure."""
        row = self.items[start : start + count]
        apart = any(i.clause != row[0].clause or i.ties for i in row)
        if len(row) < count or apart or row[0].filler or row[-1].filler:
            return []
        said = parts(" ".join(i.text for i in row))
        return self._surely(self.index.named(said)) or self._lamps(said)

    def _of_one(self, start: int, said: tuple[str, ...]) -> list[Named]:
        """What a token names by itself, by its last word if by nothing else, or what it may stand for."""
        token = self.items[start]
        plural = token.text.endswith("s")
        named = self.index.named(said, plural) or self._lamps(said)
        last = said[-1:]
        if not named and len(said) > 1 and token.noun != "tone":  # "the whole picture" hangs on no wall
            named, said = self.index.named(last), last
        if said == last and last[0] in self.vocabulary.lists["anylight"]:  # though one may be called "Light"
            named = [n for n in named if n.signs != {"light exact"} and (plural or not _translated([n]))]
        if "stop" in token.lists and not token.noun:
            return self._surely(named)
        if named or token.known:
            return named
        guessed = self.index.named(said[-1:], guess=True)
        if self._head_after(start):  # "ball gown" is no glove, though a ball is for sports too
            guessed = [n for n in guessed if any(sign.endswith("misspelled") for sign in n.signs)]
        return [n for n in guessed if plural or not self.index.is_several(n)]  # "a car" is not its wheels

    def _surely(self, named: list[Named]) -> list[Named]:
        return [n for n in named if not n.signs.isdisjoint(_SURE)]

    def _lamps(self, said: tuple[str, ...]) -> list[Named]:
        """Of "window light" the lights that a window names: what stands before a word for light tells which one."""
        any_light = len(said) > 1 and said[-1] in self.vocabulary.lists["anylight"]
        return [n for n in self.index.named(said[:-1]) if n.kind == "lights"] if any_light else []

    def _noun(self, start: int) -> str:
        """The kind of thing that a token is: "unknown" for a word that nobody knows, or that is a mood, or here the thing itself."""
        token = self.items[start]
        if "thing" not in token.lists and (token.known or token.unsure):
            return token.noun
        before = [i for i in self.passage.content(0, start) if not i.names_a_look]
        gives_light = before and "lighting" in before[-1].lists  # "lit by a red firefly"
        return token.noun or ("light" if gives_light else "unknown")


def _of_a_wish(mention: NounMention) -> NounMention | None:
    """A thing that is to be moved or the like, which later words may be about: "move the chairs and make them blue"."""
    named = [replace(n, signs=n.signs | {"of a wish"}) for n in mention.named if n.kind == "things"]
    return replace(mention, noun="", role="", named=tuple(named)) if named else None


def _translated(named: list[Named]) -> bool:
    """Whether no name has the very word: "wooden" of "wood planks"."""
    return all(sign.endswith("synonym") for n in named for sign in fit_signs(n))
