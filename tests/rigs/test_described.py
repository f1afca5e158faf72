# SPDX-License-Identifier: Apache-2.0
"""Lights that a prompt describes one by one: each stands where its words say, in its color, as strong as they say."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from proxy_renderer.color.floats import chroma, hex_from_srgb, lab_from_srgb, srgb_from_hex
from proxy_renderer.goals.resolve import goals_of
from proxy_renderer.rigs.chosen import chosen_rig
from proxy_renderer.rigs.described import EDGES
from proxy_renderer.words.lexicon.rigs import Rig, RigLight, rig_table
from proxy_renderer.words.lexicon.vocabulary import default_vocabulary
from proxy_renderer.words.parser import parse
from proxy_renderer.words.types import LightDescription, SceneDescription

SIDES = {"left": -1.0, "right": 1.0}
KITCHEN = SceneDescription(
    objects={"Cup": "subject", "Plate": "subject", "Wall": "surroundings"},
    materials={"Clay": "subject", "Glaze": "subject", "Plaster": "surroundings"},
    object_materials={"Cup": ("Clay",), "Plate": ("Glaze",), "Wall": ("Plaster",)},
)


def rig(prompt: str, scene: SceneDescription | None = None) -> Rig:
    """The rig of a prompt."""
    vocabulary = default_vocabulary()
    found = chosen_rig(goals_of(parse(prompt, scene or SceneDescription(), vocabulary)), rig_table(), vocabulary)
    assert found
    return found.rig


def part(prompt: str, name: str) -> RigLight:
    """The light of a prompt's rig that plays a part."""
    (light,) = (light for light in rig(prompt).lights if light.part == name)
    return light


def sides(rig: Rig) -> dict[str, float]:
    """Color of a light -> on which side it stands."""
    return {light.color: 1.0 if light.azimuth > 0 else -1.0 for light in rig.lights if light.color}


@pytest.mark.parametrize("first", SIDES)
@pytest.mark.parametrize(
    "form",
    [
        "a {a} light from the {x} and a {b} light from the {y}",
        "a {a} lamp on the {x}, a {b} one on the {y}",
        "two lights: a {a} one at the {x} and a {b} one at the {y}",
        "{a} softbox from the {x} plus a {b} kicker from the {y}",
        "a large {a} key from the {x} with a weak {b} fill from the {y}",
    ],
)
@pytest.mark.parametrize("colors", [("pink", "teal"), ("orange", "blue"), ("green", "magenta")])
@pytest.mark.parametrize("scene", [SceneDescription(), KITCHEN], ids=["no names", "kitchen"])
def test_each_light_has_its_color_on_its_side(form, first, colors, scene):
    (second,) = SIDES.keys() - {first}
    named = default_vocabulary().colors
    expected = dict(zip((hex_from_srgb(named[c]) for c in colors), (SIDES[first], SIDES[second]), strict=True))
    found = rig(form.format(a=colors[0], b=colors[1], x=first, y=second), scene)
    assert sides(found) == expected
    assert found.lights[0].part == "key"


@pytest.mark.parametrize("scene", [SceneDescription(), KITCHEN], ids=["no names", "kitchen"])
@pytest.mark.parametrize(
    "prompt",
    ["teal light from one side and pink from the other", "split lighting, teal and pink", "teal and pink neon light"],
)
def test_two_colors_that_are_joined_are_two_lights(prompt, scene):
    assert sorted(sides(rig(prompt, scene)).values()) == [-1.0, 1.0]


def test_a_color_of_a_substance_that_is_not_there_colors_no_light():
    scene = SceneDescription(objects={"Tree": "subject"}, materials={"Bark": "subject"})
    assert not any(light.color for light in rig("golden backlight, rough gray stone", scene).lights)


def test_a_mood_brings_no_colored_edges_beside_lights_of_named_colors():
    assert {"rim", "kicker"} <= {light.part for light in rig("whimsical autumn afternoon").lights}
    assert not any(light.color for light in rig("whimsical autumn afternoon, golden backlight").lights)


