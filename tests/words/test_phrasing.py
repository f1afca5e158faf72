# SPDX-License-Identifier: Apache-2.0
"""Ways to say things: elided verbs, comparatives, similes, hyphens, slips of the keyboard, what should stay."""

import json

import pytest

from proxy_renderer.cli.explain import account
from proxy_renderer.planning.advice import compose
from proxy_renderer.schema import VibeError
from proxy_renderer.words.parser import parse
from proxy_renderer.words.types import SceneDescription

TABLE = SceneDescription(
    objects={"Cup": "subject", "Table": "subject", "Lemon": "subject", "Wall": "surroundings"},
    materials={"Cup": "subject", "Table": "subject", "Lemon": "subject", "Wall": "surroundings"},
    object_materials={"Cup": ("Cup",), "Table": ("Table",), "Lemon": ("Lemon",), "Wall": ("Wall",)},
)


def said(prompt: str, scene: SceneDescription = TABLE) -> dict[str, tuple[str, ...]]:
    """Entry or color -> the materials that are meant, or the kind of thing where none are."""
    found = parse(prompt, scene).attributes
    return {a.entry: a.owners or (a.kind,) for a in found if not a.cause}


MEANT = [
    (
        "the cup is copper, the table matte white, the wall dark teal",
        {"copper metal": ("Cup",), "matte": ("Table",), "white": ("Table",), "dark teal": ("Wall",)},
    ),
    ("the lemon more yellow and the cup glossier", {"yellow": ("Lemon",), "glossy": ("Cup",)}),
    ("cup: cobalt blue; table: darker", {"cobalt blue": ("Cup",), "darker surface": ("Table",)}),
    ("the terracotta cup", {"terracotta": ("Cup",)}),
    ("a cup as white as snow", {"white": ("Cup",)}),
    ("leave the cup alone, the table should be green", {"green": ("Table",)}),
    ("cooler shadows, a greenish wall", {"cool shadows": ("shadow",), "greenish": ("Wall",)}),
    ("wihte cup, balck table", {"white": ("Cup",), "black": ("Table",)}),
    ("everything grey-blue", {"grey blue": ("Cup", "Table", "Lemon", "Wall")}),
    ("a cup left in the desert", {"desert": ("surroundings",)}),
    ("sleek white product shot", {"studio light": ("light",), "glossy": ("subject",), "white": ("subject",)}),
    ("red cup, bright product shot", {"red": ("Cup",), "bright light": ("light",), "studio light": ("light",)}),
    ("the wall dark teal in warm light", {"dark teal": ("Wall",), "warm light": ("light",)}),
    ("a toxic green glow from below", {"toxic green": ("light",), "under light": ("light",)}),
    ("a faint purple glow", {"purple": ("light",)}),
    ("a strong light behind the cup", {"strong light": ("light",), "back light": ("light",)}),
    ("blue wall behind the cup", {"blue": ("Wall",)}),
    ("gold cup, black marble", {"gold": ("Cup",), "black marble": ("surroundings",)}),
    ("copper cup, polished concrete table", {"copper metal": ("Cup",), "glossy": ("Table",), "concrete": ("Table",)}),
    (
        "wet street, blue neon",
        {"wet": ("surroundings",), "city street": ("surroundings",), "blue": ("light",), "neon light": ("light",)},
    ),
    ("neon cup", {"neon": ("Cup",)}),
    ("jade cup, red temple", {"jade": ("Cup",), "red": ("surroundings",), "cathedral interior": ("surroundings",)}),
    ("a white cup at night", {"white": ("Cup",), "night": ("light",)}),
    ("copper cup, glowing", {"copper metal": ("Cup",), "glowing": ("Cup",)}),
    ("a red cup, a brass chandelier", {"red": ("Cup",)}),
    ("a brass lamp", {"brass": ("subject",)}),
    ("a toxic green cup in fog", {"toxic green": ("Cup",), "fog": ("fog",)}),
]


@pytest.mark.parametrize(("prompt", "meant"), MEANT)
def test_what_is_meant_is_found(prompt, meant):
    assert said(prompt) == meant


def test_colors_between_colors_are_mixed():
    by_name = {a.entry: a.color for a in parse("a grey-blue cup, a greenish yellow wall", TABLE).attributes}
    red, green, blue = by_name["grey blue"]
    assert blue > max(red, green)
    assert min(red, green) > 0.15
    red, green, blue = by_name["greenish yellow"]
    assert green > red > blue


def test_a_kind_of_a_color_lies_between_both_but_two_colors_stay_two():
    khaki_green = {a.entry: a.color for a in parse("a khaki green cup", TABLE).attributes}
    (red, green, blue) = khaki_green["khaki green"]
    assert green > red > blue
    two = [a.entry for a in parse("teal orange grade", TABLE).attributes]
    assert "teal orange" not in two
    assert "navy white" not in [a.entry for a in parse("navy white cup", TABLE).attributes]


def test_each_thing_has_a_caption_of_its_own():
    prompts = compose(parse("matte white cup, glossy black table", TABLE))
    assert prompts.subject.startswith("a matte white cup, ")
    assert "a glossy black table" in prompts.subject


def test_a_light_that_is_named_outshines_the_light_of_a_mood():
    neon = json.loads(account("rainy night", "json"))["plan"]["light/Key/color"]
    lamps = json.loads(account("rainy night, street lamps", "json"))["plan"]["light/Key/color"]
    assert "neon" in neon["reason"]
    assert "neon" not in lamps["reason"]


@pytest.mark.parametrize(
    ("prompt", "painted"), [("neon pink light", ()), ("pink light", ()), ("red tail light", ("Tail Light Glass",))]
)
def test_light_is_no_thing_whose_name_has_that_word_too(prompt, painted):
    scene = SceneDescription(
        objects={"Tail Light Left": "surroundings", "Body": "subject"},
        materials={"Tail Light Glass": "surroundings", "Paint": "subject"},
        object_materials={"Tail Light Left": ("Tail Light Glass",), "Body": ("Paint",)},
    )
    (color,) = parse(prompt, scene).attributes
    assert color.owners == painted


def test_a_prompt_of_guesses_in_another_language_is_refused():
    with pytest.raises(VibeError):
        parse("bardzo ciepły i złoty ton, bez cienia", SceneDescription())
