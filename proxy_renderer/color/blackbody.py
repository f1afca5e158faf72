# SPDX-License-Identifier: Apache-2.0
"""The color of a light by its temperature."""

from __future__ import annotations

import torch
from torch import Tensor

# Fits of Planck's law in linear Rec.709, luminance 1, for the temperatures from each knot on: red and green are
# a/T + bT + c, blue is a cubic. They are Blender's own (Cycles, kernel/tables.h, Apache-2.0), so that a
# temperature means the very same light here.
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
    """Color of a light of this temperature, as Blender multiplies it in.

    Args:
        kelvin: (...,) temperature; below 800 K and above 12000 K nothing changes any more.

    Returns:
        Linear Rec.709 (..., 3), luminance about 1, never negative.
    """
    t = kelvin.clamp(800.0, 12000.0)
    i = torch.bucketize(t.detach(), t.new_tensor(_KNOTS), right=True)
    r, g, b = (t.new_tensor(table)[i].unbind(-1) for table in (_RED, _GREEN, _BLUE))
    red = r[0] / t + r[1] * t + r[2]
    green = g[0] / t + g[1] * t + g[2]
    blue = ((b[0] * t + b[1]) * t + b[2]) * t + b[3]
    return torch.stack((red, green, blue), -1).clamp_min(0.0)
