# SPDX-License-Identifier: GPL-3.0-or-later
"""Broken and unusual scenes, from Blender to the gradient: no crash, no NaN, and Cycles' picture where it has one."""

import bpy
import numpy as np
import pytest
import torch
from faulty_scenes import FAULTS, aim, plain
from marks import few_of
from PIL import Image
from vibe_render.export import reading
from vibe_render.render import final_render
from vibe_render.scene.subject import SubjectChoice

from proxy_renderer.color.tensors import mean_difference
from proxy_renderer.optimize.scene_facts import described
from proxy_renderer.render.proxy import Proxy
from proxy_renderer.scene import SceneData, load_scene
from proxy_renderer.schema import VibeError
from proxy_renderer.words.lexicon.vocabulary import default_vocabulary
from proxy_renderer.words.scene import SceneIndex

SAMPLES = 32


def exported(scene, folder, choice=None):
    """The job, and the scene as the engine reads it."""
    job = reading.export_scene(scene, folder, choice or SubjectChoice())
    return job, load_scene(folder)


def render(scene: SceneData, size: tuple[int, int]) -> torch.Tensor:
    """The picture, after proof that neither it nor any gradient holds a NaN or an infinity."""
    values = {k: torch.tensor(i.value, requires_grad=True) for k, i in scene.instances.items()}
    picture = Proxy(scene, size).render(values)
    for name in ("display", "linear", "mask"):
        assert torch.isfinite(getattr(picture, name)).all(), name
    (picture.display.sum() + picture.linear.sum() + picture.mask.sum()).backward()
    broken = [k for k, v in values.items() if v.grad is not None and not torch.isfinite(v.grad).all()]
    assert not broken
    return picture.display.detach()


@pytest.mark.parametrize(
    "name", few_of(FAULTS, {"no_lights", "nan_texture", "zero_scale", "geometry_nodes", "broken_texture", "shape_keys"})
)
def test_fault(scene, tmp_path, name):
    fault = FAULTS[name]
    fault.build(scene, plain(scene))
    job, read = exported(scene, tmp_path)
    warnings = " ".join(job.warnings)
    assert fault.warns in warnings
    assert fault.warns or fault.near is None or not warnings
    longest = max(scene.render.resolution_x, scene.render.resolution_y)
    size = scene.render.resolution_x, scene.render.resolution_y
    SceneIndex(described(read), default_vocabulary()).named(("lamp",))  # what a prompt may name can be looked up
    picture = render(read, size)
    if fault.near is not None:
        final_render.render_picture(scene, tmp_path / "cycles.png", longest, SAMPLES)
        with Image.open(tmp_path / "cycles.png") as image:
            cycles = torch.from_numpy(np.array(image.convert("RGB"), dtype=np.float32) / 255)
        assert cycles.shape == picture.shape
        apart = mean_difference(cycles, picture).item()
        assert apart < fault.near


@pytest.mark.parametrize("kind", ["PANO", "LIGHT", "NOWHERE"])
def test_cameras_that_are_refused(scene, tmp_path, kind):
    plain(scene)
    if kind == "LIGHT":
        scene.camera = bpy.data.objects["Sun"]
    elif kind == "NOWHERE":
        scene.camera.location.x = float("nan")
    else:
        scene.camera.data.type = kind
    with pytest.raises(VibeError) as refused:
        exported(scene, tmp_path / "job")
    assert refused.value.remedy
    assert not (tmp_path / "job").exists()


@pytest.mark.parametrize("fault", ["zero_scale_subject", "all_degenerate"])
def test_a_chosen_subject_that_no_render_shows(scene, tmp_path, fault):
    FAULTS[fault].build(scene, plain(scene))
    with pytest.raises(VibeError, match="no mesh that a render shows"):
        exported(scene, tmp_path, SubjectChoice(("Subject",)))


def test_a_camera_that_sees_nothing(scene, tmp_path):
    plain(scene)
    aim(scene.camera, (0.0, -20.0, 1.0), scene.camera.location + scene.camera.location)
    scene.camera.data.clip_end = 1.0
    with pytest.raises(VibeError, match="sees no mesh"):
        exported(scene, tmp_path)
