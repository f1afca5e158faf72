# SPDX-License-Identifier: Apache-2.0
"""Colors as torch tensors (..., 3): spaces, CIEDE2000, blackbody light, look-up tables. All gradients are finite."""

import math

import torch
from jaxtyping import Float
from torch import Tensor
from torch.nn import functional

from . import constants as c

_TINY = 1e-12
_PARTS = 16  # number of parts into which `trilinear` divides its look-ups


def luminance(linear: Float[Tensor, "*pixels 3"]) -> Float[Tensor, "*pixels 1"]:
    """Luminance (..., 1) of linear Rec.709 (..., 3)."""
    return (linear * linear.new_tensor(c.LUMINANCE_WEIGHTS)).sum(-1, keepdim=True)


def srgb_from_linear(linear: Float[Tensor, "*any"]) -> Float[Tensor, "*any"]:
    """sRGB-encoded values of linear light (any shape, ≥ 0), by IEC 61966-2-1; values above 1 are not clamped."""
    curved = c.SRGB_SCALE * linear.clamp_min(c.SRGB_LINEAR_END) ** (1 / c.SRGB_EXPONENT) - c.SRGB_OFFSET
    return torch.where(linear <= c.SRGB_LINEAR_END, linear * c.SRGB_SLOPE, curved)


def linear_from_srgb(encoded: Float[Tensor, "*any"]) -> Float[Tensor, "*any"]:
    """Linear light of sRGB-encoded values (any shape); the inverse of `srgb_from_linear`."""
    curved = ((encoded.clamp_min(c.SRGB_ENCODED_END) + c.SRGB_OFFSET) / c.SRGB_SCALE) ** c.SRGB_EXPONENT
    return torch.where(encoded <= c.SRGB_ENCODED_END, encoded / c.SRGB_SLOPE, curved)


def lab_from_linear(linear: Float[Tensor, "*pixels 3"]) -> Float[Tensor, "*pixels 3"]:
    """CIE Lab, white D65, of linear Rec.709 (..., 3) in [0, 1]: L in [0, 100], a and b about ±110."""
    matrix = linear.new_tensor(c.XYZ_FROM_REC709)
    white = matrix.sum(1)
    ratio = linear @ (matrix / white[:, None]).T
    cube_root = ratio.clamp_min(c.LAB_DELTA**3) ** (1 / 3)
    f = torch.where(ratio > c.LAB_DELTA**3, cube_root, ratio * (1 / c.LAB_DELTA) ** 2 / 3 + c.LAB_OFFSET)
    fx, fy, fz = f.unbind(-1)
    return torch.stack((116 * fy - 16, 500 * (fx - fy), 200 * (fy - fz)), -1)


def oklab_from_srgb(display: Float[Tensor, "*pixels 3"]) -> Float[Tensor, "*pixels 3"]:
    """OKLab (Ottosson 2020) of sRGB-encoded images (..., 3) in [0, 1]: L in [0, 1], a and b about ±0.4."""
    cones = linear_from_srgb(display) @ display.new_tensor(c.CONES_FROM_REC709).T
    return cones.clamp_min(1e-6) ** (1 / 3) @ display.new_tensor(c.OKLAB_FROM_CONES).T


def lab_from_srgb(display: Float[Tensor, "*pixels 3"]) -> Float[Tensor, "*pixels 3"]:
    """CIE Lab (D65) of sRGB-encoded images (..., 3) in [0, 1]."""
    return lab_from_linear(linear_from_srgb(display))


def _root(squared: Tensor) -> Tensor:
    """Square root whose gradient at zero is zero, not NaN."""
    return torch.where(squared > _TINY, squared.clamp_min(_TINY).sqrt(), torch.zeros_like(squared))


def _hue(b: Tensor, a: Tensor) -> Tensor:
    """Hue angle in radians, [0, 2π), of Lab components `b` and `a`; 0 with a zero gradient for a neutral color."""
    neutral = (a.abs() < _TINY) & (b.abs() < _TINY)
    angle = torch.atan2(b.masked_fill(neutral, 0.0), a.masked_fill(neutral, 1.0))
    return torch.where(angle < 0, angle + 2 * math.pi, angle)


def ciede2000(lab1: Float[Tensor, "*#pixels 3"], lab2: Float[Tensor, "*#pixels 3"]) -> Float[Tensor, "*#pixels"]:
    """CIEDE2000 (...) of colors in CIE Lab (..., 3): 1 is just visible (Sharma, Wu, Dalal 2005; kL = kC = kH = 1)."""
    (l1, a1, b1), (l2, a2, b2) = lab1.unbind(-1), lab2.unbind(-1)
    c7 = ((_root(a1 * a1 + b1 * b1) + _root(a2 * a2 + b2 * b2)) / 2) ** 7
    stretch = 1.5 - 0.5 * (c7 / (c7 + 25.0**7)).clamp_min(_TINY).sqrt()
    a1, a2 = a1 * stretch, a2 * stretch
    c1, c2 = _root(a1 * a1 + b1 * b1), _root(a2 * a2 + b2 * b2)
    h1, h2 = _hue(b1, a1), _hue(b2, a2)

    # The shorter way round the hue circle; a neutral color has no hue, so it takes the other color's.
    neutral = c1 * c2 < _TINY
    turn = h2 - h1
    dh = turn - 2 * math.pi * torch.round(turn / (2 * math.pi)).detach()
    mean_h = torch.where(neutral, h1 + h2, h1 + dh / 2)
    delta_l, delta_c = l2 - l1, c2 - c1
    half_turn = torch.where(neutral, torch.zeros_like(dh), dh) / 2
    delta_h = 2 * _root(c1 * c2) * half_turn.sin()

    mean_l, mean_c = (l1 + l2) / 2, (c1 + c2) / 2
    t = 1 - 0.17 * torch.cos(mean_h - math.radians(30)) + 0.24 * torch.cos(2 * mean_h)
    t = t + 0.32 * torch.cos(3 * mean_h + math.radians(6)) - 0.20 * torch.cos(4 * mean_h - math.radians(63))
    degrees = torch.rad2deg(torch.remainder(mean_h, 2 * math.pi))
    rotation = torch.deg2rad(60 * torch.exp(-(((degrees - 275) / 25) ** 2)))
    c7 = mean_c**7
    twist = -2 * (c7 / (c7 + 25.0**7)).clamp_min(_TINY).sqrt() * rotation.sin()
    from_middle = (mean_l - 50) ** 2
    dl = delta_l / (1 + 0.015 * from_middle / (20 + from_middle).sqrt())
    dc = delta_c / (1 + 0.045 * mean_c)
    dh = delta_h / (1 + 0.015 * mean_c * t)
    return _root(dl * dl + dc * dc + dh * dh + twist * dc * dh)


