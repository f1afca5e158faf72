# SPDX-License-Identifier: Apache-2.0
"""Color temperatures that are told as numbers."""

import pytest
from plan_parts import SCENE, make_plan

from proxy_renderer.schema import VibeError
from proxy_renderer.words.parser import parse


def temperatures(prompt):
    """Light -> the middle of its range of temperatures, kelvin; None where no word is about it."""
    rows = {key.split("/")[1]: row for key, row in make_plan(prompt).items() if key.endswith("/temperature")}
    return {name: (row.lower[0] + row.upper[0]) / 2 if row.priority else None for name, row in rows.items()}


@pytest.mark.parametrize(
    ("prompt", "kelvins"),
    [
        ("5000 K bulb", 5000),
        ("lit by a 2,700K lamp", 2700),
        ("6500 kelvin light", 6500),
        ("7540 K", 7500),
        ("1900k candlelight", 1900),
        ("embers of 800 K", 1300),
    ],
)
def test_a_number_of_kelvins_is_the_lights_temperature(prompt, kelvins):
    assert temperatures(prompt)["Key"] == pytest.approx(kelvins)


def test_each_light_gets_its_own():
    assert temperatures("3200K key light, 6500 kelvin fill") == pytest.approx({"Key": 3200, "Fill": 6500, "Back": None})


@pytest.mark.parametrize("prompt", ["4K render", "8k", "90000 K", "480k", "12 k"])
def test_other_numbers_are_no_temperatures(prompt):
    with pytest.raises(VibeError, match="names a look"):
        parse(prompt, SCENE)
