# SPDX-License-Identifier: Apache-2.0
"""Radiometry: how bright Blender's lights make a white diffuse surface that faces them. The only table of it.

Checked against Cycles renders by blender_tests/scene/test_key_light.py.
"""

import math

_UNIT_ENERGY = {
    "POINT": 4 * math.pi**2,
    "SPOT": 4 * math.pi**2,  # Blender's spots are points with a mask: inside the cone as bright as those
    "AREA": math.pi**2,
    "SUN": math.pi,
}
TABLE_TOE, TABLE_STOPS = 2.0**-10, 16.0  # the compositor's table: TOE · (2 ** s - 1), s from 0 to STOPS


def unit_energy(light_type: str, distance: float = 1.0) -> float:
    """The energy at which a white diffuse surface that faces the light has a radiance of 1: watts at meters, or W/m² of a sun."""
    falloff = 1.0 if light_type == "SUN" else distance**2  # a sun's energy is an irradiance
    return _UNIT_ENERGY[light_type] * falloff


def radiance(light_type: str, energy: float, distance: float = 1.0, stops: float = 0.0) -> float:
    """Radiance of a white diffuse surface that faces a light of some W (W/m² of a sun): the inverse of `unit_energy`."""
    return energy * 2.0**stops / unit_energy(light_type, distance)