def mean_difference(display1: Float[Tensor, "*pixels 3"], display2: Float[Tensor, "*pixels 3"]) -> Float[Tensor, ""]:
    """Mean CIEDE2000 (a scalar) of two sRGB-encoded images (..., 3) in [0, 1]."""
    return ciede2000(lab_from_srgb(display1), lab_from_srgb(display2)).mean()


# Fits of Planck's law in linear Rec.709 with luminance 1, one row for each interval between knots (kelvin): red and
# green are a/T + bT + c, blue is a cubic. They are Blender's own (Cycles, kernel/tables.h, Apache-2.0), so that a
# temperature has the same color here as in Blender.
_KNOTS = (965.0, 1167.0, 1449.0, 1902.0, 3315.0, 6365.0)
_RED = (
    (1.61919106e3, -2.05010916e-3, 5.02995757),
    (2.48845471e3, -1.11330907e-3, 3.22621544),
    (3.34143193e3, -4.86551192e-4, 1.76486769),
    (4.09461742e3, -1.27446582e-4, 7.25731635e-1),
    (4.67028036e3, 2.91258199e-5, 1.26703442e-1),
    (4.59509185e3, 2.87495649e-5, 1.50345020e-1),
    (3.78717450e3, 9.35907826e-6, 3.99075871e-1),
)
_GREEN = (
    (-4.88999748e2, 6.04330754e-4, -7.55807526e-2),
    (-7.55994277e2, 3.16730098e-4, 4.78306139e-1),
    (-1.02363977e3, 1.20223470e-4, 9.36662319e-1),
    (-1.26571316e3, 4.87340896e-6, 1.27054498),
    (-1.42529332e3, -4.01150431e-5, 1.43972784),
    (-1.17554822e3, -2.16378048e-5, 1.30408023),
    (-5.00799571e2, -4.59832026e-6, 1.09098763),
)
_BLUE = (
    (5.96945309e-11, -4.85742887e-8, -9.70622247e-5, -4.07936148e-3),
    (2.40430366e-11, 5.55021075e-8, -1.98503712e-4, 2.89312858e-2),
    (-1.40949732e-11, 1.89878968e-7, -3.56632824e-4, 9.10767778e-2),
    (-3.61460868e-11, 2.84822009e-7, -4.93211319e-4, 1.56723440e-1),
    (-1.97075738e-11, 1.75359352e-7, -2.50542825e-4, -2.22783266e-2),
    (-1.61997957e-13, -1.64216008e-8, 3.86216271e-4, -7.38077418e-1),
    (6.72650283e-13, -2.73078809e-8, 4.24098264e-4, -7.52335691e-1),
)


def blackbody(kelvin: Tensor) -> Tensor:
    """Blackbody color (..., 3), linear Rec.709 with luminance about 1; `kelvin` (...) is clamped to [800, 12000]."""
    t = kelvin.clamp(800.0, 12000.0)
    i = torch.bucketize(t.detach(), t.new_tensor(_KNOTS), right=True)
    r, g, b = (t.new_tensor(table)[i].unbind(-1) for table in (_RED, _GREEN, _BLUE))
    red = r[0] / t + r[1] * t + r[2]
    green = g[0] / t + g[1] * t + g[2]
    blue = ((b[0] * t + b[1]) * t + b[2]) * t + b[3]
    return torch.stack((red, green, blue), -1).clamp_min(0.0)


def trilinear(table: Tensor, place: Tensor) -> Tensor:
    """Trilinear interpolation (C, N) of a table (1, C, D, H, W) at N places.

    `place` (N, 3) has coordinates along W, H and D, in this order: -1 is the first entry, 1 the last; clamped outside.
    """
    # A batch of parts: torch's CPU kernel uses one core per member.
    parts = functional.pad(place, (0, 0, 0, -len(place) % _PARTS)).view(_PARTS, -1, 1, 1, 3)
    tables = table.expand(_PARTS, -1, -1, -1, -1)
    values = functional.grid_sample(tables, parts, padding_mode="border", align_corners=True)
    return values.transpose(0, 1).reshape(table.shape[1], -1)[:, : len(place)]


def by_stops(table: Tensor, colors: Tensor, toe: float, stops: float) -> Tensor:
    """Values (..., 3) of a table (1, 3, S, S, S) for colors (..., 3) ≥ 0, interpolated trilinearly.

    The last axes of the table are blue, green and red. The S entries of each are at the component values
    toe · (2 ** s - 1), with s evenly spaced from 0 to `stops`.
    """
    place = torch.log2(colors * (1 / toe) + 1) * (2 / stops) - 1
    return trilinear(table, place.reshape(-1, 3)).T.reshape(colors.shape)
