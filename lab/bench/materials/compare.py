# SPDX-License-Identifier: Apache-2.0
"""Distance of a finished scene from what was measured."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import torch

from lab.bench.paper.finished import FinishedPicture
from proxy_renderer.color.constants import XYZ_FROM_REC709
from proxy_renderer.color.floats import oklab_from_srgb, srgb_from_linear
from proxy_renderer.color.tensors import blackbody, ciede2000

FinalValues = Mapping[str, Mapping[str, Any]]
"""Of a finished scene: `parameters` of report.json."""
BALL = "Ball"

_WHITISH = 0.03
"""Greatest distance from the Planckian locus of a light with a color temperature, CIE 1960."""


def material(
    row: Mapping[str, Any], values: FinalValues, after: FinishedPicture, reference: FinishedPicture
) -> dict[str, Any]:
    """A ball against measured values.

    Args:
        reference: The studio's picture with the measured values, in the artist's light.

    Returns:
        `metal_right`; `delta_e`, CIEDE2000 between the ball's mean colors; `roughness`, `ior` and `transmission`: how far
        each is off, None where the data or the scene has none.
    """
    means = [torch.from_numpy(shot.lab[shot.region(BALL)].mean(0)) for shot in (after, reference)]
    metallic = _value(values, "metallic")
    return {
        "metal_right": metallic is not None and (metallic >= 0.5) == (row["metalness"] >= 0.5),
        "delta_e": round(float(ciede2000(*means)), 2),
        **{name: _off(_value(values, name), row.get(name)) for name in ("roughness", "ior", "transmission")},
    }


def _value(values: FinalValues, name: str) -> float | None:
    found: float | None = values.get(f"material/{BALL}/{name}", {}).get("after")
    return found


def _off(value: float | None, measured: float | None) -> float | None:
    return None if value is None or measured is None else round(abs(value - measured), 3)


def lamp(row: Mapping[str, Any], values: FinalValues) -> dict[str, Any]:
    """The strongest lamp against a measured light source.

    Returns:
        `kelvin`, the correlated color temperature of the lamp's light; `mireds`, how far it is off (5 are just seen),
        None for a source without a temperature; `hue`, degrees off in OKLab, of such a source; None for others.
    """
    light = lamp_light(values)
    kelvin = correlated_kelvin(light)
    wanted = row["kelvin"]
    return {
        "kelvin": None if kelvin is None else round(kelvin),
        "mireds": round(abs(1e6 / kelvin - 1e6 / wanted), 1) if kelvin and wanted else None,
        "hue": None if wanted else round(_hue_apart(light, row["color"]), 1),
    }


def lamp_light(values: FinalValues) -> list[float]:
    """Linear color of the light of the lamp with the most power."""
    powers = {
        key.split("/")[1]: each["after"]
        for key, each in values.items()
        if key.startswith("light/") and key.endswith("/power")
    }
    name = max(powers, key=lambda each: float(powers[each]))
    color = values[f"light/{name}/color"]["after"]
    glow = blackbody(torch.tensor(float(values[f"light/{name}/temperature"]["after"])))
    return [float(c) * float(g) for c, g in zip(color, glow.flatten(), strict=True)]


def correlated_kelvin(linear: Sequence[float]) -> float | None:
    """Correlated color temperature of a light: where the Planckian locus comes nearest in CIE 1960.

    Args:
        linear: Linear RGB, Rec.709.

    Returns:
        800 to 25000, or None for a light that is far from white.
    """
    x, y, z = (sum(w * c for w, c in zip(row, linear, strict=True)) for row in XYZ_FROM_REC709)
    total = max(x + 15 * y + 3 * z, 1e-9)
    u, v = 4 * x / total, 6 * y / total
    kelvins = [800.0 * (25000.0 / 800.0) ** (i / 500) for i in range(501)]
    nearest = min(kelvins, key=lambda t: math.hypot(u - _locus(t)[0], v - _locus(t)[1]))
    away = math.hypot(u - _locus(nearest)[0], v - _locus(nearest)[1])
    return nearest if away < _WHITISH else None


def _locus(t: float) -> tuple[float, float]:
    """The Planckian locus in CIE 1960 at a temperature in kelvin (Krystek 1985)."""
    u = (0.860117757 + 1.54118254e-4 * t + 1.28641212e-7 * t * t) / (1 + 8.42420235e-4 * t + 7.08145163e-7 * t * t)
    v = (0.317398726 + 4.22806245e-5 * t + 4.20481691e-8 * t * t) / (1 - 2.89741816e-5 * t + 1.61456053e-7 * t * t)
    return u, v


def _hue_apart(linear: Sequence[float], other: Sequence[float]) -> float:
    hues = []
    for color in (linear, other):
        _, a, b = oklab_from_srgb(srgb_from_linear([c / max(*color, 1e-9) for c in color]))
        hues.append(math.degrees(math.atan2(b, a)))
    return abs((hues[0] - hues[1] + 180.0) % 360.0 - 180.0)
