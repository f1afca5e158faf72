# SPDX-License-Identifier: GPL-3.0-or-later
"""Invertible pairs between what Blender stores and what the schema means."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from ..core.schema_import import schema


@dataclass(frozen=True)
class Codec:
    """A pair of inverse functions.

    Attributes:
        decode: Blender's stored value to the schema's components.
        encode: The schema's components to Blender's stored value.
    """

    decode: Callable[[Any], schema.Values]
    encode: Callable[[schema.Values], Any]


NUMBER = Codec(lambda raw: (float(raw),), lambda values: values[0])

COLOR = Codec(lambda raw: tuple(map(float, raw[:3])), lambda values: tuple(values))
"""Linear RGB; a fourth, stored component is alpha, which stays as it is."""

DEGREES = Codec(lambda raw: (math.degrees(raw),), lambda values: math.radians(values[0]))

LENS = Codec(
    lambda per_sensor: (math.degrees(2.0 * math.atan(0.5 / per_sensor)),),
    lambda values: 0.5 / math.tan(math.radians(values[0]) / 2.0),
)
"""Focal length as a multiple of the sensor's size, to the field of view."""
