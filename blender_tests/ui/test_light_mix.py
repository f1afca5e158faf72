# SPDX-License-Identifier: GPL-3.0-or-later
"""Light Mix in the panel by its operators: a slider changes the image at once, Apply and Compositor write it, Revert takes it back."""

import bpy
import numpy as np
import pytest
from dump import contents, difference
from panel_layout import drawn
from small_scenes import studio
from vibe_render.core import compat
from vibe_render.render import bake
from vibe_render.run import light_mix
from vibe_render.run.state import addon_state
from vibe_render.scene.nodes import mix
from vibe_render.scene.steps import LIGHT_MIX, Steps
from vibe_render.ui import drawing
from vibe_render.ui import light_mix as light_mix_ui


@pytest.fixture
def mixing(addon, monkeypatch):
    """A studio whose lights have been rendered apart, and a dump of before."""
    monkeypatch.setattr(light_mix, "_SIZE", 64)
    monkeypatch.setattr(light_mix, "_SAMPLES", 4)
    studio(addon)
    addon.render.engine = "CYCLES"
    before = contents()
    assert bpy.ops.vibe.mix_render() == {"FINISHED"}
    yield addon, before
    drawing.end_timers()
    addon_state.forget_mix()


def image():
    light_mix_ui._draw()
    return bake.read_file(addon_state.mix.picture)[..., :3]


def test_a_slider_changes_the_image_and_nothing_else(mixing):
    scene, before = mixing
    assert [channel.name for channel in scene.vibe.mix] == ["Area", "Point", "Spot", "Sun", "World"]
    first, users = image(), scene.users
    scene.vibe.mix["Sun"].factor = 0.0
    assert bpy.app.timers.is_registered(light_mix_ui._draw)  # soon, once for all that moves
    dark = image()
    assert dark.mean() < 0.6 * first.mean()
    scene.vibe.mix["Sun"].color = (1.0, 0.2, 0.1)
    scene.vibe.mix["Sun"].factor = 1.0
    red = image()
    assert red[..., 0].mean() > 1.2 * red[..., 2].mean()
    assert difference(before, contents()) == {}
    assert scene.users == users
    bpy.ops.vibe.mix_reset()
    assert np.array_equal(image(), first)


def test_apply_writes_a_step_and_the_image_stays(mixing):
    scene, before = mixing
    scene.vibe.mix["Sun"].factor, scene.vibe.mix["Sun"].color = 0.5, (1.0, 0.5, 0.25)
    mixed = image()
    sun = bpy.data.lights["Sun"].energy
    assert bpy.ops.vibe.mix_apply() == {"FINISHED"}
    assert bpy.data.lights["Sun"].energy == pytest.approx(0.5 * sun)
    assert tuple(bpy.data.lights["Sun"].color) == pytest.approx((1.0, 0.5, 0.25))
    assert [step.sentence for step in Steps.of(scene).steps] == [LIGHT_MIX]
    assert {change.name for change in scene.vibe.changes} == {"light/Sun/strength", "light/Sun/color"}
    assert scene.vibe.mix["Sun"].factor == 1.0  # from here on
    assert np.abs(image() - mixed).max() <= 1.0 / 255.0
    assert not bpy.ops.vibe.mix_apply.poll()
    scene.vibe.mix["Sun"].factor = 2.0
    bpy.ops.vibe.mix_apply()
    assert bpy.data.lights["Sun"].energy == pytest.approx(sun)
    bpy.ops.vibe.revert()
    assert difference(before, contents()) == {}
    assert addon_state.mix is None  # the lights are other ones now


def test_the_compositor_has_the_mix_until_revert(mixing):
    scene, before = mixing
    scene.vibe.mix["Area"].factor = 0.25
    assert bpy.ops.vibe.mix_nodes() == {"FINISHED"}
    assert mix.read_mix(scene) == {"Area": (0.25, 0.25, 0.25)}
    assert [group.name for group in scene.view_layers[0].lightgroups] == ["Area"]
    assert bpy.ops.vibe.mix_render() == {"FINISHED"}
    assert scene.vibe.mix["Area"].factor == 0.25  # the slider stands where the nodes are
    bpy.ops.vibe.revert()
    assert difference(before, contents()) == {}


def test_the_panel_has_a_slider_for_each_light(mixing):
    found = drawn(light_mix_ui.MixPanel)
    sliders = [
        "Area",
        "factor",
        "color",
        "Point",
        "factor",
        "color",
        "Spot",
        "factor",
        "color",
        "Sun",
        "factor",
        "color",
    ]
    place = found.index("Area") - 1
    assert found[place + 1 : place + 1 + len(sliders)] == sliders
    assert found[-3:] == ["vibe.mix_apply", "vibe.mix_nodes", "vibe.mix_reset"]


def test_eevee_is_told_that_it_needs_cycles(addon):
    addon.render.engine = compat.EEVEE
    assert not bpy.ops.vibe.mix_render.poll()
    assert light_mix.NEEDS_CYCLES in " ".join(drawn(light_mix_ui.MixPanel))
