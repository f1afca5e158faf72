# SPDX-License-Identifier: Apache-2.0
"""What is transparent lets its share of light and of sight through."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
import torch

from lab.bench.scenes import balls
from proxy_renderer.render.material.inputs import geometry_of
from proxy_renderer.render.proxy import Proxy
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
    passing = geometry_of(_with(alpha), torch.device("cpu")).clear(*ACROSS)
    assert float(passing) == pytest.approx((1 - alpha) ** 2, abs=1e-5)


def test_alpha_of_a_texture() -> None:
    image = np.full((4, 4, 1), 0.25, np.float32)
    passing = geometry_of(_with(1.0, alpha=Texture(image)), torch.device("cpu")).clear(*ACROSS)
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


def test_a_mirror_shows_a_texture() -> None:
    """A metal ball over a floor that is red on one side and blue on the other."""
    scene = balls(2, 1, 4)
    image = np.zeros((2, 2, 3), np.float32)
    image[:, 0, 0] = image[:, 1, 2] = 0.8
    floor = dataclasses.replace(scene.materials[1], texture=Texture(image, "EXTEND"))
    corners = scene.mesh.vertices[scene.mesh.faces]
    mesh = dataclasses.replace(scene.mesh, uvs=(corners[..., :2] / 18 + 0.5).astype(np.float32))
    scene = dataclasses.replace(scene, materials=(scene.materials[0], floor), mesh=mesh)
    key = "material/Ball 0/"
    values = {key + "metallic": torch.ones(1), key + "roughness": torch.zeros(1), key + "base_color": torch.ones(3)}
    ball = Proxy(scene, SIZE).render(values).linear[26:34]
    left, right = ball[:, 16:21].mean((0, 1)), ball[:, 27:32].mean((0, 1))
    assert left[0] > 1.5 * left[2]
    assert right[2] > 1.5 * right[0]


def test_rays_find_their_way_out_of_thick_and_thin_glass() -> None:
    """Two shells, one in the other: a ray passes four walls and sees the white world, at any IOR."""
    scene = balls(2, 0, 3)
    inner = scene.mesh.vertices.copy()
    inner = (inner - (0, 0, 1)) * 0.9 + (0, 0, 1)
    count = len(scene.mesh.vertices)
    ball = scene.mesh.object == 0
    mesh = dataclasses.replace(
        scene.mesh,
        vertices=np.concatenate([scene.mesh.vertices, inner]).astype(np.float32),
        faces=np.concatenate([scene.mesh.faces[ball], scene.mesh.faces[ball][:, ::-1] + count]).astype(np.int32),
        normals=np.concatenate([scene.mesh.normals[ball], -scene.mesh.normals[ball][:, ::-1]]),
        **{n: np.concatenate([getattr(scene.mesh, n)[ball]] * 2) for n in ("uvs", "material", "object")},
    )
    scene = dataclasses.replace(scene, mesh=mesh)
    key = "material/Ball 0/"
    white = {key + "base_color": torch.ones(3), key + "transmission": torch.ones(1), key + "roughness": torch.zeros(1)}
    for ior in (1.0, 1.5):
        seen = Proxy(scene, SIZE).render({**white, key + "ior": torch.tensor([ior])}).linear
        world = seen[0, 0]
        assert torch.allclose(seen[18, 24], world, rtol=0.15)
