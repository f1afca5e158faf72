# SPDX-License-Identifier: Apache-2.0
"""Words that link lights to objects, and words that only look so."""

import pytest

from proxy_renderer.words.parser import Understood
from proxy_renderer.words.types import LightDescription, SceneDescription

ROOM = SceneDescription(
    objects={"Bottle": "subject", "Statue": "subject", "Wall": "surroundings", "Table": "surroundings"},
    materials={"Glass": "subject", "Stone": "subject", "Plaster": "surroundings", "Wood": "surroundings"},
    object_materials={"Bottle": ("Glass",), "Statue": ("Stone",), "Wall": ("Plaster",), "Table": ("Wood",)},
    lights={"Key": LightDescription("AREA", "key"), "Desk Lamp": LightDescription("POINT", "fill")},
)


def links(prompt):
    parsed = Understood(prompt, ROOM).parsed
    return [(each.only, each.objects, each.role, each.lights) for each in parsed.links]


@pytest.mark.parametrize(
    ("prompt", "link", "looks"),
    [
        ("a rim light only on the bottle", (True, ("Bottle",), "rim", ()), ["rim light"]),
        ("rim light on the bottle only, warm fog", (True, ("Bottle",), "rim", ()), ["rim light", "warm fog"]),
        ("the lamp does not light the wall", (False, ("Wall",), "", ("Desk Lamp",)), []),
        ("the key light only on the statue", (True, ("Statue",), "key", ("Key",)), []),
        ("the desk lamp lights only the table and the bottle", (True, ("Table", "Bottle"), "", ("Desk Lamp",)), []),
        ("warm desk lamp not on the wall, thin fog", (False, ("Wall",), "", ("Desk Lamp",)), ["warm", "thin fog"]),
        ("a cold rim light only on the bottle and red table", (True, ("Bottle",), "rim", ()), ["cold", "rim light", "red"]),
        ("The key shouldn't light the background", (False, ("Wall",), "key", ("Key",)), []),
    ],
)  # fmt: skip
def test_a_light_is_linked_by_words(prompt, link, looks):
    assert links(prompt) == [link]
    assert [word.text for word in Understood(prompt, ROOM).words] == looks


def test_what_names_nothing_is_said_and_not_used():
    for prompt, missing in (
        ("warm, the lantern does not light the wall", "light 'lantern'"),
        ("warm, the key light only on the vase", "object 'the vase'"),
    ):
        assert not links(prompt)
        assert any(f"there is no {missing}" in note for note in Understood(prompt, ROOM).parsed.notes)


@pytest.mark.parametrize(
    "prompt", ["warm light only on the bottle", "dust only on the table", "warm lamp, not on the wall", "wet table"]
)
def test_other_words_link_nothing(prompt):
    assert links(prompt) == []
