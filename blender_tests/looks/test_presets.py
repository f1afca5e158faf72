# SPDX-License-Identifier: GPL-3.0-or-later
"""Looks carried from one scene to another, and preset files that must be refused."""

import json
import sys
from contextlib import contextmanager

import bpy
import pytest
import scenes
from vibe_render.export import reading
from vibe_render.looks import transfer
from vibe_render.scene import bindings, scene_context
from vibe_render.scene.subject import SubjectChoice

from proxy_renderer.schema import VERSION, VibeError, preset


def opened(build, folder):
    scene = build()
    return scene, reading.export_scene(scene, folder, SubjectChoice())


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
    return transfer.extract_look("a test", job, values)


def test_a_preset_survives_its_file(look, tmp_path):
    (tmp_path / "preset.json").write_text(look.dumps(), encoding="utf-8")
    assert transfer.load_preset(tmp_path / "preset.json") == look
    assert look.roles["volume"] == [{"density": [pytest.approx(0.5)]}]
    assert look.roles["key"][0]["azimuth"] == [pytest.approx(-90.0)]
    assert "camera" not in look.roles


def test_it_fits_a_scene_with_other_lights_materials_and_lengths(look, tmp_path):
    scene, job = opened(scenes.textured, tmp_path / "other")
    values = transfer.fit_look(look, job).values
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
    assert bindings.write(scene, values, job.analysis.objects, job.analysis.pivot) == {}
    after = bindings.read(scene, job.analysis.objects, job.analysis.pivot)
    for key, value in values.items():
        assert after[key] == pytest.approx(value, rel=1e-4, abs=1e-4), key


def test_lamps_become_suns_of_the_same_brightness(look, tmp_path):
    scene, job = opened(scenes.textured, tmp_path / "other")
    lamp = bpy.data.objects["Key"].data
    lamp.type = "SUN"
    job = reading.export_scene(scene, tmp_path / "sun", SubjectChoice())
    entry = {"power": [9.8696], "size": [0.5]}  # an area light that makes white come out at 1
    values = transfer.fit_look(preset.Preset("", {"key": [entry]}, {"key": ["AREA"]}), job).values
    assert values["light/Key/strength"] == [pytest.approx(3.14159, rel=1e-3)]
    assert values["light/Key/angle"] == [pytest.approx(28.07, rel=1e-3)]


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        ({"version": VERSION + 1}, "newer version"),
        ({"version": "1"}, "which version"),
        ({"version": True}, "which version"),
        ({"version": 10**400}, "newer version"),
        ({"name": 3}, "name is not a short text"),
        ({"prompt": ["a"]}, "prompt is not a short text"),
        ({"run": "import os; os.remove('/')"}, "unknown field 'run'"),
        ({"roles": {"/etc/passwd": [{}]}}, "unknown role"),
        ({"roles": {"world": [{"https://example.org/a.hdr": [1.0]}]}}, "unknown parameter"),
        ({"roles": {"key": [{}]}, "kinds": {"key": ["LASER"]}}, "unknown type of light 'LASER'"),
        ({"roles": {"key": [{}]}, "kinds": {"key": [["AREA"]]}}, "unknown type of light"),
        ({"roles": {"key": [{}]}, "kinds": {"key": ["AREA", "SUN"]}}, "do not fit its lights"),
        ({"roles": {"key": [{}]}, "kinds": {"key": "AREA"}}, "do not fit its lights"),
        ({"kinds": {"film": []}}, "do not fit its lights"),
        ({"kinds": 1}, "kinds of lights are broken"),
        ({"roles": {"subject": [{"roughness": [10**400]}]}}, "out of bounds"),
        ({"roles": {"subject": [{"roughness": ["0.1"]}]}}, "needs 1 numbers"),
        ({"roles": {"subject": [{"roughness": [[0.1]]}]}}, "needs 1 numbers"),
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
def test_presets_that_are_refused(tmp_path, change, complaint):
    raw = {"format": "vibe-preset", "version": VERSION, "name": "", "roles": {}, "kinds": {}, **change}
    (tmp_path / "p.json").write_text(json.dumps(raw))
    with pytest.raises(VibeError, match=complaint):
        transfer.load_preset(tmp_path / "p.json")


