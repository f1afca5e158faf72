# SPDX-License-Identifier: Apache-2.0
"""How far values may go for a picture of another scene."""

import pytest

from proxy_renderer.reference.ranges import LightColors, entries_of
from proxy_renderer.schema import FAMILIES, Instance

LINE = (1.0, 0.6, 0.3), (1.0, 1.0, 1.0)
WARM = LightColors(LINE, LINE, paint=0.5)


def instances(**colors):
    values = {"light/Key/color": (1.0, 1.0, 1.0), "film/saturation": (1.0,), "film/lift": (1.0, 1.0, 1.0)}
    return {key: _instance(key, value) for key, value in (values | colors).items()}


def _instance(key, value):
    parts = key.split("/")
    return Instance(FAMILIES[f"{parts[0]}/{parts[-1]}"], parts[1] if len(parts) == 3 else "", value)


def entries(made, traits=("light", "grade", "palette")):
    return entries_of(made, traits, {"chroma"}, same=False, name="a.jpg", colors=WARM)


def test_light_takes_hues_of_the_picture_and_keeps_its_level():
    entry = entries(instances(**{"light/Key/color": (0.1, 0.1, 0.5)}))["light/Key/color"]
    assert entry.lower == pytest.approx((0.5, 0.3, 0.15))
    assert not entry.any_hue


def test_paint_keeps_the_saturation_that_the_picture_leaves_it():
    assert entries(instances())["film/saturation"].lower == (0.5,)


def test_a_grade_beside_light_cuts_no_shadows_off_and_one_alone_does_all():
    assert entries(instances())["film/lift"].lower[0] == pytest.approx(0.98)
    assert entries(instances(), ("grade",))["film/lift"].lower[0] == pytest.approx(0.9)
