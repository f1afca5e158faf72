# SPDX-License-Identifier: Apache-2.0
"""The reader of prompts: what it binds in a small scene, and that its features, targets and assignment are what they say."""

import os
import subprocess
import sys
from dataclasses import replace

import pytest

from proxy_renderer.words.lexicon.vocabulary import shipped_vocabulary
from proxy_renderer.words.names import fit, parts
from proxy_renderer.words.parser import parse, why
from proxy_renderer.words.reader import read_words
from proxy_renderer.words.types import LightDescription, MaterialLook, SceneDescription

_READS = """
from proxy_renderer.words.model import reading
from proxy_renderer.words.lexicon.vocabulary import shipped_vocabulary
from proxy_renderer.words.types import SceneDescription

words = SceneDescription(
    objects={"Armchair": "subject", "Side Table": "surroundings", "Floor": "surroundings"},
    materials={"Velvet": "subject", "Oak": "subject", "Glass": "surroundings", "Parquet": "surroundings"},
    object_materials={"Armchair": ("Velvet", "Oak"), "Side Table": ("Glass", "Oak"), "Floor": ("Parquet",)},
)
for prompt in ("navy armchair, oak table darker than the floor", "everything white but the armchair and the floor"):
    for pairs in reading(prompt, words, shipped_vocabulary()).pairs:
        for pair in pairs:
            print(pair.target.kind, sorted(pair.target.names), pair.target.mention, pair.features)
"""
"""Prints what words may describe, in the order in which it is looked at."""

GARAGE = SceneDescription(
    objects={"carShell": "subject", "Brake_FL": "subject", "Boden": "surroundings", "Crate": "surroundings"},
    materials={"CarShellNew": "subject", "BrakeDisc": "subject", "Beton": "surroundings", "CrateWood": "surroundings"},
    object_materials={
        "carShell": ("CarShellNew",),
        "Brake_FL": ("BrakeDisc",),
        "Boden": ("Beton",),
        "Crate": ("CrateWood",),
    },
    lights={
        "Desk Lamp": LightDescription("POINT", "fill", 60.0),
        "Window Area": LightDescription("AREA", "key", -60.0),
    },
)


def bound(prompt):
    """Look word -> the attribute that it became."""
    return {a.word: a for a in parse(prompt, GARAGE, shipped_vocabulary()).attributes}


@pytest.mark.parametrize(
    ("prompt", "word", "owners"),
    [
        ("red car", "red", ("CarShellNew",)),
        ("glossy crate, matte floor", "matte", ("Beton",)),
        ("brakes yellow, crate blue", "yellow", ("BrakeDisc",)),
        ("crate whiter than the floor", "whiter", ("CrateWood",)),
        ("car and crate in teal", "teal", ("CarShellNew", "CrateWood")),
    ],
)
def test_words_are_bound_to_things(prompt, word, owners):
    assert bound(prompt)[word].owners == owners


def test_two_lamps_get_two_lights():
    found = bound("warm desk lamp, cold blue window light")
    assert found["warm"].lights == ("Desk Lamp",)
    assert found["cold blue"].lights == ("Window Area",)


def test_the_rest_is_all_that_was_not_named():
    assert bound("red car, everything else grey")["grey"].owners == ("BrakeDisc", "Beton", "CrateWood")


def test_without_the_weights_it_would_be_otherwise():
    vocabulary = shipped_vocabulary()
    weights = {"a color word of things": -9.0, "a color word of picture": 9.0}
    (red,) = read_words("red car", GARAGE, vocabulary, weights).parsed.attributes
    assert red.kind == "ambience"


@pytest.mark.parametrize(
    ("said", "name", "way"),
    [
        ("car", "carShell", "whole"),
        ("brakes", "Brake_L", "exact"),
        ("floor", "Boden", "synonym"),
        ("wood table", "WoodTable.001", "exact"),
        ("laces", "Schnürsenkel", "synonym"),
        ("faucet", "Torneira_01", "synonym"),
        ("brick", "MI_Baksteen", "synonym"),
        ("chair", "Krzesło.003", "synonym"),
        ("left lamp", "Lamp_L", "all"),
        ("cup", "Crate", ""),
    ],
)
def test_names_fit(said, name, way):
    assert fit(parts(said), parts(name), shipped_vocabulary()) == way


