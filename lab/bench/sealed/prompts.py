# SPDX-License-Identifier: Apache-2.0
"""Prompts, drawn at random, with what each asks for."""

from __future__ import annotations

import json
import random
import re
import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from string import Formatter
from typing import Any

from lab.bench.sealed import rules
from lab.bench.sealed.scenes import DrawnScene, DrawnThing, draw_scene
from proxy_renderer.color.floats import Values, srgb_from_hex, srgb_from_linear

_HERE = Path(__file__).parent
_SAID_OF_THINGS = ("Metal", "Crystal", "Manmade", "Organic", "Plastic")
"""Kinds of measured materials that a vase can be made of; nobody asks for a sofa of blood, or of juice."""
_WARM, _COOL = 3500.0, 8000.0
"""Kelvin up to which a lamp is seen as warm, and from which as cool; of those in between a picture need not show anything."""
_RECOLORING = ("time", "weather", "grade", "mood", "lamp")
"""Kinds of asks that change what light falls on a thing, or how the picture is graded."""
_RELIGHTING = {"lightness", "fog", "contrast", "black_point"}
"""Measures of asks that change how light a thing is."""
NAMED, CAST = "named color", "cast"
"""The two measures of this benchmark that are not in rules.toml."""


@dataclass(frozen=True)
class SealedAsk:
    """One thing that a prompt asks for.

    Attributes:
        kind: "color", "material", "finish", "time", "weather", "grade", "mood", "light" or "lamp".
        words: That ask for it.
        part: The material that is meant; "" for the picture.
        shows: Names of rules that have to hold.
        color: sRGB-encoded: a thing's, or that of a lamp's light; None where none is named.
        material: Measured values, a row of physically_based.json; None for other kinds.
    """

    kind: str
    words: str
    part: str = ""
    shows: tuple[str, ...] = ()
    color: Values | None = None
    material: Mapping[str, Any] | None = None

    @property
    def regions(self) -> set[str]:
        """Regions that have to be in view for it to be judged; see `FinishedPicture.region`."""
        parts = {rules.rule(name).part for name in self.shows} - {"thing"}
        return parts | ({self.part} if self.part else set())

    @property
    def measures(self) -> dict[str, str]:
        """Measures of its rules -> what tells this ask's own rules from others."""
        own = {rules.rule(name).takes: name for name in self.shows}
        if self.color is not None:
            own[CAST if self.kind == "lamp" else f"{NAMED} of {self.part}"] = self.words
        if self.material is not None:
            own |= {f"{NAMED} of {self.part}": self.words, "roughness": self.words, "metallic": self.words}
        return own

    @property
    def clashes(self) -> set[str]:
        """Measures that no other ask may have."""
        named = {each for name in self.shows for each in rules.rule(name).clashes}
        if self.kind == "lamp" and self.color is not None:
            named |= {NAMED, "warmth", "chroma", "shadow_warmth", "highlight_warmth"}
        return named


@dataclass(frozen=True)
class Looseness:
    """Changes of a prompt's other asks to the color of a thing.

    Attributes:
        tint: Its hue and its chroma: by colored light, by a grade.
        lightness: How light it is: by dim or bright light, by fog.
    """

    tint: bool
    lightness: bool


STRICT = Looseness(False, False)
"""White light, and no grade."""


@dataclass(frozen=True)
class SealedJob:
    """A prompt and a scene.

    Attributes:
        number: From 0.
        prompt: The words.
        asks: What they ask for.
        scene: What they are said of.
    """

    number: int
    prompt: str
    asks: tuple[SealedAsk, ...]
    scene: DrawnScene

    @property
    def looseness(self) -> Looseness:
        """Changes of its asks to the colors of all that is seen."""
        taken = {measure for ask in self.asks for measure in ask.measures}
        return Looseness(any(ask.kind in _RECOLORING for ask in self.asks), bool(taken & _RELIGHTING))


