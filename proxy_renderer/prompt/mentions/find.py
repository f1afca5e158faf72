# SPDX-License-Identifier: Apache-2.0
"""The places of a prompt where things, lights and parts of the picture are named."""

from __future__ import annotations

from dataclasses import replace
from itertools import takewhile

from ..lexicon.nearest import table
from ..lexicon.vocabulary import Vocabulary
from ..tokens import Token
from .joined import joined
from .names import FITS, parts
from .nouns import Named, NounMention
from .passage import Passage
from .picked import with_picks
from .scene import SceneIndex
from .spared import with_spared

_LONGEST = 3  # tokens of a name
_SURE = (*(f"{s} {way}" for s in ("material", "object", "group", "light") for way in FITS[:2]),)


def mentions(passage: Passage, index: SceneIndex, vocabulary: Vocabulary) -> list[NounMention]:
    """All of a prompt, those of several nouns last.

    Args:
        passage: The prompt.
        index: The scene.
        vocabulary: What words mean.
    """
    single: list[NounMention] = []
    start = 0
    while start < len(passage.items):
        found = _mention(passage, start, index, vocabulary)
        if found:
            single.append(_with_side(passage, found, index, vocabulary))
        start = found.end + 1 if found else start + 1
    single = [m for m in single if not _determines(m, passage, single, vocabulary)]
    single = with_spared(passage, with_picks(passage, single, index, vocabulary))
    return [*single, *joined(passage, single, index.words)]


def _determines(
    mention: NounMention, passage: Passage, single: list[NounMention], vocabulary: Vocabulary
) -> bool:
    """Whether "all" only says that all of the noun after it is meant: "all bottles", "all of the fruit"."""
    if mention.noun != "others" or not passage.items[mention.start].filler:
        return False
    ahead = passage.items[mention.end + 1 :]
    skipped = sum(1 for _ in takewhile(lambda i: i.filler or "of" in i.token.lists, ahead))
    place = mention.end + 1 + skipped
    if not any(m.start == place and m.named for m in single):
        return False
    item = passage.items[place]
    known = vocabulary.entries.get(item.token.entry)
    return not item.names_a_look or (known is not None and known.slot == "setting")


def _mention(passage: Passage, start: int, index: SceneIndex, vocabulary: Vocabulary) -> NounMention | None:
    """The one that begins at an item, the longest name first."""
    item = passage.items[start]
    if item.wished or item.ties:
        return None
    for count in range(_LONGEST, 1, -1):
        row = passage.items[start : start + count]
        whole = len(row) == count and all(i.clause == item.clause and not i.ties for i in row)
        text = " ".join(i.token.text for i in row)
        if whole and not (row[0].filler or row[-1].filler):
            named = [n for n in index.named(parts(text)) if not n.signs.isdisjoint(_SURE)]
            named = named or _lamps(parts(text), index, vocabulary)
            if named:
                last = row[-1].token
                return NounMention(start, start + count - 1, text, last.noun, light_role(last), tuple(named))
    return _word(passage, start, index, vocabulary)


def _lamps(said: tuple[str, ...], index: SceneIndex, vocabulary: Vocabulary) -> list[Named]:
    """Of "window light" the lights that a window names: what stands before a word for light tells which one."""
    if len(said) < 2 or said[-1] not in vocabulary.lists["anylight"]:
        return []
    return [n for n in index.named(said[:-1]) if n.kind == "lights"]


