# SPDX-License-Identifier: Apache-2.0
"""Operations of the grade, of surfaces and of refraction, one by one."""

import math

import torch
from operation_tests import OperationTests, colors, number

from proxy_renderer.render import film as grade
from proxy_renderer.render.material import albedo
from proxy_renderer.render.transport.secondary_hits import refract

GRAY = torch.full((2, 2, 3), 0.18)
FLAT = torch.rand(2, 2)


class _GradeTests(OperationTests):
    """An operation of the grade on a picture and one number."""

    shape = (4, 5, 3)
    wrong = (FLAT, torch.tensor(1.0))


class TestPower(_GradeTests):
    operation = staticmethod(grade.power)
    inputs = (colors(4, 5), number(0.7))
    values = (((torch.full((1, 1, 3), 0.25), torch.tensor(0.5)), 0.5),)


class TestContrast(_GradeTests):
    operation = staticmethod(grade.contrast)
    inputs = (colors(4, 5), number(1.3))
    values = (((GRAY, torch.tensor(1.7)), 0.18), ((2 * GRAY, torch.tensor(2.0)), 0.72))


class TestSaturation(_GradeTests):
    operation = staticmethod(grade.saturation)
    inputs = (colors(4, 5), number(1.2))
    values = (((torch.tensor([[[1.0, 0.0, 0.0]]]), torch.tensor(0.0)), 0.2126), ((GRAY, torch.tensor(2.0)), 0.18))


class TestTurnHue(_GradeTests):
    operation = staticmethod(grade.turn_hue)
    inputs = (colors(4, 5), number(25.0))
    values = (((torch.tensor([[[1.0, 0.0, 0.0]]]), torch.tensor(120.0)), [0.0, 1.0, 0.0]),)


class TestLiftGammaGain(OperationTests):
    operation = staticmethod(grade.lift_gamma_gain)
    inputs = (colors(4, 5), *(torch.tensor([0.9, 1.0, 1.1], dtype=torch.float64) for _ in range(3)))
    shape = (4, 5, 3)
    wrong = (colors(4, 5), torch.ones(2), torch.ones(3), torch.ones(3))
    values = (((GRAY, torch.ones(3), torch.ones(3), torch.tensor([1.0, 2.0, 3.0])), [0.18, 0.36, 0.54]),)


class TestAlbedoBasis(OperationTests):
    operation = staticmethod(albedo.basis)
    inputs = (torch.linspace(0.1, 0.9, 6, dtype=torch.float64),)
    shape = (7, 6)
    wrong = (torch.rand(3, 4),)
    values = (((torch.tensor([1.0]),), [[1.0]] + [[0.0]] * 6), ((torch.tensor([0.0]),), 1.0))


class TestRefract(OperationTests):
    """By 45 degrees into glass: Snell's sine behind the surface."""

    DOWN = (math.sqrt(0.5), 0.0, -math.sqrt(0.5))
    operation = staticmethod(lambda toward, normal, ratio: refract(toward, normal, ratio)[0])
    inputs = (
        torch.tensor([[0.6], [0.0], [-0.8]], dtype=torch.float64),
        torch.tensor([[0.0], [0.0], [1.0]], dtype=torch.float64),
        1 / 1.5,
    )
    shape = (3, 1)
    wrong = (torch.rand(2, 4), torch.rand(3, 4), 1.0)
    SINE = math.sqrt(0.5) / 1.5
    values = (
        (
            (torch.tensor(DOWN)[:, None], torch.tensor([[0.0], [0.0], [1.0]]), 1 / 1.5),
            [[SINE], [0.0], [-math.sqrt(1 - SINE**2)]],
        ),
    )
