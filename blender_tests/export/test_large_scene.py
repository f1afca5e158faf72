# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene of two million triangles goes the whole way and back, and nothing of it is left out."""

import time

import bpy
import pytest
from dump import contents, difference
from faulty_scenes import AIM
from vibe_render.run import session
from vibe_render.run.state import addon_state
from vibing import advance

from proxy_renderer.scene import load_scene


@pytest.mark.timeout(900)
@pytest.mark.slow
def test_two_million_triangles(addon):
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=4, radius=1.0, location=AIM)
    fine = bpy.context.object
    finer = fine.modifiers.new("Fine", "SUBSURF")
    finer.levels, finer.render_levels = 0, 5
    fine.data.materials.append(bpy.data.materials["Body"])
    before, settings = contents(), addon.vibe
    settings.subject = "SELECTED"
    settings.rounds, settings.steps, settings.size, settings.anchor = 1, 2, 64, True
    running = advance(lambda running: running.stage == session.ANCHORING)
    read = load_scene(running._job)
    assert len(read.mesh.faces) > 1_900_000
    while running.advance():
        time.sleep(0.02)
    addon_state.end()
    assert any(change.name == "material/Body/base_color" for change in settings.changes)
    assert running.prediction_error < 10.0
    assert bpy.ops.vibe.revert() == {"FINISHED"}
    assert difference(before, contents()) == {}
