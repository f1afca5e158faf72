# SPDX-License-Identifier: Apache-2.0
"""Pictures that must come out as physics and Blender's conventions say."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
import torch

from lab.bench.scenes import balls
from proxy_renderer.render.lights.light_types import light_sources
from proxy_renderer.render.proxy import Proxy
from proxy_renderer.scene import SceneData, WorldData
from proxy_renderer.scene.values import RenderValues


def _settings(scene: SceneData, **values: float) -> RenderValues:
    return RenderValues(scene, {k.replace("__", "/"): torch.tensor([v]) for k, v in values.items()}, "cpu")


def test_large_area_lamp_against_many_points() -> None:
    """The polygon formula, its horizon included, against a sum over the lamp's surface."""
    scene = balls(2, 1, 2)
    lamp = light_sources(scene, _settings(scene, **{"light__Lamp 0__size": 3.0}))[0]
    normal = torch.nn.functional.normalize(torch.tensor([[1.0], [-1.0], [0.2]]), dim=0)
    point = torch.tensor([[0.5], [0.2], [0.3]])
    grid = (torch.arange(100) + 0.5) / 100 - 0.5
    u, v = (g.flatten() * 3.0 for g in torch.meshgrid(grid, grid, indexing="ij"))
    place = lamp.position[:, None] + lamp.axes[:, 0:1] * u + lamp.axes[:, 1:2] * v
    offset = place - point
    squared = (offset * offset).sum(0)
    toward = offset / squared.sqrt()
    cosines = (toward * normal).sum(0).clamp_min(0) * (toward * lamp.axes[:, 2:3]).sum(0).clamp_min(0)
    expected = float((cosines / squared).mean()) / math.pi
    assert float(lamp.irradiance(point, normal).irradiance) == pytest.approx(expected, rel=0.05)


def test_a_mirror_ball_reflects_what_it_sees() -> None:
    """Chrome in a plain world has the world's color; a white furnace stays white for every material."""
    scene = balls(1, 0, 4)
    proxy = Proxy(scene, (48, 48))
    white = {"world/color": torch.ones(3), "world/strength": torch.ones(1), "material/Ball 0/base_color": torch.ones(3)}
    for roughness in (0.0, 0.3, 0.7, 1.0):
        for metallic in (0.0, 0.5, 1.0):
            values = {
                "material/Ball 0/roughness": torch.tensor([roughness]),
                "material/Ball 0/metallic": torch.tensor([metallic]),
            }
            picture = proxy.render({**white, **values}).linear
            ball = picture[:10, 20:28]  # its top: it sees the world, not the floor below
            assert ball.mean().item() == pytest.approx(1.0, abs=0.06), (roughness, metallic)


def test_mirror_images_are_antialiased() -> None:
    """A mirror ball at the size of a prediction, against the same with sixteen times as many pixels."""
    scene = balls(3, 2, 4)
    values = {"material/Ball 0/metallic": torch.tensor([1.0]), "material/Ball 0/roughness": torch.tensor([0.0])}
    with torch.no_grad():
        large = Proxy(scene, (256, 256)).render(values).linear.permute(2, 0, 1)[None]
        truth = torch.nn.functional.avg_pool2d(large, 4)[0].permute(1, 2, 0)
        coarse, fine = (Proxy(scene, (64, 64), fine=f).render(values).linear for f in (False, True))
    errors = [float((picture - truth).abs().mean()) for picture in (coarse, fine)]
    assert errors[1] < 0.8 * errors[0], errors


def test_mask_and_depth() -> None:
    picture = Proxy(balls(2, 1, 4), (64, 64)).render({})
    assert set(np.unique(picture.mask[28:32, 30:34].numpy())) == {1.0}
    assert picture.mask[[0, -1], 0].tolist() == [0.0, 0.0]
    assert 0.0 < picture.mask.mean() < 0.5
    assert picture.depth[32, 32].item() == pytest.approx(5.0, abs=0.1)
    assert torch.isinf(picture.depth[0, 0])


def test_a_turned_environment_moves_the_light() -> None:
    """Blender: at rotation 0 the picture's middle lies towards +X; a positive angle brings +Y's light there."""
    image = np.full((16, 32, 3), 0.02, np.float32)
    image[6:10, 15:17] = 20.0
    scene = dataclasses.replace(balls(1, 0, 3), world=WorldData("environment", image))
    proxy = Proxy(scene, (32, 32))
    right = proxy.render({}).linear[8:20].mean((0, 2))
    left = proxy.render({"world/rotation": torch.tensor([180.0])}).linear[8:20].mean((0, 2))
    assert right[18:26].mean() > 1.5 * right[6:14].mean()
    assert left[6:14].mean() > 1.5 * left[18:26].mean()
