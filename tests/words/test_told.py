# SPDX-License-Identifier: Apache-2.0
"""What an artist says that a word describes counts before what the reader takes it for."""

from __future__ import annotations

import pytest

from proxy_renderer.schema import VibeError
from proxy_renderer.schema.targets import GENERAL
from proxy_renderer.words.parser import Understood, parse
from proxy_renderer.words.types import LightDescription, SceneDescription

SCENE = SceneDescription(
    objects={"Cube.003": "subject", "Cube.004": "subject", "Plane": "surroundings"},
    materials={"Material": "subject", "Material.001": "subject", "Material.002": "surroundings"},
    object_materials={"Cube.003": ("Material",), "Cube.004": ("Material.001",), "Plane": ("Material.002",)},
    lights={"Area": LightDescription("AREA", "key"), "Area.001": LightDescription("AREA", "rim")},
)


def told(prompt, **targets):
    """The attributes that a prompt says itself, with targets."""
    parsed = parse(prompt, SCENE, told={word.replace("_", " "): name for word, name in targets.items()})
    return [a for a in parsed.attributes if not a.cause], parsed


@pytest.mark.parametrize("word", ["copper", "glossy", "teal", "velvet"])
@pytest.mark.parametrize("prompt", ["{} teapot, warm light", "the sofa in {}", "warm light and {}", "walls in {}"])
@pytest.mark.parametrize(
    ("name", "material"), [("Cube.003", "Material"), ("cube.004", "Material.001"), ("Material.002", "Material.002")]
)
def test_a_word_goes_where_it_is_told(word, prompt, name, material):
    attributes, parsed = told(prompt.format(word), **{word: name})
    assert [a.owners for a in attributes if a.word == word] == [(material,)]
    assert word not in parsed.ignored


@pytest.mark.parametrize("word", ["copper", "glossy", "warm"])
def test_a_word_that_is_not_to_be_used_is_left_out(word):
    attributes, parsed = told(f"dim light, {word} and teal", **{word: "not used"})
    assert word not in [a.word for a in attributes]
    assert word in parsed.ignored


@pytest.mark.parametrize(
    ("target", "kind"), [("lights", "light"), ("key light", "light"), ("rim light", "rim"), ("image", "tone")]
)
def test_a_word_can_be_told_to_be_of_light_or_of_the_image(target, kind):
    attributes, _ = told("teapot, warm", warm=target)
    assert {a.kind for a in attributes if a.word == "warm"} & {kind, "whole", "ambience"}
    assert not any(a.owners for a in attributes)


def test_one_light_can_be_meant():
    attributes, _ = told("warm and dim", warm="Area.001")
    assert [a.lights for a in attributes if a.word == "warm"] == [("Area.001",)]


def test_a_word_that_the_prompt_lacks_is_told_of():
    _, parsed = told("teal", copper="Cube.003")
    assert any("copper" in note for note in parsed.notes)


@pytest.mark.parametrize("pairs", [["copper"], ["=Cube.003"], ["copper="], ["copper=Teapot"], ["misty=Cube.003"]])
def test_what_cannot_be_is_one_line_with_its_remedy(pairs):
    with pytest.raises(VibeError) as caught:
        _ = Understood("misty copper", SCENE, pairs).parsed
    assert caught.value.remedy
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name", sorted(GENERAL))
def test_what_every_scene_has_can_be_told(name):
    told("misty teal", teal=name)


@pytest.mark.parametrize(
    ("prompt", "names"),
    [
        ("Cube.003: copper, Plane: glossy teal, warm light", {"copper": "Cube.003", "glossy": "Plane", "teal": "Plane"}),
        ("misty; cube.004 = gold; plane: velvet", {"gold": "Cube.004", "velvet": "Plane"}),
        ("Area.001: warm, dim light", {"warm": "Area.001"}),
    ],
)  # fmt: skip
def test_a_name_before_a_colon_is_a_target(prompt, names):
    words = {word.text: word.target for word in Understood(prompt, SCENE).words}
    assert {word: words[word] for word in names} == names


def test_a_key_that_a_word_can_say_nothing_of_is_read_as_before():
    assert not Understood("Cube.003: misty, glossy", SCENE).unknown


@pytest.mark.parametrize("key", ["kupferner", "kupfern", "copper"])
def test_a_word_of_another_language_is_told_as_it_is_typed(key):
    understood = Understood("ein kupferner Würfel, warmes Licht", SCENE, [f"{key}=Plane"])
    (copper, warm) = understood.words
    assert (copper.key, copper.target) == ("kupferner", "Plane")
    assert warm.target == "lights"
    assert not any("target" in note for note in understood.parsed.notes)


def test_several_names_are_one_target():
    attributes, _ = told("copper teapot", copper="Cube.003 + Cube.004")
    assert [a.owners for a in attributes] == [("Material", "Material.001")]


def test_a_name_of_the_scene_comes_before_what_every_scene_has():
    scene = SceneDescription(
        objects={"Light": "subject"},
        materials={"Chalk": "subject"},
        object_materials={"Light": ("Chalk",)},
        lights={"Sun": LightDescription("SUN", "key")},
    )
    (word,) = Understood("warm", scene, ["warm=Light"]).words
    assert [a.owners for a in Understood("warm", scene, ["warm=Light"]).parsed.attributes] == [("Chalk",)]
    assert word.target == "Light"


def test_equal_words_of_another_language_are_told_apart():
    prompt = "roter Würfel, rote Ebene"
    first, second = Understood(prompt, SCENE).words
    assert (first.text, second.text) == ("roter", "rote")
    assert [key.partition("#")[2] for key in (first.key, second.key)] == ["1", "2"]
    told_first, told_second = Understood(prompt, SCENE, [f"{second.key}=Cube.003"]).words
    assert (told_first.target, told_second.target) == (first.target, "Cube.003")
