# SPDX-License-Identifier: GPL-3.0-or-later
"""The preset library, and its looks on and from the open scene."""

import json
import shutil

import bpy
import numpy as np
import pytest
from dump import contents, difference
from results import FOUND, PIVOT, PROMPT, read
from sample_presets import DAY, NOIR
from vibe_render.looks import library, thumbnail, transfer
from vibe_render.render import bake
from vibe_render.run.session import result
from vibe_render.scene import bindings, snapshot
from vibe_render.scene.subject import SubjectChoice

from proxy_renderer.schema import VibeError, messages, preset


def names(words=""):
    return [look.name for look in library.all_looks(words)]


def test_saved_found_renamed_and_deleted(own, wide):
    saved = library.save_preset(NOIR, wide)
    assert saved.preset == NOIR
    assert saved.picture.is_file()
    assert library.save_preset(NOIR).name == "Noir 2"
    assert names() == ["Noir", "Noir 2", "Cosy"]
    assert names("hard LIGHT") == ["Noir", "Noir 2"]
    assert library.find_preset("cosy").shipped
    assert library.find_preset("co").name == "Cosy"
    renamed = library.rename_preset(saved, "Night / ../../ Ünder")
    assert renamed.path.parent == own
    assert renamed.picture.is_file()
    assert not saved.path.exists()
    assert not saved.picture.exists()
    assert renamed.name == "Night / ../../ Ünder"
    assert library.rename_preset(renamed, "night / ../../ ünder").picture.is_file()
    library.delete_preset(library.find_preset("Noir 2"))
    library.delete_preset(library.find_preset("night"))
    assert list(own.iterdir()) == []


def test_shipped_looks_stay(own):
    cosy = library.find_preset("Cosy")
    for act in (library.delete_preset, lambda look: library.rename_preset(look, "Mine")):
        with pytest.raises(VibeError, match="comes with Vibe Render"):
            act(cosy)
    assert names() == ["Cosy"]


def test_export_and_import(own, wide, tmp_path):
    library.export_preset(library.save_preset(NOIR, wide), tmp_path / "shared.json")
    shutil.rmtree(own)
    own.mkdir()
    brought = library.import_preset(tmp_path / "shared.json")
    assert brought.preset == NOIR
    assert brought.picture.is_file()


def test_a_picture_that_is_none_is_not_imported(own, tmp_path):
    (tmp_path / "odd.json").write_text(NOIR.dumps())
    (tmp_path / "odd.jpg").write_text("import os")
    assert not library.import_preset(tmp_path / "odd.json").picture.exists()


def test_a_broken_preset_is_listed_with_its_problem(own):
    (own / "bad.json").write_text(json.dumps({"format": "vibe-preset", "version": 1, "roles": {"moon": []}}))
    (bad,) = [look for look in library.all_looks() if look.problem]
    assert bad.name == "bad"
    assert "unknown role 'moon'" in bad.problem
    with pytest.raises(VibeError, match="unknown role"):
        library.preset_named("bad")
    library.delete_preset(bad)
    assert names() == ["Cosy"]


def test_names_that_are_not_there(own):
    with pytest.raises(VibeError, match="no preset 'sunny'") as refused:
        library.preset_named("sunny")
    assert "Cosy" in refused.value.remedy
    with pytest.raises(VibeError, match="cannot be read"):
        library.preset_named("sunny.json")


def test_a_folder_that_cannot_be_written(own, monkeypatch):
    (own / "file").write_text("")
    monkeypatch.setattr(library, "preset_folder", lambda: own / "file")
    with pytest.raises(VibeError, match="cannot be written"):
        library.save_preset(NOIR)


def test_thumbnails_show_the_middle(wide, tmp_path, scene):
    thumbnail.save_thumbnail(wide, tmp_path / "small.jpg")
    small = bake.read_file(tmp_path / "small.jpg")
    assert small.shape == (thumbnail.SIZE, thumbnail.SIZE, 4)
    assert np.abs(small[5:-5, 5:-5, :3] - (0, 1, 0)).max() < 0.05


