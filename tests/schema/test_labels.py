# SPDX-License-Identifier: Apache-2.0
"""What people read instead of keys."""

import pytest

from proxy_renderer.schema import FAMILIES, GROUPS, labels


@pytest.mark.parametrize(
    ("key", "expected"),
    [
        ("light/Key/power", "Key light: Power"),
        ("light/Sun.001/angle", "Sun.001: Angle"),
        ("light/Ceiling Lamp/power", "Ceiling Lamp: Power"),
        ("material/wood/oak/base_color", "wood/oak: Base Color"),
        ("world/strength", "World: Strength"),
        ("volume/density", "Fog: Density"),
        ("film/grade_gamma", "Grade Gamma"),
        ("camera/fov", "Camera: Field of View"),
    ],
)
def test_titles(key, expected):
    assert labels.title(key) == expected


def test_no_parameter_shows_its_key():
    """Neither an underscore nor a slash, whatever the row; every group and unit has words."""
    assert set(labels.GROUP_TITLES) == set(GROUPS)
    for row in FAMILIES.values():
        key = row.key("Thing" if row.group in ("light", "material") else "")
        said = f"{labels.title(key)}: {labels.text(key, (row.default,) * row.components)}"
        assert not set("_/") & set(said.replace(" /m", "").replace("W/m²", "")), said


@pytest.mark.parametrize(
    ("key", "value", "expected"),
    [
        ("film/exposure", 0.4, "+0.4 stops"),
        ("film/exposure", -0.00397, "0 stops"),
        ("light/Key/power", 123.4, "123 W"),
        ("light/Key/power", 0.00001, "0 W"),
        ("volume/density", 0.013924, "0.0139 /m"),
    ],
)
def test_values(key, value, expected):
    assert labels.text(key, (value,)) == expected


def test_a_note_names_a_few():
    keys = [f"light/Lamp {i}/power" for i in range(5)]
    assert labels.titles(keys) == "Lamp 0: Power, Lamp 1: Power, Lamp 2: Power and 2 more"
    assert labels.titles(keys[:1]) == "Lamp 0: Power"


@pytest.mark.parametrize(
    ("other", "is_same"), [(0.9125, True), (0.9125000238418579, True), (0.91249, True), (0.915, False)]
)
def test_a_rounding_border_between_two_values_makes_no_change(other, is_same):
    """Blender stores 32 bits: 0.9125 comes back as 0.91250002, which reads "0.913" and not "0.912"."""
    assert labels.same("film/saturation", (0.9125,), (other,)) == is_same
