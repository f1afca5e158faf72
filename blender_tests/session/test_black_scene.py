# SPDX-License-Identifier: GPL-3.0-or-later
"""In the panel, too, a scene that renders black ends after the before image, with its cause, and is as it was."""

import bpy
import pytest
from dump import contents, difference
from small_scenes import compositor
from vibe_render.run.state import addon_state
from vibe_render.scene import snapshot
from vibing import fails


def cut_off(scene):
    tree = compositor(scene)
    tree.links.remove(tree.links[-1])


def lights_are_off(scene):
    for light in bpy.data.lights:
        light.energy = 0.0
    scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.0


@pytest.mark.parametrize(
    ("fault", "cause"), [(cut_off, "output of its compositor"), (lights_are_off, "no light reaches")]
)
def test_a_black_scene_ends_with_its_cause(addon, fault, cause):
    fault(addon)
    addon.vibe.prompt = "glossy red cube"
    before = contents()
    assert cause in fails(addon_state.begin(bpy.context))
    assert not snapshot.exists(addon)
    assert not difference(before, contents())
