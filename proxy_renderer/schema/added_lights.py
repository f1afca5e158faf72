# SPDX-License-Identifier: Apache-2.0
"""The lights that a vibe may add to a scene: one for each part that a light can play and each of Blender's types."""

from __future__ import annotations

from dataclasses import dataclass

PARTS = ("key", "fill", "rim", "kicker", "accent", "practical", "background", "top", "bounce")
"""What a light is for, as a gaffer says it. The scene's own lights have the roles key, fill, rim and other."""
_TYPES = {"AREA": "", "POINT": " Lamp", "SPOT": " Spot", "SUN": " Sun"}
_ROLES = {"key": "key", "rim": "rim", "kicker": "rim"}
COLLECTION = "Vibe Lights"
"""Where added lights are, in the scene."""


@dataclass(frozen=True)
class AddedLight:
    """A light that a scene may get.

    Attributes:
        name: Of the object in Blender; parameters are keyed by it.
        type: "AREA", "POINT", "SPOT" or "SUN".
        part: One of `PARTS`.
    """

    name: str
    type: str
    part: str

    @property
    def role(self) -> str:
        """What it counts as among the scene's lights: "key", "fill" or "rim"."""
        return _ROLES.get(self.part, "fill")


def light_name(part: str, kind: str) -> str:
    """The name of the light that plays a part: "Vibe Key Spot"."""
    return f"Vibe {part.capitalize()}{_TYPES[kind]}"


ADDED_LIGHTS: dict[str, AddedLight] = {
    (name := light_name(part, kind)): AddedLight(name, kind, part) for part in PARTS for kind in _TYPES
}
"""By name."""
