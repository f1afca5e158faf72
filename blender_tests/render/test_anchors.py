# SPDX-License-Identifier: GPL-3.0-or-later
"""Small Cycles pictures of values that are tried: light by light, and the scene is untouched afterwards."""

import bpy
import pytest
import small_scenes as scenes
import torch
from dump import difference, dump
from vibe_render.export import reading
from vibe_render.render import anchors, bake, final_render
from vibe_render.scene import bindings, snapshot
from vibe_render.scene.subject import SubjectChoice

from proxy_renderer.color.tensors import mean_difference
from proxy_renderer.render.cycles import CyclesPicture
from proxy_renderer.render.proxy import Proxy
from proxy_renderer.scene import load_scene
from proxy_renderer.schema import VibeError, messages

PIVOT = (0.0, 0.0, 0.5)
TRIED = {
    "light/Point/power": [900.0],
    "light/Vibe Rim/power": [200.0],
    "world/color": [0.2, 0.3, 0.5],
    "material/Body/base_color": [0.7, 0.1, 0.1],
    "volume/density": [0.05],
    "film/contrast": [1.4],
}


def contents():
    """Everything in the file but the picture that Blender makes for any render."""
    return {path: value for path, value in dump().items() if "images[Render Result]" not in path}


def load(scene, path, groups):

    return CyclesPicture.load(path, groups)


@pytest.fixture
def studio(scene, tmp_path):
    """Every kind of light, a light group of the artist's own, and a compositor that uses its pass."""
    subject = scenes.studio(scene)
    scene.render.resolution_x, scene.render.resolution_y = 96, 64
    tree = scenes.compositor(scene)
    layer = scene.view_layers[0]
    layer.lightgroups.add(name="Mine")
    bpy.data.objects["Sun"].lightgroup = "Mine"
    scene.world.lightgroup = "Mine"
    layer.use_pass_mist = True
    scene.render.engine = "CYCLES"
    layer.update_render_passes()
    node = next(n for n in tree.nodes if n.bl_idname == "CompositorNodeRLayers")
    blur = tree.nodes.new("CompositorNodeBlur")
    tree.links.new(node.outputs["Mist"], blur.inputs["Image"])
    return scene, subject, tmp_path / "anchor.exr"


def test_the_groups_add_up_to_the_picture(studio):
    scene, subject, path = studio
    groups = anchors.render_anchor(scene, path, {}, subject, PIVOT, size=48, samples=16)
    assert set(groups.values()) == {"light/Area", "light/Point", "light/Spot", "light/Sun", "world"}
    picture = load(scene, path, groups)
    assert picture.size == (48, 32)
    bright = [o for o, part in picture.parts.items() if part.mean() > 0.01 * picture.whole.mean()]
    assert len(bright) >= 2
    assert picture.rest.mean() < 1e-3 * picture.whole.mean()
    total = sum(picture.parts.values()).mean().item()
    assert total == pytest.approx(picture.whole.mean().item(), rel=0.03)


def test_glowing_surfaces_are_the_rest(studio):
    scene, subject, path = studio
    scenes.shader(bpy.data.materials["Ground"]).inputs["Emission Strength"].default_value = 2.0
    picture = load(scene, path, anchors.render_anchor(scene, path, {}, subject, PIVOT, 48, 4))
    assert picture.rest.mean() > 0.3


def test_values_are_tried_and_taken_back(studio):
    scene, subject, path = studio
    before = contents()
    plain = load(scene, path, anchors.render_anchor(scene, path, {}, subject, PIVOT, 48, 8))
    groups = anchors.render_anchor(scene, path, TRIED, subject, PIVOT, 48, 8)
    assert difference(before, contents()) == {}
    assert not snapshot.exists(scene)
    tried = load(scene, path, groups)
    assert "light/Vibe Rim" in tried.parts
    assert tried.whole.mean() > 1.3 * plain.whole.mean()
    assert not list(path.parent.glob(".*"))


def test_same_seed_same_picture(studio):
    scene, subject, path = studio
    first, again = (
        load(scene, path, anchors.render_anchor(scene, path, TRIED, subject, PIVOT, 48, 8)).whole for _ in range(2)
    )
    assert torch.equal(first, again)


def test_a_render_that_fails_leaves_the_scene_alone(studio, monkeypatch):
    scene, subject, path = studio
    before = contents()

    def broken(*_, **__):
        raise MemoryError("no room")

    monkeypatch.setattr(bake, "render_file", broken)
    with pytest.raises(MemoryError):
        anchors.render_anchor(scene, path, TRIED, subject, PIVOT)
    answer = anchors.answer_anchor(scene, path.parent, messages.Anchor(3, TRIED, 48, 4), subject, PIVOT)
    assert answer.number == 3
    assert "no room" in answer.error
    assert difference(before, contents()) == {}


def test_what_cannot_be_is_said(studio):
    scene, subject, path = studio
    before = contents()
    wrong = messages.Anchor(1, {"world/color": [float("nan")] * 3}, 48, 4)
    assert "finite" in anchors.answer_anchor(scene, path.parent, wrong, subject, PIVOT).error
    path.write_bytes(b"")
    with pytest.raises(VibeError, match="cannot be written"):
        anchors.render_anchor(scene, path / "a.exr", {}, subject, PIVOT, 16, 1)
    assert difference(before, contents()) == {}


def test_an_anchor_after_a_vibe_keeps_the_vibe(studio):
    scene, subject, path = studio
    bindings.write(scene, {"light/Point/power": [50.0], "film/contrast": [1.2]}, subject, PIVOT)
    before = contents()
    anchors.render_anchor(scene, path, TRIED, subject, PIVOT, 48, 2)
    assert difference(before, contents()) == {}
    assert bindings.read(scene, subject, PIVOT)["light/Point/power"] == (50.0,)


def test_lights_that_share_data_are_one_group(studio):
    scene, subject, path = studio
    twin = bpy.data.objects.new("Twin", bpy.data.lights["Point"])
    twin.location = (-2.0, -1.0, 2.0)
    scene.collection.objects.link(twin)
    groups = anchors.render_anchor(scene, path, {}, subject, PIVOT, 32, 2)
    assert sorted(groups.values()).count("light/Point") == 1
    assert "light/Twin" not in groups.values()


def test_an_anchored_proxy_shows_what_cycles_renders(scene, tmp_path):
    """Other powers, colors and materials than the anchor's: nearer to Cycles than without it."""
    scenes.studio(scene)
    scene.render.resolution_x = scene.render.resolution_y = 64
    analysis = reading.export_scene(scene, tmp_path, SubjectChoice(objects=("Subject",))).analysis
    data = load_scene(tmp_path)
    path = tmp_path / "a.exr"
    groups = anchors.render_anchor(scene, path, {}, analysis.objects, analysis.pivot, 64, 64)
    values = {"light/Area/power": [300.0], "light/Sun/color": [1.0, 0.6, 0.3], "film/exposure": [-1.0]}
    with bindings.trial(scene, values, analysis.objects, analysis.pivot):
        final_render.render_picture(scene, tmp_path / "after.png", 64, 256)
    from proxy_renderer.engine.pictures import load_picture

    after = torch.from_numpy(load_picture(tmp_path / "after.png"))
    proxy = Proxy(data, (64, 64))
    moved = {k: torch.tensor(v) for k, v in values.items()}
    with torch.no_grad():
        before = mean_difference(proxy.render(moved).display, after)
        proxy.anchor({}, CyclesPicture.load(path, groups))
        anchored = mean_difference(proxy.render(moved).display, after)
    assert anchored < before
    assert anchored < 1.0
