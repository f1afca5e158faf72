# SPDX-License-Identifier: Apache-2.0
"""The film: OCIO views as tables, the grade's formulas, and gradients through all of it."""

from dataclasses import replace

import numpy as np
import pytest
import torch
from operation_tests import OperationTests, colors
from tiny_job import blender_config

from proxy_renderer.color.floats import lab_from_srgb
from proxy_renderer.color.view_transform import ViewTransform, apply_ocio
from proxy_renderer.planning.light_levels import radiance
from proxy_renderer.render import film
from proxy_renderer.render import film as grade
from proxy_renderer.render.film import Film
from proxy_renderer.scene import FilmSettings
from proxy_renderer.schema import PARAMETERS, VibeError
from proxy_renderer.schema.radiometry import TABLE_STOPS, TABLE_TOE

SPEC = FilmSettings(blender_config(), "sRGB", "AgX", "", transparent=False, working_space="Linear Rec.709")
SIZE = (20, 12)  # width, height
NEUTRAL = {p.family: torch.full((p.components,), p.default) for p in PARAMETERS if p.group == "film"}


@pytest.fixture
def picture():
    torch.manual_seed(1)
    return 2 ** (torch.rand(SIZE[1], SIZE[0], 3) * 8 - 6)


@pytest.mark.parametrize(
    ("view", "look"),
    [("Standard", ""), ("AgX", ""), ("AgX", "AgX - Punchy"), ("Filmic", "High Contrast"), ("Khronos PBR Neutral", "")],
)
def test_the_table_is_ocio(view, look):
    random = np.random.default_rng(0)
    tint = random.uniform(0, 1, (20000, 3)) ** random.choice([0.1, 1.0, 3.0], (20000, 1))
    colors = (tint / tint.max(-1, keepdims=True) * 2 ** random.uniform(-10, 5.5, (20000, 1))).astype(np.float32)
    exact = apply_ocio(colors, SPEC.ocio, "sRGB", view, look).clip(0, 1)
    got = ViewTransform(SPEC.ocio, "sRGB", view, look)(torch.from_numpy(colors)).clamp(0, 1).numpy()
    assert np.abs(got - exact).mean() < 0.3 / 255
    assert np.quantile(np.abs(got - exact), 0.99) < 2.5 / 255


def test_the_artists_compositor_is_a_table_in_stops(picture):
    """An exposure of a stop and a swap of red and blue, of which the table has no color exactly."""
    axis = TABLE_TOE * (2 ** torch.linspace(0, TABLE_STOPS, 33) - 1)
    blue, green, red = torch.meshgrid(axis, axis, axis, indexing="ij")
    graded = torch.stack((blue, green, red), -1) * 2
    table = torch.log2(graded / TABLE_TOE + 1)
    developed = Film(replace(SPEC, compositor=table.numpy()), SIZE).grade(picture, NEUTRAL)
    torch.testing.assert_close(developed, 2 * picture.flip(-1), rtol=0.01, atol=0.0)


def test_a_white_balance_comes_before_the_view(picture):
    matrix = ((0.9, -0.2, 0.0), (0.0, 1.1, 0.0), (0.2, 0.3, 1.3))
    balanced = Film(replace(SPEC, white_balance=matrix), SIZE).develop(picture, NEUTRAL)
    linear = (picture @ torch.tensor(matrix).T).numpy()
    exact = apply_ocio(linear, SPEC.ocio, "sRGB", "AgX").clip(0, 1)
    assert np.abs(balanced.numpy() - exact).mean() < 0.5 / 255


def shown(view):
    """A view's display values, in single or double precision."""

    def operation(linear):
        transform = ViewTransform(SPEC.ocio, "sRGB", view)
        transform._lut = transform._lut.to(linear.dtype)
        return transform(linear)

    return staticmethod(operation)


class _ViewTests(OperationTests):
    """A table of 65 colors in each direction: it comes within 1/255."""

    rtol, atol = 0.0, 1 / 255
    inputs = (colors(4, 5),)
    shape = (4, 5, 3)
    wrong = (torch.rand(3, 4),)


class TestStandardView(_ViewTests):
    """The sRGB curve of IEC 61966-2-1, and no more."""

    operation = shown("Standard")
    values = (
        ((torch.full((1, 3), 0.2140411),), 0.5),
        ((torch.tensor([[0.001, 0.2140411, 1.0]]),), [[0.01292, 0.5, 1.0]]),
        ((torch.zeros(1, 3),), 0.0),
    )


class TestFilmicView(_ViewTests):
    """Black, and the white of its log encoding, 16.29 times scene-linear one (Blender's Filmic, 6.5 stops over gray)."""

    operation = shown("Filmic")
    values = (((torch.zeros(1, 3),), 0.0), ((torch.full((1, 3), 0.18 * 2**6.5),), 1.0))


