# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene that is set up for EEVEE: it stays so, its EEVEE renders show the vibe, and no setting of Cycles is left."""

import subprocess
import sys

import bpy
import numpy as np
import pytest
from dump import contents, difference
from vibe_render.core import compat
from vibe_render.render import bake

RENDER = """
import sys, bpy
bpy.ops.wm.open_mainfile(filepath=sys.argv[1])
bpy.context.scene.render.filepath = sys.argv[2]
bpy.ops.render.render(write_still=True)
"""
SETTINGS = tuple(f"scenes[Scene].{name}" for name in ("render", "cycles", "eevee", "view_layers"))


@pytest.fixture
def studio(addon):
    """The studio, for EEVEE and small."""
    addon.render.engine = compat.EEVEE
    addon.eevee.taa_render_samples = 4
    addon.render.resolution_x, addon.render.resolution_y = 48, 48
    addon.render.image_settings.file_format = "PNG"
    settings = addon.vibe
    settings.prompt = "glossy red cube, dark, thick fog, vignette"
    settings.rounds, settings.steps, settings.anchor = 1, 2, True
    return addon


def rendered(folder, name):
    """What EEVEE makes of the scene as it is, (H, W, 3); None where it cannot render at all."""
    blend, picture = folder / f"{name}.blend", folder / f"{name}.png"
    bpy.ops.wm.save_as_mainfile(filepath=str(blend), copy=True)
    command = [sys.executable, "-c", RENDER, str(blend), str(picture)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=400)
    if done.returncode or not picture.is_file():
        return None
    image = bpy.data.images.load(str(picture))
    try:
        return bake.image_pixels(image)
    finally:
        bpy.data.images.remove(image)


def settings_of(found):
    """What the scene says of rendering, but for what a grade and fog need, and for the list of objects."""
    theirs = {k: v for k, v in found.items() if k.startswith(SETTINGS) and "objects[" not in k}
    return {k: v for k, v in theirs.items() if not k.endswith((".use_compositing", ".volume_biased"))}


@pytest.mark.slow
def test_a_vibe_leaves_eevee_at_work(studio, tmp_path):
    first, before = rendered(tmp_path, "before"), contents()
    assert bpy.ops.vibe.run() == {"FINISHED"}
    assert studio.render.engine == compat.EEVEE
    assert difference(settings_of(before), settings_of(contents())) == {}
    trees = [*bpy.data.node_groups, *(m.node_tree for m in bpy.data.materials), studio.world.node_tree]
    for tree in filter(None, trees):
        assert not [node for node in tree.nodes if node.bl_idname == "NodeUndefined"]
        assert all(link.is_valid for link in tree.links)
    if first is not None:  # there is a graphics card, or something that stands for one
        second = rendered(tmp_path, "after")
        assert second is not None
        assert np.isfinite(second).all()
        assert second.std() > 0.005  # neither black nor fog all over
        middle = second[16:32, 16:32].mean((0, 1))
        assert middle[0] > 1.2 * max(middle[1], middle[2])  # through thick fog
        assert second.mean() < first.mean()
    assert bpy.ops.vibe.revert() == {"FINISHED"}
    assert difference(before, contents()) == {}
