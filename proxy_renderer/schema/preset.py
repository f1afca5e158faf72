# SPDX-License-Identifier: Apache-2.0
"""Presets: a look by semantic role, so that it can be put on another scene.

A preset knows no names and no lengths. Its values belong to the most visible material of the
subject, to the key light, and so on; they are multiples of the scene's reference lengths, and light
directions are counted from the camera.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

from .errors import VibeError
from .parameters import FAMILIES, VERSION

FORMAT = "vibe-preset"

ROLES: dict[str, str] = {
    "subject": "material",
    "surroundings": "material",
    "key": "light",
    "fill": "light",
    "rim": "light",
    "world": "world",
    "volume": "volume",
    "film": "film",
}
"""Every role and the parameter group of its values. A camera belongs to its scene, not to a look."""

Entry = dict[str, list[float]]
"""Values of one material, light, …: parameter name to components, in multiples of its reference."""


@dataclass(frozen=True)
class Preset:
    """A look.

    Attributes:
        name: What the artist typed.
        roles: Role to its entries, the most visible or brightest first.
        kinds: Of every light entry, its type ("AREA", …), by role.
        version: Of the parameter table that it was made with.
    """

    name: str
    roles: dict[str, list[Entry]]
    kinds: dict[str, list[str]] = field(default_factory=dict)
    version: int = VERSION

    def dumps(self) -> str:
        """The text of a preset file."""
        return json.dumps({"format": FORMAT, **asdict(self)}, indent=1, allow_nan=False, ensure_ascii=False)


def loads(text: str) -> Preset:
    """Reads the text of a preset file.

    Raises:
        VibeError: If it is not a preset, was made by a newer version, or holds a value that is
            unknown, not finite or out of bounds.
    """
    try:
        raw = json.loads(text)
    except ValueError as error:
        raise VibeError(
            f"The preset is not JSON: {error}.", "Use a preset.json that a vibe has written."
        ) from error
    if not isinstance(raw, dict) or raw.get("format") != FORMAT or not isinstance(raw.get("roles"), dict):
        raise VibeError(
            "This file is not a Vibe Render preset.", "Use a preset.json that a vibe has written."
        )
    version = raw.get("version")
    if not isinstance(version, int) or version > VERSION:
        raise VibeError(
            f"The preset was made by a newer version of Vibe Render ({version}, this is {VERSION}).",
            "Update Vibe Render.",
        )
    for role, entries in raw["roles"].items():
        _check_role(role, entries)
    kinds = raw.get("kinds")
    return Preset(str(raw.get("name", "")), raw["roles"], kinds if isinstance(kinds, dict) else {}, version)


def _check_role(role: str, entries: Any) -> None:
    if role not in ROLES:
        raise VibeError(f"The preset has an unknown role {role!r}.", f"Roles are: {', '.join(ROLES)}.")
    if not isinstance(entries, list) or not all(isinstance(entry, dict) for entry in entries):
        raise VibeError(
            f"The preset's role {role!r} is broken.", "Use a preset.json that a vibe has written."
        )
    for entry in entries:
        for name, value in entry.items():
            _check_value(role, name, value)


def _check_value(role: str, name: str, value: Any) -> None:
    parameter = FAMILIES.get(f"{ROLES[role]}/{name}")
    if parameter is None:
        raise VibeError(f"The preset has an unknown parameter {role}/{name}.", "Remove it from the preset.")
    numbers = isinstance(value, list) and all(
        isinstance(v, int | float) and not isinstance(v, bool) for v in value
    )
    if not numbers or len(value) != parameter.components:
        raise VibeError(
            f"The preset's {role}/{name} needs {parameter.components} numbers.", "Correct the preset."
        )
    if not all(math.isfinite(v) for v in value):
        raise VibeError(f"The preset's {role}/{name} is not a finite number.", "Correct the preset.")
    if not all(parameter.lower <= v <= parameter.upper for v in value):
        raise VibeError(
            f"The preset's {role}/{name} is out of bounds: {value}.",
            f"Use {parameter.lower:g} to {parameter.upper:g}.",
        )


def clamped(group: str, values: Mapping[str, Sequence[float]]) -> Entry:
    """An entry with every value within the bounds that `loads` insists on."""
    entry = {}
    for name, value in values.items():
        parameter = FAMILIES[f"{group}/{name}"]
        entry[name] = [min(max(float(v), parameter.lower), parameter.upper) for v in value]
    return entry
