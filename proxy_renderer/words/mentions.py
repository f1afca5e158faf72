# SPDX-License-Identifier: Apache-2.0
"""The places of a prompt where things, lights and parts of the image are named: nouns, lists and exceptions."""

import re
from collections.abc import Iterable
from dataclasses import replace
from itertools import product

from .lexer import Token
from .lexicon.languages import singular, thing_words
from .lexicon.vocabulary import Vocabulary
from .names import FITS, parts
from .passage import Passage, is_object
from .scene import REGIONS, LookIndex, Named, NounMention, SceneIndex, fit_rank, fit_signs, materials_of, surest
from .types import SceneDescription

_LONGEST = 3  # tokens of a name
_STOPS = ("around", "comparison", "exception")  # a look word after one describes no noun before it: "a cup on red"
_SURE = (*(f"{s} {way}" for s in ("material", "object", "group", "light") for way in FITS[:2]),)
_NO_NOUNS = {"negation", "comparison", "exception", "action", "undo", "beyond"}
# Lists and exceptions are found by patterns over a string with a letter for each token, and commas between clauses.
# Nouns of the scene begin with T (things), K (lights) or N (the noun is a look word, too), others with M (a part of the
# image) or I; n is each further token of a noun. Other tokens: Q "all", O "the rest", L a look word, _ a filler,
# u unknown, those of _LETTERS, and . for any other known word.
_LETTERS = {
    "P": {"spared"}, "X": {"exception"}, "G": {"again"}, "A": {"listing"},
    "F": {"of"}, "W": {"save", "refusal"}, "B": {"save"}, "R": {"refusal"},
}  # fmt: skip
"""Letter of a token that is no noun -> lists of the vocabulary's grammar that it is in."""
_LISTABLE, _NOUNS = "TKNM", "TKNMI"
_NOUN = f"[{_NOUNS}]n*"
_LISTED = f"(?:[_ALOQu]*{_NOUN}(?:_*A[_ALOQu]*{_NOUN})*)"
_THINGS = "(?:[_A]*Tn*(?:_*A[_A]*Tn*)*)"
_EXCEPTED = [
    re.compile(pattern)
    for pattern in (
        f"[XP]({_LISTED})",  # "except the floor and the wall"
        f"[OQ][BW]({_LISTED})",  # "everything but the floor"
        f"[OQ][^,]*[BW]({_LISTED})(?=[^L,]*(?:,|$))",  # "everything grey but the floor"
        f"[RW]({_THINGS})",  # "not the cables"
        "(Tn*)_*(?:P|[RW]_*(?:,|$))",  # "the buckle excepted", "the grid not"
    )
]
_JOINED = re.compile(  # "box and cup"; over a comma only names: "bezel, strap and dial"
    f"[{_LISTABLE}]n*(?:(?:(?:_*A)+_*(?:[uI]_*)?|(?<=[TKNn])[_A]*,[_A]*(?=[TKN]))[{_LISTABLE}]n*)+"
)


def mentions(passage: Passage, index: SceneIndex, vocabulary: Vocabulary) -> list[NounMention]:
    """All nouns of a prompt, then the lists that join several of them."""
    finder, single, start = _NounFinder(passage, index, vocabulary), [], 0
    while start < len(passage.items):  # the longest name first
        found = finder.at(start)
        if found:
            single.append(found)
        start = found.end + 1 if found else start + 1
    row = _NounRow(passage, single, vocabulary)
    excepted, lists = row.excepted(), row.joined()
    single = [replace(mention, excepted=mention.start in excepted) for mention in single]
    by_start = {mention.start: mention for mention in single}
    joined = (_joined([by_start[start] for start in starts], index.words) for starts in lists)
    return [*single, *filter(None, joined)]


