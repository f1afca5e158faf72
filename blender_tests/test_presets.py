# SPDX-License-Identifier: GPL-3.0-or-later
"""Looks carried from one scene to another, and preset files that must be refused."""

import json

import bpy
import pytest
import scenes
from vibe_render import bindings, presets, scene_io
from vibe_render.subject import Choice

from proxy_renderer.schema import VERSION, VibeError, preset


def opened(build, folder):
    scene = build()
    return scene, scene_io.open_job(scene, folder, Choice())


@pytest.fixture
def look(tmp_path):
    """What a vibe did to the still life: its most visible material, its lights, its film."""
    _, job = opened(scenes.still_life, tmp_path)
    key = next(i.owner for i in job.instances.values() if i.role == "key")
    camera = job.instances["camera/azimuth"].value[0]
    values = {
        "material/Bottle Glaze/base_color": (0.0, 0.3, 0.3),
        "material/Bottle Glaze/roughness": (0.1,),
        "material/Wall/base_color": (0.5, 0.1, 0.1),
        f"light/{key}/azimuth": (camera - 90.0,),
        f"light/{key}/color": (1.0, 0.5, 0.2),
        "volume/density": (0.5 * job.instances["volume/density"].reference,),
        "film/saturation": (1.4,),
        "camera/fov": (30.0,),
    }
    return presets.extract("a test", job, values)


def test_a_preset_survives_its_file(look, tmp_path):
    (tmp_path / "preset.json").write_text(look.dumps(), encoding="utf-8")
    assert presets.load(tmp_path / "preset.json") == look
    assert look.roles["volume"] == [{"density": [pytest.approx(0.5)]}]
    assert look.roles["key"][0]["azimuth"] == [pytest.approx(-90.0)]
    assert "camera" not in look.roles


def test_it_fits_a_scene_with_other_lights_materials_and_lengths(look, tmp_path):
    scene, job = opened(scenes.textured, tmp_path / "other")
    values = presets.match(look, job)
    globe = {k: v for k, v in values.items() if k.startswith("material/Globe Map/")}
    assert globe["material/Globe Map/recolor"] == [1.0]
    tint = globe["material/Globe Map/tint"]
    assert tint[0] < tint[1]
    assert globe["material/Globe Map/roughness"] == [pytest.approx(0.1)]
    camera = job.instances["camera/azimuth"].value[0]
    assert values["light/Key/azimuth"] == [pytest.approx(camera - 90.0)]
    density = job.instances["volume/density"]
    assert values["volume/density"] == [pytest.approx(0.5 * density.reference)]
    assert not any(k.startswith("camera/") for k in values)
    assert bindings.write(scene, values, job.survey.objects, job.survey.pivot) == {}
    after = bindings.read(scene, job.survey.objects, job.survey.pivot)
    for key, value in values.items():
        assert after[key] == pytest.approx(value, rel=1e-4, abs=1e-4), key


def test_lamps_become_suns_of_the_same_brightness(look, tmp_path):
    scene, job = opened(scenes.textured, tmp_path / "other")
    lamp = bpy.data.objects["Key"].data
    lamp.type = "SUN"
    job = scene_io.open_job(scene, tmp_path / "sun", Choice())
    entry = {"power": [9.8696], "size": [0.5]}  # an area light that makes white come out at 1
    values = presets.match(preset.Preset("", {"key": [entry]}, {"key": ["AREA"]}), job)
    assert values["light/Key/strength"] == [pytest.approx(3.14159, rel=1e-3)]
    assert values["light/Key/angle"] == [pytest.approx(28.07, rel=1e-3)]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"version": VERSION + 1}, "newer version"),
        ({"version": "1"}, "newer version"),
        ({"format": "other"}, "not a Vibe Render preset"),
        ({"roles": {"subject": [{"roughness": [float("nan")]}]}}, "finite"),
        ({"roles": {"subject": [{"roughness": [7.0]}]}}, "out of bounds"),
        ({"roles": {"subject": [{"roughness": [0.1, 0.2]}]}}, "needs 1 numbers"),
        ({"roles": {"subject": [{"roughness": "high"}]}}, "needs 1 numbers"),
        ({"roles": {"subject": [{"sparkle": [1.0]}]}}, "unknown parameter"),
        ({"roles": {"moon": [{}]}}, "unknown role"),
        ({"roles": {"film": 3}}, "broken"),
    ],
)
def test_presets_that_are_refused(tmp_path, change, said):
    raw = {"format": "vibe-preset", "version": VERSION, "name": "", "roles": {}, "kinds": {}, **change}
    (tmp_path / "p.json").write_text(json.dumps(raw))
    with pytest.raises(VibeError, match=said):
        presets.load(tmp_path / "p.json")


def test_files_that_are_no_presets(tmp_path):
    with pytest.raises(VibeError, match="cannot be read"):
        presets.load(tmp_path / "missing.json")
    (tmp_path / "p.json").write_text("{")
    with pytest.raises(VibeError, match="not JSON"):
        presets.load(tmp_path / "p.json")
    (tmp_path / "p.json").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(VibeError, match="cannot be read"):
        presets.load(tmp_path / "p.json")
