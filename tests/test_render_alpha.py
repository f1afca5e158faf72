# SPDX-License-Identifier: Apache-2.0
"""What is transparent lets its share of light and of sight through."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
import torch

from proxy_renderer.bench.scenes import balls
from proxy_renderer.render.proxy import Proxy
from proxy_renderer.render.visibility import Geometry
from proxy_renderer.scene import SceneData, Texture

SIZE = (48, 48)
ACROSS = torch.tensor([[0.0], [-5.0], [1.0]]), torch.tensor([[0.0], [1.0], [0.0]]), torch.tensor([10.0])
"""Origin, direction and length of a way through the middle of the ball."""


def _with(opacity: float, **maps: Texture) -> SceneData:
    """A ball of some alpha on an opaque floor."""
    scene = balls(2, 1, 3)
    ball = dataclasses.replace(scene.materials[0], alpha=opacity, maps=maps)
    return dataclasses.replace(scene, materials=(ball, scene.materials[1]))


@pytest.mark.parametrize("alpha", [0.0, 0.3, 1.0])
def test_light_passes_both_walls_of_a_ball(alpha: float) -> None:
    passing = Geometry(_with(alpha), torch.device("cpu")).clear(*ACROSS)
    assert float(passing) == pytest.approx((1 - alpha) ** 2, abs=1e-5)


def test_alpha_of_a_texture() -> None:
    image = np.full((4, 4, 1), 0.25, np.float32)
    passing = Geometry(_with(1.0, alpha=Texture(image)), torch.device("cpu")).clear(*ACROSS)
    assert float(passing) == pytest.approx(0.75**2, abs=1e-5)


@pytest.mark.parametrize("alpha", [0.0, 0.4])
def test_what_is_behind_shows(alpha: float) -> None:
    """A black ball before a white world, on a transparent film: it covers alpha of what its walls leave."""
    scene = _with(alpha)
    scene = dataclasses.replace(scene, film=dataclasses.replace(scene.film, transparent=True))
    cover = Proxy(scene, SIZE).render({}).alpha
    assert cover is not None
    assert float(cover[18, 24]) == pytest.approx(1 - (1 - alpha) ** 2, abs=1e-4)


def test_a_camera_behind_nothing_but_transparency_keeps_its_gradients() -> None:
    scene = _with(0.5)
    color = torch.tensor(scene.instances["material/Ball 0/base_color"].value, requires_grad=True)
    Proxy(scene, SIZE).render({"material/Ball 0/base_color": color}).linear.sum().backward()
    assert color.grad is not None
    assert bool((color.grad > 0).all())
