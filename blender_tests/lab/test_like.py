# SPDX-License-Identifier: GPL-3.0-or-later
"""`python -m lab like`: hidden looks, and a task from end to end."""

import pytest
from vibe_render.core.schema_import import schema

from lab.blender.like.hidden import hidden_values


def instances(*rows):
    made = [schema.Instance(schema.FAMILIES[f], owner, value, ref, role) for f, owner, value, ref, role in rows]
    return {instance.key: instance for instance in made}


def scene(world, lamp, front=0.0):
    return instances(
        ("camera/azimuth", "", (front,), 1.0, ""),
        ("light/azimuth", lamp, (-30.0,), 1.0, "key"),
        ("light/temperature", lamp, (6500.0,), 1.0, "key"),
        ("light/azimuth", "Back", (150.0,), 1.0, "rim"),
        (world, "", (0.5, 0.5, 0.5), 1.0, ""),
        ("volume/density", "", (0.0,), 0.25, ""),
        ("film/exposure", "", (0.0,), 1.0, ""),
        ("material/roughness", "Glaze", (0.5,), 1.0, "subject"),
    )


LOOK = ("light", "world", "volume", "film")


def test_two_scenes_get_the_same_look_each_in_its_own_terms():
    one = hidden_values(scene("world/color", "Softbox"), "a", LOOK)
    two = hidden_values(scene("world/tint", "Window", front=40.0), "a", LOOK)
    assert one["light/Softbox/temperature"] == two["light/Window/temperature"]
    assert one["world/color"] == two["world/tint"]
    assert one["light/Softbox/azimuth"][0] + 40.0 == pytest.approx(two["light/Window/azimuth"][0])
    assert one["volume/density"] == two["volume/density"]
    assert one != hidden_values(scene("world/color", "Softbox"), "b", LOOK)


def test_only_what_the_groups_name_is_hidden_and_roles_stay():
    look = scene("world/color", "Softbox")
    assert set(hidden_values(look, "a", ("film",))) == {"film/exposure"}
    assert "material/Glaze/roughness" in hidden_values(look, "a", ("material",))
    for seed in map(str, range(40)):
        values = hidden_values(look, seed, LOOK)
        assert abs(values["light/Softbox/azimuth"][0]) <= 80.0
        assert 140.0 <= values["light/Back/azimuth"][0] <= 220.0
        assert 2500.0 <= values["light/Softbox/temperature"][0] <= 9600.0


def test_some_looks_have_fog():
    foggy = [hidden_values(scene("world/color", "A"), str(n), LOOK)["volume/density"][0] > 0 for n in range(200)]
    assert 70 < sum(foggy) < 130
