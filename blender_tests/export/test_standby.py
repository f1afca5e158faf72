# SPDX-License-Identifier: GPL-3.0-or-later
"""Lights that the words may ask for are offered to the engine, and are in the scene only once values add them."""

import json

import dump
import numpy as np
import pytest
import scenes
from vibe_render.export import reading
from vibe_render.scene import bindings, snapshot
from vibe_render.scene.subject import SubjectChoice

from proxy_renderer.optimize.stage import set_stage
from proxy_renderer.scene import load_scene
from proxy_renderer.schema.added_lights import ADDED_LIGHTS, CARD, COLLECTION


def test_lights_on_standby_are_no_part_of_the_scene(tmp_path):
    scene = scenes.still_life()
    job = reading.export_scene(scene, tmp_path, SubjectChoice(("Bottle",)))
    content = json.loads((tmp_path / "scene.json").read_text())
    assert {row["name"] for row in content["standby"]["lights"]} == set(ADDED_LIGHTS)
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


@pytest.mark.parametrize(
    "name", ["Vibe Key Spot", "Vibe Key Lamp", "Vibe Key Sun", "Vibe Key Blinds", "Vibe Key Leaves"]
)
def test_each_type_of_light_is_added_to_its_collection_and_taken_away(tmp_path, name):
    scene = scenes.still_life()
    before = dump.contents()
    job = reading.export_scene(scene, tmp_path, SubjectChoice(("Bottle",)))
    energy = "strength" if ADDED_LIGHTS[name].type == "SUN" else "power"
    values = {f"light/{name}/{energy}": [6.0], f"light/{name}/azimuth": [120.0]}
    assert bindings.write(scene, values, job.analysis.objects, job.analysis.pivot) == {}
    light = scene.objects[name]
    assert [c.name for c in light.users_collection] == [COLLECTION]
    assert not light.visible_camera
    card = next((o for o in scene.objects if o.name == CARD), None)
    assert bool(card) == bool(ADDED_LIGHTS[name].pattern)
    if card:
        assert card.parent == light
        assert not any(getattr(card, f"visible_{ray}") for ray in ("camera", "diffuse", "glossy"))
    snapshot.revert(scene)
    assert dump.difference(before, dump.contents()) == {}


def test_a_card_stands_where_the_engine_has_it(tmp_path):
    scene = scenes.still_life()
    job = reading.export_scene(scene, tmp_path, SubjectChoice(("Bottle",)))
    addition = set_stage([load_scene(tmp_path)], "sun through the blinds")
    values = {key: list(entry.start) for key, entry in addition.plan.entries.items() if "Vibe" in key}
    bindings.write(scene, values, job.analysis.objects, job.analysis.pivot)
    card = next(o for o in scene.objects if o.name == CARD)
    here = np.array([card.matrix_world @ v.co for v in card.data.vertices])
    data = addition.scenes[0]
    number = next(i for i, thing in enumerate(data.objects) if thing.name == CARD)
    there = data.mesh.vertices[np.unique(data.mesh.faces[data.mesh.object == number])]
    assert np.abs(here - there).max() < 1e-3 * np.abs(there).max()
