# SPDX-License-Identifier: Apache-2.0
"""Lamps of some size against sums over many points of them."""

import math
from dataclasses import replace

import pytest
import torch

from proxy_renderer.render.geometry.vectors import tangents
from proxy_renderer.render.lights import cones
from proxy_renderer.render.lights.irradiance import arrival
from proxy_renderer.render.lights.lamps import Lamp, half_axes
from proxy_renderer.scene import Light

DOWN = torch.eye(3)
PLACE = torch.tensor([0.0, 0.0, 2.0])
UP = torch.tensor([[0.0], [0.0], [1.0]])


def lamp(kind, size, **fields):
    light = Light("Lamp", kind, tuple(map(tuple, DOWN.tolist())), (0.0, 0.0, 2.0), **fields)
    return Lamp(light, torch.ones(3), PLACE, DOWN, torch.tensor(size))


def floor(reach=3.0, count=25):
    x = torch.linspace(0.0, reach, count)
    return torch.stack((x, torch.zeros_like(x), torch.zeros_like(x)))


@pytest.mark.parametrize(("size", "blend"), [(0.02, 0.2), (0.6, 0.15), (0.6, 1.0), (1.0, 0.4)])
def test_the_rim_of_a_large_spot_is_the_mean_over_its_disc(size, blend):
    spot = lamp("SPOT", size, spot_size=1.2, spot_blend=blend)
    points = floor()
    found = arrival(spot, points, UP.expand_as(points))
    plain = arrival(lamp("POINT", size), points, UP.expand_as(points))
    across, up = tangents(found.toward)
    torch.manual_seed(0)
    total = torch.zeros(points.shape[1])
    for _ in range(4000):
        radius, angle = size * math.sqrt(torch.rand(())), 2 * math.pi * float(torch.rand(()))
        target = PLACE[:, None] + radius * (across * math.cos(angle) + up * math.sin(angle)) - points
        total += cones.spot_cone(spot, target / target.norm(dim=0))
    torch.testing.assert_close(found.irradiance / plain.irradiance, total / 4000, atol=0.05, rtol=0.05)


@pytest.mark.parametrize("degrees", [40.0, 60.0, 120.0])
@pytest.mark.parametrize("shape", ["SQUARE", "DISK"])
def test_a_focused_area_light_is_the_sum_over_its_area(degrees, shape):
    focused = lamp("AREA", 1.0, spread=math.radians(degrees), shape=shape)
    points = floor()
    normals = UP.expand_as(points)
    found = arrival(focused, points, normals).irradiance
    torch.manual_seed(0)
    u, v = half_axes(focused)
    total = torch.zeros(points.shape[1])
    for _ in range(4000):
        x, y = (2 * torch.rand(2) - 1).tolist()
        offset = PLACE[:, None] + u * x + v * y - points
        squared = (offset * offset).sum(0)
        cosine = offset[2] / squared.sqrt()
        total += cosine * cosine / squared * cones.spread(focused, cosine)
    wanted = total / 4000 / math.pi  # radiance 1 / (pi area), times the area
    torch.testing.assert_close(found, wanted, atol=0.06 * float(wanted.max()), rtol=0.05)


def test_a_hard_falloff_is_a_spheres():
    """Blender's soft falloff takes a lamp for a disc: close by it is darker than a sphere of the same power."""
    points = torch.tensor([[0.0], [0.0], [0.0]])
    soft = lamp("POINT", 1.0)
    hard = replace(soft, light=replace(soft.light, soft_falloff=False))
    assert arrival(hard, points, UP).irradiance.item() == pytest.approx(1 / (4 * math.pi * 4))
    assert arrival(soft, points, UP).irradiance.item() == pytest.approx(1 / (4 * math.pi * 5))
