# SPDX-License-Identifier: Apache-2.0
"""The places of a prompt where things, lights and parts of the image are named: nouns, lists, exceptions, one of several."""

import re
from collections.abc import Iterable, Iterator
from dataclasses import replace
from itertools import chain
from typing import Literal

from .lexer import Token
from .lexicon.vocabulary import Vocabulary
from .names import FITS, parts
from .passage import Passage
from .scene import (
    REGIONS,
    LookIndex,
    Named,
    NounMention,
    SceneIndex,
    fit_rank,
    fit_signs,
    materials_of,
    surest,
)
from .types import SceneDescription

_LONGEST = 3  # tokens of a name
_SURE = (*(f"{s} {way}" for s in ("material", "object", "group", "light") for way in FITS[:2]),)
_BY_LOOK = frozenset({"material exact", "by look"})
_NO_NOUNS = {"negation", "comparison", "exception", "action", "undo", "beyond"}
# Picks
_ONE = ("one", "ones")
_NEAR = 3  # items from a word that picks to its noun
_RANKS = {
    "left": ("x", 0), "right": ("x", -1), "middle": ("off", 0), "near": ("depth", 0), "far": ("depth", -1),
    "big": ("size", -1), "small": ("size", 0), "first": ("name", 0), "second": ("name", 1), "third": ("name", 2),
    "fourth": ("name", 3), "fifth": ("name", 4), "last": ("name", -1),
}  # fmt: skip
"""A way to pick one of several -> by what these are ordered, and the place of the one."""
# Lists and exceptions are patterns over a row of letters, one for each token. Nouns: T a thing, K a light, N another name, and a noun
# that is a look; M a part of the image, I anything else without a name in the scene; n are their other tokens. Others: Q "all",
# O "the rest", L a look, _ filler, u unknown, . what is known, a comma between clauses, and those of _LETTERS.
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
    """All nouns of a prompt, those of several nouns last."""
    finder, single, start = _NounFinder(passage, index, vocabulary), [], 0
    while start < len(passage.items):  # the longest name first
        found = finder.at(start)
        if found:
            single.append(found)
        start = found.end + 1 if found else start + 1
    single = [
        m for m, after in zip(single, [*single[1:], None], strict=False) if not _owns(m, after, passage)
    ]
    single = with_picks(passage, single, index, vocabulary)
    excepted = _NounRow(passage, single, vocabulary).excepted()
    single = [replace(mention, excepted=mention.start in excepted) for mention in single]
    lists = (_joined(run, index.words) for run in _NounRow(passage, single, vocabulary).joined())
    return [*single, *filter(None, lists)]


def _owns(noun: NounMention, after: NounMention | None, passage: Passage) -> bool:
    """Whether a thing is only named for a part of it that follows: the bottle of "the bottle's cap"."""
    if after is None or after.start != noun.end + 1:
        return False
    both = [{n for each in m.named if each.kind == "things" for n in each.names} for m in (noun, after)]
    apart = passage.items[noun.end].clause != passage.items[after.start].clause
    looks = passage.items[noun.end].names_a_look or passage.items[after.start].names_a_look
    return all(both) and both[0].isdisjoint(both[1]) and not (apart or looks)


