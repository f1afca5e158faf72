# SPDX-License-Identifier: GPL-3.0-or-later
"""The looks that come with Vibe Render: whole, small, and of use on a scene that they were not made on."""

import tomllib
from pathlib import Path

import pytest
import vibe_render
from dump import contents, difference
from small_scenes import studio
from vibe_render.looks import library, thumbnail, transfer
from vibe_render.render import bake
from vibe_render.run.session import result
from vibe_render.scene.subject import SubjectChoice

from lab.blender import make_looks

ROWS = tomllib.loads(make_looks.PROMPTS.read_text(encoding="utf-8"))["look"]


@pytest.fixture(autouse=True)
def own(tmp_path, monkeypatch):
    """The artist has no presets of their own."""
    monkeypatch.setattr(library, "preset_folder", lambda: tmp_path)


@pytest.fixture
def addon(scene):
    """The add-on, registered with a studio in the file."""
    vibe_render.register()
    studio(scene)
    yield scene
    vibe_render.unregister()


def test_there_is_one_for_each_prompt_and_no_other():
    shipped = [library.Look(path, path.stem) for path in library.SHIPPED.glob("*.json")]
    assert {look.path for look in shipped} == {library.path_for(library.SHIPPED, row["name"]) for row in ROWS}
    assert len(shipped) == 12


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row["name"])
def test_it_is_whole_and_small(row):
    look = library.find_preset(row["name"])
    assert look.problem == ""
    assert look.shipped
    assert look.prompt == row["prompt"]
    assert look.picture.stat().st_size < 15_000
    assert bake.read_file(look.picture).shape == (thumbnail.SIZE, thumbnail.SIZE, 4)
    assert not {"subject", "surroundings"} & set(look.preset.roles)  # materials are the artist's


def test_each_goes_onto_another_scene_and_off_again(addon):
    before = contents()
    for row in ROWS:
        look = library.find_preset(row["name"])
        assert transfer.apply_preset(addon, look.preset, SubjectChoice()) == []
        assert addon.vibe.changes
    assert result.revert(addon) == []
    assert difference(before, contents()) == {}


def test_names_are_found_on_the_command_line():
    assert library.preset_named("noir").name == "Noir"
    assert library.preset_named(str(Path(library.SHIPPED) / "noir.json")).name == "Noir"
