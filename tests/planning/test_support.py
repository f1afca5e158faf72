# SPDX-License-Identifier: Apache-2.0
"""What no word names but claims may need."""

import math
from dataclasses import replace

import pytest
from plan_parts import CONTEXT, make_instances, make_plan

from proxy_renderer.color.floats import lab_from_srgb, srgb_from_linear
from proxy_renderer.planning.types import PictureStats

FLOOR, BODY = "material/Floor/base_color", "material/Body/base_color"


def supported(plan):
    return {key for key, entry in plan.items() if entry.reason.startswith("supports")}


def test_what_supports_the_words_may_stay_where_the_artist_has_it():
    instances = make_instances()
    plan = make_plan("teal dolphin", instances)
    assert {FLOOR, "film/exposure", "light/Key/power", "world/strength"} <= supported(plan)
    for key in supported(plan):
        entry, value = plan[key], instances[key].value
        assert entry.lower <= value <= entry.upper
        assert entry.lower < entry.upper
        assert entry.prior > 0


def test_neither_named_nor_locked_values_support():
    instances = make_instances()
    instances["film/exposure"] = replace(instances["film/exposure"], locked="keyframed")
    supports = supported(make_plan("teal dolphin on a red floor, strong light", instances))
    assert supports & {FLOOR, BODY, "film/exposure", "light/Key/power"} == set()


def test_a_surface_that_no_word_names_may_become_another_shade_of_its_own_color():
    instances = make_instances()
    instances[FLOOR] = replace(instances[FLOOR], value=(0.02, 0.01, 0.01))
    entry = make_plan("matte black teapot", instances)[FLOOR]
    assert entry.upper[0] > 0.05
    assert entry.upper[0] / entry.upper[1] == pytest.approx(2.0)
    assert entry.lower[0] < 0.01


def exposures(percentiles, now=0.0):
    """The range of exposure for a picture with these L* at 5, 50 and 95 percent, and the stops of its proxy."""
    stats = PictureStats(percentiles=percentiles)
    entry = make_plan(
        "teal dolphin", context=replace(CONTEXT, picture=stats, values={"film/exposure": (now,)})
    )
    return entry["film/exposure"].lower[0], entry["film/exposure"].upper[0]


def test_a_scene_that_is_all_dark_or_all_light_may_be_exposed_as_it_needs():
    assert exposures((5.0, 40.0, 90.0)) == (-1.5, 1.5)
    lower, upper = exposures((0.1, 0.5, 6.0))
    assert lower == -1.5
    assert upper > 5.0
    lower, upper = exposures((92.0, 95.0, 97.0))
    assert lower < -3.0
    assert upper == 1.5


def test_what_a_round_has_gained_in_exposure_stays_in_reach():
    assert exposures((10.0, 40.0, 75.0), now=4.0)[1] == pytest.approx(4.0)


def test_of_many_surfaces_only_those_that_are_seen_much_may_change():
    names = tuple(f"Thing {n}" for n in range(9))
    instances = make_instances(materials=(("Body", "subject"), *((name, "surroundings") for name in names)))
    shares = {name: 0.02 * n for n, name in enumerate(names)}
    plan = make_plan("teal dolphin", instances, replace(CONTEXT, material_share=shares))
    mine = {key.split("/")[1] for key in supported(plan) if key.startswith("material/")}
    assert mine == {"Thing 5", "Thing 6", "Thing 7", "Thing 8"}


def test_only_named_colors_are_strengthened():
    assert "film/saturation" in supported(make_plan("teal dolphin"))
    assert "film/saturation" not in supported(make_plan("soft light"))


def test_vivid_colors_need_something_that_has_one():
    """Of gray things each gets a hue of its own; where anything has a color, saturation is enough, and named colors are."""
    gray = make_instances()
    plan = make_plan("vivid colors", gray)
    hues = [
        hue_of([(a + b) / 2 for a, b in zip(e.lower, e.upper, strict=True)])
        for e in (plan[BODY], plan[FLOOR])
    ]
    assert 90 < abs(hues[0] - hues[1]) < 270
    colored = gray | {FLOOR: replace(gray[FLOOR], value=(0.5, 0.1, 0.1))}
    for prompt, scene in (("vivid colors", colored), ("soft light", gray), ("vivid colors, teal body", gray)):
        entry = make_plan(prompt, scene)[FLOOR]
        assert entry.lower <= scene[FLOOR].value <= entry.upper


def hue_of(linear):
    _, a, b = lab_from_srgb(srgb_from_linear(linear))
    assert math.hypot(a, b) > 30
    return math.degrees(math.atan2(b, a)) % 360


def test_where_light_has_a_color_what_the_world_sheds_may_have_it_too():
    """A gray world gives gray shadows in green light; no word about the light as a whole, and it stays."""
    instances = make_instances()
    entry = make_plan("green light", instances)["world/color"]
    value = instances["world/color"].value
    assert entry.lower[0] < 0.5 * value[0]
    assert entry.lower[1] == pytest.approx(value[1])
    assert entry.any_hue
    assert make_plan("green rim light", instances)["world/color"].priority is None


def test_a_light_that_is_added_has_nothing_to_be_stronger_than():
    """The power that the scene's file gives it says nothing; weaker is weaker than what words ask for."""
    context = replace(CONTEXT, added_lights=("Back",))
    instances = make_instances()
    power = "light/Back/power"
    instances[power] = replace(instances[power], value=(0.01,))
    plain, bright, faint = (
        make_plan(f"a {word}rim light", instances, context)[power] for word in ("", "bright ", "faint ")
    )
    assert (bright.lower, bright.upper) == (plain.lower, plain.upper)
    assert 0.01 < faint.upper[0] < plain.lower[0]


def test_gray_things_become_vivid_in_the_hue_that_they_have():
    instances = make_instances()
    instances[FLOOR] = replace(instances[FLOOR], value=(0.447, 0.389, 0.337))
    entry = make_plan("vivid colors", instances)[FLOOR]
    middle = [(a + b) / 2 for a, b in zip(entry.lower, entry.upper, strict=True)]
    _, a, b = lab_from_srgb(srgb_from_linear(instances[FLOOR].value))
    assert hue_of(middle) == pytest.approx(math.degrees(math.atan2(b, a)), abs=6)


def test_a_lamp_that_has_a_size_as_words_want_it_begins_there():
    """Also where the ends are reckoned from it: the last digit of a range is no reason to begin elsewhere."""
    instances = make_instances()
    size = "light/Key/size"
    entry = make_plan("soft light", instances)[size]
    instances[size] = replace(instances[size], value=(entry.lower[0] * (1 - 1e-12),))
    assert make_plan("soft light", instances)[size].start is None
    instances[size] = replace(instances[size], value=(entry.lower[0] / 4,))
    assert make_plan("soft light", instances)[size].start is not None


def test_a_tint_of_the_film_is_left_to_claims_from_faint_to_strong():
    entry = make_plan("orange highlights")["film/gain"]
    assert entry.any_hue
    assert entry.upper[0] - 1 > 2 * (entry.lower[0] - 1) > 0
    assert entry.lower[2] < entry.upper[2] < 1
