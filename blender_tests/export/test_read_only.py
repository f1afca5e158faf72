# SPDX-License-Identifier: GPL-3.0-or-later
"""A .blend that cannot be written: it is vibed all the same, the file stays, and nothing of the vibe is lost."""

import bpy
import pytest
from dump import contents, difference
from headless_runs import FILES, QUICK, run_headless, save_scene
from small_disk import small_disk
from vibe_render.scene import snapshot


@pytest.fixture
def disk(tmp_path):
    with small_disk(tmp_path / "disk", 4000) as made:
        yield made


@pytest.mark.slow
def test_from_the_panel(addon, disk, tmp_path):
    shot = disk.folder / "shot.blend"
    settings = addon.vibe
    settings.rounds, settings.steps, settings.anchor = 1, 2, True
    bpy.ops.wm.save_as_mainfile(filepath=str(shot))
    held = shot.read_bytes()
    disk.protect()
    bpy.ops.wm.open_mainfile(filepath=str(shot))
    before = contents()
    assert bpy.ops.vibe.run() == {"FINISHED"}
    changes = {change.name: change.values() for change in bpy.context.scene.vibe.changes}
    assert changes
    with pytest.raises(RuntimeError, match="not writable"):  # Blender's own words
        bpy.ops.wm.save_mainfile()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "mine.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "mine.blend"))
    scene = bpy.context.scene
    assert {change.name: change.values() for change in scene.vibe.changes} == changes
    assert snapshot.exists(scene)
    assert bpy.ops.vibe.revert() == {"FINISHED"}
    assert difference(before, contents()) == {}
    assert shot.read_bytes() == held
    assert disk.files() == {"shot.blend"}


@pytest.mark.slow
def test_from_the_command_line(disk, tmp_path):
    shot = save_scene(disk.folder / "shot.blend")
    held = shot.read_bytes()
    code, printed = run_headless("run", shot, "--prompt=red box", f"--out={disk.folder / 'out'}", "--no-anchor", *QUICK)
    assert code == 0, printed
    vibed = (disk.folder / "out" / "vibed.blend").read_bytes()
    disk.protect()
    for arguments, words in (
        (("run", shot, "--prompt=red box", f"--out={disk.folder / 'more'}"), "Choose another with --out."),
        (("revert", disk.folder / "out" / "vibed.blend"), "vibed.blend is read-only. Make it writable"),
    ):
        code, printed = run_headless(*arguments, *QUICK)
        assert code == 2, printed
        assert words in printed.splitlines()[-1]
        assert "Traceback" not in printed
    code, printed = run_headless("run", shot, "--prompt=red box", f"--out={tmp_path / 'out'}", "--no-anchor", *QUICK)
    assert code == 0, printed
    assert {path.name for path in (tmp_path / "out").iterdir()} == FILES
    assert shot.read_bytes() == held
    assert (disk.folder / "out" / "vibed.blend").read_bytes() == vibed
    assert disk.files() == {"shot.blend", *(f"out/{name}" for name in FILES)}
