# SPDX-License-Identifier: Apache-2.0
"""Sentences about several lights: each light gets its own words, and what the scene lacks is named."""

import pytest
from plan_parts import make_instances, make_plan

from proxy_renderer.goals.resolve import goals_of
from proxy_renderer.planning.support import missing_lights
from proxy_renderer.words.lexicon.vocabulary import default_vocabulary
from proxy_renderer.words.parser import parse
from proxy_renderer.words.types import LightDescription, SceneDescription

STANDBY = {"Vibe Key": "key", "Vibe Fill": "fill", "Vibe Rim": "rim"}
TWO = (("Area", "AREA", "key", -70.0), ("Area.001", "AREA", "fill", 70.0))


def plan_of(prompt, lights):
    context = SceneDescription(lights={name: LightDescription(kind) for name, kind, _, _ in lights})
    return make_plan(prompt, make_instances(lights=lights), context)


def is_warm(plan, light):
    entry = plan[f"light/{light}/temperature"]
    return entry.priority is not None and entry.upper[0] < 5000


def is_cool(plan, light):
    gel, kelvin = plan[f"light/{light}/color"], plan[f"light/{light}/temperature"]
    blue = gel.priority is not None and gel.upper[0] < gel.lower[2]
    return blue or (kelvin.priority is not None and kelvin.lower[0] > 7000)


@pytest.mark.parametrize("names", [("Desk Lamp", "Window"), ("Window", "Desk Lamp")])
def test_lights_are_meant_by_their_names(names):
    plan = plan_of(
        "warm lamp, cold blue window light", [(names[0], "AREA", "key", 0.0), (names[1], "AREA", "fill", 50.0)]
    )
    assert is_warm(plan, "Desk Lamp")
    assert not is_cool(plan, "Desk Lamp")
    assert is_cool(plan, "Window")
    assert not is_warm(plan, "Window")


def test_a_light_that_is_named_alone_is_the_only_one_that_changes():
    plan = plan_of("warm desk lamp", [("Desk Lamp", "POINT", "fill", 0.0), ("Ceiling", "AREA", "key", 50.0)])
    assert is_warm(plan, "Desk Lamp")
    assert not is_warm(plan, "Ceiling")


def test_words_about_one_light_are_for_all_of_them():
    plan = plan_of("soft warm light from the left", TWO)
    assert is_warm(plan, "Area")
    assert is_warm(plan, "Area.001")


@pytest.mark.parametrize(
    ("prompt", "added"),
    [
        ("bright rim light", ["Vibe Rim"]),
        ("with fill light", ["Vibe Fill"]),
        ("no rim light", []),
        ("warm light from the left", []),
        ("dark, misty, cosy", []),
    ],
)
def test_what_one_lamp_lacks(prompt, added):
    assert found(prompt, (("Light", "POINT", "key", -40.0),)) == added


def test_a_scene_that_has_the_lights_lacks_none():
    lights = (("Key", "AREA", "key", -40.0), ("Back", "AREA", "rim", 160.0))
    assert found("bright rim light", lights) == found("red and blue lights", lights) == []


def test_a_light_on_standby_plays_no_other_part():
    assert found("bright rim light", (("Light", "POINT", "key", -40.0),), {"Vibe Fill": "fill"}) == []


def found(prompt, lights, standby=STANDBY):
    context = SceneDescription(lights={name: LightDescription(kind) for name, kind, _, _ in lights})
    goals = goals_of(parse(prompt, SceneDescription()))
    return missing_lights(goals, make_instances(lights=lights), context, standby, default_vocabulary())


@pytest.mark.parametrize(("prompt", "blue"), [("morning light", False), ("morning, pale blue light", True)])
def test_a_light_that_is_said_to_be_blue_is_not_warm_by_its_time_of_day(prompt, blue):
    key = make_plan(prompt)["light/Key/temperature"]
    assert (key.upper[0] >= 5500) == blue


@pytest.mark.parametrize(
    ("prompt", "takes"),
    [("lit by a 12000 K lamp", True), ("cool light", False), ("3200 K key light", False), ("matte teal", False)],
)
def test_the_world_may_take_the_color_of_a_temperature_that_is_told_for_all_lights(prompt, takes):
    """A world that is warm drowns light of 12,000 K; where words only say cool, it is as the artist has it."""
    plan = plan_of(prompt, TWO)
    assert ("shadows too" in plan["world/color"].reason) == takes
    if takes:
        red, _, blue = plan["world/color"].upper
        assert blue > red
