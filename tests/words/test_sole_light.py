# SPDX-License-Identifier: Apache-2.0
"""One light that burns alone: the others go out, not the one that is named."""

import pytest

from proxy_renderer.goals.resolve import goals_of
from proxy_renderer.rigs.chosen import chosen_rig
from proxy_renderer.words.lexicon.rigs import rig_table
from proxy_renderer.words.lexicon.vocabulary import default_vocabulary
from proxy_renderer.words.parser import Understood
from proxy_renderer.words.types import LightDescription, SceneDescription

ROOM = SceneDescription(
    objects={"Chair": "subject", "Wall": "surroundings"},
    materials={"Cloth": "subject", "Plaster": "surroundings"},
    object_materials={"Chair": ("Cloth",), "Wall": ("Plaster",)},
    lights={"Floor Lamp": LightDescription("POINT"), "Window Light": LightDescription("AREA")},
)
WAYS = (
    "only the {} on", "just the {} is on", "lit only by the {}", "all lights off except the {}", "everything off but the {}",
)  # fmt: skip


def rig(prompt):
    found = chosen_rig(goals_of(Understood(prompt, ROOM).parsed), rig_table(), default_vocabulary())
    assert found
    return found.rig


@pytest.mark.parametrize("way", WAYS)
def test_a_lamp_alone_is_lamplight(way):
    assert rig(way.format("floor lamp")).name == "lamplight"
    assert rig(way.format("candle")).name == "candlelight"


@pytest.mark.parametrize("way", WAYS)
def test_any_other_light_alone_leaves_the_rest_in_the_dark(way):
    found = rig(way.format("window light"))
    assert {light.own for light in found.lights if light.part == "key"} == {"Window Light"}
    assert found.own < -8.0
    assert found.world < -5.0


def test_only_that_is_said_of_other_things_stays_what_it_is():
    assert not {w.entry for w in Understood("rim light only on the chair", ROOM).words} & {"lamplight"}
    for prompt in ("fog, lamp on", "lamp on with fog"):
        assert {w.entry for w in Understood(prompt, ROOM).words} == {"fog", "stronger lamp"}
