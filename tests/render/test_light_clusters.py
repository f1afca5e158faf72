# SPDX-License-Identifier: Apache-2.0
"""Many lights in clusters: near the picture of all lights, exact while they are few, and differentiable in each."""

from dataclasses import replace

import pytest
import torch

from lab.bench.metrics import difference
from lab.bench.scenes import balls
from proxy_renderer.render.lights import shadows
from proxy_renderer.render.proxy import Proxy

SIZE = (40, 40)
MANY = 24
DARK = {"film/exposure": torch.tensor([-5.0])}


@pytest.fixture(scope="module")
def scene():
    return balls(3, MANY, 3)


@pytest.fixture(scope="module")
def proxy(scene):
    proxy = Proxy(scene, SIZE)
    with torch.no_grad():
        proxy.render(DARK)
    return proxy


def test_few_lights_stay_alone():
    few = Proxy(balls(3, shadows.EXACT, 2), (16, 16))
    with torch.no_grad():
        few.render({})
    assert [c.members for c in few._cache.clusters.clusters] == [(i,) for i in range(shadows.EXACT)]


def test_many_lights_are_traced_as_few_and_look_like_all(scene, proxy, monkeypatch):
    with torch.no_grad():
        clustered = proxy.render(DARK).display
        monkeypatch.setattr(shadows, "EXACT", MANY)
        exact = Proxy(scene, SIZE).render(DARK).display
    assert len(proxy._cache.clusters) == 16
    assert sorted(proxy._cache.clusters.row) == list(range(MANY))
    apart = difference(clustered, exact)
    assert 0 < apart.delta_e < 0.5
    assert apart.p95 < 1.5


def test_a_clusters_source_has_the_power_of_its_lights(proxy):
    frame = proxy._frame({})
    surface = frame.view_samples.surface

    def at(lamp):
        return lamp.irradiance(surface.position, surface.normal)

    def total(lamps):
        return sum(at(lamp).irradiance.mean() * lamp.color for lamp in lamps)

    torch.testing.assert_close(total(frame.sources), total(frame.lamps), rtol=0.05, atol=0.0)


def test_light_and_gradient_of_a_lamp_in_a_cluster_are_its_own(proxy):
    shared = next(c for c in proxy._cache.clusters.clusters if len(c.members) > 1).members[-1]
    key = f"light/Lamp {shared}/power"
    if key not in proxy.scene.instances:
        key = f"light/Lamp {shared}/strength"
    power = torch.tensor(proxy.scene.instances[key].value, requires_grad=True)
    proxy.render({**DARK, key: power}).linear.mean().backward()
    with torch.no_grad():
        low, high = (proxy.render({**DARK, key: power * f}).linear.mean() for f in (0.5, 1.5))
    assert power.grad.item() > 0
    assert power.grad.item() == pytest.approx(float((high - low) / power.detach()), rel=1e-3)


def test_a_lamp_that_moves_gets_shadows_of_its_own(scene):
    proxy = Proxy(scene, SIZE)
    with torch.no_grad():
        proxy.render(DARK)
    index = next(c for c in proxy._cache.clusters.clusters if len(c.members) > 1).members[-1]
    key = f"light/Lamp {index}/azimuth"
    azimuth = torch.tensor(scene.instances[key].value, requires_grad=True)
    proxy.render({**DARK, key: azimuth}).linear.mean().backward()
    found = proxy._cache.clusters
    assert found.clusters[found.row[index]].members == (index,)
    assert azimuth.grad.abs().item() > 0
    kept = proxy._cache
    with torch.no_grad():
        proxy.render(DARK)
    assert proxy._cache is kept


def test_lights_that_light_some_things_only_stay_alone(scene, proxy):
    lamps = proxy._frame({}).lamps
    odd = [replace(lamp, light=replace(lamp.light, unlit=(0,))) if i == 20 else lamp for i, lamp in enumerate(lamps)]
    found = shadows.LightClusters.of(odd, [False] * MANY, proxy._cache.view_samples(proxy._frame({}).view).surface)
    assert found.clusters[found.row[20]].members == (20,)
