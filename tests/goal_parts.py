# SPDX-License-Identifier: Apache-2.0
"""Prompts drawn from the vocabulary, and what they wish for in a scene with a vase, a table and a wall."""

from __future__ import annotations

import random
from collections.abc import Iterator
from dataclasses import replace
from functools import cache

from plan_parts import SCENE, make_instances

from proxy_renderer.color.floats import hex_from_srgb, srgb_from_hex
from proxy_renderer.goals.resolve import Goals, goals_of
from proxy_renderer.planning.planner import plan
from proxy_renderer.planning.types import Plan
from proxy_renderer.schema import VibeError
from proxy_renderer.words.lexicon.vocabulary import shipped_vocabulary
from proxy_renderer.words.parser import parse
from proxy_renderer.words.types import LightDescription, Parsed, SceneDescription

ROOM = SceneDescription(
    "vase",
    {"vase": "subject", "Table": "surroundings", "Wall": "surroundings"},
    {"Clay": "subject", "Wood": "surroundings", "Plaster": "surroundings"},
    {"vase": ("Clay",), "Table": ("Wood",), "Wall": ("Plaster",)},
    {
        "Key": LightDescription("AREA", "key", -40.0),
        "Fill": LightDescription("AREA", "fill", 60.0),
        "Back": LightDescription("POINT", "rim", 160.0),
    },
)
_THINGS = ("vase", "table", "wall")
_COLORED = (*_THINGS, "light", "background", "key light", "rim light", "fog", "sky")


def plan_of(goals: Goals) -> Plan:
    """The plan of goals for the scene that `ROOM` names."""
    return plan(goals, make_instances(materials=tuple(ROOM.materials.items())), SCENE)


def read(prompt: str, scene: SceneDescription = ROOM) -> Goals:
    """The goals of a prompt."""
    return goals_of(parse(prompt, scene, shipped_vocabulary()))


def drawn(seed: int, number: int) -> Iterator[tuple[str, Parsed]]:
    """Prompts of one to four phrases that name a look, with what is understood of them.

    Args:
        seed: Of the draw.
        number: How many there are.
    """
    draw = random.Random(seed)
    while number:
        prompt = ", ".join(_phrase(draw) for _ in range(draw.randint(1, 4)))
        try:
            parsed = parse(prompt, ROOM, shipped_vocabulary())
        except VibeError:  # "keep the wall" alone
            continue
        if parsed.attributes:
            number -= 1
            yield prompt, parsed


def exact(parsed: Parsed) -> Parsed:
    """A prompt whose colors are those that six hexadecimal digits can say."""
    attributes = (replace(a, color=srgb_from_hex(hex_from_srgb(a.color))) if a.color else a for a in parsed.attributes)
    return replace(parsed, attributes=list(attributes))


@cache
def _names(*slots: str) -> tuple[str, ...]:
    return tuple(e.name for e in shipped_vocabulary().entries.values() if e.slot in slots or not slots)


def _phrase(draw: random.Random) -> str:
    """A word alone, denied, said softly or strongly, or of something."""
    colors = tuple(shipped_vocabulary().colors)
    word, thing, surface = (draw.choice(_names()), draw.choice(_THINGS), draw.choice(_names("finish", "material")))
    phrases = (
        word,
        draw.choice(_names("mood")),
        draw.choice(_names("lighting")),
        draw.choice(_names("setting", "atmosphere", "grade")),
        f"not {word}",
        f"{draw.choice(('slightly', 'a bit', 'very', 'extremely'))} {word}",
        f"{draw.choice(colors)} {draw.choice(_COLORED)}",
        f"a {surface} {thing}",
        f"the {thing} is {draw.choice(('dark', 'pale', 'light', 'bright'))} {surface}",
        f"the light from the left is {draw.choice(colors)}, the light from the right is {draw.choice(colors)}",
        f"{draw.choice(('softer', 'brighter', 'darker', 'warmer', 'cooler'))} {draw.choice(('light', 'key light', 'vase'))}",
        f"keep the {thing}",
    )
    return draw.choice(phrases)
