# SPDX-License-Identifier: GPL-3.0-or-later
"""The preset panel's operators, without a window."""

import bpy
import pytest
from dump import contents, difference
from sample_presets import DAY, NOIR
from vibe_render.looks import library, thumbnail, transfer
from vibe_render.ui import drawing, presets

from proxy_renderer.schema import preset


@pytest.fixture
def held(addon, own):
    """What the panel holds, with a preset of the artist's chosen in a studio."""
    saved = library.save_preset(NOIR)
    bpy.ops.vibe.preset_choose(path=str(saved.path))
    return bpy.context.window_manager.vibe_presets


def names():
    return [look.name for look in library.all_looks()]


def test_applied_saved_and_reverted(held):
    before = contents()
    assert not bpy.ops.vibe.preset_save.poll()
    assert bpy.ops.vibe.preset_apply() == {"FINISHED"}
    assert bpy.context.scene.vibe.vibed_preset == "Noir"
    assert bpy.ops.vibe.preset_save(name="Mine") == {"FINISHED"}
    mine = library.preset_at(held.chosen)
    assert mine.name == "Mine"
    assert mine.picture.is_file()
    assert mine.preset.roles["film"][0]["contrast"] == [pytest.approx(1.4)]
    assert drawing.look_icon(mine) != drawing.look_icon(library.find_preset("Noir"))
    assert bpy.ops.vibe.revert() == {"FINISHED"}
    assert difference(before, contents()) == {}


def test_what_did_not_fit_is_kept_for_the_panel(held):
    look = preset.Preset("Many", {**DAY.roles, "subject": [{"roughness": [0.1]}] * 3})
    assert bpy.ops.vibe.preset_apply(path=str(library.save_preset(look).path)) == {"FINISHED"}
    assert held.rest.splitlines() == ["Subject material: 2 more than this scene has"]


def test_renamed_exported_imported_and_deleted(held, tmp_path):
    assert bpy.ops.vibe.preset_rename(name="Black and White") == {"FINISHED"}
    assert bpy.ops.vibe.preset_export(filepath=str(tmp_path / "bw.json")) == {"FINISHED"}
    assert transfer.load_preset(tmp_path / "bw.json").name == "Black and White"
    assert bpy.ops.vibe.preset_delete() == {"FINISHED"}
    assert names() == ["Cosy"]
    assert held.chosen == ""
    assert not bpy.ops.vibe.preset_delete.poll()
    assert bpy.ops.vibe.preset_import(filepath=str(tmp_path / "bw.json")) == {"FINISHED"}
    assert names() == ["Black and White", "Cosy"]


def test_one_bad_file_does_not_keep_others_out(held, tmp_path, capfd):
    (tmp_path / "a.json").write_text("nonsense")
    (tmp_path / "b.json").write_text(DAY.dumps())
    (tmp_path / "c.json").write_text("[]")
    a, b, c = ({"name": f"{name}.json"} for name in "abc")
    assert bpy.ops.vibe.preset_import(files=[a, b, c], directory=str(tmp_path)) == {"FINISHED"}
    assert set(names()) == {"Cosy", "Day", "Noir"}
    assert held.chosen == str(library.find_preset("Day").path)
    output = capfd.readouterr().out
    assert "Warning: Day is among your presets. Left out: a.json (" in output
    assert "; c.json (" in output
    with pytest.raises(RuntimeError, match=r"a\.json.*; c\.json"):
        bpy.ops.vibe.preset_import(files=[a, c], directory=str(tmp_path))


def test_shipped_presets_are_applied_and_not_deleted(held):
    bpy.ops.vibe.preset_choose(path=str(library.find_preset("Cosy").path))
    assert not bpy.ops.vibe.preset_delete.poll()
    assert not bpy.ops.vibe.preset_rename.poll()
    assert bpy.ops.vibe.preset_apply() == {"FINISHED"}


@pytest.mark.parametrize(
    "act",
    [
        lambda path: bpy.ops.vibe.preset_apply(path=path),
        lambda path: bpy.ops.vibe.preset_export(path=path, filepath=path + "2"),
        lambda path: bpy.ops.vibe.preset_import(filepath=path),
    ],
)
def test_nonsense_is_one_clear_line_and_changes_nothing(held, own, act):
    (own / "bad.json").write_text('{"format": "vibe-preset", "version": 1, "roles": {"film": [{"a": 1}]}}')
    before, there = contents(), sorted(own.iterdir())
    with pytest.raises(RuntimeError, match="unknown parameter film/'a'"):
        act(str(own / "bad.json"))
    assert difference(before, contents()) == {}
    assert sorted(own.iterdir()) == there


def test_what_is_no_file_or_a_name_of_ours(held, tmp_path):
    with pytest.raises(RuntimeError, match="No file was chosen"):
        bpy.ops.vibe.preset_import(filepath=str(tmp_path), directory=str(tmp_path))
    assert bpy.ops.vibe.preset_rename(name="Cosy") == {"FINISHED"}
    assert library.preset_at(held.chosen).name == "Cosy 2"


def test_assets_and_lut_of_the_look(held, tmp_path):
    assert not bpy.ops.vibe.export_lut.poll()
    assert not bpy.ops.vibe.export_assets.poll()
    bpy.ops.vibe.preset_apply()
    with thumbnail.rendered_thumbnail(bpy.context.scene):  # Blender 4.5 orders passes anew at a render
        pass
    before = contents()
    assert bpy.ops.vibe.export_lut(filepath=str(tmp_path / "noir.cube")) == {"FINISHED"}
    assert bpy.ops.vibe.export_assets(filepath=str(tmp_path / "noir.blend")) == {"FINISHED"}
    assert difference(before, contents()) == {}
    white = (tmp_path / "noir.cube").read_text().splitlines()[-1].split()
    assert len(set(white)) == 1  # no saturation
    with bpy.data.libraries.load(str(tmp_path / "noir.blend"), assets_only=True) as (there, _):
        assert there.materials == ["Noir Body"]
        assert there.node_groups == ["Noir Grade"]


def test_panel_finds_what_it_draws(held):
    """What is drawn without a window: nothing; but its icons and columns can be asked for."""
    assert all(drawing.look_icon(look) for look in library.all_looks())
    assert presets.PresetsPanel.poll(bpy.context)
