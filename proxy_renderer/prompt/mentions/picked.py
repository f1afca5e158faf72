# SPDX-License-Identifier: Apache-2.0
"""The places of a prompt that pick one of several alike things: "the left ball", "the one on the right", "ribbon B"."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from itertools import chain
from typing import Literal

from ..lexicon.vocabulary import Vocabulary
from ..names import plain_name
from ..tokens import Token
from ..types import SceneDescription
from .names import parts
from .nouns import Named, NounMention
from .passage import Passage
from .scene import SceneIndex

_ONE = ("one", "ones")
_NEAR = 3  # items from a word that picks to its noun
_RANKS = {
    "left": ("x", 0), "right": ("x", -1), "middle": ("off", 0), "near": ("depth", 0), "far": ("depth", -1),
    "big": ("size", -1), "small": ("size", 0), "first": ("name", 0), "second": ("name", 1), "third": ("name", 2),
    "fourth": ("name", 3), "fifth": ("name", 4), "last": ("name", -1),
}  # fmt: skip
"""A way to pick one of several -> by what these are ordered, and the place of the one."""


def with_picks(
    passage: Passage, single: list[NounMention], index: SceneIndex, vocabulary: Vocabulary
) -> list[NounMention]:
    """The mentions of a prompt, with what is picked; the noun of "the left one" is one that came before."""
    found = {mention.start: _with_number(passage, mention, index) for mention in single}
    for place, item in enumerate(passage.items):
        way = _way(item.text, vocabulary)
        if way is None or item.wished:
            continue
        noun = _noun_of(passage, place, single)
        groups = [_group(noun, index)] if noun else []
        groups += [g for m in single if m.end < place and not noun and len(g := _group(m, index)) > 1][-1:]
        groups += _alike(index.words) if not noun and _is_one(passage, place) else []
        one = next((o for g in groups if (o := _picked(way, g, index.words))), "")
        if one:
            target = noun or found.get(place) or NounMention(place, place, item.text)
            known = found.get(target.start, target)
            found[target.start] = _picking(known, index.worn(one), f"picked {way}")
    return [found[start] for start in sorted(found)]


def _way(said: str, vocabulary: Vocabulary) -> str | None:
    """How a word, or a place such as "on the right", picks one of several; None if it does not."""
    *before, last = said.split()
    placed = not before or before[0] in vocabulary.lists["around"]
    return vocabulary.picks.get(last) if placed else None


def _with_number(passage: Passage, mention: NounMention, index: SceneIndex) -> NounMention:
    """A noun with the number or letter after it."""
    after = passage.items[mention.end + 1 : mention.end + 2]
    group = _group(mention, index)
    one = _numbered(after[0].text, group) if len(group) > 1 and after else ""
    if one:
        return _picking(mention, index.worn(one), "picked by number")
    lamp = _lamp_called(mention, after[0].text if after else "")
    return _picking(mention, frozenset({lamp}), "picked by number", "lights") if lamp else mention


def _lamp_called(mention: NounMention, number: str) -> str:
    """Of "Area" and "Area.001" the light that a noun with this number, or without one, is the name of; "" where it is none's."""
    every = (n.names for n in mention.named if n.kind == "lights" and len(n.names) > 1)
    ends = {name: "".join(re.findall(r"\d+$", name)) for name in sorted(frozenset().union(*every))}
    said = number if number.isdecimal() else ""
    if mention.noun == "light" and not said:
        return ""
    meant = [name for name, end in ends.items() if _bare(end) == _bare(said)]
    return meant[0] if len(meant) == 1 else ""


def _picking(
    mention: NounMention, names: frozenset[str], sign: str, kind: Literal["things", "lights"] = "things"
) -> NounMention:
    """A noun that means some materials or lights above all; what else is known of them stays known."""
    known = [n for n in mention.named if n.kind == kind and n.names == names]
    signs = frozenset().union(*(n.signs for n in known), {"picked", sign})
    rest = [n for n in mention.named if n not in known]
    return replace(mention, named=(*rest, Named(kind, names, signs)))


