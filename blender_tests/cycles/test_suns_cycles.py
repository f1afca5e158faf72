# SPDX-License-Identifier: GPL-3.0-or-later
"""A sun in the world's picture throws the shadow that it throws in Cycles."""

import pytest
import torch
from vibe_render.export import reading
from vibe_render.render import final_render
from vibe_render.scene.subject import SubjectChoice

from lab.bench.metrics import difference
from lab.blender.scenes.build import build
from lab.blender.scenes.recipe import CameraRecipe, FinishRecipe, SceneRecipe, WorldRecipe
from proxy_renderer.engine.pictures import load_picture
from proxy_renderer.render.proxy import Proxy
from proxy_renderer.scene import load_scene


@pytest.mark.slow
def test_the_sun_of_a_city_throws_a_shadow(tmp_path):
    matte = FinishRecipe((0.7, 0.7, 0.7), 0.8)
    world = WorldRecipe(1.0, picture="city")
    recipe = SceneRecipe("city", "head", (matte,), (), world, ground=matte, view=CameraRecipe(12.0, 20.0, fill=0.6))
    scene, subject = build(recipe, 0)
    reading.export_scene(scene, tmp_path, SubjectChoice(tuple(o.name for o in subject)))
    final_render.render_picture(scene, tmp_path / "cycles.png", 64, 64)
    cycles = torch.from_numpy(load_picture(tmp_path / "cycles.png").copy())
    proxy = Proxy(load_scene(tmp_path), (64, 64))
    assert proxy.environment.suns
    with torch.no_grad():
        found = difference(proxy.render({}).display, cycles)
    print(found)
    assert found.delta_e < 1.1
