# SPDX-License-Identifier: Apache-2.0
"""Fog against closed forms, brute-force integration along rays, and finite differences."""

import math
from dataclasses import replace

import pytest
import torch
from operation_tests import OperationTests, colors, number
from tiny_job import write_job

from lab.bench.scenes import balls
from proxy_renderer.render.geometry.camera import view_of
from proxy_renderer.render.lights.light_types import light_sources
from proxy_renderer.render.transport.fog import DIRECTIONS, FogMedium, SingleScattering
from proxy_renderer.scene import FogBounds, load_scene
from proxy_renderer.scene.values import RenderValues

SIZE = (64, 48)
UP = torch.tensor([[0.0], [0.0], [1.0]])
NO_WORLD = torch.zeros(3, 1)


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    return load_scene(write_job(tmp_path_factory.mktemp("job")))


def settings(scene, **volume):
    values = {f"volume/{k}": torch.as_tensor(v, dtype=torch.float32).reshape(-1) for k, v in volume.items()}
    return RenderValues(scene, values, "cpu")


def fog(scene, **volume):
    return FogMedium(scene, settings(scene, **volume))


def integrate(scene, start, toward, length, falloff, offset=0.0, steps=10000):
    """Fog along a ray by brute force."""
    t = (torch.arange(steps, dtype=torch.float64) + 0.5) / steps * length
    points = start.double() + toward.double() * t
    center, half = (
        torch.tensor(v, dtype=torch.float64)[:, None] for v in (scene.volume.center, scene.volume.half_size)
    )
    inside = ((points - center).abs() <= half).all(0)
    height = (points[2] - scene.volume.base - offset).clamp_min(0)
    return (torch.exp(-falloff * height) * inside).sum().item() * length / steps


@pytest.mark.parametrize("falloff", [0.0, 1e-5, 0.3, 4.0])
def test_thickness_is_the_integral(scene, falloff):
    medium = fog(scene, density=1.0, falloff=falloff, offset=0.5)
    torch.manual_seed(0)
    for start in ([0.0, -3.0, 1.0], [-20.0, 1.0, 2.0], [0.0, 0.0, 30.0], [2.0, 2.0, 0.6]):
        begin = torch.tensor(start)[:, None]
        for _ in range(6):
            toward = torch.nn.functional.normalize(torch.randn(3, 1), dim=0)
            wanted = integrate(scene, begin, toward, 25.0, falloff, 0.5)
            assert medium.thickness(begin, toward, 25.0).item() == pytest.approx(wanted, rel=2e-3, abs=2e-3)


class DoubleValues(RenderValues):
    """Values in double precision, for gradients against finite differences."""

    def scalar(self, key, default=0.0):
        return self.given[key].reshape(-1)[0] if key in self.given else super().scalar(key, default)


def passing(kind):
    """Transmittance of a fog of some density, falloff and height above 1 m, between ±3 m or everywhere."""
    bounds = FogBounds(kind, (0.0, 0.0, 0.0), (3.0, 3.0, 3.0), 1.0)
    scene = replace(balls(1, 1, 1), volume=bounds)

    def operation(density, falloff, offset, start, toward, distance):
        given = {"volume/density": density, "volume/falloff": falloff, "volume/offset": offset}
        return FogMedium(scene, DoubleValues(scene, given, "cpu")).transmittance(start, toward, distance)

    return staticmethod(operation)


def along(density, falloff, offset, start, toward, distance):
    """Arguments of `passing` for one ray."""
    ray = (torch.tensor(v, dtype=torch.float64)[:, None] for v in (start, toward))
    return number(density), number(falloff), number(offset), *ray, distance


ALOFT, SLANTED = (0.0, 0.0, 1.0), (0.8, 0.0, 0.6)