class _NounFinder:
    """Finds single nouns."""

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
        if seen := self._by_look(token, named):
            return self._mention(start, start, "", seen)
        noun = token.noun or "unknown" if token.presents else self._noun(start)
        return self._mention(start, start, noun, named) if named or noun else None

    def _mention(self, start: int, end: int, noun: str, named: list[Named]) -> NounMention:
        """A noun with the light that it means: "key light" the key, "light" light in general ("")."""
        text, roles = " ".join(i.text for i in self.items[start : end + 1]), self.vocabulary.roles
        last = self.items[end]
        role = next((roles[word] for word in last.text.split() if word in roles), "")
        role = last.noun if last.noun in ("fill", "rim") else role
        return NounMention(start, end, text, noun, role, tuple(named))

    def _of_several(self, start: int, count: int) -> list[Named]:
        """Names of some tokens in a row, if that is sure."""
        row = self.items[start : start + count]
        apart = any(i.clause != row[0].clause or i.ties for i in row)
        if len(row) < count or apart or row[0].filler or row[-1].filler:
            return []
        said = parts(" ".join(i.text for i in row))
        return self._surely(self.index.named(said)) or self._lamps(said)

    def _of_one(self, start: int, said: tuple[str, ...]) -> list[Named]:
        """Names of a token by itself, by its last word if by nothing else, or with a mistake."""
        token = self.items[start]
        plural = token.text.endswith("s")
        named = self.index.named(said) or self._lamps(said)
        if token.text in self.vocabulary.roles:  # a "blue rim" is of light, though glasses have rims
            named = [n for n in named if n.kind == "lights"] or self._surely(named)
        last = said[-1:]
        if not named and len(said) > 1 and token.noun != "tone":  # "the whole picture" hangs on no wall
            named, said = self.index.named(last), last
        if said == last and last[0] in self.vocabulary.lists["anylight"]:  # though one may be called "Light"
            named = [n for n in named if n.signs != {"light exact"} and (plural or not _is_translated([n]))]
        if "stop" in token.lists and not token.noun:
            return self._surely(named)
        return named or ([] if token.known else self.index.modeled(said[-1]))

    def _by_look(self, token: Token, named: list[Named]) -> list[Named]:
        """Materials by their present look or shape, which also tell apart the materials of a name."""
        things = [n for n in named if n.kind == "things"]
        if things and token.presents:
            return [replace(n, names=self._looks.narrowed(n.names, token.presents)) for n in things]
        names = frozenset[str]() if named else self._looks.meant(token.text, token.presents)
        return [Named("things", names, _BY_LOOK)] if names else []

    def _is_of_the_next(self, start: int) -> bool:
        """Whether a look is said of the thing after it: "red" of "red leather seats" is no red lamp."""
        token, head = self.items[start], self._head_after(start)
        if head is None or not token.names_a_look or token.noun:
            return False
        return not token.entry or bool(self._surely(self.index.named(parts(head.text))))

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

    def _surely(self, named: list[Named]) -> list[Named]:
        return [n for n in named if not n.signs.isdisjoint(_SURE)]

    def _lamps(self, said: tuple[str, ...]) -> list[Named]:
        """Of "window light" the lights that a window names."""
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


def _is_translated(named: list[Named]) -> bool:
    """Whether no name has the very word: "wooden" of "wood planks"."""
    return all(sign.endswith("synonym") for n in named for sign in fit_signs(n))


class _NounRow:
    """The nouns of a prompt among its other tokens, as a row of letters."""

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
        """Places where nouns begin that the prompt leaves out."""
        spans = [match.span(1) for pattern in _EXCEPTED for match in pattern.finditer(self._letters)]
        return {noun.start for span in spans for noun in self._within(*span, _NOUNS)}

    def joined(self) -> list[list[NounMention]]:
        """The lists of nouns that have nothing said between them."""
        return [list(self._within(*match.span(), _LISTABLE)) for match in _JOINED.finditer(self._letters)]

    def _within(self, start: int, end: int, letters: str) -> Iterator[NounMention]:
        places = (self._places[i] for i in range(start, end) if self._letters[i] in letters)
        return (self._nouns[place] for place in places)

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
    """One mention of several nouns: the surest names of each, once of all sources and once of materials; None if nothing."""
    if not any(mention.named for mention in run):
        return None
    found = []
    for kind, first in (
        (k, f) for k in ("things", "lights") for f in ("material", "object", "first", "whole")
    ):
        each = [surest(m, kind, first) or _region(m, kind, words) for m in run]
        every = [named for named in each if named]
        if len(every) == len(run):
            names = frozenset().union(*(n.names for n in every))
            shared = frozenset.intersection(*(n.signs for n in every))
            least_sure = {*fit_signs(max(every, key=fit_rank))}  # a list is no surer
            signs = shared | least_sure | {"joined", f"joined {first}"}
            found.append(Named(kind, names, signs))
    text = " and ".join(mention.text for mention in run)
    excepted = all(mention.excepted for mention in run)
    named = {(n.kind, n.names): n for n in reversed(found)}
    return NounMention(
        run[0].start, run[-1].end, text, named=tuple(named.values()), members=len(run), excepted=excepted
    )


def _region(mention: NounMention, kind: str, words: SceneDescription) -> Named | None:
    """The part of the image that a noun without a name means: "ground" all that lies around."""
    region = "" if mention.noun == "unknown" else REGIONS.get(mention.noun, "")
    names = materials_of(region, words) if kind == "things" else frozenset()
    return Named(kind, names, frozenset()) if names else None


