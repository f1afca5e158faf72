# SPDX-License-Identifier: GPL-3.0-or-later
"""Further sentences on the command line, in processes of their own: what they change, what they keep, and what is refused."""

import json

import bpy
import pytest
from headless_runs import QUICK, run_headless, save_scene
from vibe_render.scene import snapshot

pytestmark = pytest.mark.slow
DARKER = ["--then=darker", "--then=half as strong", "--then=back to the first"]


def report(folder):
    return json.loads((folder / "report.json").read_text("utf-8"))


def exposure(blend):
    bpy.ops.wm.open_mainfile(filepath=str(blend))
    return bpy.context.scene.view_settings.exposure


@pytest.fixture(scope="module")
def shot(tmp_path_factory):
    return save_scene(tmp_path_factory.mktemp("further") / "shot.blend")


@pytest.fixture(scope="module")
def vibed(shot):
    """The folder of a prompt with three further sentences."""
    out = shot.parent / "out"
    code, output = run_headless("run", shot, "--prompt=red box, warm light", *DARKER, f"--out={out}", *QUICK)
    assert code == 0, output
    return out


def test_steps_are_in_the_report_with_a_picture_each(vibed):
    steps = report(vibed)["steps"]
    assert [step["sentence"] for step in steps] == ["red box, warm light", "darker", "half as strong"]
    assert [step["shown"] for step in steps] == [True, False, False]  # back to the first
    assert steps[1]["values"].keys() <= {"film/exposure", "world/strength"}
    assert steps[1]["values"]["film/exposure"][0] < 0.0
    assert {f"step-{n}.png" for n in (1, 2, 3)} <= {path.name for path in vibed.iterdir()}


def test_steps_are_in_the_file_and_go_on_from_there(vibed):
    """What was changed by hand since then is a step of its own."""
    before = exposure(vibed / "vibed.blend")
    bpy.context.scene.objects["Area"].data.energy *= 0.5
    energy = bpy.context.scene.objects["Area"].data.energy
    bpy.ops.wm.save_as_mainfile(filepath=str(vibed.parent / "by_hand.blend"))
    out = vibed.parent / "on"
    code, output = run_headless(
        "run", vibed.parent / "by_hand.blend", "--then=a bit darker", "--then=a bit cooler", f"--out={out}", *QUICK
    )
    assert code == 0, output
    assert exposure(out / "vibed.blend") < before
    assert bpy.context.scene.objects["Area"].data.energy == pytest.approx(energy, rel=0.2)
    assert report(out)["steps"][-1]["sentence"] == "half as strong"  # kept, though it is not shown
    assert "a bit darker" in [step["sentence"] for step in report(out)["steps"]]
    # The last search began with the picture of the step before it, which is not rendered again.
    darker = next(n for n, step in enumerate(report(out)["steps"], 1) if step["sentence"] == "a bit darker")
    assert (out / "before.png").read_bytes() == (out / f"step-{darker}.png").read_bytes()


def test_the_image_before_shows_what_a_sentence_takes_back_first(vibed):
    """The last image does not show a scene whose values a sentence has changed before its search."""
    out = vibed.parent / "returned"
    words = ["--then=a bit darker", "--then=back to the first, but cooler"]
    code, output = run_headless("run", vibed / "vibed.blend", *words, f"--out={out}", *QUICK)
    assert code == 0, output
    darker = next(n for n, step in enumerate(report(out)["steps"], 1) if step["sentence"] == "a bit darker")
    assert (out / "before.png").read_bytes() != (out / f"step-{darker}.png").read_bytes()


def test_revert_takes_all_steps_back(vibed):
    before = exposure(vibed.parent / "shot.blend")
    copy = vibed.parent / "copy.blend"
    copy.write_bytes((vibed / "vibed.blend").read_bytes())
    code, output = run_headless("revert", copy)
    assert code == 0, output
    assert exposure(copy) == before
    assert not [key for key in bpy.context.scene.keys() if key.startswith("vibe_")]  # noqa: SIM118


@pytest.mark.parametrize(
    ("arguments", "problem"),
    [
        (["--then=warmer"], "has no look to go on from"),
        (["--then= "], "The step is empty"),
        (["--prompt=red box", "--then=warmer", "--frames=1,2"], "--then is for one shot"),
        (["--prompt=red box", "--then=back to step 5"], "There is no step 5"),
    ],
)
def test_what_cannot_be_is_one_line(shot, tmp_path, arguments, problem):
    code, output = run_headless("run", shot, *arguments, f"--out={tmp_path}", *QUICK)
    assert code == 2
    line = next(line for line in output.splitlines() if problem in line)
    assert line.count(". ") >= 1  # with what to do
    assert "Traceback" not in output


def test_a_light_is_linked_by_a_further_sentence(shot):
    """A sentence that names no look: nothing is searched."""
    out = shot.parent / "linked"
    words = ["--prompt=warm light", "--then=the area light does not light the floor"]
    code, output = run_headless("run", shot, *words, f"--out={out}", *QUICK)
    assert code == 0, output
    assert "Area light: not on Floor." in output
    assert report(out)["steps"][-1]["values"] == {"light/Area (not on Floor)/linked": [1.0]}
    bpy.ops.wm.open_mainfile(filepath=str(out / "vibed.blend"))
    linking = bpy.data.objects["Area"].light_linking
    assert [o.name for o in linking.receiver_collection.objects] == ["Floor"]
    assert snapshot.revert(bpy.context.scene) == []
    assert linking.receiver_collection is None
    assert not bpy.data.collections
