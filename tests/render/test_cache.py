# SPDX-License-Identifier: Apache-2.0
"""Rays are traced again only where something has moved."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
import torch

from lab.bench.scenes import balls
from proxy_renderer.render.geometry.visibility import RayGeometry
from proxy_renderer.render.proxy import Proxy


@pytest.fixture
def traced(monkeypatch: pytest.MonkeyPatch) -> Iterator[list[int]]:
    """Counts of rays, by call; the rays are traced all the same."""
    counts: list[int] = []
    for name in ("first_hits", "clear"):
        original = getattr(RayGeometry, name)

        def spy(self, origin, *rest, _original=original):  # type: ignore[no-untyped-def]
            counts.append(origin.shape[1])
            return _original(self, origin, *rest)

        monkeypatch.setattr(RayGeometry, name, spy)
    return iter([counts]).__next__()


def test_colors_and_powers_trace_nothing(traced: list[int]) -> None:
    proxy = Proxy(balls(2, 2, 2), (48, 48))
    before = proxy.render({}).linear
    traced.clear()
    changed = {"light/Lamp 0/power": torch.tensor([500.0]), "material/Floor/base_color": torch.tensor([0.1, 0.2, 0.9])}
    after = proxy.render(changed).linear
    assert not traced
    assert not torch.allclose(before, after)


def test_one_moving_lamp_leaves_the_other_alone(traced: list[int]) -> None:
    proxy = Proxy(balls(2, 2, 2), (48, 48))
    proxy.render({})
    everything = sum(traced)
    traced.clear()
    proxy.render({"light/Lamp 1/azimuth": torch.tensor([80.0])})
    one = sum(traced)
    traced.clear()
    proxy.render({"light/Lamp 0/azimuth": torch.tensor([10.0]), "light/Lamp 1/azimuth": torch.tensor([80.0])})
    assert 0 < sum(traced) < 0.8 * everything
    assert 0 < one < 0.5 * everything


@pytest.mark.parametrize("thing", ["Floor", "Ball 0"])
@pytest.mark.parametrize("opaque", [True, False])
def test_of_a_new_mirror_only_what_it_shows_is_traced(traced: list[int], thing: str, opaque: bool) -> None:
    scene = balls(2, 2, 2)
    metal = {f"material/{thing}/metallic": torch.ones(1)}
    mirror = metal | {f"material/{thing}/roughness": torch.tensor([0.1])}
    duller = metal | {f"material/{thing}/roughness": torch.tensor([0.6])}
    matte = metal | {f"material/{thing}/roughness": torch.ones(1)}
    glass = {} if opaque else {"material/Ball 1/transmission": torch.ones(1)}
    mirror, duller, matte = mirror | glass, duller | glass, matte | glass
    travelled = Proxy(scene, (48, 48))
    travelled.render(mirror)
    everything = sum(traced)
    for values in (duller, glass, mirror, matte, mirror):
        traced.clear()
        changed = travelled.render(values).display
        assert 0 < sum(traced) < 0.4 * everything
        assert torch.equal(changed, Proxy(scene, (48, 48)).render(values).display)


def test_a_moving_camera_traces_all_again(traced: list[int]) -> None:
    proxy = Proxy(balls(2, 1, 2), (48, 48))
    proxy.render({})
    everything = sum(traced)
    traced.clear()
    proxy.render({"camera/azimuth": torch.tensor([20.0])})
    assert sum(traced) > 0.7 * everything


def test_a_render_depends_on_its_values_only() -> None:
    scene = balls(2, 2, 2)
    values = {"light/Lamp 0/azimuth": torch.tensor([25.0]), "camera/azimuth": torch.tensor([15.0])}
    travelled, fresh = Proxy(scene, (48, 48)), Proxy(scene, (48, 48))
    travelled.render({})
    travelled.render({"light/Lamp 0/azimuth": torch.tensor([90.0])})
    assert torch.equal(travelled.render(values).display, fresh.render(values).display)


@pytest.mark.parametrize("lamp", ["Lamp 0", "Lamp 1", "Lamp 3"])  # an area light, a point, a spot
def test_a_light_that_changes_its_size_keeps_the_shadows_of_bounced_light(traced: list[int], lamp: str) -> None:
    scene = balls(2, 4, 2)
    larger = {f"light/{lamp}/size": torch.tensor([1.5])}
    travelled = Proxy(scene, (48, 48))
    travelled.render({})
    traced.clear()
    travelled.render({f"light/{lamp}/azimuth": torch.tensor([80.0])})
    moved = sum(traced)
    travelled.render({})
    traced.clear()
    changed = travelled.render(larger).display
    assert 0 < sum(traced) < 0.7 * moved
    # What a light that moved sends is added after the rest: the last bit may differ
    torch.testing.assert_close(changed, Proxy(scene, (48, 48)).render(larger).display, rtol=1e-5, atol=1e-6)


def test_renders_that_differ_in_one_value_share_nothing_that_it_changes() -> None:
    scene = balls(3, 1, 1)
    base = {
        "material/Ball 0/coat": torch.ones(1),
        "material/Ball 1/metallic": torch.tensor([0.5]),
        "material/Ball 1/specular_tint": torch.tensor([0.5, 0.2, 0.2]),
        "light/Lamp 0/power": torch.tensor([300.0]),
    }
    travelled = Proxy(scene, (24, 24))
    travelled.render(base)
    for key, instance in scene.instances.items():
        # What has glowed stays a light.
        if not key.startswith(("material/Ball 0", "light/Lamp 0")) or "emission" in key:
            continue
        lower, upper, value = (torch.tensor(v) for v in (instance.lower, instance.upper, instance.value))
        there = base | {key: torch.lerp(base.get(key, value), torch.where(value < upper, upper, lower), 0.25)}
        fresh = Proxy(scene, (24, 24)).render(there).linear
        torch.testing.assert_close(travelled.render(there).linear, fresh, rtol=1e-5, atol=1e-6, msg=key)


def test_values_may_be_changed_in_place() -> None:
    scene = balls(2, 1, 2)
    values = {
        "material/Ball 0/roughness": torch.tensor([0.1]),
        "material/Ball 0/specular": torch.tensor([0.3]),
        "light/Lamp 0/power": torch.tensor([50.0]),
    }
    same = {key: value.clone() for key, value in values.items()}
    travelled = Proxy(scene, (48, 48))
    first = travelled.render(values).linear
    for value in values.values():
        value *= 2
    assert torch.equal(travelled.render(values).linear, Proxy(scene, (48, 48)).render(values).linear)
    assert torch.equal(travelled.render(same).linear, first)


def test_seeds_are_reproducible() -> None:
    scene = balls(2, 1, 2)
    first, second = (Proxy(scene, (48, 48), seed=3).render({}).display for _ in range(2))
    assert torch.equal(first, second)


def test_memory_grows_as_the_pixels_do() -> None:
    """Bytes that a step keeps for its gradient."""
    scene = balls(2, 2, 2)

    def kept(side: int) -> int:
        found: dict[int, int] = {}

        def pack(tensor: torch.Tensor) -> torch.Tensor:
            found[tensor.untyped_storage().data_ptr()] = tensor.untyped_storage().nbytes()
            return tensor

        values = {key: torch.tensor(i.value, requires_grad=True) for key, i in scene.instances.items()}
        with torch.autograd.graph.saved_tensors_hooks(pack, lambda tensor: tensor):
            Proxy(scene, (side, side)).render(values).display.mean().backward()
        return sum(found.values())

    assert kept(256) < 4.4 * kept(128)
