# SPDX-License-Identifier: GPL-3.0-or-later
"""Cameras, frames and .blends that share a look, with the real engine: the look holds, what is animated stays."""

import json
import math

import bpy
import numpy as np
import pytest
from headless_runs import run_headless
from PIL import Image
from small_scenes import camera, cube, light, principled, shader, world

QUICK = ["--rounds=1", "--steps=4", "--size=64", "--samples=4"]
COLOR = "material/Body/base_color"


def save_sequence(path, red=0.8, strength=0.5):
    """A box that turns before two cameras, while the lamp fades and a marker cuts to the other camera."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    box, floor = cube(scene, "Box", (0.0, 0.0, 0.5)), cube(scene, "Floor", (0.0, 0.0, -5.0), 10.0)
    body = principled("Body", box)
    shader(body).inputs["Base Color"].default_value = (red, 0.1, 0.1, 1.0)
    principled("Ground", floor)
    lamp = light(scene, "POINT")
    lamp.data.energy = 300.0
    lamp.data.keyframe_insert("energy", frame=1)
    lamp.data.energy = 60.0
    lamp.data.keyframe_insert("energy", frame=20)
    box.keyframe_insert("location", frame=1)
    box.location.x = 0.7
    box.keyframe_insert("location", frame=20)
    world(scene).node_tree.nodes["Background"].inputs["Strength"].default_value = strength
    side = camera(scene, (6.0, 0.0, 1.0))
    side.name, side.rotation_euler = "Side", (math.radians(88.0), 0.0, math.radians(90.0))
    front = camera(scene)
    front.name = "Front"
    scene.timeline_markers.new("cut", frame=10).camera = side
    scene.render.resolution_x, scene.render.resolution_y = 96, 64
    scene.cycles.samples = 4
    scene.frame_set(1)
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return path


def opened(path):
    """The color of the box and of the lamp, and how the scene of a .blend is framed."""
    bpy.ops.wm.open_mainfile(filepath=str(path))
    scene = bpy.context.scene
    socket = shader(bpy.data.materials["Body"]).inputs["Base Color"]
    return {
        "color": tuple(socket.default_value)[:3],
        "lamp": tuple(bpy.data.lights["Point"].color),
        "framed": (scene.camera.name, scene.frame_current),
        "marker": scene.timeline_markers["cut"].camera.name,
        "exposure": scene.view_settings.exposure,
    }


def run(out, *arguments):
    code, output = run_headless("run", *arguments, "--prompt=glossy teal box, dim warm light", f"--out={out}", *QUICK)
    assert code == 0, output
    return json.loads((out / "report.json").read_text()), output


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("shots")
    save_sequence(folder / "shot.blend")
    save_sequence(folder / "other.blend", red=0.3, strength=1.0)
    return folder


@pytest.mark.slow
def test_two_cameras_at_two_frames_share_a_look(folder):
    out = folder / "out"
    report, _ = run(out, folder / "shot.blend", "--cameras=Front,Side", "--frames=1,20")
    names = [f"{camera} · frame {frame}" for camera in ("Front", "Side") for frame in (1, 20)]
    assert [shot["name"] for shot in report["shots"]] == names
    for number, shot in enumerate(report["shots"], start=1):
        assert shot["after"] == (f"after-{number}.png" if number > 1 else "after.png")
        assert shot["similarity"]["after"] != report["shots"][number - 2]["similarity"]["after"]
        with Image.open(out / shot["after"]) as picture:
            assert picture.size == (64, 43)
    assert {p.name for p in out.glob("*.blend")} == {"vibed.blend"}
    with Image.open(out / "compare.png") as sheet:  # a row for each shot
        assert sheet.height > sheet.width / 2
    red, green, blue = report["parameters"][COLOR]["after"]
    assert red < min(green, blue)
    power = report["parameters"]["light/Point/power"]
    assert power["before"] == power["after"]
    assert "keyframe" in power["reason"] or "animat" in power["reason"]
    assert len(report["anchored"]["pictures"]) >= 8  # before and after the round, for each shot
    before, after = opened(folder / "shot.blend"), opened(out / "vibed.blend")
    assert after["color"] == pytest.approx((red, green, blue), abs=1e-5)
    assert after["framed"] == before["framed"]
    assert after["marker"] == "Side"
    assert [k for k in (1, 20) if energy_at(k) == pytest.approx({1: 300.0, 20: 60.0}[k])] == [1, 20]


def energy_at(frame):
    bpy.context.scene.frame_set(frame)
    return bpy.data.lights["Point"].energy


@pytest.mark.slow
def test_two_blends_get_the_same_values_and_a_grade_each(folder):
    out = folder / "both"
    report, _ = run(out, folder / "shot.blend", folder / "other.blend", "--grade-each")
    assert [shot["name"] for shot in report["shots"]] == ["shot", "other"]
    assert "film/shot 2/exposure" in report["parameters"]
    assert {p.name for p in out.glob("*.blend")} == {"vibed.blend", "vibed-2.blend"}
    first, second = (opened(out / name) for name in ("vibed.blend", "vibed-2.blend"))
    assert first["color"] == second["color"] == pytest.approx(report["parameters"][COLOR]["after"], abs=1e-5)
    assert first["lamp"] == second["lamp"]
    code, output = run_headless("revert", out / "vibed-2.blend")
    assert code == 0, output
    assert opened(out / "vibed-2.blend")["color"][0] == pytest.approx(0.3)


def test_final_frames_are_seen_through_the_shots_camera(folder):
    """Also at a frame where a marker cuts to another one."""

    def frame(name, *camera):
        out = folder / "frames" / name
        code, output = run_headless("frames", folder / "shot.blend", "--frames=12", *camera, f"--out={out}")
        assert code == 0, output
        with Image.open(out / "0012.png") as picture:
            return np.asarray(picture.convert("RGB"), float)

    own, side, front = frame("own"), frame("side", "--cameras=Side"), frame("front", "--cameras=Front")
    assert np.abs(own - side).mean() < 1.0
    assert np.abs(front - side).mean() > 5.0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--cameras=Front,Top"], "There is no camera 'Top' in shot.blend. There are: Front, Side."),
        (["--frames=1,x"], "'x' names no frames."),
    ],
)
def test_mistakes(folder, tmp_path, arguments, message):
    code, output = run_headless("run", folder / "shot.blend", "--prompt=noir", f"--out={tmp_path}", *arguments)
    assert code == 2
    assert message in output
    assert "Traceback" not in output