class _NounFinder:
    def __init__(self, passage: Passage, index: SceneIndex, vocabulary: Vocabulary) -> None:
        self.passage, self.items, self.index, self.vocabulary = passage, passage.items, index, vocabulary
        self._looks = LookIndex(index.words, vocabulary)

    def at(self, start: int) -> NounMention | None:
        """The noun that begins at an item."""
        token = self.items[start]
        if token.ties or token.wished:
            return None
        for count in range(_LONGEST, 1, -1):
            if named := self._of_several(start, count):
                return self._mention(start, start + count - 1, self.items[start + count - 1].noun, named)
        if "others" in token.lists:
            return NounMention(start, start, token.text, "others")
        said = parts(token.name if token.scene and token.guess else token.text)
        after = self.items[start + 1 : start + 2]
        if token.text in self.vocabulary.words["paints"] and any("definite" in i.lists for i in after):
            return None  # "paint the crate" names no paint
        if not said or not token.lists.isdisjoint(_NO_NOUNS):
            return None
        named = [] if self._is_of_the_next(start) else self._of_one(start, said)
        if seen := self._looks.told(token, named):
            return self._mention(start, start, "", seen)
        noun = token.noun or "unknown" if token.presents else self._noun(start)
        return self._mention(start, start, noun, self._numbered(start, named)) if named or noun else None

    def _numbered(self, start: int, named: list[Named]) -> list[Named]:
        """The names that have the number after a noun: "cube 2" is Cube.002; `named` if there is none."""
        number = next((item.text for item in self.items[start + 1 : start + 2]), "")
        if not number.isdecimal():
            return named
        theirs = re.compile(rf"\D0*{int(number)}$").search
        objects = filter(theirs, self.index.objects(parts(self.items[start].text)))
        things = (self.index.words.object_materials.get(name, ()) for name in objects)
        lights = (filter(theirs, each.names) for each in named if each.kind == "lights")
        found = (("things", things, "object exact"), ("lights", lights, "light exact"))
        each = [Named(kind, frozenset().union(*names), frozenset({sign})) for kind, names, sign in found]
        return [numbered for numbered in each if numbered.names] or named

    def _mention(self, start: int, end: int, noun: str, named: list[Named]) -> NounMention:
        """A noun with the role of the light that it names: "key" for "key light", "" for "light"."""
        text, last = " ".join(i.text for i in self.items[start : end + 1]), self.items[end]
        role = last.noun if last.noun in ("fill", "rim") else self.vocabulary.role(last.text)
        return NounMention(start, end, text, noun, role, tuple(named))

    def _of_several(self, start: int, count: int) -> list[Named]:
        """What some tokens in a row name in the scene, if their fit is sure."""
        row = self.items[start : start + count]
        apart = any(i.clause != row[0].clause or i.ties for i in row)
        if len(row) < count or apart or row[0].filler or row[-1].filler:
            return []
        said = parts(" ".join(i.text for i in row))
        return self._surely(self.index.named(said)) or self._lamps(said)

    def _of_one(self, start: int, said: tuple[str, ...]) -> list[Named]:
        """What a single token names in the scene, by all of its words or else by the last one."""
        token = self.items[start]
        named = self.index.named(said) or self._lamps(said)
        of_a_role = token.noun in ("rim", "fill") and not token.text.endswith("s")
        if of_a_role or token.text in self.vocabulary.roles:  # a "blue rim" is of light, though glasses have rims
            named = [n for n in named if n.kind == "lights"] or self._surely(named)
        last = said[-1:]
        if not named and len(said) > 1 and token.noun != "tone":  # "the whole picture" is no object
            named, said = self.index.named(last), last
        if said == last and last[0] in self.vocabulary.lists["anylight"]:  # not one that is called "Light"
            plural = token.text.endswith("s")
            named = [n for n in named if n.signs != {"light exact"} and (plural or not _is_translated(n))]
            if not plural and self.vocabulary.nouns.get(last[0]) == "light":  # nor a "Tail Light"
                named = [n for n in named if n.kind == "lights"] or self._surely(named)
        return self._surely(named) if "stop" in token.lists and not token.noun else named

    def _is_of_the_next(self, start: int) -> bool:
        """True if a look word describes the thing after it, with only looks between: "red leather seats" names no red lamp."""
        token = self.items[start]
        if not token.names_a_look or token.noun:
            return False
        for item in self.items[start + 1 :]:
            if item.clause != token.clause or item.ties or item.filler:
                return False
            named = self.index.named(parts(item.text))
            if item.noun or named:
                return not token.entry or bool(self._surely(named))
            if not (item.names_a_look or item.strength):
                return False
        return False

    def _surely(self, named: list[Named]) -> list[Named]:
        return [n for n in named if not n.signs.isdisjoint(_SURE)]

    def _lamps(self, said: tuple[str, ...]) -> list[Named]:
        """The lights that the words before a final "light" name: "window" of "window light"."""
        any_light = len(said) > 1 and said[-1] in self.vocabulary.lists["anylight"]
        return [n for n in self.index.named(said[:-1]) if n.kind == "lights"] if any_light else []

    def _noun(self, start: int) -> str:
        """The kind of noun that a token is: "unknown" for an unknown word, or a look word that may be a thing; "" for none."""
        token = self.items[start]
        if token.noun or ("thing" not in token.lists and (token.known or token.unsure)):
            return token.noun
        before = [i for i in self.passage.content(0, start) if not i.names_a_look]
        return "light" if before and "lighting" in before[-1].lists else "unknown"  # "lit by a red firefly"


