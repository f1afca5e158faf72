# SPDX-License-Identifier: GPL-3.0-or-later
"""A glowing bulb in fog lights its surroundings, and has a halo, as in Cycles."""

import torch
from vibe_render.bench.scenes.build import build
from vibe_render.bench.scenes.recipe import CameraRecipe, FinishRecipe, FogRecipe, SceneRecipe, WorldRecipe
from vibe_render.export import reading
from vibe_render.render import final_render
from vibe_render.scene.subject import SubjectChoice

from proxy_renderer.bench.metrics import difference
from proxy_renderer.engine.report import load_picture
from proxy_renderer.render.proxy import Proxy
from proxy_renderer.scene import load_scene


def test_the_halo_of_a_bulb_in_fog(tmp_path):
    bulb = FinishRecipe(
        (0.8, 0.8, 0.8), 0.8, inputs={"Emission Strength": 9.0, "Emission Color": (1.0, 0.6, 0.25)}
    )
    iron = FinishRecipe((0.2, 0.1, 0.05), 0.8)
    world = WorldRecipe(1.0, (0.01, 0.01, 0.015))
    ground = FinishRecipe((0.4, 0.35, 0.3), 0.9)
    finishes = (bulb, *(iron,) * 6)
    recipe = SceneRecipe(
        "bulb",
        "lantern",
        finishes,
        (),
        world,
        ground=ground,
        fog=FogRecipe(0.4),
        view=CameraRecipe(12.0, 10.0),
    )
    scene, subject = build(recipe, 0)
    reading.export_scene(scene, tmp_path, SubjectChoice(tuple(o.name for o in subject)))
    final_render.render(scene, tmp_path / "cycles.png", 64, 96)
    cycles = torch.from_numpy(load_picture(tmp_path / "cycles.png").copy())
    proxy = Proxy(load_scene(tmp_path), (64, 64))
    with torch.no_grad():
        picture = proxy.render({}).display
    assert proxy.emitters.materials
    found = difference(picture, cycles)
    print(found, cycles.mean(), picture.mean())
    assert found.delta_e < 2.0
    assert abs(cycles.mean() - picture.mean()) < 0.04 * cycles.mean()
