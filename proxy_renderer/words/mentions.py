# SPDX-License-Identifier: Apache-2.0
"""Finds where a prompt names objects, lights and parts of the image: nouns, lists of nouns, and exceptions."""

import re
from dataclasses import replace

from .lexicon.languages import singular, thing_words
from .lexicon.vocabulary import Vocabulary
from .names import FITS, parts
from .passage import Passage, is_object
from .scene import REGIONS, LookIndex, Named, NounMention, SceneIndex, fit_rank, fit_signs, surest

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
    """All nouns of a prompt in its order, then a mention for each list that joins several of them: "box and cup"."""
    finder, single, start = _NounFinder(passage, index, vocabulary), [], 0
    while start < len(passage.items):  # the longest name first
        found = finder.at(start)
        if found:
            single.append(found)
        start = found.end + 1 if found else start + 1
    letters, places = _letters(passage, single, vocabulary)

    def nouns_in(start: int, end: int, kinds: str) -> list[int]:
        return [places[i] for i in range(start, end) if letters[i] in kinds]

    spans = [match.span(1) for pattern in _EXCEPTED for match in pattern.finditer(letters)]
    excepted = {place for span in spans for place in nouns_in(*span, _NOUNS)}
    by_start = {mention.start: replace(mention, excepted=mention.start in excepted) for mention in single}
    lists = (nouns_in(*match.span(), _LISTABLE) for match in _JOINED.finditer(letters))
    joined = (_joined([by_start[start] for start in starts]) for starts in lists)
    return [*by_start.values(), *filter(None, joined)]


class _NounFinder:
    def __init__(self, passage: Passage, index: SceneIndex, vocabulary: Vocabulary) -> None:
        self.passage, self.items, self.index, self.vocabulary = passage, passage.items, index, vocabulary
        self._looks = LookIndex(index.words, vocabulary)

    def at(self, start: int) -> NounMention | None:
        """The noun that begins at token `start`, the longest name first; None if none does."""
        token = self.items[start]
        if token.ties or token.wished:
            return None
        for count in range(_LONGEST, 1, -1):  # tokens in a row, if it is sure that they name something
            row = self.items[start : start + count]
            apart = any(i.clause != token.clause or i.ties for i in row)
            words = () if apart or token.filler or row[-1].filler else parts(" ".join(i.text for i in row))
            if len(row) == count and (named := self._surely(self.index.named(words)) or self._lamps(words)):
                return self._mention(start, start + count - 1, row[-1].noun, named)
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
        return self._mention(start, start, noun, named) if named or noun else None

    def _mention(self, start: int, end: int, noun: str, named: list[Named]) -> NounMention:
        """The noun of the tokens `start` to `end`, with its role of lights: "key" for "key light", "" for "light"."""
        text, last = " ".join(i.text for i in self.items[start : end + 1]), self.items[end]
        role = last.noun if last.noun in ("fill", "rim") else self.vocabulary.role(last.text)
        return NounMention(start, end, text, noun, role, tuple(named))

    def _of_one(self, start: int, said: tuple[str, ...]) -> list[Named]:
        """Materials and lights that a single token names, by all of its words `said` or else by the last one."""
        token, last = self.items[start], said[-1:]
        named, plural = self.index.named(said) or self._lamps(said), token.text.endswith("s")
        of_a_role = token.text in self.vocabulary.roles or (token.noun in ("rim", "fill") and not plural)
        if not named and len(said) > 1 and token.noun != "tone":  # "the whole picture" is no object
            named, said = self.index.named(last), last
        any_light = said == last and last[0] in self.vocabulary.lists["anylight"]
        if any_light:  # "light" does not mean one that is called "Light"
            named = [n for n in named if n.signs != {"light exact"}]
        of_light = any_light and not plural and self.vocabulary.nouns.get(last[0]) == "light"
        if of_a_role or of_light:  # a "blue rim" is of light, though glasses have rims; and no light is a "Tail Light"
            is_light = any(i.text in self.vocabulary.lists["anylight"] for i in self.items[start + 1 : start + 2])
            named = [n for n in named if n.kind == "lights"] or ([] if is_light else self._surely(named))
        return self._surely(named) if token.filler and not token.noun else named  # "the" is no French tea

    def _is_of_the_next(self, start: int) -> bool:
        """True if look word `start` describes the next noun, with only looks between: "red" in "red leather seats"."""
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
        """Kind of noun of token `start`: "unknown" for an unknown word or a look that may be a thing; "" for none."""
        token = self.items[start]
        known = token.noun or ("thing" not in token.lists and (token.known or token.unsure))
        return token.noun if known else "unknown"


