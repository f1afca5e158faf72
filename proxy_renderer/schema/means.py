# SPDX-License-Identifier: Apache-2.0
"""Means: which groups of parameters may serve which kind of word. A mood never repaints the scene.

Moods, light words, places, weather, seasons, times of day and grade words are served by lights, world, air and film. A material
changes only for a word that the prompt itself says, that is bound to the object or material, and that speaks of its color,
substance or finish. A material that lights the scene by its glow is a light: what light words do to its emission is no paint.
"""

from __future__ import annotations

PAINT = "material"
"""The group of parameters that only words about surfaces may change."""
_LIT = frozenset(("light", "world", "volume", "film"))
MEANS: dict[str, frozenset[str]] = {
    "color": _LIT | {PAINT},
    "finish": _LIT | {PAINT},
    "material": _LIT | {PAINT},
    "lighting": _LIT,
    "atmosphere": _LIT,
    "grade": _LIT,
    "mood": _LIT,
    "setting": _LIT,
}
"""Slot of a word -> groups of parameters that may serve it."""
SURFACES = tuple(slot for slot, groups in MEANS.items() if PAINT in groups)
"""Slots of words about surfaces."""


def may_serve(group: str, slot: str, cause: str = "") -> bool:
    """Whether a group of parameters may serve a word.

    Args:
        group: Of the parameters.
        cause: The mood that stands for the word; "" for a word that the prompt says.
    """
    return group in MEANS[slot] and not (cause and group == PAINT)