def test_looks_are_tried_one_after_the_other_and_reverted(addon):
    before = contents()
    transfer.apply_preset(addon, NOIR, SubjectChoice())
    assert addon.vibe.vibed_preset == "Noir"
    noir = bindings.read(addon, (), PIVOT)
    assert noir["film/saturation"] == (0.0,)
    assert transfer.apply_preset(addon, DAY, SubjectChoice()) == []
    day = bindings.read(addon, (), PIVOT)
    assert day["film/saturation"] == (1.0,)
    assert day["film/exposure"] == (1.0,)
    assert result.revert(addon) == []
    assert difference(before, contents()) == {}


def test_a_look_on_top_of_a_vibe_leads_back_to_it(addon):
    result.apply(addon, PROMPT, messages.Result(FOUND, {}, ""), [bpy.data.objects["Subject"]], PIVOT)
    vibed = read(addon)
    transfer.apply_preset(addon, NOIR, SubjectChoice())
    assert read(addon)["film/contrast"] == [pytest.approx(1.4)]
    transfer.apply_preset(addon, DAY, SubjectChoice())
    assert read(addon) == {key: pytest.approx(value, abs=1e-4) for key, value in vibed.items()}


def test_strength_dims_a_light_that_the_look_brought(addon):
    bpy.data.objects.remove(bpy.data.objects["Sun"])  # the only light behind the subject, if any is
    for light in [o for o in addon.objects if o.type == "LIGHT" and o.location.y > 0]:
        bpy.data.objects.remove(light)
    transfer.apply_preset(addon, NOIR, SubjectChoice())
    rim = bpy.data.objects["Vibe Rim"].data
    full = rim.energy
    assert full > 0.0
    addon.vibe.strength = 0.5
    assert 0.0 < rim.energy < full
    addon.vibe.show_original = True
    assert rim.energy == 0.0


def test_what_fails_leaves_the_scene_with_the_look_before(addon):
    transfer.apply_preset(addon, NOIR, SubjectChoice())
    before = contents()
    nothing = preset.Preset("Nothing", {"fill": [{"power": [0.06]}]}, {"fill": ["AREA"]})
    for light in [o for o in addon.objects if o.type == "LIGHT"]:
        light.hide_render = light.name != "Area"
    before = contents()
    with pytest.raises(VibeError, match="Nothing in this scene"):
        transfer.apply_preset(addon, nothing, SubjectChoice())
    assert difference(before, contents()) == {}
    assert addon.vibe.vibed_preset == "Noir"


def test_a_look_is_captured_as_it_is_now(addon, tmp_path):
    with pytest.raises(VibeError, match="no look to save"):
        transfer.capture_preset(addon, SubjectChoice(), "None")
    transfer.apply_preset(addon, NOIR, SubjectChoice())
    taken = transfer.capture_preset(addon, SubjectChoice(), "Mine")
    assert taken.prompt == NOIR.prompt
    assert transfer.preset.loads(taken.dumps()) == taken
    assert taken.roles["film"] == [{n: [pytest.approx(v)] for n, (v,) in NOIR.roles["film"][0].items()}]
    assert taken.roles["subject"][0]["roughness"] == [pytest.approx(0.15)]
    assert taken.kinds["key"] == ["SUN"]  # as bright as the lamp of the preset
    assert taken.roles["key"][0]["strength"] == [pytest.approx(60.0 / np.pi, rel=0.02)]
    addon.vibe.strength = 0.0
    flat = transfer.capture_preset(addon, SubjectChoice(), "Flat")
    assert flat.roles["film"][0]["saturation"] == [pytest.approx(1.0)]
    assert snapshot.exists(addon)
    with thumbnail.rendered_thumbnail(addon) as picture:
        assert bake.read_file(picture).shape == (thumbnail.SIZE, thumbnail.SIZE, 4)
