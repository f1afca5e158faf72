# SPDX-License-Identifier: Apache-2.0
"""Which targets of a reader's look words are what the labels of a sentence say."""

from __future__ import annotations

import re
from difflib import SequenceMatcher

from lab.train.sentences.labels import ROLES, LabeledScene, LabeledSentence, LabelTarget, LookWord
from proxy_renderer.words.lexicon.entries import normalize
from proxy_renderer.words.lexicon.vocabulary import shipped_vocabulary
from proxy_renderer.words.names import is_detail
from proxy_renderer.words.targets import MATTER, PromptPairs, TargetPair
from proxy_renderer.words.types import GLOW

_WORD = re.compile(r"\d+|[^\W\d_]+(?:['’][a-z]+)?")  # "2900K" is read as "2900 kelvin"
_NAMED = ("light", "lights", "key", "fill", "rim", "air", "surroundings")
"""Kinds of targets that a word names by saying what there is of them."""
_GENERAL = ("lighting", "atmosphere")


def as_meant(word: str) -> str:
    """A word as the readers have it: normalized, and spelled out where it was typed in a hurry."""
    plain = normalize(word)
    return shipped_vocabulary().typed.get(plain, plain)


def right_pairs(sentence: LabeledSentence, read: PromptPairs) -> list[list[bool]]:
    """Of each pair of a reading, whether it is right.

    A look word that no label covers is right where it is left out.

    Args:
        read: The reader's look words with all their targets.
    """
    places = _places(sentence.text, read)
    found = []
    for look, pairs in zip(read.passage.looks, read.pairs, strict=True):
        label = next((w for w in sentence.words if _covers(w, places.get(look.index))), None)
        wanted = label.targets if label else (LabelTarget("none"),)
        right = [any(is_right(pair, target, sentence.scene) for target in wanted) for pair in pairs]
        if not label:
            itself = {number for number, noun in enumerate(read.mentions) if noun.covers(look.index)}
            right = _unlabeled(right, pairs, sentence, _names_a_thing(look.index, read), itself)
        found.append(right)
    return found


def _names_a_thing(index: int, read: PromptPairs) -> bool:
    """True if a look word is the name of something in the scene: "lake" where there is one."""
    named = (n for m in read.mentions if m.covers(index) and m.members == 1 for n in m.named)
    return any(each.kind == "things" for each in named)


def _unlabeled(
    right: list[bool], pairs: list[TargetPair], sentence: LabeledSentence, a_thing: bool, itself: set[int]
) -> list[bool]:
    """The right target of a word that needs no label: it says where a light comes from, or only names what it is ("sunlight").

    `itself` are the numbers of the nouns that the word is in.

    A word that names a thing of the scene is no setting besides: "lake" of "lake emerald" where there is a lake. Other
    settings may have been no look word yet when the sentence was labeled: neither reading of them is wrong.
    """
    directs = [_directs(pair) for pair in pairs]
    if any(directs):
        lit = [t for word in sentence.words for t in word.targets if t.kind in ("lights", "light", *ROLES)]
        wanted = lit or [LabelTarget("light")]
        rightly = (any(is_right(pair, t, sentence.scene) for t in wanted) for pair in pairs)
        return [both == (True, True) for both in zip(directs, rightly, strict=True)]
    may_be = [kind for kind in _NAMED if not (a_thing and kind == "surroundings")]
    themselves = [pair.target.mention in itself and pair.target.kind in may_be for pair in pairs]
    known = any(t and pair.target.names for t, pair in zip(themselves, pairs, strict=True))
    if any(themselves):
        return [t or (known and r) for t, r in zip(themselves, right, strict=True)]
    around = [not a_thing and pair.sense.slot == "setting" and pair.target.kind == "surroundings" for pair in pairs]
    return [r or a for r, a in zip(right, around, strict=True)]


def _directs(pair: TargetPair) -> bool:
    """True if a word says where the light comes from that it describes."""
    entry = shipped_vocabulary().entries.get(pair.sense.entry)
    effects = entry.effects if entry else ()
    return any(e.name in ("azimuth", "elevation") and not e.weak for e in effects)


def _covers(word: LookWord, place: tuple[int, int] | None) -> bool:
    return place is not None and place[0] < word.end and word.start < place[1]


def _places(text: str, read: PromptPairs) -> dict[int, tuple[int, int]]:
    """Item -> where its words stand in the artist's text; what the reader has put otherwise, where others are missing.

    "Night" of "three in the morning" stands where all four do; as many words as are missing, mistyped ones, stand one by one.
    """
    theirs = [(as_meant(m.group()), m.span()) for m in _WORD.finditer(text)]
    mine = [(word, i) for i, item in enumerate(read.passage.items) for word in item.text.split()]
    matcher = SequenceMatcher(None, [w for w, _ in mine], [w for w, _ in theirs], autojunk=False)
    places: dict[int, tuple[int, int]] = {}
    for kind, first, last, start, end in matcher.get_opcodes():
        if kind not in ("equal", "replace"):
            continue
        alike = last - first == end - start
        for n in range(first, last):
            spans = [theirs[start + n - first][1]] if alike else [span for _, span in theirs[start:end]]
            item = mine[n][1]
            places[item] = (places.get(item, spans[0])[0], spans[-1][1])
    return places


def is_right(pair: TargetPair, wanted: LabelTarget, scene: LabeledScene) -> bool:
    """True if a pair is what a label says.

    Args:
        pair: A look word with a target.
    """
    kind, names = pair.target.kind, pair.target.names
    if wanted.kind in ("materials", "subject", "surroundings"):
        meant = wanted.names if wanted.kind == "materials" else scene.materials_of(wanted.kind)
        return kind == wanted.kind or (kind in MATTER and _painted(pair, scene) == meant) or _plain(names) == meant
    if wanted.kind == "lights":
        return _plain(names) == wanted.names
    if wanted.kind in ROLES:
        return kind == wanted.kind or (bool(names) and names == _of_role(wanted.kind, scene))
    if wanted.kind == "light":
        return kind in ("light", "shadow", "highlight") or (kind == "lights" and names == _of_role("key", scene))
    if wanted.kind == "picture" and kind in ("shadow", "highlight"):
        return True
    if wanted.kind == "picture" and kind in ("light", "air"):
        return pair.sense.slot in _GENERAL and pair.sense.way == "own"
    return kind == wanted.kind


def _painted(pair: TargetPair, scene: LabeledScene) -> frozenset[str]:
    """The materials that a target changes: details of a thing are spared."""
    kind = pair.target.kind
    names = scene.materials_of(kind) if kind in ("subject", "surroundings") else pair.target.names
    return frozenset(name for name in names if not is_detail(name)) or names


def _plain(names: frozenset[str]) -> frozenset[str]:
    return frozenset(name.removeprefix(GLOW) for name in names)


def _of_role(role: str, scene: LabeledScene) -> frozenset[str]:
    return frozenset(light.name for light in scene.lights if light.role == role)