@pytest.mark.parametrize("noun", ["rim", "rim light", "kicker", "backlight"])
@pytest.mark.parametrize("side", SIDES)
def test_an_edge_stands_behind_on_its_side_and_leaves_the_scene_lit_as_it_is(noun, side):
    found = rig(f"a cool {noun} from the {side}")
    (edge,) = found.lights
    assert 100 < abs(edge.azimuth) < 180
    assert edge.azimuth * SIDES[side] > 0
    assert found.keeps_own_light
    assert found.world is None
    assert found.sky is None


@pytest.mark.parametrize("noun", ["rim", "fill", "bounce"])
@pytest.mark.parametrize("weak", ["faint", "dim", "weak"])
def test_a_weak_light_is_weaker_and_leaves_the_exposure(noun, weak):
    prompt = "hard key from the left and a {}blue {} from the right"
    plain, weaker = (rig(prompt.format(word, noun)) for word in ("", f"{weak} "))
    stops = [next(light.stops for light in each.lights if light.part == noun) for each in (plain, weaker)]
    assert stops[1] < stops[0] - 0.5
    assert weaker.exposure == plain.exposure


@pytest.mark.parametrize("none", ["no fill", "almost no fill", "hardly any fill", "without any fill"])
def test_no_fill_is_deeper_shadow_and_no_light(none):
    plain, deep = rig("hard key from the left"), rig(f"hard key from the left, {none}")
    assert [light.part for light in deep.lights] == ["key"]
    assert deep.world < plain.world


@pytest.mark.parametrize("noun", ["key", "lamp", "light"])
def test_a_comma_between_adjectives_parts_no_light(noun):
    (light,) = rig(f"a small, hard {noun} from the left").lights
    assert light.size < 0.5
    assert light.azimuth < 0


@pytest.mark.parametrize(("source", "kind"), [("spot", "SPOT"), ("candle", "POINT"), ("softbox", "AREA")])
def test_a_light_is_what_its_name_says(source, kind):
    assert part(f"a {source} from the left and a dim blue rim from the right", "key").type == kind


@pytest.mark.parametrize("prompt", ["a tungsten spot from above", "a 2700K spot from above"])
def test_what_a_light_is_like_is_no_other_light(prompt):
    light = rig(prompt).lights[0]
    assert light.type == "SPOT"
    assert light.is_warm


@pytest.mark.parametrize(
    ("where", "azimuth"), [("back left", -140), ("back right", 125), ("left", -85), ("above", None)]
)
def test_two_words_of_place_are_half_way_between(where, azimuth):
    light = rig(f"a hard key from the {where}").lights[0] if azimuth else rig("a hard key from above").lights[0]
    assert light.azimuth == pytest.approx(azimuth, abs=1) if azimuth else light.elevation > 60


def test_lights_on_both_sides_are_a_pair():
    key, other = (part("softboxes on both sides", name) for name in ("key", "accent"))
    assert (key.azimuth, key.elevation, key.size) == (-other.azimuth, other.elevation, other.size)


@pytest.mark.parametrize("prompt", ["red cup, a blue lamp from the left", "a blue lamp from the left, the cup red"])
def test_a_things_color_is_no_lights(prompt):
    assert len(sides(rig(prompt, KITCHEN))) == 1
    assert {a.owners for a in parse(prompt, KITCHEN).attributes if a.entry == "red"} == {("Clay",)}


def test_a_light_that_the_scene_names_is_that_light():
    lamp, sun = (LightDescription(kind, "other", None) for kind in ("POINT", "SUN"))
    scene = replace(KITCHEN, lights={"Desk Lamp": lamp, "Sun": sun})
    lights = rig("warm desk lamp, cold sun from behind", scene).lights
    assert {light.own for light in lights} == {"Desk Lamp", "Sun"}


