# SPDX-License-Identifier: Apache-2.0
"""Orbits around the subject: places of cameras and lights as azimuth, elevation and distance.

An azimuth of 0 is in front of the subject (-Y), 90 is at +X, which is the right-hand side of a
image taken from the front; an elevation of 90 is straight above. Angles are in degrees.
"""

import math
from collections.abc import Sequence

Vector = tuple[float, float, float]
Matrix = tuple[Vector, Vector, Vector]
IDENTITY: Matrix = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def direction(azimuth: float, elevation: float) -> Vector:
    """Unit vector from the subject toward a camera or light at these angles, in degrees."""
    a, e = math.radians(azimuth), math.radians(elevation)
    return math.cos(e) * math.sin(a), -math.cos(e) * math.cos(a), math.sin(e)


def angles(vector: Sequence[float]) -> tuple[float, float]:
    """Azimuth in (-180, 180] and elevation in [-90, 90] of a vector, degrees: the inverse of `direction`.

    The azimuth of a vertical vector is 0.

    >>> angles((2.0, 0.0, 0.0)), angles((0.0, 0.0, 1.0))
    ((90.0, 0.0), (0.0, 90.0))
    """
    x, y, z = vector
    return math.degrees(math.atan2(x, -y)) if x or y else 0.0, math.degrees(math.atan2(z, math.hypot(x, y)))


def frame(azimuth: float, elevation: float) -> Matrix:
    """Rotation of a camera that looks at the subject, rows of a 3x3 matrix. Its columns: right, up, to the viewer."""
    a = math.radians(azimuth)
    zx, zy, zz = direction(azimuth, elevation)
    xx, xy = math.cos(a), math.sin(a)
    return (xx, -zz * xy, zx), (xy, zz * xx, zy), (0.0, zx * xy - zy * xx, zz)
