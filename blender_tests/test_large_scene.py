# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene of two million triangles goes the whole way, and nothing of it is left out."""

import bpy
import pytest
import torch
from faulty_scenes import AIM, plain
from vibe_render import scene_io
from vibe_render.subject import Choice

from proxy_renderer.render.proxy import Proxy
from proxy_renderer.scene import load_scene


@pytest.mark.timeout(900)
def test_two_million_triangles(scene, tmp_path):
    subject = plain(scene)
    bpy.context.view_layer.objects.active = subject
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=4, radius=1.0, location=AIM)
    fine = bpy.context.object
    finer = fine.modifiers.new("Fine", "SUBSURF")
    finer.levels, finer.render_levels = 0, 5
    job = scene_io.open_job(scene, tmp_path, Choice((fine.name,)))
    assert len(job.survey.geometry.faces) > 1_900_000
    assert job.warnings == []
    read = load_scene(tmp_path)
    picture = Proxy(read, (64, 64)).render({key: torch.tensor(i.value) for key, i in read.instances.items()})
    assert torch.isfinite(picture.display).all()
    assert picture.mask.sum() > 10.0
