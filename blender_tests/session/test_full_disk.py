# SPDX-License-Identifier: GPL-3.0-or-later
"""A disk that is really full: one clear line with the remedy, nothing cut off stays, and it works when there is room."""

import re
from dataclasses import replace

import bpy
import pytest
from dump import contents, difference
from headless_runs import QUICK, run_headless, run_with_model, save_scene
from model_server import sensible, serving
from sample_presets import NOIR
from small_disk import small_disk
from small_scenes import studio, wide_picture
from vibe_render.looks import assets, library, lut
from vibe_render.render import final_render
from vibe_render.run import preview, session
from vibe_render.run.state import addon_state
from vibe_render.ui import words
from vibing import advance, fails

from proxy_renderer.schema import VibeError

NO_ROOM = "There is no room left on the disk, in "


@pytest.fixture
def disk(tmp_path):
    with small_disk(tmp_path / "disk", 400) as disk:
        yield disk


@pytest.mark.parametrize("left", [0, 1])
def test_presets(disk, monkeypatch, tmp_path, left):
    """With one page left, the preset has room, and its picture does not."""
    mine, wide = replace(NOIR, name="Mine"), wide_picture(tmp_path)
    monkeypatch.setattr(library, "preset_folder", lambda: disk.folder)
    library.save_preset(mine, wide)
    there = disk.files()
    disk.fill(left)
    for act in (
        lambda: library.save_preset(mine, wide),
        lambda: library.export_preset(library.find_preset("Mine"), disk.folder / "other.json"),
        lambda: assets.add_catalogs(disk.folder, ["Vibe Render/Materials"]),
        lambda: lut.write_cube(disk.folder / "noir.cube", "Noir", {}),
    ):
        with pytest.raises(VibeError, match=f"{re.escape(NO_ROOM)}{disk.folder}. Make room"):
            act()
        assert disk.files() == there
    assert library.find_preset("Mine").preset == mine
    disk.make_room()
    assert library.save_preset(mine, wide).picture.is_file()


def test_pictures_of_blender(scene, disk):
    """Blender itself says nothing of a picture that it could not write."""
    studio(scene)
    disk.fill()
    with pytest.raises(VibeError, match=NO_ROOM):
        final_render.render_picture(scene, disk.folder / "after.png", 32, 1)
    assert disk.files() == set()
    disk.make_room()
    final_render.render_picture(scene, disk.folder / "after.png", 32, 1)
    assert disk.files() == {"after.png"}


def test_what_is_only_convenient_is_left_out(scene, disk, tmp_path, monkeypatch):
    monkeypatch.setattr(words, "own_folder", lambda path: disk.folder)
    words.remember("noir")
    disk.fill()
    words.remember("golden hour")
    (tmp_path / "picture.png").write_bytes(b"own" * 9000)
    picture = preview.store_before(disk.folder / "kept.png", tmp_path / "picture.png", True)
    assert picture == tmp_path / "picture.png"
    assert disk.files() == {"prompts.json"}
    assert list(words.history()) == ["noir"]


STAGES = {
    "reading": lambda running: running.stage == session.READING,
    "asked": lambda running: running.asked,
    "waiting for an anchor": lambda running: running.stage == session.ANCHORING,
}


@pytest.mark.slow
def test_a_vibe_without_room_for_its_files_and_then_one_with_room(addon, disk):
    before, settings = contents(), addon.vibe
    bpy.context.preferences.filepaths.temporary_directory = str(disk.folder)
    settings.anchor, settings.rounds, settings.steps = True, 1, 2
    for until in STAGES.values():
        running = advance(until)
        disk.fill()
        assert NO_ROOM + str(disk.folder) in fails(running)
        assert "Make room" in addon_state.failure.remedy
        assert difference(before, contents()) == {}
        assert {name for name in disk.files() if "/vibe-before-" not in name} == set()
        disk.make_room()
    assert bpy.ops.vibe.run() == {"FINISHED"}
    assert settings.changes
    assert bpy.ops.vibe.revert() == {"FINISHED"}
    assert difference(before, contents()) == {}


@pytest.mark.slow
def test_a_run_without_room_for_its_results(disk, tmp_path):
    shot, out = save_scene(tmp_path / "shot.blend"), disk.folder / "out"
    disk.fill(left=8)
    code, output = run_headless("run", shot, "--prompt=blue box", f"--out={out}", "--no-anchor", *QUICK)
    assert code == 2, output
    blender4 = "vibed.blend cannot be written: No such file"  # what it says of a full disk
    assert f"vibe: {NO_ROOM}{out}. " in output or (blender4 in output and bpy.app.version < (5, 0))
    assert "Make room there" in output
    assert "Traceback" not in output
    assert disk.files() == set()


@pytest.mark.slow
def test_a_model_whose_answers_cannot_be_kept(disk, tmp_path, monkeypatch):
    """They are paid for again next time; that is all."""
    monkeypatch.setenv("VIBE_CACHE", str(disk.folder))
    disk.fill()
    with serving(sensible) as model:
        report, _ = run_with_model(tmp_path, model)
    assert disk.files() == set()
    assert (report["vlm"]["calls"], report["vlm"]["failures"]) == (1, [])