class TestBoxOfFog(OperationTests):
    """Beer and Lambert's law over the part of the way that is in the fog."""

    operation = passing("box")
    inputs = (
        number(0.3), number(0.4), number(0.2), 2 * colors(4).T, torch.nn.functional.normalize(colors(4).T - 0.4, dim=0),
        torch.tensor([0.7, 2.0, 5.0, 9.0], dtype=torch.float64),
    )  # fmt: skip
    shape = (4,)
    wrong = (number(0.3), number(0.0), number(0.0), torch.zeros(2, 4), torch.zeros(2, 4), 1.0)
    values = (
        (along(0.3, 0.0, 0.0, (0, 0, -2), ALOFT, math.inf), math.exp(-0.3 * 5)),
        (along(0.3, 0.0, 0.0, (0, 0, -2), ALOFT, 2.0), math.exp(-0.3 * 2)),
        (along(0.3, 0.0, 0.0, (-9, 0, 0), (1, 0, 0), math.inf), math.exp(-0.3 * 6)),
        (along(0.3, 0.0, 0.0, (-9, 0, 0), (1, 0, 0), 5.0), 1.0),
        (along(0.3, 0.0, 0.0, (0, 9, 0), (1, 0, 0), math.inf), 1.0),
    )


class TestEndlessFog(OperationTests):
    """It thins above 1.5 m by exp(-h / 2): a way up from there to h has (1 - exp(-h / 2)) / (1 / 2) of its depth."""

    operation = passing("world")
    inputs = TestBoxOfFog.inputs
    shape = (4,)
    wrong = TestBoxOfFog.wrong
    values = (
        (along(0.1, 0.5, 0.5, (0, 0, 1.5), ALOFT, math.inf), math.exp(-0.1 * 2)),
        (along(0.1, 0.5, 0.5, (0, 0, 0.5), ALOFT, math.inf), math.exp(-0.1 * 3)),
        (along(0.1, 0.5, 0.5, (0, 0, 1.5), SLANTED, 5.0), math.exp(-0.1 * 2 * (1 - math.exp(-1.5)) / 0.6)),
        (along(0.1, 0.5, 0.5, (0, 0, 3.5), (1, 0, 0), 4.0), math.exp(-0.1 * 4 * math.exp(-1))),
        (along(0.1, 0.5, 0.5, (0, 0, 1.0), (1, 0, 0), 4.0), math.exp(-0.1 * 4)),
    )


def test_an_infinite_fog_swallows_the_sun(scene):
    everywhere = replace(scene, volume=replace(scene.volume, kind="world"))
    assert fog(everywhere, density=0.1).transmittance(torch.zeros(3, 1), UP, math.inf).item() == 0


def in_the_open(origin, toward, distance, without):
    """Nothing is in the way of light."""
    return torch.ones_like(distance)


def haze(scene, volume, world=NO_WORLD, lamps=None, clear=in_the_open):
    """Scattered light (3,) and transmittance in the middle of the picture, up to the far side of the box."""
    s = settings(scene, **volume)
    view = view_of(scene, s, SIZE)
    found = SingleScattering(clear).scatter(
        FogMedium(scene, s), view, 6.0, light_sources(scene, s) if lamps is None else lamps, world
    )
    place = torch.tensor([[32.0], [24.0]])
    light, passing = found.look_up(place, torch.tensor([math.inf]))
    return light[:, 0], passing[0]


def brute_force(scene, s, lamp, steps=8000):
    """Single scattering of a small lamp along the middle ray."""
    medium, view = FogMedium(scene, s), view_of(scene, s, SIZE)
    start, toward = view.rays(torch.tensor([[32.0], [24.0]]))
    length = 30.0
    t = (torch.arange(steps) + 0.5) / steps * length
    points = start + toward * t
    offset = lamp.position[:, None] - points
    distance = offset.norm(dim=0)
    to_lamp = offset / distance
    g = medium.anisotropy
    cosine = (to_lamp * toward).sum(0)
    phase = (1 - g * g) / (4 * math.pi) / (1 + g * g - 2 * g * cosine) ** 1.5
    intensity = (lamp.axes[:, 2] @ to_lamp).clamp_min(0) / math.pi
    here = medium.thickness(points, UP.expand_as(points), 1e-2) / 1e-2  # relative density
    incoming = intensity / distance**2 * medium.transmittance(points, to_lamp, distance) * phase * here
    reaching = medium.transmittance(start.expand_as(points), toward.expand_as(points), t)
    return (incoming * reaching).sum() * length / steps * medium.density * medium.albedo * lamp.color