BALLS = SceneDescription(
    objects=dict.fromkeys(("Sphere", "Sphere.001", "Sphere.002"), "subject"),
    materials=dict.fromkeys(("One", "Two", "Three"), "subject"),
    object_materials={"Sphere": ("One",), "Sphere.001": ("Two",), "Sphere.002": ("Three",)},
)


def test_why_names_targets_scores_and_facts():
    told = why(read_words("red car, warm desk lamp", GARAGE, shipped_vocabulary()))
    assert "→" in told
    assert "things: CarShellNew" in told
    assert "lights: Desk Lamp" in told
    assert "%" in told


@pytest.mark.parametrize("prompt", ["red " * 500, "red 🚗 car", "<b>red</b> car", "red car\u202e"])
def test_odd_prompts_are_read(prompt):
    assert any(a.color for a in parse(prompt, GARAGE, shipped_vocabulary()).attributes)


def test_a_prompt_is_read_alike_in_every_process():
    """Python orders sets anew in each process: what is likely must not depend on it."""
    told = {
        subprocess.run(
            [sys.executable, "-c", _READS], env={**os.environ, "PYTHONHASHSEED": seed}, capture_output=True, check=True
        ).stdout
        for seed in ("1", "2", "3")
    }
    assert len(told) == 1
    assert told.pop().strip()


def test_light_is_any_light_though_one_is_called_so() -> None:
    """A light called "Light" is not told apart by "warm light"."""
    one = replace(GARAGE, lights={"Light": LightDescription("AREA", "key", 0.0)})
    two = replace(one, lights=one.lights | {"Lamp": LightDescription("POINT", "fill", 60.0)})
    for scene in (one, two):
        (warm,) = (a for a in parse("dusk, warm light", scene).attributes if a.word == "warm light")
        assert warm.lights == ()


def test_one_light_is_no_headlight() -> None:
    headlights = replace(
        GARAGE,
        objects=GARAGE.objects | {"Headlights": "subject"},
        materials=GARAGE.materials | {"LampGlass": "subject"},
        object_materials={**GARAGE.object_materials, "Headlights": ("LampGlass",)},
    )
    assert {a.kind for a in parse("soft warm light", headlights).attributes} == {"light"}


def test_a_rim_is_of_light_though_glasses_have_rims() -> None:
    scene = SceneDescription(
        objects={"Head": "subject", "Glasses Rims": "subject", "Hair": "subject"},
        materials={"Skin": "subject", "Frame": "subject", "Strands": "subject"},
        object_materials={"Head": ("Skin",), "Glasses Rims": ("Frame",), "Hair": ("Strands",)},
        lights={"Key Light": LightDescription("AREA", "key"), "Rim Light": LightDescription("AREA", "rim", 150.0)},
    )
    for prompt in ("teal rim", "teal rim on her hair from the right"):
        (teal,) = (a for a in parse(prompt, scene).attributes if a.word == "teal")
        assert teal.owners == (), prompt


def test_a_noun_of_several_parts_names_what_most_of_them_wear():
    parts_of = {"Scooter Body": "Scooter Paint", "Scooter Shield": "Scooter Paint", "Scooter Seat": "Scooter Seat"}
    shares = {"Scooter Paint": 0.05, "Scooter Seat": 0.01}
    scene = SceneDescription(
        objects=dict.fromkeys(parts_of, "surroundings"),
        materials=dict.fromkeys(shares, "surroundings"),
        object_materials={thing: (material,) for thing, material in parts_of.items()},
        looks={name: MaterialLook(share=share) for name, share in shares.items()},
    )
    (red,) = (a for a in parse("red scooter", scene).attributes if a.word == "red")
    assert red.owners == ("Scooter Paint",)


def test_a_place_in_the_name_of_an_object_is_no_look():
    scene = SceneDescription(
        objects={"Garage Gate": "surroundings"},
        materials={"Oak": "surroundings"},
        object_materials={"Garage Gate": ("Oak",)},
        lights={"Sun": LightDescription("SUN")},
    )
    words = {a.word for a in parse("low sun raking across the garage door", scene).attributes}
    assert "low sun" in words
    assert "garage" not in words


def test_an_article_names_nothing():
    scene = SceneDescription(
        objects={"Tea": "surroundings", "Cup": "subject"},
        materials={"Tea": "surroundings", "Clay": "subject"},
        object_materials={"Tea": ("Tea",), "Cup": ("Clay",)},
    )
    assert not any("Tea" in a.owners for a in parse("blue dusk outside the window, warm glow", scene).attributes)