@pytest.mark.parametrize(("like", "keeps"), [("bright", True), ("soft", True), ("warm", False)])
def test_a_light_of_the_scene_keeps_its_color_unless_words_give_it_one(like, keeps):
    lamp, sun = (LightDescription(kind, "other", None) for kind in ("POINT", "SUN"))
    scene = replace(KITCHEN, lights={"Desk Lamp": lamp, "Sun": sun})
    lights = rig(f"{like} desk lamp, golden sun from behind", scene).lights
    (light,) = (light for light in lights if light.own == "Desk Lamp")
    assert (not (light.color or light.kelvin)) is keeps


@pytest.mark.parametrize("source", ["moonlight", "daylight"])
def test_a_window_is_where_a_sun_comes_in(source):
    light = rig(f"{source} through the windows").lights[0]
    assert (light.type, light.through) == ("SUN", "window")


@pytest.mark.parametrize("words", ["the rest darker", "the rest of the room darker"])
def test_darker_is_not_black(words):
    plain, darker, black = (
        rig(f"window light from the left{x}") for x in ("", f", {words}", ", everything else black")
    )
    assert black.world < darker.world < plain.world


def test_slightly_is_of_the_color_and_faint_of_the_light():
    full, slight, faint = (part(f"a {x}yellow lamp from the left", "key").color for x in ("", "slightly ", "faint "))
    chromas = [chroma(lab_from_srgb(srgb_from_hex(color))) for color in (full, slight, faint)]
    assert chromas[1] < 0.6 * chromas[0]
    assert chromas[2] == pytest.approx(chromas[0], rel=0.05)


@pytest.mark.parametrize("second", ["cold moonlight from behind", "the moonlight comes from behind"])
def test_a_source_that_is_named_twice_is_one_light(second):
    found = rig(f"a full moon, {second}")
    assert [light.type for light in found.lights].count("SUN") == 1
    assert abs(found.lights[0].azimuth) > 120


@pytest.mark.parametrize("color", ["greenish", "pale blue", "orange"])
@pytest.mark.parametrize("air", ["mist", "smoke"])
def test_a_color_before_fog_is_the_fogs(color, air):
    attributes = parse(f"cold moonlight, {color} {air}", SceneDescription()).attributes
    assert {a.kind for a in attributes if a.color} == {"fog"}


def test_no_light_is_black_and_dark_red_is_not_black():
    assert not sides(rig("a jet black lamp from the left"))
    spot = "a spot from the left, {} background"
    assert rig(spot.format("dark burgundy")).world > rig(spot.format("black")).world or (
        rig(spot.format("dark burgundy")) == rig("a spot from the left")
    )


@pytest.mark.parametrize("join", [":", ","])
@pytest.mark.parametrize("scene", [SceneDescription(), KITCHEN], ids=["no names", "kitchen"])
def test_lights_that_are_counted_are_told_apart_by_what_follows(join, scene):
    found = rig(f"two lamps from behind{join} orange on the left, blue on the right", scene)
    named = default_vocabulary().colors
    assert sides(found) == {hex_from_srgb(named["orange"]): -1.0, hex_from_srgb(named["blue"]): 1.0}
    assert {light.part for light in found.lights if light.color} <= {"key", "accent", "rim", "kicker"}


@pytest.mark.parametrize("finish", ["translucent", "glossy"])
def test_a_finish_in_the_description_of_a_light_stays_a_surfaces(finish):
    attributes = parse(f"a warm spot from the left, {finish} with light bleeding through", KITCHEN).attributes
    assert all(a.kind == "subject" for a in attributes if a.entry == finish)


def test_a_temperature_overrules_the_color_that_a_rig_gives_its_rim():
    assert part("industrial hangar", "rim").color
    edge = part("industrial hangar, cold backlight", "rim")
    assert not edge.color
    assert edge.kelvin > 7000.0