def _group(mention: NounMention, index: SceneIndex) -> list[str]:
    """The objects that a noun names."""
    return index.objects(parts(mention.text)) if mention.noun != "light" else []


def _noun_of(passage: Passage, place: int, single: list[NounMention]) -> NounMention | None:
    """The noun that a word picks one of: right after it, or before it and "on the"."""
    items = passage.items
    known = (m for m in single if m.text not in _ONE and (m.named or m.noun != "unknown"))
    near = [m for m in known if items[m.start].clause == items[place].clause and not m.covers(place)]
    after = (m for m in near if place < m.start <= place + _NEAR)
    before = (m for m in reversed(near) if m.end < place <= m.end + _NEAR)
    right_after = (m for m in after if all(i.names_a_look for i in passage.content(place + 1, m.start)))
    led_back = (m for m in before if _leads_back(items[m.end + 1 : place], items[place]))
    return next(chain(right_after, led_back), None)


def _is_one(passage: Passage, place: int) -> bool:
    """Whether a word that picks stands for an object by itself: "the left one", "left red", but not "from the left"."""
    clause = [p for p, item in enumerate(passage.items) if item.clause == passage.items[place].clause]
    after = [passage.items[p] for p in clause if p > place]
    if any(item.text in _ONE for item in after[:1]):
        return True
    before = [passage.items[p] for p in clause if p < place]
    definite = any("definite" in item.lists for item in before[-1:])
    where = any(item.ties for item in before[-1 - definite :])
    said = next((item for item in after if not item.filler), None)
    return said is not None and (said.names_a_look or (said.ties and definite)) and not where


def _leads_back(between: list[Token], pick: Token) -> bool:
    """Whether a word picks one of what was named before: "the ball on the left"."""
    said = any(token.ties for token in between) or " " in pick.text
    return said and all(token.filler or token.ties for token in between)


def _picked(way: str, group: list[str], words: SceneDescription) -> str:
    """The one of a group of objects that a word picks; "" where it cannot be told.

    Args:
        way: A key of `_RANKS`.
        words: The names in the scene, and where the objects are.
    """
    by, index = _RANKS[way]
    ranks = {name: _rank(by, name, words) for name in group if by == "name" or name in words.places}
    order = sorted(ranks, key=lambda name: ranks[name])
    told = len(order) > max(index, 1) and ranks[order[0]] != ranks[order[-1]]
    return order[index] if told else ""


def _rank(by: str, name: str, words: SceneDescription) -> tuple[float, str]:
    """Where an object stands among others, from left to right, from near to far, by its size, or by its name: "Ball", "Ball.001"."""
    if by == "name":
        return int((re.findall(r"\d+", name) or [0])[-1]), name
    x, depth, size = words.places[name]
    return {"x": x, "off": abs(x), "depth": depth, "size": size}[by], ""


def _numbered(said: str, group: list[str]) -> str:
    """The object whose name ends in a number or letter: "cube 2" is Cube.002, "ribbon B" Ribbon_B; "" for none."""
    same = [name for name in group if _bare(re.split(r"[\W_]+", name)[-1].lower()) == _bare(said)]
    return same[0] if len(same) == 1 else ""


def _bare(number: str) -> str:
    return str(int(number)) if number.isdecimal() else number


def _alike(words: SceneDescription) -> Iterator[list[str]]:
    """The subject's objects of one name, most of them first; then all of the subject's, and all of the scene's."""
    subject = [name for name, region in words.objects.items() if region == "subject"]
    kinds: dict[str, list[str]] = {}
    for name in subject:
        kinds.setdefault(plain_name(name), []).append(name)
    yield from sorted((kind for kind in kinds.values() if len(kind) > 1), key=len, reverse=True)
    yield from (subject, list(words.objects))
