# SPDX-License-Identifier: Apache-2.0
"""Plain prompts are read right, whatever becomes of the reader: every look word, its slot and what it describes."""

import tomllib
from functools import cache
from pathlib import Path

import pytest

from proxy_renderer.words.lexicon.vocabulary import shipped_vocabulary
from proxy_renderer.words.parser import parse, refuse_without_look
from proxy_renderer.words.types import GLOW, LightDescription, SceneDescription

SCENES = tomllib.loads(Path(__file__).with_name("plain_readings.toml").read_text("utf-8"))
WHOLE = {"tone": "picture", "whole": "picture", "ambience": "picture"}


@cache
def scene(name):
    rows = SCENES[name]
    return SceneDescription(
        rows.get("subject", ""),
        rows["objects"],
        rows["materials"],
        {wearer: tuple(worn) for wearer, worn in rows["object_materials"].items()},
        {light: LightDescription(*said) for light, said in rows["lights"].items()},
        tuple(rows.get("glows", ())),
    )


def target(attribute, words):
    """What an attribute describes, in the terms of plain_readings.toml."""
    lights = {*attribute.lights} or {n for n, x in words.lights.items() if x.role == attribute.role}
    if lights == {*words.lights}:
        return "light"
    if lights:
        return " + ".join(n.replace(GLOW, "glow ") if GLOW in n else f"light {n}" for n in sorted(lights))
    named, left = [], {*attribute.owners}
    for region in ("subject", "surroundings"):
        theirs = {n for n, its in words.materials.items() if its == region}
        if theirs <= left:
            named.append(region)
            left -= theirs
    named += [n for n in words.materials if n in left]
    return " + ".join(named) or WHOLE.get(attribute.kind, attribute.kind)


def reading(name, prompt):
    said = parse(prompt, scene(name), shipped_vocabulary()).attributes
    return {a.word: f"{a.slot} {target(a, scene(name))}" for a in said if not a.cause}


def rows(table):
    return [(name, *row) for name, scene in SCENES.items() for row in scene.get(table, {}).items()]


@pytest.mark.parametrize(("name", "prompt", "right"), rows("readings"))
def test_a_plain_prompt_is_read_right_and_never_refused_before_the_scene_is_known(name, prompt, right):
    refuse_without_look(prompt)
    assert reading(name, prompt) == right


@pytest.mark.xfail(strict=True, reason="known wrong; move it to the readings once it is right")
@pytest.mark.parametrize(("name", "prompt", "right"), rows("known_wrong"))
def test_what_is_known_to_be_read_wrong(name, prompt, right):
    assert reading(name, prompt) == right


def test_other_readings_would_be_noticed():
    assert reading("kitchen", "blue cup") != {"blue": "color subject"}
    assert len(rows("readings")) > 150