def _letters(passage: Passage, single: list[NounMention], vocabulary: Vocabulary) -> tuple[str, list[int]]:
    """A string: a letter for each token, commas between clauses (see `_LETTERS`); and its characters' token places."""
    nouns = {mention.start: mention for mention in single}
    inside = {i for m in single for i in range(m.start + 1, m.end + 1)}
    letters, places = "", list[int]()
    for place, token in enumerate(passage.items):
        noun = nouns.get(place)
        entry = vocabulary.entries.get(token.entry)
        if place in inside:
            letter = "n"
        elif noun is None:
            kinds = (letter for letter, lists in _LETTERS.items() if lists <= token.lists)
            rest = "_" if token.filler else "L" if token.names_a_look else "." if token.known else "u"
            letter = next(kinds, rest)
        elif noun.noun == "others":
            letter = "Q" if token.filler else "O"
        elif not noun.named:
            letter = "M" if noun.noun in REGIONS and noun.end + 1 not in nouns else "I"
        elif token.names_a_look and not (entry and entry.slot == "setting"):
            letter = "N"
        else:
            letter = "T" if any(named.kind == "things" for named in noun.named) else "K"
        parted = place > 0 and token.clause != passage.items[place - 1].clause
        letters += f",{letter}" if parted else letter
        places += [place] * (1 + parted)
    return letters, places


def _joined(run: list[NounMention]) -> NounMention | None:
    """One mention for a list of nouns, with the surest names of each noun; None if none of them names anything."""
    if not any(mention.named for mention in run):
        return None
    found = []
    for kind in ("things", "lights"):
        every = [named for mention in run if (named := surest(mention, kind, "whole"))]
        if len(every) == len(run):
            names = frozenset[str]().union(*(n.names for n in every))
            shared = frozenset.intersection(*(n.signs for n in every))
            least_sure = {*fit_signs(max(every, key=fit_rank))}  # a list is no surer
            found.append(Named(kind, names, shared | least_sure | {"joined", "joined whole"}))
    text, excepted = " and ".join(mention.text for mention in run), all(mention.excepted for mention in run)
    return NounMention(run[0].start, run[-1].end, text, named=(*found,), members=len(run), excepted=excepted)


def named_objects(mention: NounMention, index: SceneIndex) -> list[str]:
    """Names of the scene's objects that a noun names; [] if it names lights only."""
    if all(named.kind != "things" for named in mention.named):  # a lamp is one, light is none
        return []
    said = parts(mention.text)
    # "table lamp" may name an object "Lamp"
    return next((found for n in range(len(said)) if (found := index.objects(said[n:]))), [])


class OwnNouns:
    """Finds the noun that a look word describes; `look` is the place of that word among the tokens."""

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
        """The object of a look word's change phrase, "roof" of "the roof from red to grey"; None if it is in none."""
        change, items = self._items[look].change, enumerate(self._items)
        places = (p for p, item in items if change and item.presents and item.change == change)
        return next((self._at[place] for place in places if place in self._at), None)

    def _after(self, look: int) -> NounMention | None:
        """The noun after a look word ("a red roof"), of several the last one in the scene, else the last; or None."""
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
        """The noun before a look word ("the roof is red"); the scene's precede those without article; or None."""
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
        listed = singular(noun.text) in thing_words()
        return bool(noun.named) or noun.noun != "unknown" or listed or self._led(noun.start)

    def _led(self, place: int) -> bool:
        """True if an article stands before token `place`, or before the looks in front of that token."""
        while place > 0 and (self._items[place - 1].names_a_look or self._items[place - 1].strength):
            place -= 1
        return place > 0 and not self._items[place - 1].lists.isdisjoint(("article", "definite"))
