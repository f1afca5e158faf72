# SPDX-License-Identifier: Apache-2.0
"""Presets: a look by semantic role, so that it can be put on another scene.

A preset has no names of objects and no lengths in meters. Its values belong to the most visible
material of the subject, to the key light, and so on. They are multiples of the scene's reference
lengths, and azimuths of lights are relative to the camera.
"""

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

from .errors import VibeError, quoted
from .limits import LONGEST_NAME as LONGEST_NAME
from .limits import LONGEST_PROMPT
from .parameters import FAMILIES, PARAMETERS, VERSION

FORMAT = "vibe-preset"

ROLES: dict[str, str] = {  # role -> the parameter group of its values; a camera belongs to its scene, not to a look
    **dict.fromkeys(("subject", "surroundings"), "material"),
    **dict.fromkeys(("key", "fill", "rim"), "light"),
    **{group: group for group in ("world", "volume", "film")},
}

Entry = dict[str, list[float]]  # of one owner: parameter name -> components, in multiples of the instance's reference

LIGHT_TYPES = tuple(dict.fromkeys(t for p in PARAMETERS if p.group == "light" for t in p.only))
"""Blender's types of light."""

LARGEST = 1_000_000  # most bytes of a preset file; a file with a hundred materials has a tenth of that
_FIELDS = {"format", "version", "name", "prompt", "roles", "kinds", "goals"}
_OURS = "Use a preset that Vibe Render has written."


@dataclass(frozen=True)
class Preset:
    """A look by role, as a preset file keeps it."""

    name: str  # its title
    roles: dict[str, list[Entry]]  # role -> its entries, the most visible or brightest first
    kinds: dict[str, list[str]] = field(default_factory=dict)  # type of each light ("AREA", …), by role
    prompt: str = ""  # what the artist typed
    # the goals of its search, which `vibe run --goals` takes again, see docs/reference/goals.md; {} for none
    goals: dict[str, Any] = field(default_factory=dict)
    version: int = VERSION  # of the parameter table that it was made with

    def dumps(self) -> str:
        """The text of a preset file."""
        return json.dumps({"format": FORMAT, **asdict(self)}, indent=1, allow_nan=False, ensure_ascii=False)


def title(prompt: str) -> str:
    """A name for a prompt: its first words, `LONGEST_NAME` characters at most."""
    words = " ".join(prompt.split())
    if len(words) <= LONGEST_NAME:
        return words
    return words[: LONGEST_NAME - 1].rpartition(" ")[0].rstrip(",;: ") + "…"


def loads(text: str) -> Preset:
    """Reads the text of a preset file; runs nothing in it. Raises VibeError if it is no valid preset, or a newer one."""
    try:
        raw = json.loads(text)
    except RecursionError as error:
        raise VibeError("The preset is nested too deeply.", _OURS) from error
    except ValueError as error:
        raise VibeError(f"The preset is not JSON: {error}.", _OURS) from error
    if not isinstance(raw, dict) or raw.get("format") != FORMAT or not isinstance(raw.get("roles"), dict):
        raise VibeError("This file is not a Vibe Render preset.", _OURS)
    version = raw.get("version")
    if not isinstance(version, int) or isinstance(version, bool) or version < 1:
        raise VibeError("The preset does not say which version of the schema it is for.", _OURS)
    if version > VERSION:
        newer = f"a newer version of Vibe Render ({quoted(str(version))}, this is {VERSION})"
        raise VibeError(f"The preset was made by {newer}.", "Update Vibe Render.")
    for name in sorted(raw.keys() - _FIELDS):
        raise VibeError(f"The preset has an unknown field {quoted(name)}.", "Remove it from the preset.")
    for role, entries in raw["roles"].items():
        _check_role(role, entries)
    kinds = raw.get("kinds", {})
    if not isinstance(kinds, dict):
        raise VibeError("The preset's kinds of lights are broken.", _OURS)
    for role, types in kinds.items():  # a role that has types of lights has one for each of its entries
        of_light = ROLES.get(role) == "light" and isinstance(types, list)
        if not of_light or len(types) != len(raw["roles"].get(role, ())):
            raise VibeError(f"The preset's kinds of lights for {quoted(role)} do not fit its lights.", _OURS)
        for unknown in (each for each in types if each not in LIGHT_TYPES):
            remedy = f"Types are: {', '.join(LIGHT_TYPES)}."
            raise VibeError(f"The preset has an unknown type of light {quoted(str(unknown))}.", remedy)
    name, prompt = _text(raw, "name", LONGEST_NAME), _text(raw, "prompt", LONGEST_PROMPT)
    goals = raw.get("goals", {})
    if not isinstance(goals, dict):
        raise VibeError("The preset's goals are no object.", "Remove them from the preset.")
    return Preset(name, raw["roles"], kinds, prompt, goals, version)


def _text(raw: dict[str, Any], name: str, most: int) -> str:
    """The text of a field of `raw` on one line, without unprintable characters; if longer than `most`, its `title`."""
    value = raw.get(name, "")
    if not isinstance(value, str) or len(value) > LONGEST_PROMPT:
        raise VibeError(f"The preset's {name} is not a short text.", f"Write at most {most} characters.")
    line = " ".join("".join(c if c.isprintable() else " " for c in value).split())
    return line if len(line) <= most else title(line)


def _check_role(role: str, entries: Any) -> None:
    if role not in ROLES:
        raise VibeError(f"The preset has an unknown role {quoted(role)}.", f"Roles are: {', '.join(ROLES)}.")
    if not isinstance(entries, list) or not all(isinstance(entry, dict) for entry in entries):
        raise VibeError(f"The preset's role {role!r} is broken.", _OURS)
    for name, value in (item for entry in entries for item in entry.items()):
        parameter = FAMILIES.get(f"{ROLES[role]}/{name}")
        if parameter is None:
            problem = f"The preset has an unknown parameter {role}/{quoted(name)}."
            raise VibeError(problem, "Remove it from the preset.")
        numbers = isinstance(value, list) and all(type(v) in (int, float) for v in value)
        if not numbers or len(value) != parameter.components:
            problem = f"The preset's {role}/{name} needs {parameter.components} numbers."
            raise VibeError(problem, "Correct the preset.")
        if any(isinstance(v, float) and not math.isfinite(v) for v in value):  # isfinite fails for a large int
            raise VibeError(f"The preset's {role}/{name} is not a finite number.", "Correct the preset.")
        if not all(parameter.lower <= v <= parameter.upper for v in value):
            remedy = f"Use {parameter.lower:g} to {parameter.upper:g}."
            raise VibeError(f"The preset's {role}/{name} is out of bounds: {quoted(str(value))}.", remedy)


def clamped(group: str, values: Mapping[str, Sequence[float]]) -> Entry:
    """Parameter name -> value (a multiple of the reference), clamped to the schema's bounds, which `loads` checks."""
    rows = ((name, FAMILIES[f"{group}/{name}"], value) for name, value in values.items())
    return {name: [min(max(float(v), row.lower), row.upper) for v in value] for name, row, value in rows}
