# SPDX-License-Identifier: Apache-2.0
"""The lights that a vibe may add to a scene: one for each part of a rig and type of light, and suns with a pattern."""

import math
from dataclasses import dataclass

PARTS = ("key", "fill", "rim", "kicker", "accent", "practical", "background", "top", "bounce")
"""Parts that a light can play, as gaffers name them. The scene's own lights have the roles key, fill, rim and other."""
_TYPES = {"AREA": "", "POINT": " Lamp", "SPOT": " Spot", "SUN": " Sun"}
_ROLES = {"key": "key", "rim": "rim", "kicker": "rim"}
PATTERNS = {"slats": " Blinds", "leaves": " Leaves"}  # pattern of a light's card (its mask) -> end of the light's name
CARD = "Vibe Card"  # the name of a card, a mask in front of a light that only shadow rays see
CARD_AWAY = 1.6  # how far in front of the subject's center a card stands, in sizes of the card
_SLATS, _OPEN, _WINDOW, _FRAME = 9, 0.5, 1.3, 14.0  # number of slats, their open share, half widths of window and frame
_LEAVES, _LEAF, _CROWN = 260, 0.17, 2.2  # number, half length of a leaf, radius of the crown
_GOLDEN = 2.399963  # the golden angle, radians
COLLECTION = "Vibe Lights"  # where added lights are, in the scene


@dataclass(frozen=True)
class AddedLight:
    """A light that a scene may get."""

    name: str  # of the object in Blender; parameters are keyed by it
    type: str  # "AREA", "POINT", "SPOT" or "SUN"
    part: str  # one of `PARTS`
    pattern: str = ""  # of `PATTERNS`, or ""

    @property
    def role(self) -> str:
        """Its role among the scene's lights: "key", "fill" or "rim"."""
        return role_of(self.part)


def role_of(part: str) -> str:
    """The role of a light that plays a part: "key", "fill" or "rim"."""
    return _ROLES.get(part, "fill")


def light_name(part: str, kind: str, pattern: str = "") -> str:
    """The name of the added light for a part, a type of light and a pattern: "Vibe Key Spot", "Vibe Key Blinds"."""
    return f"Vibe {part.capitalize()}{PATTERNS[pattern] if pattern else _TYPES[kind]}"


_PLAIN = [AddedLight(light_name(part, kind), kind, part) for part in PARTS for kind in _TYPES]
_PATTERNED = [AddedLight(light_name("key", "SUN", p), "SUN", "key", p) for p in PATTERNS]
ADDED_LIGHTS: dict[str, AddedLight] = {light.name: light for light in (*_PLAIN, *_PATTERNED)}  # by name
Quad = tuple[tuple[float, float], tuple[float, float], tuple[float, float], tuple[float, float]]


def card(pattern: str, size: float) -> list[Quad]:
    """Corners (x, y) of a card's opaque quads around its center, in meters, as the light sees them.

    The card is a mask in front of a light: a window with "slats", or "leaves". All lengths are multiples of its `size`.
    """
    if pattern == "slats":
        pitch = 2 * _WINDOW / _SLATS
        rows = [-_WINDOW + pitch * i for i in range(_SLATS)]
        parts = [_box(-_WINDOW, y, _WINDOW, y + pitch * (1 - _OPEN)) for y in rows]
        parts += [_box(-_FRAME, _WINDOW, _FRAME, _FRAME), _box(-_FRAME, -_FRAME, _FRAME, -_WINDOW)]
        parts += [_box(-_FRAME, -_WINDOW, -_WINDOW, _WINDOW), _box(_WINDOW, -_WINDOW, _FRAME, _WINDOW)]
    else:  # a sunflower's spiral of leaves of different sizes: even, without rows
        parts = []
        for i in range(_LEAVES):
            away, turn = _CROWN * math.sqrt((i + 0.5) / _LEAVES), _GOLDEN * i
            x, y = away * math.cos(turn), away * math.sin(turn)
            length, turn = _LEAF * (0.55 + 0.9 * ((i * 0.754877) % 1.0)), _GOLDEN * i * 1.7
            a, b = length * math.cos(turn), length * math.sin(turn)
            # a rhombus, twice as long as wide
            parts.append(((x + a, y + b), (x - b / 2, y + a / 2), (x - a, y - b), (x + b / 2, y - a / 2)))
    return [tuple((x * size, y * size) for x, y in part) for part in parts]  # type: ignore[misc]


def _box(left: float, low: float, right: float, high: float) -> Quad:
    return (left, low), (right, low), (right, high), (left, high)
