# SPDX-License-Identifier: Apache-2.0
"""Distance of found values from the hidden ones: those of the key light that a picture can tell."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import torch

from proxy_renderer.color.tensors import blackbody, luminance
from proxy_renderer.schema import orbit

_KELVIN = torch.arange(1500.0, 12001.0, 50.0)
Found = Mapping[str, Sequence[float]]


def key_light_errors(made: Mapping[str, Any], found: Found) -> dict[str, float]:
    """Errors of the key light, where the look has moved it.

    Args:
        made: What Blender's side has told of the look: `before` and `hidden`, which have the same keys, and `roles`.
        found: Values of the finished scene by key; for what is not there, the value before counts.

    Returns:
        `direction`, degrees; `temperature`, kelvin, of the light's color and temperature together; `level`, stops of its power,
        the lightness of its color and the picture's exposure together, because one picture tells no more. Empty without a key light.
    """
    hidden, before = made["hidden"], made["before"]
    owner = next((key.split("/")[1] for key, role in made["roles"].items() if role == "key"), "")
    if not owner:
        return {}

    def value(name: str, values: Found, default: Sequence[float] = ()) -> Sequence[float]:
        key = f"light/{owner}/{name}" if not name.startswith("film/") else name
        return values.get(key, before.get(key, default))

    def aim(values: Found) -> orbit.Vector:
        return orbit.direction(value("azimuth", values)[0], value("elevation", values)[0])

    power = "power" if f"light/{owner}/power" in hidden else "strength"

    def level(values: Found) -> float:
        exposure = sum(value(f"film/{name}", values, (0.0,))[0] for name in ("exposure", "grade_exposure"))
        return math.log2(max(value(power, values)[0] * float(luminance(light(values))), 1e-9)) + exposure

    def light(values: Found) -> torch.Tensor:
        color, kelvin = value("color", values, (1.0,) * 3), value("temperature", values, (6500.0,))[0]
        return torch.tensor(color) * blackbody(torch.tensor(kelvin))

    errors = {}
    if f"light/{owner}/azimuth" in hidden:
        cosine = sum(a * b for a, b in zip(aim(hidden), aim(found), strict=True))
        errors["direction"] = math.degrees(math.acos(min(max(cosine, -1.0), 1.0)))
    if f"light/{owner}/temperature" in hidden:
        errors["temperature"] = abs(seen_temperature(light(hidden)) - seen_temperature(light(found)))
    if f"light/{owner}/{power}" in hidden:
        errors["level"] = abs(level(hidden) - level(found))
    return {name: round(error, 3) for name, error in errors.items()}


def found_in(report: Mapping[str, Any]) -> dict[str, list[float]]:
    """The values of a finished scene by key, from its report.json, where a scalar is no list."""
    after = {key: row["after"] for key, row in report["parameters"].items()}
    return {key: value if isinstance(value, list) else [value] for key, value in after.items()}


def seen_temperature(color: torch.Tensor) -> float:
    """The temperature of the blackbody light that is most like a light of a color (3,), linear."""
    light = color.clamp_min(1e-4).log()
    candidates = blackbody(_KELVIN).clamp_min(1e-4).log()
    apart = (candidates - candidates.mean(1, keepdim=True)) - (light - light.mean())
    return float(_KELVIN[apart.square().sum(1).argmin()])
