# SPDX-License-Identifier: Apache-2.0
"""Which of a scene's lights a prompt means: by name, then by role, then by side, then by how much they light."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ...words.attributes import fixture, side
from ...words.lexicon.vocabulary import Vocabulary
from ...words.names import plain_name
from ...words.types import Attribute

_NEAR = 90.0  # degrees from where words want a light within which one is already there


@dataclass(frozen=True)
class KnownLight:
    """A light of a scene, as words may mean it.

    Attributes:
        name: As its owner is called: the artist's name of a light, or "material/NAME" of what glows.
        role: "key", "fill" or "rim".
        names: What it may be called: its own name and its type, or its material's and those of its objects.
        turn: Azimuth relative to the camera, degrees.
        added: Whether the scene lacks it and gets it for the words.
    """

    name: str
    role: str
    names: tuple[str, ...]
    turn: float
    added: bool = False


def assigned(
    attributes: Sequence[Attribute], lights: Sequence[KnownLight], vocabulary: Vocabulary
) -> dict[int, list[str]]:
    """The lights that are told apart (`Attribute.lamp`), each with the names of its own; none where the scene has too few.

    Lights that are left over are lit like the nearest of those that have a side, or else like the last one without a
    name of its own.

    Args:
        lights: The most important one first, those that are added last.
    """
    said: dict[int, list[Attribute]] = {}
    for attribute in attributes:
        if attribute.lamp:
            said.setdefault(attribute.lamp, []).append(attribute)
    words = {
        n: frozenset().union(*(fixture(a.thing, vocabulary) for a in group)) for n, group in said.items()
    }
    roles = {n: role_of(group) for n, group in said.items()}
    turns = {n: sum(ends) / 2 for n, group in said.items() if (ends := side(group, vocabulary))}
    found: dict[int, list[str]] = {n: [] for n in said}
    free = list(lights)

    def give(number: int, theirs: Sequence[KnownLight]) -> None:
        found[number] += [light.name for light in theirs]
        free[:] = [light for light in free if light not in theirs]

    for number in said:
        give(number, [light for light in free if _is_called(light, words[number])])
    for number in said:
        if not found[number] and roles[number]:
            give(number, [light for light in free if light.role == roles[number]])
    own = {number for number in said if found[number]}
    for number in sorted(
        turns.keys() - own, key=lambda n: min((_apart(x, turns[n]) for x in free), default=0.0)
    ):
        near = [light for light in free if light.added or _apart(light, turns[number]) < _NEAR]
        give(number, sorted(near, key=lambda x: (x.added, _apart(x, turns[number])))[:1])
    for number in said:
        if not found[number]:
            give(number, free[:1])
    sided = {number: turn for number, turn in turns.items() if number not in own}
    last = [number for number in said if number not in own and not roles[number]][-1:]
    for light in list(free):
        if len(sided) > 1:
            give(min(sided, key=lambda n: _apart(light, sided[n])), [light])
        elif last:
            give(last[0], [light])
    return found


def named(thing: str, lights: Sequence[KnownLight], vocabulary: Vocabulary) -> list[str] | None:
    """The lights that a thing's name means: "the desk lamp"; None if it means none, or light in general."""
    words = fixture(thing, vocabulary)
    return [light.name for light in lights if _is_called(light, words)] or None


def role_of(said: Sequence[Attribute]) -> str:
    """The role that words give to a light: "key", "fill" or "rim"; "" if they give none."""
    return next((a.role or a.kind for a in said if a.role or a.kind != "light"), "")


def _is_called(light: KnownLight, words: frozenset[str]) -> bool:
    """Whether words name a light: "window", or "moonlight" a Moon; a sun is one by its type."""
    theirs = {_singular(word) for name in light.names for word in plain_name(name).split()}
    spoken = {_singular(word) for word in words}
    return bool(theirs & (spoken | {word.removesuffix("light") for word in spoken}))


def _singular(word: str) -> str:
    return word.removesuffix("s")


def _apart(light: KnownLight, turn: float) -> float:
    return abs((light.turn - turn + 180.0) % 360.0 - 180.0)
