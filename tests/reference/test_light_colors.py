# SPDX-License-Identifier: Apache-2.0
"""Light has the hues of the casts that a picture has, and no others."""

import pytest

from proxy_renderer.claims.claim import Claim
from proxy_renderer.reference.light_colors import light_colors


def cast(a, b, measure="midtone_cast"):
    return Claim("a.jpg", "picture", measure, "picture", (a - 2, b - 2), (a + 2, b + 2))


def test_a_neutral_picture_lets_light_be_hardly_colored():
    colors = light_colors([cast(0, 0), cast(1, -1, "shadow_cast")])
    assert min(colors.lower) > 0.8
    assert not colors.any_hue


def test_an_orange_cast_lets_light_be_orange_and_neither_green_nor_blue():
    colors = light_colors([cast(20, 40), cast(8, 12, "shadow_cast")])
    red, green, blue = colors.lower
    assert blue < 0.1 < green < 0.5 < red
    assert not colors.any_hue  # between white and orange, as one line


def test_teal_shadows_and_orange_lights_let_light_be_either():
    colors = light_colors([cast(-15, -10, "shadow_cast"), cast(15, 30, "highlight_cast")])
    assert colors.any_hue
    assert min(colors.lower) < 0.3


def test_a_slight_cast_lets_light_be_of_its_own_hue_only():
    red, green, blue = light_colors([cast(4, 4), cast(1, 1, "highlight_cast")]).lower
    assert red == 1.0 > green > blue  # on the way from white, and not greenish


@pytest.mark.parametrize("measure", ["median", "tint"])
def test_other_claims_say_nothing_of_light(measure):
    assert light_colors([cast(40, 40, measure)]) == light_colors([])


@pytest.mark.parametrize(("vivid", "least"), [(3.0, 0.0), (14.0, 0.5), (40.0, 1.0)])
def test_a_picture_with_colors_in_it_takes_no_paint_away(vivid, least):
    chroma = Claim("a.jpg", "picture", "chroma", "picture", (0.0,), (vivid,))
    assert light_colors([chroma]).paint == pytest.approx(least)
