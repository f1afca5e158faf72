# SPDX-License-Identifier: GPL-3.0-or-later
"""Fog of the proxy looks like fog in Cycles, under every kind of light."""

import pytest
import torch
from marks import few_of
from vibe_render.export import reading
from vibe_render.render import final_render
from vibe_render.scene.subject import SubjectChoice

from lab.bench.metrics import difference
from lab.blender.scenes.build import build
from lab.blender.scenes.recipe import CameraRecipe, FinishRecipe, FogRecipe, LightRecipe, SceneRecipe, WorldRecipe
from proxy_renderer.engine.pictures import load_picture
from proxy_renderer.render.proxy import Proxy
from proxy_renderer.scene import load_scene

LIGHTS = {
    "area": ((LightRecipe("AREA", 45.0, 40.0, 1.3, 1.0),), WorldRecipe(1.0, (0.05, 0.06, 0.08))),
    "sun": ((LightRecipe("SUN", 45.0, 40.0, 0.9, 3.0),), WorldRecipe(1.0, (0.2, 0.25, 0.35))),
    "spot": (
        (LightRecipe("SPOT", -125.0, 50.0, 1.2, 0.1, distance=5.5, settings={"spot_size": 0.9}),),
        WorldRecipe(1.0, (0.02, 0.02, 0.03)),
    ),
    "point": ((LightRecipe("POINT", -35.0, 30.0, 0.9, 0.2, distance=2.9),), WorldRecipe(1.0, (0.05, 0.05, 0.05))),
    "world": ((), WorldRecipe(1.0, (0.5, 0.55, 0.65))),
}
FOGS = {
    "thin": FogRecipe(0.3),
    "fog": FogRecipe(0.9, (0.8, 0.85, 0.9)),
    "thick": FogRecipe(2.8, (0.5, 0.7, 0.9), 0.4),
    "low": FogRecipe(3.5, falloff=1.0, offset=0.3),
    "black": FogRecipe(1.4, (0.0, 0.0, 0.0)),
}
FINISH, GROUND = FinishRecipe((0.6, 0.2, 0.1), 0.4), FinishRecipe((0.5, 0.45, 0.4), 0.7)
VIEW = CameraRecipe(12.0, 10.0, fill=0.6)


@pytest.mark.parametrize(
    "name",
    few_of(
        ["area fog", "sun thick", "spot thin", "world fog", "point low", "area black", "world thick"],
        ["point low", "area black"],
    ),
)
def test_fog_matches_cycles(tmp_path, name):
    light, fog = name.split()
    lamps, world = LIGHTS[light]
    recipe = SceneRecipe(name, "head", (FINISH,), lamps, world, ground=GROUND, fog=FOGS[fog], view=VIEW)
    scene, subject = build(recipe, 0)
    reading.export_scene(scene, tmp_path, SubjectChoice(tuple(o.name for o in subject)))
    final_render.render_picture(scene, tmp_path / "cycles.png", 48, 64)
    cycles = torch.from_numpy(load_picture(tmp_path / "cycles.png").copy())
    with torch.no_grad():
        proxy = Proxy(load_scene(tmp_path), (48, 48)).render({}).display
    found = difference(proxy, cycles)
    print(f"{name}: {found}")
    assert cycles.mean() > 0.05
    assert found.delta_e < 2.6  # so small a picture is all edges; at 128 pixels it is below 1.6
    assert abs(cycles.mean() - proxy.mean()) < 0.04 * cycles.mean()
