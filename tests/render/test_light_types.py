# SPDX-License-Identifier: Apache-2.0
"""Types of light: lights of some size against sums over many points of them, radiometry, and types that are none."""

import math

import pytest
import torch
from operation_tests import OperationTests, number

from proxy_renderer.render.geometry.vectors import tangents
from proxy_renderer.render.lights.light_source import LightSource
from proxy_renderer.render.lights.light_types import LIGHT_TYPES
from proxy_renderer.scene import Light
from proxy_renderer.schema import radiometry

DOWN = torch.eye(3)
PLACE = torch.tensor([0.0, 0.0, 2.0])
UP = torch.tensor([[0.0], [0.0], [1.0]])


def made(kind, position, axes, size, **fields):
    light = Light("Lamp", kind, tuple(map(tuple, DOWN.tolist())), (0.0, 0.0, 2.0), **fields)
    cone = {"cone": size.new_tensor(light.spot_size)} if kind == "SPOT" else {}
    return LIGHT_TYPES[kind](light, torch.ones(3), position, axes, size, **cone)


def lamp(kind, size, **fields):
    return made(kind, PLACE, DOWN, torch.tensor(size), **fields)


def arriving(kind, **fields):
    """Irradiance, that of a surface that faces the light, and the solid angle (3, N) at points with normals (3, N)."""

    def operation(points, normals, position, axes, size):
        direct = made(kind, position, axes, size, **fields).irradiance(points, normals)
        return torch.stack((direct.irradiance, direct.frontal, direct.solid_angle))

    return staticmethod(operation)


def at(*places):
    """Points as columns, double precision."""
    return torch.tensor(places, dtype=torch.float64).T


def lit(*places, normal=(0.0, 0.0, 1.0), size=1.0):
    """Arguments of `arriving`: points with one normal below a light that stands at (0, 0, 2) and shines down."""
    points = at(*places)
    return points, at(normal).expand_as(points), PLACE.double(), DOWN.double(), number(size)


class _LightTests(OperationTests):
    """A type of light; a source of a power of 1 W, or an irradiance of 1 W/m²."""

    TILTED = at((0.1, -0.2, 0.9), (0.3, 0.1, 0.8))
    inputs = (at((0.4, 0.3, 0.1), (-0.7, 0.2, 0.3)), TILTED, *lit((0, 0, 0), size=0.5)[2:])
    shape = (3, 2)
    wrong = (torch.zeros(2, 4), torch.zeros(3, 4), *lit((0, 0, 0))[2:])


class TestPointLight(_LightTests):
    """A disc that faces the point, with the view factor r² / (d² + r²), as Blender's soft falloff has it."""

    FAR = 1 / (4 * math.pi * 8.01)
    operation = arriving("POINT")
    values = (
        (lit((0, 0, 0)), [[1 / (4 * math.pi * 5)]] * 2 + [[math.pi / 4]]),
        (lit((2, 0, 0), size=0.1), [[math.sqrt(0.5) * FAR], [FAR], [math.pi * 0.01 / 8]]),
        (lit((0, 0, 0), normal=(0, 0, -1.0)), [[0.0], [1 / (4 * math.pi * 5)], [math.pi / 4]]),
    )


class TestHardPointLight(_LightTests):
    """A sphere, whose view factor is r² / d²: close by brighter than Blender's disc of the same power."""

    operation = arriving("POINT", soft_falloff=False)
    values = ((lit((0, 0, 0)), [[1 / (4 * math.pi * 4)]] * 2 + [[math.pi / 4]]),)


class TestPointLightByArea(_LightTests):
    """Not normalized, its power is that of each square meter of the sphere: 1 W/m² of surface, r² / d² of that here."""

    operation = arriving("POINT", normalize=False, soft_falloff=False)
    values = ((lit((0, 0, 0), size=0.5), [[1 / 16]] * 2 + [[math.pi / 16]]),)


class TestSpotLight(_LightTests):
    """As bright as a point light inside, dark outside, half where the smoothstep of the cosine is halfway."""

    EDGE = math.cos(0.6)
    HALFWAY = (1 + EDGE) / 2
    ASIDE = 2 * math.sqrt(1 / HALFWAY**2 - 1)
    HALF = HALFWAY**2 / 4 / (4 * math.pi) / 2
    operation = arriving("SPOT", spot_size=1.2, spot_blend=1.0)
    values = (
        (lit((0, 0, 0), size=1e-3), [[1 / (16 * math.pi)]] * 2 + [[math.pi * 1e-6 / 4]]),
        (lit((2, 0, 0), (0, 2, 0), size=1e-3), [[0.0]] * 2 + [[math.pi * 1e-6 / 8]]),
        (lit((ASIDE, 0, 0), size=1e-3), [[HALF * HALFWAY], [HALF], [math.pi * 1e-6 * HALFWAY**2 / 4]]),
    )