def draw(seed: str, number: int, long: bool = False) -> SealedJob:
    """The job of a number; it depends on nothing but what is given here.

    Args:
        number: From 0.
        long: A prompt of three to five asks, as the paper's are; otherwise one of one to three.
    """
    luck = random.Random(f"{seed}/{number}")
    scene = draw_scene(luck)
    while True:
        template = luck.choice(_words()["long_templates" if long else "templates"])
        slots = [name for _, name, _, _ in Formatter().parse(template) if name]
        if "ground" in slots and not scene.ground:
            continue
        filled = {name: _draw_ask(name, scene, luck) for name in slots if name not in ("thing", "ground")}
        if not clash(list(filled.values())):
            said = {name: ask.words for name, ask in filled.items()}
            return SealedJob(
                number,
                _sentence(template.format(thing=scene.thing.say, ground=scene.ground, **said)),
                tuple(filled.values()),
                scene,
            )


def clash(asks: Sequence[SealedAsk]) -> bool:
    """True if two asks speak of one measure, each in its way, so that no picture can be expected to keep both."""
    for one in asks:
        for other in asks:
            if one is other:
                continue
            both = one.measures.keys() & other.measures.keys()
            if any(one.measures[name] != other.measures[name] for name in both):
                return True
            if any(name.partition(" of ")[0] in one.clashes for name in other.measures):
                return True
    return False


def _sentence(text: str) -> str:
    """With "an" before vowels, and a capital after a full stop."""
    text = re.sub(r"\b([Aa]) (?=[aeiouAEIOU])", r"\1n ", text)
    return re.sub(r"(?<=[.?] )[a-z]", lambda match: match[0].upper(), text)


def _draw_ask(slot: str, scene: DrawnScene, luck: random.Random) -> SealedAsk:
    drawn: dict[str, Callable[[random.Random, DrawnThing], SealedAsk]] = {
        "color": lambda luck, thing: _color(luck, thing.material),
        "other": lambda luck, thing: _color(luck, scene.ground.title()),
        "material": _material,
        "lamp": _lamp,
    }
    if slot in drawn:
        return drawn[slot](luck, scene.thing)
    word = luck.choice(_words()[slot])
    part = scene.thing.material if slot == "finish" else ""
    return SealedAsk(slot, word["say"], part, tuple(word["shows"]))


def _color(luck: random.Random, part: str) -> SealedAsk:
    name, srgb = luck.choice(survey_colors())
    return SealedAsk("color", name, part, color=srgb)


def _material(luck: random.Random, thing: DrawnThing) -> SealedAsk:
    row = luck.choice([row for row in measured()["materials"] if row["kind"] in _SAID_OF_THINGS])
    return SealedAsk("material", row["say"], thing.material, material=row)


def _lamp(luck: random.Random, _: DrawnThing) -> SealedAsk:
    kept = [row for row in measured()["lights"] if row["kelvin"] is None or not _WARM < row["kelvin"] < _COOL]
    row = luck.choice(kept)
    if row["kelvin"] is None:
        return SealedAsk("lamp", row["say"], color=srgb_from_linear(row["color"]))
    return SealedAsk("lamp", row["say"], shows=("warm" if row["kelvin"] <= _WARM else "cool",))


@cache
def survey_colors() -> tuple[tuple[str, Values], ...]:
    """The names of the XKCD survey with their colors, sRGB-encoded."""
    lines = (_HERE / "xkcd.txt").read_text("utf-8").splitlines()
    rows = (line.rsplit(" ", 1) for line in lines if not line.startswith("#"))
    return tuple((name, srgb_from_hex(code)) for name, code in rows)


@cache
def measured() -> dict[str, Any]:
    """The measured materials and light sources: `materials` and `lights`, see physically_based.json."""
    content: dict[str, Any] = json.loads((_HERE / "physically_based.json").read_text("utf-8"))
    return content


@cache
def _words() -> dict[str, Any]:
    return tomllib.loads((_HERE / "words.toml").read_text("utf-8"))
