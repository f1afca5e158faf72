# SPDX-License-Identifier: Apache-2.0
"""What the names in a scene say: which thing is meant, which things are of one kind, and which are parts of others."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cache

from .lexicon.vocabulary import normalize
from .types import SceneWords


def _words(text: str) -> frozenset[str]:
    return frozenset(text.split())


PIPELINE = _words(
    "low high hi lo lod lp hp sm sk geo geom mesh obj object grp group mat mtl material shader mid final copy new test "
    "tmp proxy collision col export inst instance part prim poly lowpoly highpoly master base body main"
)
"""What names say about how a thing was made, not what it is."""
COUNTED = _words("two three four five six seven eight nine ten")
"""Numbers at the end of names of which there are several: "Tyre Two"."""
_ORDER = COUNTED | _words("one left right front back rear fl fr rl rr")
"""What names say at their end about which one of several a thing is."""
LIMBS = _words(
    "body bodywork hull torso head neck shoulder arm forearm leg thigh foot hand paw wing tail fin ear horn limb "
    "cabin hood bonnet trunk door fender bumper roof chassis panel shell cover case casing frame lid cap top bottom side "
    "upper lower inner outer handle spout knob rim lip stem base seat backrest armrest cushion slat"
)
"""Parts that have the color of the whole, unless words say otherwise."""
DETAILS = _words(
    "tyre tire wheel hub hubcap eye eyes eyeball iris pupil beak bill teeth tooth tongue nose claw nail hoof window windows "
    "windshield windscreen glass headlight taillight light lights lamp bulb lens mirror screw bolt rivet button buckle "
    "lace sole label logo text decal sticker wick flame screen display keys grill grille exhaust plate"
)
"""Parts that keep a color of their own when the whole is painted."""
_CORES = _words("hull body bodywork torso chassis cabin fuselage trunk walls")
"""Parts that stand for a whole where nothing else is called by its name."""


@dataclass(frozen=True)
class SceneName:
    """Something in the scene that a word of the prompt names."""

    name: str
    region: str
    materials: tuple[str, ...] = ()
    several: bool = False  # objects that differ in a number only: wheels, chairs


@cache
def plain_name(name: str) -> str:
    """A name as somebody would say it: "WoodTable.001" -> "wood table", "SM_Cup.001_low" -> "cup", "Tyre Two" -> "tyre"."""
    spaced = re.sub(r"(?<=[a-z0-9])(?=[A-Z])|_", " ", re.sub(r"\.\d+", " ", name))
    words = normalize(re.sub(r"[^\w\s]|\d+", " ", spaced)).split()
    words = [w for w in words if w not in PIPELINE and len(w) > 1] or words
    while len(words) > 1 and words[-1] in _ORDER:
        words.pop()
    return " ".join(words)


def kind_of(material: str) -> str:
    """Materials of one kind are painted alike: "Tyre", "Tyre Two". A name that says nothing is a kind of its own."""
    plain = plain_name(material)
    return plain if set(plain.split()) - PIPELINE else material


def is_detail(material: str) -> bool:
    """Whether a name is that of a part with a color of its own: tyres, eyes, windows."""
    last = plain_name(material).rpartition(" ")[2]
    return last in DETAILS or last.removesuffix("s") in DETAILS


def in_parts(words: SceneWords) -> bool:
    """Whether the subject is one thing, of which only parts have names: a hull, a mast and a sail are a boat."""
    return any(region == "subject" and plain_name(name) in _CORES for name, region in words.objects.items())


def scene_names(words: SceneWords) -> dict[str, SceneName]:
    """Spoken name -> what it names; objects come before materials, whole names before last words, things before their parts."""
    objects = [
        SceneName(name, region, words.object_materials.get(name, ()))
        for name, region in words.objects.items()
    ]
    materials = [SceneName(name, region, (name,)) for name, region in words.materials.items()]
    names: dict[str, SceneName] = {}
    if words.subject:
        names[plain_name(words.subject)] = SceneName(plain_name(words.subject), "subject")
    for spell in (plain_name, lambda name: plain_name(name).rpartition(" ")[2], _whole):
        for things in (objects, materials):
            found: dict[str, SceneName] = {}
            for thing in things:
                spoken = spell(thing.name)
                if len(spoken) > 2:
                    found[spoken] = _merged(found[spoken], thing) if spoken in found else thing
            names = found | names
    limbs = {region: _limbs(region, objects, materials) for region in {t.region for t in names.values()}}
    return {spoken: _with_limbs(spoken, thing, limbs[thing.region]) for spoken, thing in names.items()}


def _whole(name: str) -> str:
    """What a limb is a part of: of "CarShellNew", a car, where nothing else is called so; "" of what is no limb."""
    whole, _, last = plain_name(name).rpartition(" ")
    return whole if last in LIMBS else ""


def _merged(first: SceneName, other: SceneName) -> SceneName:
    """Two things of one name: "the chairs" are Chair and Chair.001. Of two in different places, the subject is meant."""
    if first.region != other.region:
        return first if first.region == "subject" else other
    return replace(first, materials=_united(first.materials, other.materials), several=True)


def _united(*parts: Iterable[str]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(name for part in parts for name in part))


@dataclass(frozen=True)
class _Limbs:
    """The parts in a region that are objects or materials of their own.

    Attributes:
        heads: Names of the objects that are no parts.
        rows: Of each part the name of the whole, "" where it says none, and its materials.
    """

    heads: frozenset[str]
    rows: tuple[tuple[str, tuple[str, ...]], ...]


def _limbs(region: str, objects: list[SceneName], materials: list[SceneName]) -> _Limbs:
    near = [(plain_name(o.name).rpartition(" "), o) for o in objects if o.region == region]
    heads = {"".join(name) for name, _ in near if name[2] not in LIMBS | DETAILS}
    every = [*near, *((plain_name(m.name).rpartition(" "), m) for m in materials if m.region == region)]
    rows = tuple((name[0], thing.materials) for name, thing in every if name[2] in LIMBS)
    return _Limbs(frozenset(heads), rows)


def limbs_of(name: str, words: SceneWords) -> tuple[str, ...]:
    """The materials of an object's parts that are objects of their own: the duck's head, the only teapot's lid.

    Args:
        name: Of the object.
        words: The names in the scene.
    """
    spoken, region = plain_name(name), words.objects[name]
    near = {other: plain_name(other).rpartition(" ") for other, its in words.objects.items() if its == region}
    heads = {"".join(its) for its in near.values() if its[2] not in LIMBS | DETAILS}
    wholes = {spoken, ""} if heads == {spoken} else {spoken}
    limbs = (other for other, its in near.items() if other != name and its[2] in LIMBS and its[0] in wholes)
    return _united(*(words.object_materials.get(other, ()) for other in limbs)) if spoken in heads else ()


def _with_limbs(spoken: str, thing: SceneName, limbs: _Limbs) -> SceneName:
    """A thing with its parts that are objects of their own: the duck's head, the only teapot's lid."""
    wholes = {spoken, ""} if limbs.heads == {spoken} else {spoken}
    mine = [materials for whole, materials in limbs.rows if whole in wholes]
    return replace(thing, materials=_united(thing.materials, *mine)) if thing.materials else thing