@pytest.mark.parametrize(
    "volume",
    [
        {"density": 0.03},
        {"density": 0.3, "color": [0.9, 0.5, 0.2]},
        {"density": 1.5},
        {"density": 0.3, "anisotropy": 0.6},
        {"density": 0.5, "falloff": 0.8, "offset": 0.4},
    ],
    ids=str,
)
def test_a_lamp_in_fog_is_the_integral(scene, volume):
    s = settings(scene, **volume)
    lamp = light_sources(scene, s)[0]
    light, _ = haze(scene, volume, lamps=[lamp])
    torch.testing.assert_close(light, brute_force(scene, s, lamp), rtol=0.06, atol=1e-4)


def test_an_even_world_in_white_endless_fog_scatters_no_more_than_it_sends(scene):
    light, passing = haze(scene, {"density": 0.05, "color": [1.0] * 3}, torch.ones(3, 1), lamps=[])
    assert passing > 0.1
    assert (light < 1 - passing).all()
    assert (light > 0.5 * (1 - passing)).all()


def test_shadows_are_traced_once_for_a_camera_that_stands_still(scene):
    calls = []

    def clear(origin, toward, distance, without):
        calls.append(origin.shape[1])
        return torch.zeros_like(distance)

    s = settings(scene, density=0.2)
    view, volume = view_of(scene, s, SIZE), SingleScattering(clear)
    for _ in range(3):
        found = volume.scatter(FogMedium(scene, s), view, 6.0, light_sources(scene, s), torch.ones(3, 1))
    light, _ = found.look_up(torch.tensor([[32.0], [24.0]]), torch.tensor([5.0]))
    assert light.abs().max() == 0
    assert len(calls) == 3  # two lamps and the world


def test_world_directions_integrate_polynomials():
    weights = torch.tensor([1 / 15] * 6 + [3 / 40] * 8)
    assert weights.sum().item() == pytest.approx(1)
    torch.testing.assert_close((DIRECTIONS * weights) @ DIRECTIONS.T, torch.eye(3) / 3, atol=1e-6, rtol=0)
    assert DIRECTIONS[2].abs().min() > 0.05


LEARNED = {"density": 0.2, "color": [0.8, 0.6, 0.5], "anisotropy": 0.3, "falloff": 0.4, "offset": 0.3}


@pytest.mark.parametrize("name", LEARNED)
@pytest.mark.parametrize("density", [0.0, 0.2])
def test_gradients_match_finite_differences(scene, name, density):
    values = {k: torch.tensor(v).reshape(-1) for k, v in {**LEARNED, "density": density}.items()}
    step = 1e-3

    def score(value):
        light, passing = haze(scene, {**values, name: value}, torch.tensor([[0.3], [0.5], [0.9]]))
        return (light.double() * torch.tensor([1.0, 2.0, 3.0])).sum() + passing.double()

    given = values[name].clone().requires_grad_()
    (gradient,) = torch.autograd.grad(score(given), given)
    for i in range(len(given)):
        nudge = torch.zeros_like(given)
        nudge[i] = step
        difference = (score(values[name] + nudge) - score(values[name] - nudge)) / (2 * step)
        assert gradient[i].item() == pytest.approx(difference.item(), rel=2e-2, abs=2e-3)


def test_fog_that_is_not_there_costs_nothing(scene):
    assert not fog(scene, density=0.0).active
    assert fog(scene, density=0.01).active
    assert FogMedium(scene, RenderValues(scene, {"volume/density": torch.zeros(1, requires_grad=True)}, "cpu")).active
