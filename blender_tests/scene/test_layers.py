# SPDX-License-Identifier: GPL-3.0-or-later
"""Several view layers: the first that is rendered is what is seen, whichever is looked at."""

import bpy
import pytest
import small_scenes as scenes
import vibe_render
from vibe_render.export import reading
from vibe_render.render import anchors
from vibe_render.run.session import result
from vibe_render.scene import snapshot
from vibe_render.scene.subject import SubjectChoice

from proxy_renderer.schema import messages


@pytest.fixture
def layered(scene):
    """A studio in two layers; the first is not rendered and has neither the subject nor the key light."""
    scenes.studio(scene)
    apart = bpy.data.collections.new("Apart")
    scene.collection.children.link(apart)
    for name in ("Subject", "Area"):
        obj = bpy.data.objects[name]
        scene.collection.objects.unlink(obj)
        apart.objects.link(obj)
    first = scene.view_layers[0]
    first.use = False
    first.layer_collection.children["Apart"].exclude = True
    scene.view_layers.new("Shot")
    return scene


def test_what_is_rendered_is_exported_changed_and_reverted(layered, tmp_path):
    job = reading.export_scene(layered, tmp_path, SubjectChoice())
    assert [o.name for o in job.analysis.objects] == ["Subject"]
    assert {"material/Body/roughness", "light/Area/power"} <= job.instances.keys()
    power = bpy.data.lights["Area"].energy
    vibe_render.register()
    try:
        look = messages.Result({"light/Area/power": [7.0]}, {}, "")
        result.apply(layered, "dark", look, job.analysis.objects, job.analysis.pivot)
        assert bpy.data.lights["Area"].energy == 7.0
        assert snapshot.revert(layered) == []
    finally:
        vibe_render.unregister()
    assert bpy.data.lights["Area"].energy == power


def test_anchors_show_the_same_layer(layered, tmp_path):
    groups = anchors.render_anchor(layered, tmp_path / "anchor.exr", {}, size=32, samples=1)
    assert "light/Area" in groups.values()
    assert [layer.name for layer in layered.view_layers] == ["ViewLayer", "Shot"]
    assert not layered.view_layers["Shot"].lightgroups