@pytest.mark.parametrize("view", ["AgX", "Filmic", "Standard", "Khronos PBR Neutral"])
def test_plans_know_the_grays_that_a_view_shows(view):
    """Powers of lamps are ranged by the L* of a white surface that faces them."""
    goals = (6.0, 20.0, 50.0, 75.0, 90.0)
    grays = np.array([[radiance(goal, view)] * 3 for goal in goals], np.float32)
    shown = apply_ocio(grays, SPEC.ocio, "sRGB", view, "").clip(0, 1)
    assert [lab_from_srgb(tuple(color))[0] for color in shown] == pytest.approx(goals, abs=2.0)


def test_an_unknown_view_is_refused():
    with pytest.raises(VibeError, match="No such view"):
        Film(replace(SPEC, view="No such view"), SIZE)
    with pytest.raises(VibeError, match="cannot be made"):
        Film(replace(SPEC, ocio="missing.ocio"), SIZE)


def test_a_view_of_an_older_default_configuration_is_found():
    """Blender's OpenColorIO may be older than the engine's, and "ocio://default" is its newest configuration."""
    older, gray = "ocio://cg-config-v2.2.0_aces-v1.3_ocio-v2.4", np.full((1, 3), 0.18, np.float32)
    view = ("sRGB - Display", "ACES 1.0 - SDR Video", "")
    assert apply_ocio(gray, "ocio://default", *view) == pytest.approx(apply_ocio(gray, older, *view))


def test_neutral_values_change_nothing(picture):
    film = Film(SPEC, SIZE)
    learning = {key: value.clone().requires_grad_() for key, value in NEUTRAL.items()}
    torch.testing.assert_close(film.grade(picture, learning), picture, atol=1e-5, rtol=1e-5)
    torch.testing.assert_close(film.develop(picture, learning), film.develop(picture, {}), atol=1e-5, rtol=1e-5)
    assert film.grade(picture, NEUTRAL) is picture


def test_formulas():
    color = torch.tensor([[[0.1, 0.4, 0.02]]])
    one = torch.ones(1)
    torch.testing.assert_close(grade.contrast(color, one * 2), 0.18 * (color / 0.18) ** 2)
    torch.testing.assert_close(grade.saturation(color, one * 0), torch.full((1, 1, 3), 0.30878))
    torch.testing.assert_close(grade.power(-color, one * 2), -color)
    turned = grade.turn_hue(torch.tensor([[[1.0, 0.0, 0.0], [0.2, 0.6, 0.4]]]), one * 120)
    torch.testing.assert_close(turned, torch.tensor([[[0.0, 1.0, 0.0], [0.4, 0.2, 0.6]]]))
    lifted = grade.lift_gamma_gain(color, one * 0.9, one * 2, one * 1.5)
    torch.testing.assert_close(lifted, (((color - 1) * 1.1 + 1) * 1.5).clamp_min(0).sqrt())
    assert grade.falloff(101, 51)[25, 50].item() == 0
    assert grade.falloff(4001, 3001)[0, 0].item() == pytest.approx(1, abs=1e-3)


def test_bloom_of_an_even_picture_is_its_highlight():
    glow = film.bloom(torch.full((32, 48, 3), 3.0))
    torch.testing.assert_close(glow, torch.full((32, 48, 3), 2.0))
    assert film.bloom(torch.full((32, 48, 3), 0.8)).abs().max() == 0


MOVED = {
    "exposure": 0.4, "gamma": 1.2, "grade_exposure": -0.3, "lift": 1.05, "midtone": 0.9, "gain": 1.1, "contrast": 1.2,
    "saturation": 1.3, "hue": 20.0, "grade_gamma": 0.9, "vignette": 0.4, "glare": 0.3,
}  # fmt: skip


@pytest.mark.parametrize("name", [name for name in MOVED if name not in ("exposure", "gamma")])
def test_gradients_of_the_grade(picture, name):
    key = f"film/{name}"
    values = {k: torch.full_like(v, MOVED[k.split("/")[1]], dtype=torch.float64) for k, v in NEUTRAL.items()}
    small = picture.double()[:3, :4] * 0.2
    film = Film(SPEC, (4, 3))
    given = values[key].requires_grad_()
    assert torch.autograd.gradcheck(lambda value: film.grade(small, {**values, key: value}), given)


@pytest.mark.parametrize("name", ["exposure", "gamma"])
def test_gradients_of_the_view(picture, name):
    film, key = Film(SPEC, SIZE), f"film/{name}"
    values = {f"film/{n}": torch.tensor([MOVED[n]]) for n in ("exposure", "gamma")}

    def score(value):
        return film.develop(picture, {**values, key: value}).double().square().mean()

    value = values[key].clone().requires_grad_()
    (gradient,) = torch.autograd.grad(score(value), value)
    difference = (score(values[key] + 5e-3) - score(values[key] - 5e-3)) / 1e-2
    assert gradient.item() == pytest.approx(difference.item(), rel=1e-2)


def test_gradients_are_finite_on_black_white_and_grey():
    picture = torch.tensor([0.0, 1e-9, 0.18, 1.0, 500.0])[:, None, None].repeat(1, 4, 3).requires_grad_()
    learning = {key: value.clone().requires_grad_() for key, value in NEUTRAL.items()}
    Film(SPEC, (4, 5)).develop(picture, learning).sum().backward()
    for tensor in (picture, *learning.values()):
        assert torch.isfinite(tensor.grad).all()
