# SPDX-License-Identifier: Apache-2.0
"""What a parameter is: its bounds, its perceptual scale, and its name in a scene."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from typing import Literal

Kind = Literal["scalar", "color", "angle"]
Region = Literal["subject", "surroundings", "whole"]
Values = tuple[float, ...]


@dataclass(frozen=True)
class Scale:
    """A monotone map between a bounded value and u in [0, 1] in which equal steps look alike.

    Attributes:
        name: "linear", "log" (needs a positive lower bound) or "power".
        exponent: For "power": value = lower + (upper - lower) * u ** exponent.
    """

    name: Literal["linear", "log", "power"] = "linear"
    exponent: float = 1.0

    def to_unit(self, value: float, lower: float, upper: float) -> float:
        """Maps a value to the place where it stands between its bounds.

        Args:
            value: In the parameter's unit; outside of the bounds it is clamped.
            lower: Above 0 for "log".
            upper: Above `lower`.

        Returns:
            u in [0, 1].

        >>> Scale("log").to_unit(10.0, 1.0, 100.0), Scale().to_unit(7.0, 0.0, 4.0)
        (0.5, 1.0)
        """
        value = min(max(value, lower), upper)
        if self.name == "log":
            return math.log(value / lower) / math.log(upper / lower)
        return ((value - lower) / (upper - lower)) ** (1.0 / self.exponent)

    def from_unit(self, u: float, lower: float, upper: float) -> float:
        """Inverse of `to_unit`.

        Args:
            u: The place; outside of [0, 1] it is clamped.
            lower: As for `to_unit`.
            upper: As for `to_unit`.

        Returns:
            The value in [lower, upper].
        """
        u = min(max(u, 0.0), 1.0)
        if self.name == "log":
            return lower * (upper / lower) ** u
        return lower + (upper - lower) * u**self.exponent


LINEAR = Scale()
LOG = Scale("log")
SRGB = Scale("power", 2.2)  # color components: even steps in u are about even steps on screen


@dataclass(frozen=True)
class Parameter:
    """One row of the schema: a family of values that every scene has none, one or several of.

    Attributes:
        group: camera, light, world, material, volume or film.
        name: Unique within the group.
        kind: "scalar", "color" (three linear Rec.709 components) or "angle" (degrees).
        default: Value of one component that leaves the picture as a fresh Blender scene has it.
        lower: Hard lower bound of every component, in `unit`, times the instance's reference.
        upper: Hard upper bound, likewise.
        unit: "", "W", "W/m2", "m", "1/m", "deg", "K" or "stops".
        scale: The perceptual scale that optimization steps on.
        region: The part of the picture that it mainly changes.
        doc: What it does, for help texts and tool tips.
        blender: The socket or property that it means, as an artist would look for it.
        reference: The scene length (see `REFERENCES`) that makes the bounds independent of the
            scene's size; "" for none.
        only: The kinds of owner that have it (light types, say); empty for all.
    """

    group: str
    name: str
    kind: Kind
    default: float
    lower: float
    upper: float
    unit: str
    scale: Scale
    region: Region
    doc: str
    blender: str
    reference: str = ""
    only: tuple[str, ...] = ()

    @property
    def family(self) -> str:
        """The name shared by all instances: "material/roughness"."""
        return f"{self.group}/{self.name}"

    @property
    def components(self) -> int:
        """3 for colors, otherwise 1."""
        return 3 if self.kind == "color" else 1

    def key(self, owner: str = "") -> str:
        """The name of an instance: "material/Body/roughness", or "film/contrast"."""
        return f"{self.group}/{owner}/{self.name}" if owner else self.family


@dataclass(frozen=True)
class Instance:
    """A parameter of one thing in one scene.

    Attributes:
        parameter: The schema row.
        owner: Name of the light or material; "" for groups that a scene has one of.
        value: The artist's value, one float per component, in the parameter's unit.
        reference: What the schema's bounds are multiplied by.
        role: "subject" or "surroundings" for materials; "key", "fill", "rim" for lights.
        locked: Why the value must stay as it is; "" when it may change.
    """

    parameter: Parameter
    owner: str
    value: Values
    reference: float = 1.0
    role: str = ""
    locked: str = ""
    lower: Values = field(init=False)
    upper: Values = field(init=False)

    def __post_init__(self) -> None:
        # A scene may hold a value that the schema would not choose: the artist's value is always legal.
        low, high = (b * self.reference for b in (self.parameter.lower, self.parameter.upper))
        object.__setattr__(self, "lower", tuple(min(low, v) for v in self.value))
        object.__setattr__(self, "upper", tuple(max(high, v) for v in self.value))
        if self.parameter.scale.name == "log":
            object.__setattr__(self, "lower", tuple(max(v, low * 1e-3) for v in self.lower))

    @property
    def key(self) -> str:
        """The name in reports, presets, locks and messages."""
        return self.parameter.key(self.owner)

    def distance(self, value: Values) -> float:
        """How far a value is from the artist's on the perceptual scale.

        Args:
            value: One number per component, in the parameter's unit.

        Returns:
            The greatest difference of a component, 0 to 1.
        """
        unit = self.parameter.scale.to_unit
        ends = zip(self.value, value, self.lower, self.upper, strict=True)
        return max(abs(unit(a, low, high) - unit(b, low, high)) for a, b, low, high in ends)


def split_key(key: str) -> tuple[str, str, str]:
    """Splits a key into (group, owner, name); the owner is "" where a scene has one of the group.

    An owner's name may itself contain slashes.

    >>> split_key("material/Wood/Oak/roughness"), split_key("film/contrast")
    (('material', 'Wood/Oak', 'roughness'), ('film', '', 'contrast'))
    """
    group, _, rest = key.partition("/")
    owner, _, name = rest.rpartition("/")
    return group, owner, name


def matches(key: str, patterns: tuple[str, ...] | list[str]) -> bool:
    """Whether a key is named by a pattern.

    Args:
        key: Of an instance: "light/Key/power".
        patterns: Each a group, a group with an owner, a key, or a glob of keys.

    >>> matches("light/Key/power", ["light"]), matches("light/Key/power", ["*/power"])
    (True, True)
    """
    group, owner, _ = split_key(key)
    return any(p in (group, f"{group}/{owner}", key) or fnmatchcase(key, p) for p in patterns)
