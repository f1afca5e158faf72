# SPDX-License-Identifier: Apache-2.0
"""Autograd of the proxy renderer against central finite differences of the proxy renderer."""

from __future__ import annotations

import dataclasses

import pytest
import torch
from torch import Tensor

from proxy_renderer.bench.scenes import balls
from proxy_renderer.render.proxy import Proxy
from proxy_renderer.scene import SceneData

SIZE = (96, 96)
PLACED = ("azimuth", "elevation", "distance", "size", "angle")
STEPS = {"deg": 0.5, "K": 20.0}
OFF_BOUNDS = {  # away from kinks: every lobe is there, nothing sits on a bound
    "metallic": 0.3, "roughness": 0.45, "ior": 1.6, "specular": 0.4, "specular_tint": (0.9, 0.7, 0.5),
    "coat": 0.4, "coat_roughness": 0.3, "sheen": 0.3, "transmission": 0.2, "emission": 0.4,
    "emission_color": (0.9, 0.5, 0.3), "color": (0.9, 0.7, 0.5), "temperature": 4200.0, "density": 0.06,
    "anisotropy": 0.3, "falloff": 0.4, "offset": 0.3,
}  # fmt: skip


def _scene() -> SceneData:
    """Two balls on a floor under four kinds of lamp, in fog."""
    scene = balls(3, 4, subdivisions=3)
    instances = {}
    for key, instance in scene.instances.items():
        value = OFF_BOUNDS.get(instance.parameter.name, instance.value)
        value = value if isinstance(value, tuple) else (value,) * len(instance.value)
        instances[key] = dataclasses.replace(instance, value=value)
    return dataclasses.replace(scene, instances=instances)


SCENE = _scene()
LOOKS = [
    k for k in SCENE.instances if not k.startswith(("camera", "film")) and k.rpartition("/")[2] not in PLACED
]


@pytest.fixture(scope="module")
def proxy() -> Proxy:
    return Proxy(SCENE, SIZE)


@pytest.fixture(scope="module")
def weights() -> Tensor:
    """A smooth random picture: every region of the render counts differently."""
    coarse = torch.rand((1, 3, 5, 5), generator=torch.Generator().manual_seed(3))
    return torch.nn.functional.interpolate(coarse, SIZE[::-1], mode="bilinear")[0].permute(1, 2, 0) / 100


def _both(proxy: Proxy, weights: Tensor, key: str, step: float) -> tuple[Tensor, Tensor]:
    """Gradient (C,) of a weighted sum of the linear picture, by autograd and by differences.

    Rays refracted by another IOR are traced anew, which only differences see: so IOR is tested on opaque balls.
    """
    opaque = {k: torch.zeros(1) for k in LOOKS if k.endswith("transmission") and key.endswith("ior")}

    def total(value: Tensor) -> Tensor:
        return (proxy.render({**opaque, key: value}).linear * weights).double().sum()

    value = torch.tensor(SCENE.instances[key].value, requires_grad=True)
    (automatic,) = torch.autograd.grad(total(value), value)
    differences = torch.zeros_like(automatic)
    for i, offset in enumerate(torch.eye(len(automatic)) * step):
        with torch.no_grad():
            differences[i] = (total(value + offset) - total(value - offset)) / (2 * step)
    return automatic, differences


@pytest.mark.parametrize("key", LOOKS)
def test_looks(proxy: Proxy, weights: Tensor, key: str) -> None:
    instance = SCENE.instances[key]
    step = STEPS.get(instance.parameter.unit, max(2e-3, 0.01 * max(map(abs, instance.value))))
    automatic, differences = _both(proxy, weights, key, step)
    assert (automatic - differences).norm() <= 1e-2 * differences.norm() + 1e-5


@pytest.mark.parametrize("name", ["azimuth", "elevation", "distance", "fov"])
def test_camera_outlines(proxy: Proxy, name: str) -> None:
    """The subject's mask has no gradient but that of its outline; 15 % at 96 pixels, or 5 % of what a degree of
    field of view does where the outlines' sides cancel."""
    ramp = torch.linspace(0, 1, SIZE[0])[None] * 0.6 + torch.linspace(0, 1, SIZE[1])[:, None]
    value = torch.tensor(SCENE.instances[f"camera/{name}"].value, requires_grad=True)

    def total(value: Tensor) -> Tensor:
        return (proxy.render({f"camera/{name}": value}).mask * ramp).mean()

    (automatic,) = torch.autograd.grad(total(value), value)
    step = 0.2 if name == "distance" else 1.5
    with torch.no_grad():
        difference = (total(value + step) - total(value - step)) / (2 * step)
    assert automatic.item() == pytest.approx(difference.item(), rel=0.15, abs=6e-4)


@pytest.mark.parametrize(
    ("name", "step"), [("azimuth", 4.0), ("elevation", 4.0), ("distance", 0.2), ("size", 0.1)]
)
def test_lamp_placement(name: str, step: float) -> None:
    """Where a lamp stands, by the subject's brightness: 35 %.

    Shadows and bounced light are constants to autograd; what turns towards or away from a lamp counts most.
    """
    scene = balls(2, 1)
    proxy = Proxy(scene, SIZE)
    subject = proxy.render({}).mask[..., None]
    key = f"light/Lamp 0/{name}"
    value = torch.tensor(scene.instances[key].value, requires_grad=True)

    def total(value: Tensor) -> Tensor:
        return (proxy.render({key: value}).linear * subject).mean()

    (automatic,) = torch.autograd.grad(total(value), value)
    with torch.no_grad():
        difference = (total(value + step) - total(value - step)) / (2 * step)
    assert automatic.item() == pytest.approx(difference.item(), rel=0.35)


def test_unlit_lobes_keep_their_gradient(proxy: Proxy) -> None:
    """A weight that starts at zero, on its bound, must be able to leave it."""
    for name in ("metallic", "coat", "sheen", "transmission", "emission"):
        value = torch.zeros(1, requires_grad=True)
        proxy.render({f"material/Ball 0/{name}": value}).linear.sum().backward()
        assert value.grad is not None
        assert value.grad.abs().item() > 1e-3, name
