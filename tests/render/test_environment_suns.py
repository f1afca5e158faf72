# SPDX-License-Identifier: Apache-2.0
"""Bright parts of a picture of the world become lamps; nothing is lost, nothing is counted twice."""

import math

import pytest
import torch

from proxy_renderer.render.geometry.vectors import texels
from proxy_renderer.render.lights.environment import Environment, Sky, split_suns


def picture(height=128, sky=0.5, sun=200.0, radius=3.0, azimuth=40.0, elevation=35.0):
    """An even sky (1, 3, H, 2H) with a disc in it, its direction (3,), and the disc's irradiance."""
    toward, solid = texels(height, 2 * height, torch.device("cpu"))
    a, e = math.radians(azimuth), math.radians(elevation)
    place = torch.tensor([math.cos(e) * math.cos(a), math.cos(e) * math.sin(a), math.sin(e)])
    inside = (place @ toward > math.cos(math.radians(radius))).float()
    color = torch.tensor([1.0, 0.8, 0.6])[:, None] * sun
    image = sky + color * inside
    return image.view(1, 3, height, -1), place, (color * inside) @ solid


def test_texels_cover_the_sphere():
    toward, solid = texels(64, 128, torch.device("cpu"))
    assert solid.sum().item() == pytest.approx(4 * math.pi, rel=1e-3)
    assert (toward @ solid).abs().max() < 1e-3


@pytest.mark.parametrize("radius", [1.5, 3.0, 8.0])
def test_a_sun_is_found_where_it_is(radius):
    image, place, energy = picture(radius=radius)
    _, rest, suns = split_suns(image)
    assert len(suns) == 1
    assert suns[0].toward @ place > math.cos(math.radians(0.5))
    torch.testing.assert_close(suns[0].color, energy, rtol=0.05, atol=0.0)
    assert math.degrees(suns[0].angle) == pytest.approx(2 * radius, rel=0.15)
    torch.testing.assert_close(rest, torch.full_like(rest, 0.5), atol=0.02, rtol=0.0)


def test_an_even_sky_and_a_dark_one_have_none():
    for level in (0.7, 0.0):
        image = torch.full((1, 3, 64, 128), level)
        _, rest, suns = split_suns(image)
        assert not suns
        assert torch.equal(rest, image)


def test_a_small_light_stays_in_the_picture():
    assert not split_suns(picture(sun=1.0)[0])[2]


def sky_with(image, turn):
    environment = Environment.__new__(Environment)
    environment.hidden = ()
    environment.suns = split_suns(image)[2]
    environment.whole = image
    return Sky(environment, torch.ones(3), turn, torch.ones(3), turn)


@pytest.mark.parametrize("degrees", [0.0, 25.0, 200.0])
def test_a_sun_turns_with_the_picture(degrees):
    """Where the turned picture is brightest, there stands the lamp."""
    image, place, _ = picture()
    turn = torch.tensor(math.radians(degrees), requires_grad=True)
    lamp = sky_with(image, turn).lamps[0]
    toward, _ = texels(128, 256, torch.device("cpu"))
    x, y, z = toward
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    mapped = torch.stack((c * x - s * y, s * x + c * y, z))  # what `Sky._place` adds to the azimuth
    brightest = toward[:, int((place @ mapped).argmax())]
    assert lamp.axes[:, 2].detach() @ brightest > math.cos(math.radians(1.5))
    up = torch.tensor([[1.0], [0.0], [0.0]])
    lit = lamp.irradiance(torch.zeros(3, 1), up).irradiance
    if lit.item() > 0:
        (gradient,) = torch.autograd.grad(lit.sum(), turn)
        angle = math.radians(40.0 - degrees)
        assert gradient.item() == pytest.approx(math.cos(math.radians(35.0)) * math.sin(angle), abs=0.03)


@pytest.mark.parametrize("height", [1, 2, 4, 16, 64])
def test_an_even_sky_has_no_sun(height: int) -> None:
    picture = torch.tensor([1.0, 0.0, 1.0])[None, :, None, None].expand(1, 3, height, 2 * height)
    _, rest, suns = split_suns(picture)
    assert not suns
    assert torch.equal(rest, picture)
