# SPDX-License-Identifier: Apache-2.0
"""`python -m lab materials`: what it compares, and its figures."""

import pytest
import torch
from ball_pictures import painted

from lab.bench.materials import compare, experiment, table
from lab.bench.sealed.prompts import measured
from proxy_renderer.color.tensors import blackbody
from proxy_renderer.schema import VibeError


def values(**given):
    return {f"material/Ball/{name}": {"after": value} for name, value in given.items()}


def lamps(kelvin, color=(1.0, 1.0, 1.0)):
    rows = {"Key": (200.0, kelvin, color), "Fill": (20.0, 6500.0, (1.0, 1.0, 1.0))}
    names = ("power", "temperature", "color")
    return {
        f"light/{lamp}/{name}": {"after": each}
        for lamp, row in rows.items()
        for name, each in zip(names, row, strict=True)
    }


def test_a_ball_like_the_measured_one_is_right():
    gold = next(row for row in measured()["materials"] if row["name"] == "Gold")
    picture = painted("#d8a850", "#808080")
    same = compare.material(gold, values(metallic=1.0, roughness=0.1, ior=1.5), picture, picture)
    assert same == {"metal_right": True, "delta_e": 0.0, "roughness": 0.1, "ior": None, "transmission": None}
    other = compare.material(gold, values(metallic=0.0), painted("#5060d0", "#808080"), picture)
    assert not other["metal_right"]
    assert other["delta_e"] > 40


@pytest.mark.parametrize("kelvin", [1900.0, 2700.0, 4000.0, 6500.0, 9000.0])
def test_kelvins_are_read_off_a_light(kelvin):
    found = compare.correlated_kelvin(blackbody(torch.tensor(kelvin)).tolist())
    assert abs(1e6 / found - 1e6 / kelvin) < 12


def test_green_light_has_no_kelvins():
    assert compare.correlated_kelvin((0.0, 1.0, 0.0)) is None


def test_the_strongest_lamp_is_compared():
    candle = {"kelvin": 1850.0, "color": [1.0, 0.22, 0.0]}
    assert compare.lamp(candle, lamps(1850.0))["mireds"] < 15
    assert compare.lamp(candle, lamps(6500.0))["mireds"] > 300
    green = {"kelvin": None, "color": [0.0, 1.0, 0.0]}
    assert compare.lamp(green, lamps(6500.0, (0.1, 1.0, 0.1)))["hue"] < 10
    assert compare.lamp(green, lamps(6500.0, (1.0, 0.1, 0.1)))["hue"] > 60


def test_the_summary_tells_known_words_from_ignored_ones():
    done = {"kind": "material", "code": 0, "error": "", "metal_right": True, "roughness": 0.1, "ior": None}
    rows = [
        {**done, "name": "Gold", "prompt": "gold", "ignored": [], "delta_e": 2.0},
        {**done, "name": "Musou", "prompt": "musou", "ignored": ["musou"], "delta_e": 30.0, "metal_right": False},
        {"name": "Sun", "prompt": "sun", "kind": "light", "code": 2, "error": "vibe: no."},
    ]
    results = table.summary(rows)
    assert (results["material"]["names"], results["material"]["known"]) == (2, 1)
    assert results["material"]["metal_right"] == 1
    assert results["material"]["median"]["delta_e"] == 16.0
    assert results["material"]["median_known"]["delta_e"] == 2.0
    assert results["failed"] == {"sun": "vibe: no."}
    table.show(results)


def test_a_name_that_nothing_has_is_refused(tmp_path):
    with pytest.raises(VibeError, match="quux"):
        experiment.run(tmp_path, only="quux")