def _is_translated(named: Named) -> bool:
    """True if all names fit only by a synonym: "wooden" and "wood planks"."""
    return all(sign.endswith("synonym") for sign in fit_signs(named))


class _NounRow:
    """The nouns of a prompt among its other tokens, as a string of letters, see the head of this file."""

    def __init__(self, passage: Passage, single: Iterable[NounMention], vocabulary: Vocabulary) -> None:
        self._vocabulary = vocabulary
        self._nouns = {mention.start: mention for mention in single}
        self._inside = {i for m in self._nouns.values() for i in range(m.start + 1, m.end + 1)}
        self._places: list[int] = []
        self._letters = ""
        for place, token in enumerate(passage.items):
            parted = place and token.clause != passage.items[place - 1].clause
            self._letters += "," * bool(parted) + self._letter(place, token)
            self._places += [place] * (1 + bool(parted))

    def excepted(self) -> set[int]:
        """Places where the nouns begin that the prompt excepts."""
        spans = [match.span(1) for pattern in _EXCEPTED for match in pattern.finditer(self._letters)]
        return {place for span in spans for place in self._nouns_in(*span, _NOUNS)}

    def joined(self) -> list[list[int]]:
        """For each list of nouns with no look word between them, the places where its nouns begin."""
        return [self._nouns_in(*match.span(), _LISTABLE) for match in _JOINED.finditer(self._letters)]

    def _nouns_in(self, start: int, end: int, letters: str) -> list[int]:
        return [self._places[i] for i in range(start, end) if self._letters[i] in letters]

    def _letter(self, place: int, token: Token) -> str:
        if place in self._inside:
            return "n"
        noun = self._nouns.get(place)
        if noun is None:
            kinds = [letter for letter, lists in _LETTERS.items() if lists <= token.lists]
            rest = "_" if token.filler else "L" if token.names_a_look else "." if token.known else "u"
            return kinds[0] if kinds else rest
        if noun.noun == "others":
            return "Q" if token.filler else "O"
        if not noun.named:
            return "M" if noun.noun in REGIONS and noun.end + 1 not in self._nouns else "I"
        entry = self._vocabulary.entries.get(token.entry)
        if token.names_a_look and not (entry and entry.slot == "setting"):
            return "N"
        return "T" if any(named.kind == "things" for named in noun.named) else "K"


def _joined(run: list[NounMention], words: SceneDescription) -> NounMention | None:
    """One mention for a list of nouns; None if they name nothing in the scene.

    It has the surest names of each noun, for every preference of `surest`.
    """
    if not any(mention.named for mention in run):
        return None
    found: dict[tuple[str, frozenset[str]], Named] = {}
    for kind, first in product(("things", "lights"), ("material", "object", "first", "whole")):
        each = [surest(m, kind, first) or _region(m, kind, words) for m in run]
        every = [named for named in each if named]
        if len(every) == len(run):
            names = frozenset[str]().union(*(n.names for n in every))
            shared = frozenset.intersection(*(n.signs for n in every))
            least_sure = {*fit_signs(max(every, key=fit_rank))}  # a list is no surer
            signs = shared | least_sure | {"joined", f"joined {first}"}
            found.setdefault((kind, names), Named(kind, names, signs))
    text, excepted = " and ".join(mention.text for mention in run), all(mention.excepted for mention in run)
    named = (*found.values(),)
    return NounMention(run[0].start, run[-1].end, text, named=named, members=len(run), excepted=excepted)


