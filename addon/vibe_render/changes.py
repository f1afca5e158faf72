# SPDX-License-Identifier: GPL-3.0-or-later
"""Values as an artist reads them: names, units, and what lies between an old and a new one. No bpy here."""

from __future__ import annotations

import math

from .contract import schema

GROUPS: dict[str, tuple[str, str]] = {
    "camera": ("Camera", "OUTLINER_OB_CAMERA"),
    "light": ("Lights", "OUTLINER_OB_LIGHT"),
    "world": ("World", "WORLD"),
    "material": ("Materials", "MATERIAL"),
    "volume": ("Fog", "OUTLINER_OB_VOLUME"),
    "film": ("Color & Grade", "COLOR"),
}
"""Title and icon of every group of the schema."""

_UNITS = {
    "W": " W",
    "W/m2": " W/m²",
    "m": " m",
    "1/m": " /m",
    "deg": "°",
    "K": " K",
    "stops": " stops",
    "": "",
}


def parameter(key: str) -> schema.Parameter:
    """The schema row of an instance's key."""
    group, _, name = schema.split_key(key)
    return schema.FAMILIES[f"{group}/{name}"]


def words(name: str) -> str:
    """A parameter's own name for people: "Base Color"."""
    return {"ior": "IOR", "fov": "Field of View"}.get(name, name.replace("_", " ").title())


def title(key: str) -> str:
    """An instance's name for people: "Key Light: Power", "Fog: Density", "Saturation"."""
    group, owner, name = schema.split_key(key)
    return words(name) if group == "film" else f"{owner or GROUPS[group][0]}: {words(name)}"


def text(key: str, values: schema.Values) -> str:
    """A value with its unit: "120 W", "32°", "+0.4 stops", or three numbers for a color."""
    row = parameter(key)
    if row.kind == "color":
        return " ".join(f"{v:.2f}" for v in values)
    sign = "+" if row.unit == "stops" and values[0] > 0 else ""
    return f"{sign}{_number(values[0])}{_UNITS[row.unit]}"


def arrow(key: str, before: schema.Values, after: schema.Values) -> str:
    """The old and the new value, the unit once: "400 → 160 W"."""
    unit = _UNITS[parameter(key).unit]
    return f"{text(key, before).removesuffix(unit)} → {text(key, after)}"


def _number(value: float) -> str:
    """About three significant digits, without exponents."""
    if abs(value) < 1e-4:
        return "0"
    return f"{value:.0f}" if abs(value) >= 100 else f"{value:.3g}"


def same(key: str, before: schema.Values, after: schema.Values) -> bool:
    """Whether two values read the same, so that listing the change would only puzzle."""
    return text(key, before) == text(key, after)


def blend(key: str, before: schema.Values, after: schema.Values, strength: float) -> schema.Values:
    """The value `strength` of the way from before (0) to after (1), in even steps to the eye."""
    scale = parameter(key).scale
    return tuple(_between(scale, a, b, strength) for a, b in zip(before, after, strict=True))


def _between(scale: schema.Scale, a: float, b: float, t: float) -> float:
    if t in (0.0, 1.0):  # exactly what was there
        return b if t else a
    if scale.name == "log" and a > 0 and b > 0:
        return a * math.pow(b / a, t)
    if scale.name == "power" and a >= 0 and b >= 0:
        root = 1.0 / scale.exponent
        return ((1 - t) * a**root + t * b**root) ** scale.exponent
    return (1 - t) * a + t * b
