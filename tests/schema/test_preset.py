# SPDX-License-Identifier: Apache-2.0
"""The text of presets: goals are kept, and older presets have none."""

import json

import pytest

from proxy_renderer.goals.resolve import goals_of
from proxy_renderer.goals.written import as_json, from_json
from proxy_renderer.schema import VibeError
from proxy_renderer.schema.preset import Preset, loads
from proxy_renderer.words.parser import parse
from proxy_renderer.words.types import SceneDescription

GOALS = as_json(goals_of(parse("teal vase, golden hour, cosy", SceneDescription())))
LOOK = Preset("Dusk", {"film": [{"contrast": [1.1]}]}, prompt="teal vase, golden hour, cosy", goals=GOALS)


def test_goals_survive_the_text_of_a_preset():
    again = loads(LOOK.dumps())
    assert again == LOOK
    assert again.goals == GOALS
    assert from_json(again.goals).wishes == from_json(GOALS).wishes


def test_a_preset_of_an_earlier_version_has_no_goals():
    raw = json.loads(LOOK.dumps())
    del raw["goals"]
    assert loads(json.dumps(raw)) == Preset(LOOK.name, LOOK.roles, prompt=LOOK.prompt)
    assert loads(Preset("Plain", {}).dumps()).goals == {}


@pytest.mark.parametrize("goals", [[], "goals", 3, None, True])
def test_goals_of_the_wrong_type_are_refused(goals):
    raw = json.loads(LOOK.dumps()) | {"goals": goals}
    with pytest.raises(VibeError, match="The preset's goals are no object") as caught:
        loads(json.dumps(raw))
    assert caught.value.remedy