def _region(mention: NounMention, kind: str, words: SceneDescription) -> Named | None:
    """The part of the image that a noun without a name means: "ground" all that lies around."""
    region = "" if mention.noun == "unknown" else REGIONS.get(mention.noun, "")
    names = materials_of(region, words) if kind == "things" else frozenset()
    return Named(kind, names, frozenset()) if names else None


def named_objects(mention: NounMention, index: SceneIndex) -> list[str]:
    """The objects that a noun means by their names."""
    if all(named.kind != "things" for named in mention.named):  # a lamp is one, light is none
        return []
    said = parts(mention.text)
    # "table lamp" may name an object "Lamp"
    return next((found for n in range(len(said)) if (found := index.objects(said[n:]))), [])


class OwnNouns:
    """Finds the nouns that look words describe."""

    def __init__(self, passage: Passage, mentions: list[NounMention], vocabulary: Vocabulary) -> None:
        self._items, self._vocabulary = passage.items, vocabulary
        self._looks = {look.index for look in passage.looks}
        self._at = {p: m for m in mentions if m.members == 1 for p in range(m.start, m.end + 1)}

    def of(self, look: int) -> NounMention | None:
        """The noun that a look word describes; None if that is not certain."""
        if self._items[look].change:
            return self.changed(look)
        return self._after(look) or self._before(look)

    def changed(self, look: int) -> NounMention | None:
        """The object of the change phrase that a look word is in: the roof of "the roof from red to grey"."""
        change, items = self._items[look].change, enumerate(self._items)
        places = (p for p, item in items if change and item.presents and item.change == change)
        return next((self._at[place] for place in places if place in self._at), None)

    def _after(self, look: int) -> NounMention | None:
        """The noun after a look word: "a red roof"; of several the last, unless the scene has only an earlier one."""
        found, led = None, self._led(look)
        for place in range(look + 1, len(self._items)):
            item = self._items[place]
            if item.clause != self._items[look].clause and (found or not led):
                break  # "a crisp, pale beam" goes on
            noun = self._noun(place)
            if noun and (led or self._is_a_noun(noun)):
                found = noun if not found or noun.named or not found.named else found
            elif found or not (item.names_a_look or item.strength is not None):
                break
        return found

    def _before(self, look: int) -> NounMention | None:
        """The noun before a look word: "the roof is red"; a noun of the scene rather than one without an article."""
        found = None
        for place in range(look - 1, -1, -1):
            item = self._items[place]
            apart = item.clause != self._items[look].clause
            if apart or not item.lists.isdisjoint(_STOPS) or item.text == "with":
                break
            noun = self._noun(place)
            if noun and (noun.named or (not found and self._is_a_noun(noun))):
                found = noun
            if noun and (place in self._looks or noun.named or self._led(noun.start)):
                break
        return found

    def _noun(self, place: int) -> NounMention | None:
        item = self._items[place]
        if place in self._at:
            return self._at[place]
        if item.entry and item.text.endswith(("light", "lights")):  # "moonlight"
            return NounMention(place, place, item.text, "light")
        scenery = place - 1 in self._looks and item.text in self._vocabulary.words["scenery"]
        is_noun = not item.filler and (scenery or is_object(item, self._vocabulary))
        return NounMention(place, place, item.text, item.noun or "unknown") if is_noun else None

    def _is_a_noun(self, noun: NounMention) -> bool:
        """True if a word is a noun by itself, or by the article before it."""
        listed = singular(noun.text) in thing_words()
        return bool(noun.named) or noun.noun != "unknown" or listed or self._led(noun.start)

    def _led(self, place: int) -> bool:
        """True if an article stands before a word and the looks before it."""
        while place > 0 and (self._items[place - 1].names_a_look or self._items[place - 1].strength):
            place -= 1
        return place > 0 and not self._items[place - 1].lists.isdisjoint(("article", "definite"))
