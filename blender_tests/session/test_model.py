# SPDX-License-Identifier: GPL-3.0-or-later
"""A vision-language model in whole runs and in the preferences: what it is asked, what it costs, where its key is not."""

import json
import os
from dataclasses import asdict

import bpy
import pytest
import vibe_render
from headless_runs import run_with_model
from model_server import KEY, MODEL, has_picture, plan_for, refuses, says, sensible, serving
from small_scenes import studio
from vibe_render.run.notes import failure_note, model_lines
from vibe_render.run.session import preferences


def without_key(folder):
    """Every file below a folder, none of which may hold the key."""
    files = [p for p in folder.rglob("*") if p.is_file()]
    assert not [p for p in files if KEY.encode() in p.read_bytes()]
    return {p.name for p in files}


@pytest.mark.slow
def test_a_run_with_a_model(tmp_path):
    with serving(sensible) as model:
        report, output = run_with_model(tmp_path, model)
    assert [has_picture(body) for body in model.asked] == [True, True]
    assert {h["authorization"] for h in model.headers} == {f"Bearer {KEY}"}
    vlm = report["vlm"]
    assert (vlm["model"], vlm["calls"], vlm["failures"], vlm["format"]) == (MODEL, 1, [], "json_schema")
    assert report["rounds"][0]["advice"] == MODEL
    assert report["parameters"]["material/Box/roughness"]["reason"] == "model: asked for"
    assert report["judge"]["winner"] == "AFTER"
    assert "The model's verdict: AFTER. It is teal." in output
    names = without_key(tmp_path)
    assert {"report.json", "vibed.blend", "preset.json"} <= names
    assert KEY not in output


@pytest.mark.slow
def test_a_server_that_refuses_and_talks_about_the_key(tmp_path):
    with serving(lambda body, n: refuses(401, f"Incorrect API key provided: {KEY}")) as model:
        report, output = run_with_model(tmp_path, model)
    assert "refuses the key" in report["vlm"]["failures"][0]
    assert "refuses the key" in report["judge"]["error"]
    assert "Planned without the model in 1 of 1 rounds" in output
    without_key(tmp_path)
    assert KEY not in output


@pytest.fixture
def installed(scene):
    """The add-on with preferences, as after Install from Disk."""
    vibe_render.register()
    addon = bpy.context.preferences.addons.new()
    addon.module = "vibe_render"
    yield scene, addon.preferences
    bpy.context.preferences.addons.remove(addon)
    vibe_render.unregister()


def test_the_key_is_in_no_file_of_the_scene(installed, tmp_path):
    scene, chosen = installed
    long = KEY * 10
    chosen.vlm_model, chosen.vlm_url, chosen.vlm_key = MODEL, "http://localhost:1/v1", long
    assert chosen.vlm_key == long  # not cut
    options = scene.vibe.engine_options(bpy.context)
    assert (options.vlm_model, options.vlm_url, options.online) == (MODEL, "http://localhost:1/v1", True)
    assert KEY not in json.dumps(asdict(options))
    path = tmp_path / "scene.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path), compress=False)
    assert KEY.encode() not in path.read_bytes()


@pytest.mark.slow
def test_a_vibe_from_the_panel_with_the_key_of_the_preferences(installed, tmp_path, monkeypatch):
    scene, chosen = installed
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    studio(scene)
    scene.vibe.prompt = "glossy red cube"
    scene.vibe.effort, scene.vibe.rounds, scene.vibe.steps, scene.vibe.size = "CUSTOM", 2, 1, 64

    def dying(body, number):
        bloom = {"parameter": "film/glare", "lower": [0.3], "upper": [0.5], "priority": 1, "reason": "dreamy"}
        return says(plan_for(body, plan=[bloom])) if number == 1 else refuses(401, "expired")

    with serving(dying) as model:
        chosen.vlm_model, chosen.vlm_url, chosen.vlm_key = MODEL, model.url, KEY
        assert bpy.ops.vibe.run() == {"FINISHED"}
        vibe_render.run.state.addon_state.close()
    assert {h["authorization"] for h in model.headers} == {f"Bearer {KEY}"}
    assert scene.vibe.changes["film/glare"].reason.startswith(
        "model: dreamy"
    )  # held though the next round had no model
    without_key(tmp_path)


@pytest.mark.slow
def test_blender_s_online_access_is_asked(installed, monkeypatch):
    scene, chosen = installed
    chosen.vlm_model, chosen.vlm_url = MODEL, "https://example.org/v1"
    monkeypatch.setattr(preferences, "online", lambda: False)
    studio(scene)
    scene.vibe.prompt = "glossy red cube"
    with pytest.raises(RuntimeError, match="online access is off"):
        bpy.ops.vibe.run()
    vibe_render.run.state.addon_state.close()


def test_what_failed_is_said():
    rounds = [{"advice": "eyes:7b"}, {"advice": "offline planner: down"}]
    assert failure_note({"vlm": {"failures": ["It is down."]}, "rounds": rounds}) == (
        "Planned without the model in 1 of 2 rounds. It is down."
    )
    assert failure_note({"rounds": rounds}) == ""
    counts = {"clipped": 2, "mended": 0, "dropped": 1, "missing": 0}
    model = {"model": "eyes", "calls": 3, "cached": 1, "tokens": {"read": 9, "written": 5}, "cost_usd": 0.5}
    lines = model_lines({"vlm": {**model, **counts}}, {"error": "It is blind."})
    assert "0.5000 US dollars" in lines[0]
    assert lines[1].endswith(": 2 clipped, 1 dropped.")
    assert lines[2].endswith("It is blind.")


def test_the_environment_is_clean():
    assert "VIBE_VLM_MODEL" not in os.environ
