# SPDX-License-Identifier: GPL-3.0-or-later
"""The subject that was chosen for the last vibe or preset, kept in the .blend: later ones mean the same.

Without it, a look that was found for one thing would go onto everything prominent when it is applied again.
"""

from __future__ import annotations

import json
from collections.abc import Iterable

from bpy.types import Object, Scene

KEY = "vibe_subject"


def remember(scene: Scene, subject: Iterable[Object]) -> None:
    """Keeps a choice that was made by somebody, not by us."""
    scene[KEY] = json.dumps([thing.name_full for thing in subject])


def recall(scene: Scene) -> list[Object]:
    """What is left of the last choice; nothing if there was none."""
    try:
        names = json.loads(scene.get(KEY, "[]"))
    except (TypeError, ValueError):  # somebody else's file
        return []
    wanted = {name for name in names if isinstance(name, str)} if isinstance(names, list) else set()
    return [thing for thing in scene.objects if thing.name_full in wanted]


def forget(scene: Scene) -> None:
    """From now on the choice is ours again."""
    if KEY in scene:
        del scene[KEY]
