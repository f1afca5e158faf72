# SPDX-License-Identifier: Apache-2.0
"""How far values may go to look like a picture, and the colors that its light may have."""

from __future__ import annotations

import pytest

from proxy_renderer.goals.wish import Wish
from proxy_renderer.planning import picture_ranges
from proxy_renderer.planning.picture_ranges import LightColors, light_colors
from proxy_renderer.reference.like import effects_of
from proxy_renderer.schema import FAMILIES, Instance
from proxy_renderer.schema.parameters import PICTURE
from proxy_renderer.words.lexicon.quantities import ClaimText
from proxy_renderer.words.types import Attribute


def cast(a, b, measure="midtone_cast"):
    return ClaimText("picture", measure, (a - 2, b - 2), (a + 2, b + 2))


def test_a_neutral_picture_lets_light_be_hardly_colored():
    colors = light_colors([cast(0, 0), cast(1, -1, "shadow_cast")])
    assert min(colors.key[0]) > 0.8
    assert colors.fill == colors.key


def test_an_orange_cast_lets_light_be_orange_and_neither_green_nor_blue():
    colors = light_colors([cast(20, 40), cast(8, 12, "shadow_cast")])
    red, green, blue = colors.key[0]
    assert blue < 0.1 < green < 0.5 < red
    assert colors.fill == colors.key


def test_teal_shadows_and_orange_lights_are_each_their_own_light():
    colors = light_colors([cast(-15, -10, "shadow_cast"), cast(15, 30, "highlight_cast")])
    assert colors.key == light_colors([cast(15, 30, "highlight_cast")]).key
    assert colors.fill == light_colors([cast(-15, -10)]).fill
    assert colors.key[0][0] > colors.key[0][2]
    assert colors.fill[0][0] < colors.fill[0][2]


def test_no_light_is_of_a_hue_between_those_of_two_casts():
    colors = light_colors([cast(-5, -14), cast(-12, 6, "highlight_cast")])
    for which in (colors.key, colors.fill):
        for share in (0.0, 0.5, 1.0):
            red, green, blue = (low + share * (high - low) for low, high in zip(*which, strict=True))
            assert green < 1.5 * max(red, blue)


def test_a_slight_cast_lets_light_be_of_its_own_hue_only():
    red, green, blue = light_colors([cast(4, 4), cast(1, 1, "highlight_cast")]).key[0]
    assert red == 1.0 > green > blue  # on the way from white, and not greenish


@pytest.mark.parametrize("measure", ["median", "tint"])
def test_other_claims_say_nothing_of_light(measure):
    assert light_colors([cast(40, 40, measure)]) == light_colors([])


@pytest.mark.parametrize(("vivid", "least"), [(3.0, 0.0), (14.0, 0.5), (40.0, 1.0)])
def test_a_picture_with_colors_in_it_takes_no_paint_away(vivid, least):
    chroma = ClaimText("picture", "chroma", (0.0,), (vivid,))
    assert light_colors([chroma]).paint == pytest.approx(least)


LINE = (1.0, 0.6, 0.3), (1.0, 1.0, 1.0)
WARM = LightColors(LINE, LINE, paint=0.5)


def instances(**colors):
    values = {"light/Key/color": (1.0, 1.0, 1.0), "film/saturation": (1.0,), "film/lift": (1.0, 1.0, 1.0)}
    return {key: _instance(key, value) for key, value in (values | colors).items()}


def _instance(key, value):
    parts = key.split("/")
    return Instance(FAMILIES[f"{parts[0]}/{parts[-1]}"], parts[1] if len(parts) == 3 else "", value)


@pytest.fixture
def entries(monkeypatch):
    """Ranges for a picture of warm light."""
    monkeypatch.setattr(picture_ranges, "light_colors", lambda claims: WARM)
    word, claims = Attribute("a.jpg", "a.jpg", PICTURE, "whole", "whole"), (ClaimText("picture", "chroma"),)

    def made(instances, traits=("light", "grade", "palette")):
        effects = effects_of(instances.values(), traits, {"chroma"}, same=False)
        return picture_ranges.entries_of([Wish(word, "cast", effects=tuple(effects), claims=claims)], instances)

    return made


def test_light_takes_hues_of_the_picture_and_keeps_its_level(entries):
    entry = entries(instances(**{"light/Key/color": (0.1, 0.1, 0.5)}))["light/Key/color"]
    assert entry.lower == pytest.approx((0.5, 0.3, 0.15))
    assert not entry.any_hue


def test_paint_keeps_the_saturation_that_the_picture_leaves_it(entries):
    assert entries(instances())["film/saturation"].lower == (0.5,)


def test_a_grade_beside_light_cuts_no_shadows_off_and_one_alone_does_all(entries):
    assert entries(instances())["film/lift"].lower[0] == pytest.approx(0.98)
    assert entries(instances(), ("grade",))["film/lift"].lower[0] == pytest.approx(0.9)


def test_what_a_range_leaves_the_artist_s_value_is_in_it(entries):
    entry = entries(instances(**{"film/saturation": (1.8,)}))["film/saturation"]
    assert (entry.lower, entry.upper) == ((0.5,), (1.8,))
