# SPDX-License-Identifier: Apache-2.0
"""What no word names but claims may need."""

from dataclasses import replace

import pytest
from plan_parts import SCENE, make_instances, make_plan

from proxy_renderer.words.types import LightDescription, PictureStats


def supported(plan):
    return {key for key, entry in plan.items() if entry.reason.startswith("supports")}


def test_what_supports_the_words_may_stay_where_the_artist_has_it():
    instances = make_instances()
    plan = make_plan("teal dolphin", instances)
    assert {"film/exposure", "light/Key/power", "world/strength"} <= supported(plan)
    for key in supported(plan):
        entry, value = plan[key], instances[key].value
        assert entry.lower <= value <= entry.upper
        assert entry.lower < entry.upper
        assert entry.prior > 0


@pytest.mark.parametrize("prompt", ["teal dolphin", "vivid colors", "soft light", "matte black teapot"])
def test_no_material_supports_the_words(prompt):
    """A surface that no word names stays as it is, gray ones under "vivid colors" too."""
    assert not [key for key in supported(make_plan(prompt)) if key.startswith("material/")]


def test_neither_named_nor_locked_values_support():
    instances = make_instances()
    instances["film/exposure"] = replace(instances["film/exposure"], locked="keyframed")
    supports = supported(make_plan("teal dolphin on a red floor, strong light", instances))
    assert supports & {"film/exposure", "light/Key/power"} == set()


def exposures(percentiles, now=0.0):
    """The range of exposure for a picture with these L* at 5, 50 and 95 percent, and the stops of its proxy."""
    stats = PictureStats(percentiles=percentiles)
    entry = make_plan("teal dolphin", scene=replace(SCENE, picture=stats, values={"film/exposure": (now,)}))
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


def test_only_named_colors_are_strengthened():
    assert "film/saturation" in supported(make_plan("teal dolphin"))
    assert "film/saturation" not in supported(make_plan("soft light"))


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
    context = replace(SCENE, added_lights={"Back": LightDescription("POINT")})
    instances = make_instances()
    power = "light/Back/power"
    instances[power] = replace(instances[power], value=(0.01,))
    plain, bright, faint = (
        make_plan(f"a {word}rim light", instances, context)[power] for word in ("", "bright ", "faint ")
    )
    assert (bright.lower, bright.upper) == (plain.lower, plain.upper)
    assert 0.01 < faint.upper[0] < plain.lower[0]


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
