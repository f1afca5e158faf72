# SPDX-License-Identifier: GPL-3.0-or-later
"""Lights that the words may ask for are offered to the engine, and are in the scene only once values add them."""

import json

import dump
import scenes
from vibe_render.export import reading
from vibe_render.scene import bindings, snapshot
from vibe_render.scene.subject import SubjectChoice


def test_lights_on_standby_are_no_part_of_the_scene(tmp_path):
    scene = scenes.still_life()
    job = reading.export_scene(scene, tmp_path, SubjectChoice(("Bottle",)))
    content = json.loads((tmp_path / "scene.json").read_text())
    assert {row["name"] for row in content["standby"]["lights"]} == {"Vibe Key", "Vibe Fill", "Vibe Rim"}
    assert content["standby"]["parameters"]["light/Vibe Rim/power"]["role"] == "rim"
    assert not any("Vibe" in o.name for o in scene.objects)
    assert not any("Vibe" in key for key in job.instances)


def test_a_value_adds_the_light_and_revert_takes_it_away(tmp_path):
    scene = scenes.still_life()
    before = dump.contents()
    job = reading.export_scene(scene, tmp_path, SubjectChoice(("Bottle",)))
    values = {"light/Vibe Rim/power": [60.0]}
    assert bindings.write(scene, values, job.analysis.objects, job.analysis.pivot) == {}
    assert abs(scene.objects["Vibe Rim"].data.energy - 60.0) < 1e-3
    assert "light/Vibe Rim/power" in job.with_additions_of(values).instances
    snapshot.revert(scene)
    assert dump.difference(before, dump.contents()) == {}
