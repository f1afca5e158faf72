# SPDX-License-Identifier: Apache-2.0
"""Goals keep which words describe one light, and name no light that there is not."""

import json

import pytest

from proxy_renderer.goals.resolve import goals_of
from proxy_renderer.goals.written import as_json, from_json
from proxy_renderer.rigs.chosen import chosen_rig
from proxy_renderer.schema import VibeError
from proxy_renderer.words.lexicon.rigs import rig_table
from proxy_renderer.words.lexicon.vocabulary import default_vocabulary
from proxy_renderer.words.parser import Understood
from proxy_renderer.words.types import SceneDescription


@pytest.mark.parametrize(
    "prompt",
    [
        "two lights: a pink one at the left and a teal one at the right",
        "a hard key from above, a faint blue rim on the left",
    ],
)
def test_lights_that_are_described_one_by_one_are_the_same_again(prompt):
    words, vocabulary = SceneDescription(), default_vocabulary()
    goals = goals_of(Understood(prompt, words).parsed)
    again = from_json(json.loads(json.dumps(as_json(goals)))).within(words)
    first, second = (chosen_rig(each, rig_table(), vocabulary) for each in (goals, again))
    assert first
    assert second
    assert [light.part for light in first.rig.lights] == [light.part for light in second.rig.lights]
    assert first.rig.says == second.rig.says


@pytest.mark.parametrize(
    ("field", "value"), [("kind", "lamp"), ("role", "main"), ("described", ["one"]), ("described", [True])]
)
def test_a_wrong_target_is_refused(field, value):
    written = as_json(goals_of(Understood("a red rim light", SceneDescription()).parsed))
    written["words"][0]["target"][field] = value
    with pytest.raises(VibeError, match=rf"words\[0\]\.target\.{field}"):
        from_json(written)
