# SPDX-License-Identifier: Apache-2.0
"""Color formulas against published data and finite differences."""

import pytest
import torch

from proxy_renderer.color.tensors import (
    blackbody,
    ciede2000,
    lab_from_linear,
    lab_from_srgb,
    linear_from_srgb,
    srgb_from_linear,
)

# Sharma, Wu, Dalal 2005, table 1: L1 a1 b1, L2 a2 b2, CIEDE2000.
SHARMA = """
50 2.6772 -79.7751 50 0 -82.7485 2.0425
50 3.1571 -77.2803 50 0 -82.7485 2.8615
50 2.8361 -74.0200 50 0 -82.7485 3.4412
50 -1.3802 -84.2814 50 0 -82.7485 1.0000
50 -1.1848 -84.8006 50 0 -82.7485 1.0000
50 -0.9009 -85.5211 50 0 -82.7485 1.0000
50 0 0 50 -1 2 2.3669
50 -1 2 50 0 0 2.3669
50 2.4900 -0.0010 50 -2.4900 0.0009 7.1792
50 2.4900 -0.0010 50 -2.4900 0.0010 7.1792
50 2.4900 -0.0010 50 -2.4900 0.0011 7.2195
50 2.4900 -0.0010 50 -2.4900 0.0012 7.2195
50 -0.0010 2.4900 50 0.0009 -2.4900 4.8045
50 -0.0010 2.4900 50 0.0010 -2.4900 4.8045
50 -0.0010 2.4900 50 0.0011 -2.4900 4.7461
50 2.5 0 50 0 -2.5 4.3065
50 2.5 0 73 25 -18 27.1492
50 2.5 0 61 -5 29 22.8977
50 2.5 0 56 -27 -3 31.9030
50 2.5 0 58 24 15 19.4535
50 2.5 0 50 3.1736 0.5854 1.0000
50 2.5 0 50 3.2972 0 1.0000
50 2.5 0 50 1.8634 0.5757 1.0000
50 2.5 0 50 3.2592 0.3350 1.0000
60.2574 -34.0099 36.2677 60.4626 -34.1751 39.4387 1.2644
63.0109 -31.0961 -5.8663 62.8187 -29.7946 -4.0864 1.2630
61.2901 3.7196 -5.3901 61.4292 2.2480 -4.9620 1.8731
35.0831 -44.1164 3.7933 35.0232 -40.0716 1.5901 1.8645
22.7233 20.0904 -46.6940 23.0331 14.9730 -42.5619 2.0373
36.4612 47.8580 18.3852 36.2715 50.5065 21.2231 1.4146
90.8027 -2.0831 1.4410 91.1528 -1.6435 0.0447 1.4441
90.9257 -0.5406 -0.9208 88.6381 -0.8985 -0.7239 1.5381
6.7747 -0.2908 -2.4247 5.8714 -0.0985 -2.2286 0.6377
2.0776 0.0795 -1.1350 0.9033 -0.0636 -0.5514 0.9082
"""


def test_ciede2000_reproduces_the_published_pairs():
    rows = torch.tensor([[float(x) for x in line.split()] for line in SHARMA.split("\n") if line], dtype=torch.float64)
    difference = ciede2000(rows[:, :3], rows[:, 3:6])
    torch.testing.assert_close(difference, rows[:, 6], atol=5e-5, rtol=0)


@pytest.mark.parametrize(
    ("rgb", "lab"),
    [
        ((1, 1, 1), (100, 0, 0)),
        ((1, 0, 0), (53.24, 80.09, 67.20)),
        ((0, 0, 1), (32.30, 79.19, -107.86)),
        ((0, 0, 0), (0, 0, 0)),
    ],
)
def test_lab_of_the_primaries(rgb, lab):
    torch.testing.assert_close(
        lab_from_srgb(torch.tensor(rgb, dtype=torch.float64)), torch.tensor(lab, dtype=torch.float64), atol=0.01, rtol=0
    )


def test_srgb_round_trip():
    x = torch.linspace(0, 4, 1001, dtype=torch.float64)
    torch.testing.assert_close(linear_from_srgb(srgb_from_linear(x)), x, atol=1e-6, rtol=1e-6)
    assert srgb_from_linear(torch.tensor(0.5)).item() == pytest.approx(0.735357, abs=1e-5)


# bpy 5.2.3: light.temperature_color
BLENDER = {
    1000: (4.60136127, 0.0390419066, 0.0),
    1200: (3.96553278, 0.227897286, 0.0),
    2700: (1.93507671, 0.803530753, 0.191721484),
    4000: (1.41411614, 0.92364192, 0.53367424),
    6500: (1.04255211, 0.984052539, 1.03527153),
    10000: (0.871384084, 0.994924545, 1.43050897),
    16000: (0.826295495, 0.994508028, 1.56630766),
}


@pytest.mark.parametrize("kelvin", BLENDER)
def test_blackbody_is_blenders(kelvin):
    # Blender jumps by 0.07 % where its fit ends at 12000 K; the engine stays continuous.
    got = blackbody(torch.tensor(float(kelvin), dtype=torch.float64))
    torch.testing.assert_close(got, torch.tensor(BLENDER[kelvin], dtype=torch.float64), atol=1e-4, rtol=1e-3)


def test_gradients_match_finite_differences():
    torch.manual_seed(0)
    rgb = torch.rand(20, 3, dtype=torch.float64, requires_grad=True)
    lab = torch.tensor([[60.0, 20.0, -30.0]], dtype=torch.float64)
    assert torch.autograd.gradcheck(lambda x: ciede2000(lab_from_srgb(x), lab), rgb)
    kelvin = torch.tensor([1300.0, 2700.0, 5000.0, 9000.0], dtype=torch.float64, requires_grad=True)
    assert torch.autograd.gradcheck(blackbody, kelvin, eps=1e-2)


def test_gradients_are_finite_at_black_gray_and_equal_colors():
    rgb = torch.tensor([[0.0, 0, 0], [0.5, 0.5, 0.5], [1, 1, 1], [1, 0, 0]], requires_grad=True)
    lab = lab_from_srgb(rgb)
    for other in (lab.detach(), torch.zeros(4, 3)):
        (grad,) = torch.autograd.grad(ciede2000(lab, other).sum(), rgb, retain_graph=True)
        assert torch.isfinite(grad).all()
    (grad,) = torch.autograd.grad(lab_from_linear(rgb).sum() + srgb_from_linear(rgb).sum(), rgb)
    assert torch.isfinite(grad).all()