def rectangle(width, height, distance):
    """View factor of a rectangle for a patch that faces its middle (Howell's catalog, B-4, four times)."""
    x, y = width / 2 / distance, height / 2 / distance
    a, b = math.hypot(1, x), math.hypot(1, y)
    return 2 / math.pi * (x / a * math.atan(y / a) + y / b * math.atan(x / b))


class TestAreaLight(_LightTests):
    """Rectangles of radiance 1 / (pi area); what faces them takes them for a disc of the same area."""

    operation = arriving("AREA", shape="RECTANGLE", aspect=0.5)
    DISC = 0.5 / (4 + 0.5 / math.pi)
    BEHIND = (0.0, 0.0, 3.0)
    values = (
        (lit((0, 0, 0)), [[rectangle(1, 0.5, 2) / 0.5], [DISC / math.pi / 0.5], [DISC]]),
        (lit(BEHIND, normal=(0, 0, -1.0)), [[0.0], [0.0], [0.0]]),
    )


class TestSunLight(_LightTests):
    """Lambert's cosine law, and the solid angle of a cap."""

    operation = arriving("SUN")
    CAP = 2 * math.pi * (1 - math.cos(0.1))
    values = (
        (lit((0, 0, 0), (9, 9, 9), size=0.2), [[1.0]] * 2 + [[CAP]]),
        (lit((0, 0, 0), normal=(math.sqrt(0.75), 0, 0.5), size=0.2), [[0.5], [1.0], [CAP]]),
        (lit((0, 0, 0), normal=(0, 0, -1.0), size=0.2), [[0.0], [1.0], [CAP]]),
    )

    def test_gradient(self):
        """Not along the light's place, which nothing depends on."""
        points, normals, position, axes, size = self.inputs
        parts = [t.clone().requires_grad_() for t in (normals, axes, size)]
        assert torch.autograd.gradcheck(lambda n, a, s: self.operation(points, n, position, a, s), parts)


def floor(reach=3.0, count=25):
    x = torch.linspace(0.0, reach, count)
    return torch.stack((x, torch.zeros_like(x), torch.zeros_like(x)))


@pytest.mark.parametrize(("size", "blend"), [(0.02, 0.2), (0.6, 0.15), (0.6, 1.0), (1.0, 0.4)])
def test_the_rim_of_a_large_spot_is_the_mean_over_its_disc(size, blend):
    spot = lamp("SPOT", size, spot_size=1.2, spot_blend=blend)
    points = floor()
    light = spot.irradiance(points, UP.expand_as(points))
    plain = lamp("POINT", size).irradiance(points, UP.expand_as(points))
    across, up = (t[:, None] for t in tangents(light.toward))
    torch.manual_seed(0)
    radius, angle = size * torch.rand(4000, 1).sqrt(), 2 * math.pi * torch.rand(4000, 1)
    target = PLACE[:, None, None] + radius * (across * angle.cos() + up * angle.sin()) - points[:, None]
    shares = spot.directivity((target / target.norm(dim=0)).flatten(1)).view(4000, -1)
    torch.testing.assert_close(light.irradiance / plain.irradiance, shares.mean(0), atol=0.05, rtol=0.05)


@pytest.mark.parametrize("degrees", [40.0, 60.0, 120.0])
@pytest.mark.parametrize("shape", ["SQUARE", "DISK"])
def test_a_focused_area_light_is_the_sum_over_its_area(degrees, shape):
    focused = lamp("AREA", 1.0, spread=math.radians(degrees), shape=shape)
    points = floor()
    normals = UP.expand_as(points)
    irradiance = focused.irradiance(points, normals).irradiance
    torch.manual_seed(0)
    u, v = focused.half_axes()
    x, y = 2 * torch.rand(2, 4000, 1) - 1
    offset = PLACE[:, None, None] + u[:, None] * x + v[:, None] * y - points[:, None]
    squared = (offset * offset).sum(0)
    cosine = offset[2] / squared.sqrt()
    each = cosine * cosine / squared * focused.spread(cosine.flatten()).view(cosine.shape)
    wanted = each.mean(0) / math.pi  # radiance 1 / (pi area), times the area
    torch.testing.assert_close(irradiance, wanted, atol=0.06 * float(wanted.max()), rtol=0.05)


@pytest.mark.parametrize("kind", sorted(LIGHT_TYPES))
def test_radiometry_agrees_with_the_renderer(kind):
    point = torch.zeros(3, 1)
    irradiance = lamp(kind, 0.01, shape="SQUARE").irradiance(point, UP).irradiance.item()
    assert irradiance / math.pi == pytest.approx(radiometry.radiance(kind, 1.0, 2.0), rel=1e-3)


def test_a_type_of_light_that_leaves_out_an_answer_cannot_be_made():
    class Laser(LightSource):
        energy_name, at_infinity, segment_parts = "power", False, 1

    point = lamp("POINT", 1.0)
    with pytest.raises(TypeError, match="irradiance"):
        Laser(point.light, point.color, point.position, point.axes, point.size)
