# SPDX-License-Identifier: Apache-2.0
"""Keys of light links, set by words only: "light/Rim (only on Bottle, Cap)/linked" is 1 for a linked light, else 0."""

import re
from collections.abc import Sequence
from typing import NamedTuple

from .parameters import LINEAR, Parameter, split_key

_ONLY, _NOT = "only on", "not on"
LINKED = Parameter(
    "light", "linked", "scalar", 0.0, 0.0, 1.0, "", LINEAR, "whole",
    "Whether the light is linked to objects.", "Object > Shading > Light Linking",
)  # fmt: skip
_AND = ", "
_OWNER = re.compile(rf"(.+?) \(({_ONLY}|{_NOT}) (.+)\)")


class LightLink(NamedTuple):
    """A link of a light to objects: with `only`, the light lights no other objects; else it lights all but these."""

    light: str
    only: bool
    objects: tuple[str, ...]

    def __str__(self) -> str:
        return f"{_ONLY if self.only else _NOT} {_AND.join(self.objects)}"

    @property
    def key(self) -> str:
        """The link's key.

        >>> LightLink("Rim", True, ("Bottle", "Cap")).key
        'light/Rim (only on Bottle, Cap)/linked'
        """
        return LINKED.key(f"{self.light} ({self})")


def link_of(key: str) -> LightLink | None:
    """The link that a key stands for; None for the key of any other parameter."""
    group, owner, name = split_key(key)
    found = _OWNER.fullmatch(owner) if f"{group}/{name}" == LINKED.family else None
    return LightLink(found[1], found[2] == _ONLY, tuple(found[3].split(_AND))) if found else None


def is_on(values: Sequence[float]) -> bool:
    """True if a link with this value is on: from 0.5, because looks may be blended."""
    return values[0] >= 0.5
