# SPDX-License-Identifier: GPL-3.0-or-later
"""A library of the artist's beside a shipped one, and a studio to use its looks on."""

import pytest
import vibe_render
from sample_presets import DAY
from small_scenes import studio, wide_picture
from vibe_render.looks import assets, library, thumbnail

from proxy_renderer.schema import preset


@pytest.fixture
def own(tmp_path, monkeypatch):
    """The artist's folder, empty, beside a shipped one with one look."""
    mine, shipped = tmp_path / "mine", tmp_path / "shipped"
    for place in (mine, shipped):
        place.mkdir()
    monkeypatch.setattr(library, "preset_folder", lambda: mine)
    monkeypatch.setattr(library, "SHIPPED", shipped)
    (shipped / "cosy.json").write_text(preset.Preset("Cosy", DAY.roles, {}, "cosy, warm").dumps())
    return mine


@pytest.fixture
def addon(scene, monkeypatch):
    """The add-on, registered with a studio in the file; pictures are quick."""
    monkeypatch.setattr(thumbnail, "_SAMPLES", 2)
    monkeypatch.setattr(assets, "_BALL_SAMPLES", 2)
    vibe_render.register()
    studio(scene)
    yield scene
    vibe_render.unregister()


@pytest.fixture
def wide(tmp_path):
    """A wide picture, red on the left and right, green in the middle."""
    return wide_picture(tmp_path)