def _word(passage: Passage, start: int, index: SceneIndex, vocabulary: Vocabulary) -> NounMention | None:
    """A token that names something by itself, by its last word if by nothing else."""
    token = passage.items[start].token
    said = parts(token.name if _is_misspelled(token) else token.text)
    if "others" in token.lists:
        return NounMention(start, start, token.text, "others")
    if not said or token.lists & {"negation", "comparison", "exception", "action", "undo", "beyond"}:
        return None
    named = index.named(said) or _lamps(said, index, vocabulary)
    picture = token.noun == "tone"  # "the whole picture" is none that hangs on a wall
    if not named and len(said) > 1 and not picture:
        named = index.named(said[-1:])
    if "stop" in token.lists and not token.noun:
        named = [n for n in named if not n.signs.isdisjoint(_SURE)]
    plain = not token.known
    if not named and plain and not token.color:
        named = [n for n in index.named(said[-1:], guess=True) if _may_be_guessed(n, token, index)]
    styled = any(i.filler for i in passage.items[start + 1 : start + 2])  # "castle look"
    a_thing = "thing" in token.lists and not (styled or _is_place(passage, start))
    noun = token.noun or _stands_for(token) or ("unknown" if a_thing else "")
    if not named and noun in ("unknown", "") and _gives_light(passage, start):
        noun = "light"
    if not (named or noun):
        return None
    return NounMention(start, start, token.text, noun, light_role(token), tuple(named))


def _stands_for(token: Token) -> str:
    """What an unknown word may be: the subject, where something of it is of the same sort."""
    roles = token.entry or token.color or token.adjective or token.noun or token.strength or token.lists
    if token.scene and token.guess and not roles:
        return "subject" if token.scene.region == "subject" else "unknown"
    return "" if token.known or token.near else "unknown"


def _is_place(passage: Passage, start: int) -> bool:
    """Whether a noun is where something is: "in a dark castle"."""
    before = [
        i for i in passage.content(0, start) if i.clause == passage.items[start].clause and not i.names_a_look
    ]
    return bool(before) and not before[-1].token.lists.isdisjoint(("around", "inside"))


def _gives_light(passage: Passage, start: int) -> bool:
    """Whether a word ends what gives the light: "firefly" of "lit by a red firefly"."""
    clause, places = passage.items[start].clause, range(start - 1, -1, -1)
    if any(i.clause == clause and not i.filler and not i.ties for i in passage.items[start + 1 : start + 2]):
        return False
    before = next(
        (passage.items[p] for p in places if not (passage.items[p].filler or passage.items[p].names_a_look)),
        None,
    )
    return before is not None and before.clause == clause and "lighting" in before.token.lists


def _may_be_guessed(named: Named, token: Token, index: SceneIndex) -> bool:
    """Whether a guess may be right: "a car" is none of its four wheels, nor a boat its sail."""
    if token.text.endswith("s") or all(sign.endswith("misspelled") for sign in named.signs):
        return True
    return not (index.in_parts or index.has_several(named))


def _is_misspelled(token: Token) -> bool:
    """Whether a token is a name of the scene with a mistake in it."""
    return token.scene is not None and token.guess != "" and not table().is_english(token.text)


def _with_side(
    passage: Passage, mention: NounMention, index: SceneIndex, vocabulary: Vocabulary
) -> NounMention:
    """A light with those that stand where a word beside it says: "light from the left", "left light"."""
    if mention.noun != "light":
        return mention
    clause = passage.items[mention.start].clause
    beside = [
        *passage.content(mention.start - 2, mention.start)[-1:],
        *passage.content(mention.end + 1, mention.end + 4)[:1],
    ]
    for item in beside:
        rows = vocabulary.adjectives.get(item.token.adjective, {})
        entry = vocabulary.entries.get(item.token.entry or rows.get("otherwise", ""))
        turns = [e for e in entry.effects if e.mode == "camera" and e.name == "azimuth"] if entry else []
        if item.clause == clause and turns:
            return replace(
                mention, named=(*mention.named, *index.sided(turns[0].lower[0], turns[0].upper[0]))
            )
    return mention


def light_role(token: Token) -> str:
    """The light that a noun means: "key light" the key, "light" light in general ("").

    Args:
        token: Of the noun.
    """
    if token.noun in ("fill", "rim"):
        return token.noun
    return "key" if {"key", "keylight", "main"} & set(token.text.split()) else ""
