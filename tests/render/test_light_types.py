# SPDX-License-Identifier: Apache-2.0
"""Types of light: lights of some size against sums over many points of them, radiometry, and types that are none."""

import math
from dataclasses import replace

import pytest
import torch

from proxy_renderer.bench.scenes import balls
from proxy_renderer.render.geometry.vectors import tangents
from proxy_renderer.render.lights.types import LIGHT_TYPES, light_sources, light_type
from proxy_renderer.render.lights.types.light_source import LightSource
from proxy_renderer.scene import Light
from proxy_renderer.scene.values import RenderValues
from proxy_renderer.schema import VibeError, radiometry

DOWN = torch.eye(3)
PLACE = torch.tensor([0.0, 0.0, 2.0])
UP = torch.tensor([[0.0], [0.0], [1.0]])


def lamp(kind, size, **fields):
    light = Light("Lamp", kind, tuple(map(tuple, DOWN.tolist())), (0.0, 0.0, 2.0), **fields)
    return light_type(kind)(light, torch.ones(3), PLACE, DOWN, torch.tensor(size))


def floor(reach=3.0, count=25):
    x = torch.linspace(0.0, reach, count)
    return torch.stack((x, torch.zeros_like(x), torch.zeros_like(x)))


@pytest.mark.parametrize(("size", "blend"), [(0.02, 0.2), (0.6, 0.15), (0.6, 1.0), (1.0, 0.4)])
def test_the_rim_of_a_large_spot_is_the_mean_over_its_disc(size, blend):
    spot = lamp("SPOT", size, spot_size=1.2, spot_blend=blend)
    points = floor()
    light = spot.irradiance(points, UP.expand_as(points))
    plain = lamp("POINT", size).irradiance(points, UP.expand_as(points))
    across, up = tangents(light.toward)
    torch.manual_seed(0)
    total = torch.zeros(points.shape[1])
    for _ in range(4000):
        radius, angle = size * math.sqrt(torch.rand(())), 2 * math.pi * float(torch.rand(()))
        target = PLACE[:, None] + radius * (across * math.cos(angle) + up * math.sin(angle)) - points
        total += spot.directivity(target / target.norm(dim=0))
    torch.testing.assert_close(light.irradiance / plain.irradiance, total / 4000, atol=0.05, rtol=0.05)


@pytest.mark.parametrize("degrees", [40.0, 60.0, 120.0])
@pytest.mark.parametrize("shape", ["SQUARE", "DISK"])
def test_a_focused_area_light_is_the_sum_over_its_area(degrees, shape):
    focused = lamp("AREA", 1.0, spread=math.radians(degrees), shape=shape)
    points = floor()
    normals = UP.expand_as(points)
    irradiance = focused.irradiance(points, normals).irradiance
    torch.manual_seed(0)
    u, v = focused.half_axes()
    total = torch.zeros(points.shape[1])
    for _ in range(4000):
        x, y = (2 * torch.rand(2) - 1).tolist()
        offset = PLACE[:, None] + u * x + v * y - points
        squared = (offset * offset).sum(0)
        cosine = offset[2] / squared.sqrt()
        total += cosine * cosine / squared * focused.spread(cosine)
    wanted = total / 4000 / math.pi  # radiance 1 / (pi area), times the area
    torch.testing.assert_close(irradiance, wanted, atol=0.06 * float(wanted.max()), rtol=0.05)


def test_a_hard_falloff_is_a_spheres():
    """Blender's soft falloff takes a lamp for a disc: close by it is darker than a sphere of the same power."""
    points = torch.tensor([[0.0], [0.0], [0.0]])
    soft = lamp("POINT", 1.0)
    hard = replace(soft, light=replace(soft.light, soft_falloff=False))
    assert hard.irradiance(points, UP).irradiance.item() == pytest.approx(1 / (4 * math.pi * 4))
    assert soft.irradiance(points, UP).irradiance.item() == pytest.approx(1 / (4 * math.pi * 5))


@pytest.mark.parametrize("kind", sorted(LIGHT_TYPES))
def test_radiometry_agrees_with_the_renderer(kind):
    point = torch.zeros(3, 1)
    irradiance = lamp(kind, 0.01, shape="SQUARE").irradiance(point, UP).irradiance.item()
    assert irradiance / math.pi == pytest.approx(radiometry.radiance(kind, 1.0, 2.0), rel=1e-3)


def test_an_unknown_type_of_light_is_named():
    scene = balls(1, 1)
    scene = replace(scene, lights=(replace(scene.lights[0], type="LASER"),))
    with pytest.raises(VibeError, match="LASER") as error:
        light_sources(scene, RenderValues(scene, {}, "cpu"))
    assert all(kind in error.value.remedy for kind in LIGHT_TYPES)


def test_a_type_of_light_that_leaves_out_an_answer_cannot_be_made():
    class Laser(LightSource):
        energy_name, at_infinity, segment_parts = "power", False, 1

    point = lamp("POINT", 1.0)
    with pytest.raises(TypeError, match="irradiance"):
        Laser(point.light, point.color, point.position, point.axes, point.size)