def with_picks(
    passage: Passage, single: list[NounMention], index: SceneIndex, vocabulary: Vocabulary
) -> list[NounMention]:
    """The mentions of a prompt, each with the one of several that is picked: "the left ball", "the one on the right", "ribbon B"."""
    found = {mention.start: _with_number(passage, mention, index) for mention in single}
    for place, item in enumerate(passage.items):
        # A word such as "left", or a place such as "on the right"
        *before, last = item.text.split()
        placed = not before or before[0] in vocabulary.lists["around"]
        way = vocabulary.picks.get(last) if placed else None
        if way is None or item.wished:
            continue
        noun = _noun_of(passage, place, single)
        groups = [_group(noun, index)] if noun else []
        if not noun:  # the noun of "the left one" is one that came before, or the subject, or all objects
            groups = [g for m in single if m.end < place and len(g := _group(m, index)) > 1][-1:]
            if any(after.text in _ONE for after in passage.items[place + 1 : place + 2]):
                regions = index.words.objects
                groups += [[o for o, region in regions.items() if region == "subject"], [*regions]]
        one = next((o for g in groups if (o := _picked(way, g, index.words))), "")
        if one:
            target = noun or found.get(place) or NounMention(place, place, item.text)
            known = found.get(target.start, target)
            found[target.start] = replace(_picking(known, index.worn(one), f"picked {way}"), picked=one)
    return [found[start] for start in sorted(found)]


def _with_number(passage: Passage, mention: NounMention, index: SceneIndex) -> NounMention:
    """A noun with the number or letter after it: "cube 2" is Cube.002, "ribbon B" Ribbon_B, "area" and "area 1" are lights."""
    after = passage.items[mention.end + 1 : mention.end + 2]
    said, group = after[0].text if after else "", _group(mention, index)
    ends = {name: re.split(r"[\W_]+", name)[-1].lower() for name in group} if len(group) > 1 and said else {}
    same = [name for name, end in ends.items() if _bare(end) == _bare(said)]
    if len(same) == 1:
        return replace(_picking(mention, index.worn(same[0]), "picked by number"), picked=same[0])
    number = said if said.isdecimal() else ""
    every = (n.names for n in mention.named if n.kind == "lights" and len(n.names) > 1)
    lamps = sorted(frozenset().union(*every)) if number or mention.noun != "light" else []
    meant = [name for name in lamps if _bare("".join(re.findall(r"\d+$", name))) == _bare(number)]
    return _picking(mention, frozenset(meant), "picked by number", "lights") if len(meant) == 1 else mention


def _bare(number: str) -> str:
    return str(int(number)) if number.isdecimal() else number


def _picking(
    mention: NounMention, names: frozenset[str], sign: str, kind: Literal["things", "lights"] = "things"
) -> NounMention:
    """A noun that means some materials or lights above all; its other names stay known."""
    known = [n for n in mention.named if n.kind == kind and n.names == names]
    signs = frozenset().union(*(n.signs for n in known), {"picked", sign})
    rest = [n for n in mention.named if n not in known]
    return replace(mention, named=(*rest, Named(kind, names, signs)))


def named_objects(mention: NounMention, index: SceneIndex) -> list[str]:
    """The objects that a noun means by their names."""
    if mention.picked:
        return [mention.picked]
    if all(named.kind != "things" for named in mention.named):  # a lamp is one, light is none
        return []
    said = parts(mention.text)
    # "table lamp" of a lamp
    return next((found for n in range(len(said)) if (found := index.objects(said[n:]))), [])


def _group(mention: NounMention, index: SceneIndex) -> list[str]:
    """The objects whose names a noun fits best."""
    return index.objects(parts(mention.text)) if mention.noun != "light" else []


def _noun_of(passage: Passage, place: int, single: list[NounMention]) -> NounMention | None:
    """The noun that a word picks one of: right after it ("the left ball"), or before it ("the ball on the left")."""
    items = passage.items
    known = (m for m in single if m.text not in _ONE and (m.named or m.noun != "unknown"))
    near = [m for m in known if items[m.start].clause == items[place].clause and not m.covers(place)]
    after = (m for m in near if place < m.start <= place + _NEAR)
    right_after = (m for m in after if all(i.names_a_look for i in passage.content(place + 1, m.start)))
    led_back = []
    for mention in (m for m in reversed(near) if m.end < place <= m.end + _NEAR):
        between = items[mention.end + 1 : place]
        ties = any(token.ties for token in between) or " " in items[place].text
        led_back += [mention] if ties and all(token.filler or token.ties for token in between) else []
    return next(chain(right_after, led_back), None)


def _picked(way: str, group: list[str], words: SceneDescription) -> str:
    """The one of a group of objects that a word picks, by a key of `_RANKS`; "" where it cannot be told."""
    by, index = _RANKS[way]
    ranks: dict[str, tuple[float, str]] = {}
    for name in group:
        if by == "name":  # "Ball", "Ball.001"
            ranks[name] = int((re.findall(r"\d+", name) or [0])[-1]), name
        elif name in words.places:  # from left to right, from near to far, by size
            x, depth, size = words.places[name]
            ranks[name] = {"x": x, "off": abs(x), "depth": depth, "size": size}[by], ""
    order = sorted(ranks, key=lambda name: ranks[name])
    differs = len(order) > max(index, 1) and ranks[order[0]] != ranks[order[-1]]
    return order[index] if differs else ""
