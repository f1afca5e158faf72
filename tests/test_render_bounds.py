# SPDX-License-Identifier: Apache-2.0
"""No value that the schema allows may put NaN into a picture or a gradient."""

from __future__ import annotations

import dataclasses

import pytest
import torch
from torch import Tensor

from proxy_renderer.bench.scenes import balls
from proxy_renderer.render.proxy import Proxy

SCENE = balls(2, 4, subdivisions=2)


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


@pytest.mark.parametrize("group", ["camera", "light", "world", "material", "volume"])
def test_one_at_its_bound(proxy: Proxy, group: str) -> None:
    usual = {key: torch.tensor(i.value) for key, i in SCENE.instances.items()}
    for key, instance in SCENE.instances.items():
        if instance.parameter.group == group:
            for bound in (instance.lower, instance.upper):
                _check(proxy, {**usual, key: torch.tensor(bound)})


def test_all_at_random_bounds(proxy: Proxy) -> None:
    generator = torch.Generator().manual_seed(5)
    for _ in range(8):
        sides = torch.rand(len(SCENE.instances), generator=generator) < 0.5
        rows = zip(SCENE.instances.items(), sides, strict=True)
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