@pytest.mark.parametrize("more", ["purple rim", "soft warm light from the left, blue light from the right"])
def test_the_weather_counts_where_lights_are_described_too(more):
    assert rig(f"overcast daylight, {more}").name == rig("overcast daylight").name


def test_a_named_sun_is_the_sun_of_the_hour_before_it():
    alone, both = part("low golden sun", "key"), rig("early morning, low golden sun")
    assert both.name == rig("early morning").name
    assert (both.lights[0].elevation, both.lights[0].kelvin) == (alone.elevation, alone.kelvin)
    assert rig("golden hour, full moon").lights[0].kelvin < 5000.0  # a moon is not the sun of that sky


@pytest.mark.parametrize(
    "prompt",
    [
        "warm light from the left, cool light from the right",
        "cool light from the right, warm light from the left",
        "warm lamp, cold blue window light",
        "warm from the left, cool from the right",
    ],
)
def test_lights_of_other_temperatures_are_two_and_neither_word_gives_way(prompt):
    goals = goals_of(parse(prompt, SceneDescription()))
    kelvins = {light.kelvin or 20000.0 for light in rig(prompt).lights if light.part in ("key", "accent")}
    assert min(kelvins) < 5000.0
    assert max(kelvins) > 7000.0
    assert not [each for each in goals.lost if each.is_news]


@pytest.mark.parametrize(
    ("prompt", "sides"),
    [
        ("amber from the right and deep teal from the left", [1, -1]),
        ("cool from the left and warm from behind on the right", [-1, 1]),
        ("hard from the right, soft from the left", [1, -1]),
        ("warm from the left", [-1]),
    ],
)
def test_what_comes_from_a_side_is_a_light(prompt, sides):
    described = [light for light in rig(prompt).lights if light.part in ("key", "accent", "rim")]
    assert [math.copysign(1, light.azimuth) for light in described] == sides


def test_two_colors_of_lights_are_those_of_two_lights():
    named = default_vocabulary().colors
    lit = [light.color for light in rig("red and blue lights").lights if light.color]
    assert lit == [hex_from_srgb(named["red"]), hex_from_srgb(named["blue"])]


@pytest.mark.parametrize(
    "word", sorted({w for rig in rig_table().rigs.values() if rig.adds for w in (rig.name, *rig.words)})
)
def test_a_light_that_is_only_added_keeps_its_part_and_the_scenes_light(word):
    """Alone, if it is no word that acts on the scene's own lights, and beside a key."""
    vocabulary = default_vocabulary()
    goals = goals_of(parse(word, SceneDescription(), vocabulary))
    alone = chosen_rig(goals, rig_table(), vocabulary)
    entry = vocabulary.entries[goals.parsed.attributes[0].entry]
    assert alone or entry.wishes
    assert alone is None or alone.rig.keeps_own_light
    beside = {light.part: light for light in rig(f"soft key from the left, {word}").lights}
    assert beside["key"].azimuth < 0
    parts = {*rig_table().parts(entry.name)}
    assert not parts or beside.keys() & (parts | {*EDGES} if parts & {*EDGES} else parts)


def test_a_background_light_stays_behind_and_lights_what_is_behind():
    light = part("soft key from the left, background light", "background")
    assert abs(light.azimuth) > 150
    assert light.reach == "background"


@pytest.mark.parametrize("lamps", ["warm amber lamps", "lamps glowing warm amber", "the streetlamps amber"])
def test_the_lamps_of_a_night_are_not_its_moon(lamps):
    found = rig(f"night, {lamps}, cool moonlight fill")
    key, *others = found.lights
    assert key.type == "SUN"
    assert not key.color
    assert [light.part for light in others if light.color] == ["kicker"]


@pytest.mark.parametrize("words", ["golden hour backlight", "moonlight from behind"])
def test_a_sun_that_is_said_to_be_behind_is_the_key_and_stands_there(words):
    key, *others = rig(words).lights
    assert key.type == "SUN"
    assert abs(key.azimuth) > 120
    assert not {light.part for light in others} & {*EDGES}
