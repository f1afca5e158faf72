# SPDX-License-Identifier: Apache-2.0
"""What the names in a scene say: which thing is meant, which things are of one kind, and which are parts of others."""

from __future__ import annotations

import re
import tomllib
from functools import cache, lru_cache
from pathlib import Path

from ..schema.spec import Region
from .lexicon.entries import normalize
from .types import SceneDescription

_NAMES = 16_384  # names of scenes that are remembered


@cache
def name_words(kind: str) -> frozenset[str]:
    """Words that names are made of, by the table that is shipped.

    Args:
        kind: A row of lexicon/names.toml: "pipeline", "counted", "primitives", "order", "limbs" or "details".
    """
    path = Path(__file__).with_name("lexicon") / "names.toml"
    rows: dict[str, str] = tomllib.loads(path.read_text("utf-8"))
    return frozenset(rows[kind].split())


def spaced(name: str) -> list[str]:
    """The words that a name is written with, in lower case: "SM_WoodTable.001" -> ["sm", "wood", "table"]."""
    return normalize(re.sub(r"(?<=[a-z0-9])(?=[A-Z])|[\W_]|\d+", " ", name)).split()


@lru_cache(_NAMES)
def plain_name(name: str) -> str:
    """A name as somebody would say it: "WoodTable.001" -> "wood table", "SM_Cup.001_low" -> "cup", "Tyre Two" -> "tyre"."""
    every = spaced(name)
    words = [w for w in every if w not in name_words("pipeline") and len(w) > 1] or every
    while len(words) > 1 and words[-1] in name_words("order"):
        words.pop()
    return " ".join(words)


def kind_of(material: str) -> str:
    """Materials of one kind are painted alike: "Tyre", "Tyre Two". A name that says nothing is a kind of its own."""
    plain = plain_name(material)
    return plain if set(plain.split()) - name_words("pipeline") else material


def is_detail(material: str) -> bool:
    """Whether a name is that of a part with a color of its own: tyres, eyes, windows."""
    last = _last(material)
    return not name_words("details").isdisjoint((last, last.removesuffix("s")))


def scene_names(words: SceneDescription) -> frozenset[str]:
    """What things in a scene are called: by whole names, by last words, and by what limbs are parts of."""
    named = (*words.objects, *words.materials)
    spoken = {plain_name(words.subject)} | {spell(n) for spell in (plain_name, _last, _whole) for n in named}
    return frozenset(name for name in spoken if len(name) > 2)


def _last(name: str) -> str:
    return plain_name(name).rpartition(" ")[2]


def _whole(name: str) -> str:
    """What a limb is a part of: of "CarShellNew", a car; "" of what is no limb."""
    whole, _, last = plain_name(name).rpartition(" ")
    return whole if last in name_words("limbs") else ""


def limbs(words: SceneDescription) -> dict[str, tuple[str, ...]]:
    """Of each object the materials of its parts that are objects of their own: the duck's head, the only teapot's lid."""
    parts = name_words("limbs") | name_words("details")
    heads: dict[Region, set[str]] = {"subject": set(), "surroundings": set()}
    theirs: dict[Region, dict[str, list[str]]] = {"subject": {}, "surroundings": {}}
    for name, region in words.objects.items():
        whole, _, last = plain_name(name).rpartition(" ")
        if last not in parts:
            heads[region].add(plain_name(name))
        elif last in name_words("limbs"):
            theirs[region].setdefault(whole, []).append(name)
    found = {}
    for name, region in words.objects.items():
        spoken = plain_name(name)
        is_head = spoken in heads[region]
        wholes = {spoken, *([""] if heads[region] == {spoken} else [])} if is_head else set()
        mine = [limb for whole, its in theirs[region].items() if whole in wholes for limb in its]
        found[name] = tuple(dict.fromkeys(m for limb in mine for m in words.object_materials.get(limb, ())))
    return found
