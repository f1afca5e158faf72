# SPDX-License-Identifier: Apache-2.0
"""Radiometry: how bright Blender's lights make a white diffuse surface that faces them."""

import math

_UNIT_ENERGY = {  # checked against Cycles renders by blender_tests/scene/test_key_light.py
    "POINT": 4 * math.pi**2,
    "SPOT": 4 * math.pi**2,  # a spot is a point with a mask: as bright inside the cone
    "AREA": math.pi**2,
    "SUN": math.pi,
}
TABLE_TOE, TABLE_STOPS = 2.0**-10, 16.0  # the color table's axis: TOE · (2 ** s - 1), s from 0 to STOPS


def unit_energy(light_type: str, distance: float = 1.0) -> float:
    """Energy with which a light gives a white diffuse surface facing it a radiance of 1.

    It is in watts for a light at a `distance` in meters, and in W/m² for a sun.
    """
    return _UNIT_ENERGY[light_type] * (1.0 if light_type == "SUN" else distance**2)  # a sun's is an irradiance


def radiance(light_type: str, energy: float, distance: float = 1.0, stops: float = 0.0) -> float:
    """Radiance of a white diffuse surface that faces a light; `energy` as in `unit_energy`, brightened by `stops`."""
    return energy * 2.0**stops / unit_energy(light_type, distance)
