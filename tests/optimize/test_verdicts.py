# SPDX-License-Identifier: Apache-2.0
"""What is said of each word after the search: its state, and why the image does not show it."""

import pytest
from loop_parts import Silent, search_for

from proxy_renderer.engine.report import claims_about, foreseen, word_verdicts
from proxy_renderer.optimize.pipeline import run
from proxy_renderer.optimize.shots import ShotInput
from proxy_renderer.schema.messages import Options


@pytest.fixture
def verdicts(scene, encoder):
    def found(prompt, **options):
        settings = Options(**{"rounds": 1, "steps": 2, "size": 48, **options})
        outcome = run(search_for([ShotInput(scene)], prompt, settings, encoder, Silent()))
        claims = claims_about(outcome)
        rows = foreseen(outcome, claims)
        return {row["word"]: row for row in word_verdicts(outcome, rows, claims[0].after)}

    return found


def test_a_lock_is_named_and_can_be_opened(verdicts, scene):
    keys = [key for key in scene.instances if key.startswith("material/") and "roughness" not in key]
    row = verdicts("matte red ball", lock=keys)["red"]
    assert row["state"] == "missed"
    assert row["missing"]
    assert "may not change: locked by you" in row["why"]
    assert row["unlock"] in keys


def test_a_word_that_another_one_contradicts_names_it(verdicts):
    rows = verdicts("glossy ball, the ball is matte")
    (lost,) = [row for row in rows.values() if row["state"] == "missed" and "conflicts with" in row["why"]]
    assert lost["word"] in ("glossy", "matte")


def test_what_no_measure_reads_is_not_ticked(verdicts):
    assert verdicts("hammered ball")["hammered"]["state"] == "unmeasured"


def test_a_miss_that_the_search_could_not_help_says_why(verdicts):
    rows = list(verdicts("blinding white light, pitch black ball, very glossy").values())
    assert all(row["why"] for row in rows if row["state"] == "missed" and row["word"])
