# SPDX-License-Identifier: Apache-2.0
"""No value that the schema allows may put NaN into a picture or a gradient."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
import torch
from torch import Tensor

from lab.bench.scenes import balls
from proxy_renderer.render.proxy import Proxy
from proxy_renderer.scene import SceneData, Texture, WorldData
from proxy_renderer.schema import FAMILIES, GROUPS, Instance


def _everything() -> SceneData:
    """A scene that has every parameter: lamps of each type, a texture, an environment."""
    scene = balls(2, 4, subdivisions=2)
    image = np.random.default_rng(3).random((8, 16, 3), np.float32)
    ball, *rest = scene.materials
    rows = [
        ("material/tint", ball.name),
        ("material/recolor", ball.name),
        ("world/tint", ""),
        ("world/rotation", ""),
        ("world/backdrop_color", ""),
        ("world/backdrop_tint", ""),
        ("world/backdrop_strength", ""),
        ("world/backdrop_horizon", ""),
    ]
    linked = (Instance(p := FAMILIES[name], owner, (p.default,) * p.components) for name, owner in rows)
    return dataclasses.replace(
        scene,
        materials=(dataclasses.replace(ball, texture=Texture(image)), *rest),
        world=WorldData("environment", image, image),
        instances={**scene.instances, **{i.key: i for i in linked}},
    )


SCENE = _everything()


def test_every_parameter_is_tried() -> None:
    assert {i.parameter.family for i in SCENE.instances.values()} == set(FAMILIES)


@pytest.fixture(scope="module")
def proxy() -> Proxy:
    return Proxy(SCENE, (24, 24))


def _check(proxy: Proxy, values: dict[str, Tensor]) -> None:
    values = {key: value.clone().requires_grad_(True) for key, value in values.items()}
    picture = proxy.render(values)
    for name in ("display", "linear", "mask"):
        assert torch.isfinite(getattr(picture, name)).all(), name
    assert picture.linear.min() > -1e-3
    (picture.display.mean() + picture.linear.mean() + picture.mask.mean()).backward()
    broken = [k for k, v in values.items() if v.grad is not None and not torch.isfinite(v.grad).all()]
    assert not broken


@pytest.mark.slow
@pytest.mark.parametrize("group", GROUPS)
def test_one_at_its_bound(proxy: Proxy, group: str) -> None:
    usual = {key: torch.tensor(i.value) for key, i in SCENE.instances.items()}
    for key, instance in SCENE.instances.items():
        if instance.parameter.group == group and instance.owner != "Floor":
            for bound in (instance.lower, instance.upper):
                _check(proxy, {**usual, key: torch.tensor(bound)})


@pytest.mark.parametrize(
    "scene",
    [
        pytest.param(SCENE, id="everything"),
        pytest.param(balls(2, 4, subdivisions=2), id="plain", marks=pytest.mark.slow),
    ],
)
def test_all_at_bounds(scene: SceneData) -> None:
    proxy, generator = Proxy(scene, (24, 24)), torch.Generator().manual_seed(5)
    instances = scene.instances
    for share in (1.0, 0.0, *(0.5,) * 8):  # all low, all high, random corners
        sides = torch.rand(len(instances), generator=generator) < share
        rows = zip(instances.items(), sides, strict=True)
        _check(proxy, {key: torch.tensor(i.lower if low else i.upper) for (key, i), low in rows})


@pytest.mark.parametrize("name", ["away", "orthographic", "inside", "dark", "one pixel"])
def test_odd_views(name: str) -> None:
    scene, camera = balls(2, 0 if name == "dark" else 2, subdivisions=2), SCENE.camera
    if name == "away":
        camera = dataclasses.replace(camera, residual=((-1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, -1.0)))
    elif name == "orthographic":
        camera = dataclasses.replace(camera, type="ORTHO")
    proxy = Proxy(dataclasses.replace(scene, camera=camera), (1, 1) if name == "one pixel" else (24, 16))
    values = {key: torch.tensor(i.value) for key, i in scene.instances.items()}
    if name == "inside":
        values["camera/distance"] = torch.tensor([0.01])
    _check(proxy, values)