@contextmanager
def watched():
    """What Python opens, runs or reaches meanwhile, by its own audit events."""
    events, on = [], [True]
    kinds = ("open", "exec", "compile", "import", "socket", "subprocess", "os.system", "urllib", "ctypes")

    def hear(event, given):
        if on and event.startswith(kinds):
            events.append((event, str(given[0])))

    sys.addaudithook(hear)  # there for good, and silent afterwards
    try:
        yield events
    finally:
        on.clear()


def test_the_watch_sees_what_is_opened_and_run(tmp_path):
    with watched() as events:
        exec("1")
        (tmp_path / "x").write_text("")
    assert [event for event, _ in events] == ["compile", "exec", "open"]


def test_a_prompt_may_hold_anything_and_nothing_of_it_is_done(tmp_path):
    """A path, a URL and Python in texts stay texts; control characters go, for panels show them."""
    prompt = "__import__('os').system('touch x')\n\x1b[31m https://example.org/x ../../etc/passwd"
    raw = {"format": "vibe-preset", "version": VERSION, "name": prompt, "prompt": prompt, "roles": {}}
    (tmp_path / "p.json").write_text(json.dumps(raw))
    with watched() as events:
        look = transfer.load_preset(tmp_path / "p.json")
    assert events == [("open", str(tmp_path / "p.json"))]
    assert look.prompt == prompt.replace("\n\x1b", " ")
    assert len(look.name) <= preset.LONGEST_NAME
    assert [path.name for path in tmp_path.iterdir()] == ["p.json"]


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("[" * 400_000, "nested too deeply"),
        ('{"a":' * 100_000, "nested too deeply"),
        ("1" * 5000, "not JSON"),
        ("null", "not a Vibe Render preset"),
        (" " * (preset.LARGEST + 1), "too large"),
    ],
)
def test_hostile_files_are_one_clear_line(tmp_path, text, complaint):
    (tmp_path / "p.json").write_text(text)
    with pytest.raises(VibeError, match=complaint) as refused:
        transfer.load_preset(tmp_path / "p.json")
    assert refused.value.remedy
    assert len(str(refused.value)) < 300


def test_what_does_not_fit_is_listed(look, tmp_path):
    """Lamps in surplus, a locked value; a rim that is missing comes from us, and a dim one is not missed."""
    scene, _ = opened(scenes.textured, tmp_path / "other")
    driver = bpy.data.materials["Stand"].node_tree.nodes["Principled BSDF"].inputs["Roughness"]
    driver.keyframe_insert("default_value", frame=1)
    scene_reading = reading.read_scene(scene, SubjectChoice())
    subjects = len(transfer.role_owners(scene_reading, "subject"))
    wanted = preset.Preset(
        "",
        {
            "subject": [{"roughness": [0.2]}] * (subjects + 2),
            "surroundings": [{"roughness": [0.3]}],
            "key": [{"power": [20.0]}, {"power": [10.0]}],
            "rim": [{"power": [20.0], "color": [1.0, 0.2, 0.1]}],
            "fill": [{"power": [0.05]}],
        },
        {"key": ["AREA", "POINT"], "rim": ["AREA"], "fill": ["AREA"]},
    )
    fitted = transfer.fit_look(wanted, scene_reading)
    rest = "\n".join(fitted.rest)
    assert "Subject material: 2 more than this scene has" in rest
    assert "Key light: 1 more than this scene has" in rest
    assert "Stand: Roughness: " in rest
    assert "fill" not in rest.casefold()
    assert fitted.values["light/Vibe Rim/color"] == [1.0, 0.2, 0.1]
    assert bindings.write(scene, fitted.values, scene_reading.analysis.objects, scene_reading.analysis.pivot) == {}
    rim = bpy.data.objects["Vibe Rim"]
    low, high = scene_context.bounds(scene, scene_reading.analysis.objects)
    distance = (rim.matrix_world.translation - (low + high) / 2.0).length
    assert rim.data.energy == pytest.approx(20.0 * distance**2, rel=1e-3)


def test_files_that_are_no_presets(tmp_path):
    with pytest.raises(VibeError, match="cannot be read"):
        transfer.load_preset(tmp_path / "missing.json")
    (tmp_path / "p.json").write_text("{")
    with pytest.raises(VibeError, match="not JSON"):
        transfer.load_preset(tmp_path / "p.json")
    (tmp_path / "p.json").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(VibeError, match="cannot be read"):
        transfer.load_preset(tmp_path / "p.json")
