# SPDX-License-Identifier: Apache-2.0
"""What fog does between surfaces: bounds, convergence, and finite differences."""

from dataclasses import replace

import pytest
import torch
from tiny_job import write_job

from proxy_renderer.render.geometry.camera import view_of
from proxy_renderer.render.lights.emitters import Emitters
from proxy_renderer.render.lights.environment import Environment, sky_of
from proxy_renderer.render.lights.light_types import light_sources
from proxy_renderer.render.material.inputs import geometry_of
from proxy_renderer.render.proxy import Proxy
from proxy_renderer.render.surface.view_cache import ViewCache
from proxy_renderer.render.transport import indirect
from proxy_renderer.render.transport.fog import FogMedium
from proxy_renderer.scene import load_scene
from proxy_renderer.scene.values import RenderValues

SIZE = (64, 48)


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    return load_scene(write_job(tmp_path_factory.mktemp("job")))


@pytest.fixture(scope="module")
def cache(scene):
    return view_cache(scene)


def view_cache(scene):
    geometry = geometry_of(scene, torch.device("cpu"))
    metals = torch.zeros(len(scene.materials))
    view = view_of(scene, settings(scene), SIZE)
    lamps = light_sources(scene, settings(scene))
    return ViewCache(scene, geometry, view, metals, metals > 0, lamps, Emitters(geometry, 6.0), 0)


def settings(scene, **volume):
    values = {f"volume/{k}": torch.as_tensor(v, dtype=torch.float32).reshape(-1) for k, v in volume.items()}
    return RenderValues(scene, values, "cpu")


def found(scene, rays, lamps=True, **volume):
    s = settings(scene, **volume)
    sky = sky_of(Environment(scene, torch.device("cpu")), s)
    return rays.gather(FogMedium(scene, s), light_sources(scene, s) if lamps else [], sky), sky


def test_black_fog_takes_light_and_gives_none(scene, cache):
    got, _ = found(scene, cache.indirect_fog(6.0), density=0.2, color=[0.0] * 3)
    assert got.scattered.abs().max() == 0
    assert got.haze.abs().max() == 0
    for share in (got.ambient, got.passing, got.path_transmittance, got.light_transmittance, got.mirrored):
        assert (share > 0).all()
        assert (share <= 1 + 1e-6).all()
        assert share.mean() < 0.99
    count = got.light_transmittance.shape[1] // 2
    assert (got.path_transmittance[:, :count] < got.light_transmittance[:, :count] + 1e-6).all()


def test_white_fog_gives_less_than_it_takes(scene, cache):
    """Light that scatters once is a part of what does not come straight."""
    got, sky = found(scene, cache.indirect_fog(6.0), lamps=False, density=0.2, color=[1.0] * 3)
    most = torch.pi * sky.color.max()
    assert got.scattered.mean() > 0.05 * most
    assert (got.scattered < most * (1 - got.passing.min())).all()


def test_segments_are_fine_enough(scene, monkeypatch):
    results = []
    for segments in (indirect._FOG_SEGMENTS, 60):
        monkeypatch.setattr(indirect, "_FOG_SEGMENTS", segments)
        rays = view_cache(scene).indirect_fog(6.0)
        results.append(found(scene, rays, density=0.2)[0])
    coarse, fine = results
    assert coarse.scattered.mean() == pytest.approx(fine.scattered.mean().item(), rel=0.08)
    assert coarse.haze.mean() == pytest.approx(fine.haze.mean().item(), rel=0.08)


LEARNED = {"density": 0.2, "color": [0.8, 0.6, 0.5], "anisotropy": 0.3, "falloff": 0.4, "offset": 0.3}


@pytest.mark.parametrize("name", LEARNED)
def test_gradients_match_finite_differences(scene, cache, name):
    values = {k: torch.tensor(v).reshape(-1) for k, v in LEARNED.items()}
    rays = cache.indirect_fog(6.0)

    def score(value):
        got, _ = found(scene, rays, **{**values, name: value})
        parts = (got.ambient, got.passing, got.path_transmittance, got.light_transmittance, got.scattered, got.mirrored)
        return sum(p.double().mean() * (i + 1) for i, p in enumerate(parts))

    given = values[name].clone().requires_grad_()
    (gradient,) = torch.autograd.grad(score(given), given)
    for i in range(len(given)):
        nudge = torch.zeros_like(given)
        nudge[i] = 2e-3
        difference = (score(values[name] + nudge) - score(values[name] - nudge)) / 4e-3
        assert gradient[i].item() == pytest.approx(difference.item(), rel=3e-2, abs=2e-3)


def test_a_picture_in_fog_is_finite_at_every_extreme(scene):
    proxy = Proxy(scene, SIZE)
    for density in (1e-4, 1.0, 100.0):
        for anisotropy in (-0.95, 0.95):
            values = {
                "volume/density": torch.tensor([density], requires_grad=True),
                "volume/anisotropy": torch.tensor([anisotropy], requires_grad=True),
                "volume/falloff": torch.tensor([2.0], requires_grad=True),
            }
            picture = proxy.render(values).linear
            picture.mean().backward()
            assert picture.isfinite().all()
            assert all(v.grad.isfinite().all() for v in values.values())


def test_fog_before_a_camera_that_sees_no_surface(scene):
    blind = replace(scene, camera=replace(scene.camera, clip=(0.01, 0.02)))
    picture = Proxy(blind, SIZE).render({"volume/density": torch.tensor([0.2])}).linear
    assert picture.isfinite().all()
    assert picture.max() > 0.0
