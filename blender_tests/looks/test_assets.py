# SPDX-License-Identifier: GPL-3.0-or-later
"""A look as assets: written from copies, catalogued, and whole in a fresh file."""

import bpy
import pytest
import vibe_render
from dump import contents, difference
from sample_presets import NOIR
from small_scenes import studio
from vibe_render.export import reading
from vibe_render.looks import assets, thumbnail, transfer
from vibe_render.scene.nodes import owned
from vibe_render.scene.subject import SubjectChoice

from proxy_renderer.schema import VibeError, preset

CATALOGS = ("Materials", "Worlds", "Light Rigs", "Grades", "Fogs")


@pytest.fixture
def exported(scene, tmp_path, monkeypatch):
    """A studio in a foggy noir, exported: (names, the .blend, dumps of the open file before and after)."""
    monkeypatch.setattr(assets, "_BALL_SAMPLES", 2)
    vibe_render.register()
    studio(scene)
    look = preset.Preset("Noir", {**NOIR.roles, "volume": [{"density": [0.5]}]}, NOIR.kinds, NOIR.prompt)
    transfer.apply_preset(scene, look, SubjectChoice())
    picture = tmp_path / "look.png"
    gray = bpy.data.images.new("gray", thumbnail.SIZE, thumbnail.SIZE)
    gray.generated_color, gray.filepath_raw, gray.file_format = (0.5, 0.5, 0.5, 1.0), str(picture), "PNG"
    gray.save()
    bpy.data.images.remove(gray)
    before = contents()
    scene_reading = reading.read_scene(scene, SubjectChoice())
    path = tmp_path / "library" / "noir.blend"
    path.parent.mkdir()
    names = assets.export_assets(
        scene_reading.analysis, "Noir", "black and white", [bpy.data.materials["Body"]], path, picture
    )
    yield names, path, before, contents()
    vibe_render.unregister()


def test_the_open_file_stays_as_it_is(exported):
    _, path, before, after = exported
    assert difference(before, after) == {}
    assert sorted(p.name for p in path.parent.iterdir()) == [assets.CATALOG_FILE, "noir.blend"]


def test_a_fresh_file_takes_every_asset(exported):
    names, path, _, _ = exported
    assert set(names) == {"Noir Body", "Noir World", "Noir Light Rig", "Noir Grade", "Noir Fog"}
    bpy.ops.wm.read_factory_settings(use_empty=True)
    kinds = ("materials", "worlds", "collections", "node_groups")
    with bpy.data.libraries.load(str(path), assets_only=True) as (there, wanted):
        for kind in kinds:
            setattr(wanted, kind, getattr(there, kind))
    blocks = {block.name: block for kind in kinds for block in getattr(wanted, kind)}
    assert set(blocks) == set(names)
    identifiers = {assets.catalog_identifier(f"Vibe Render/{catalog}") for catalog in CATALOGS}
    text = (path.parent / assets.CATALOG_FILE).read_text()
    assert all(identifier in text for identifier in identifiers)
    for block in blocks.values():
        assert block.asset_data.catalog_id in identifiers
        assert block.asset_data.description == "black and white"
        assert owned.MARK not in block
        assert tuple(block.preview.image_size) == (thumbnail.SIZE, thumbnail.SIZE)
        assert max(block.preview.image_pixels_float) > 0.2
    inputs = {item.name: item for item in blocks["Noir Grade"].interface.items_tree if item.in_out == "INPUT"}
    assert inputs["Saturation"].default_value == 0.0
    assert inputs["Contrast"].default_value == pytest.approx(1.4)
    rig = blocks["Noir Light Rig"].objects
    assert {obj.type for obj in rig} == {"LIGHT"}
    assert len(rig) == 4


def test_catalogs_join_those_that_are_there(tmp_path):
    root, folder = tmp_path / "library", tmp_path / "library" / "looks"
    folder.mkdir(parents=True)
    (root / assets.CATALOG_FILE).write_text("VERSION 1\n\n11111111-1111-1111-1111-111111111111:Mine:Mine\n")
    assert assets.catalog_root(folder, []) == root
    assert assets.catalog_root(folder, [str(folder)]) == folder
    for _ in range(2):
        assets.add_catalogs(root, ["Vibe Render/Worlds"])
    lines = (root / assets.CATALOG_FILE).read_text().splitlines()
    assert lines[2].endswith(":Mine:Mine")
    assert lines[3:] == [f"{assets.catalog_identifier('Vibe Render/Worlds')}:Vibe Render/Worlds:Vibe Render-Worlds"]


def test_a_catalog_file_of_the_future_is_left_alone(tmp_path):
    (tmp_path / assets.CATALOG_FILE).write_text("VERSION 7\n")
    with pytest.raises(VibeError, match="another version"):
        assets.add_catalogs(tmp_path, ["Vibe Render/Worlds"])


def test_a_folder_that_cannot_be_written(exported, tmp_path):
    _, _, before, _ = exported
    scene_reading = reading.read_scene(bpy.context.scene, SubjectChoice())
    with pytest.raises(VibeError, match="cannot be written"):
        assets.export_assets(
            scene_reading.analysis, "X", "", [], tmp_path / "missing" / "x.blend", tmp_path / "look.png"
        )
    assert difference(before, contents()) == {}
