# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene that renders black ends before the search, unless the words bring light."""

import bpy
import pytest
from headless_runs import FILES, QUICK, run_headless, save_scene
from small_scenes import world


@pytest.fixture
def dark_scene(tmp_path):
    """A scene whose only light is off."""
    save_scene(tmp_path / "dark.blend")
    bpy.data.lights[0].energy = 0.0
    world(bpy.context.scene).node_tree.nodes["Background"].inputs["Strength"].default_value = 0.0
    bpy.ops.wm.save_mainfile()
    return tmp_path / "dark.blend"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("prompt", "lit"), [("glossy red box", False), ("glossy red box, warm light from the left", True)]
)
def test_darkness_ends_a_vibe_unless_the_words_bring_light(dark_scene, tmp_path, prompt, lit):
    held, out = dark_scene.read_bytes(), tmp_path / "out"
    code, output = run_headless("run", dark_scene, f"--prompt={prompt}", f"--out={out}", *QUICK)
    assert (code == 0) == lit, output
    assert {path.name for path in out.iterdir()} == (FILES if lit else set())
    assert ("The scene renders black: no light" in output) != lit
    assert dark_scene.read_bytes() == held
