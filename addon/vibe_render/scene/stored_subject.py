# SPDX-License-Identifier: GPL-3.0-or-later
"""Stored subject: the subject of the last vibe or preset, kept in the .blend for the next ones.

Without it, a look that was found for one thing would go onto everything prominent when it is applied again.
"""

from __future__ import annotations

import json
from collections.abc import Iterable

from bpy.types import Object, Scene

SUBJECT_KEY = "vibe_subject"


def remember_subject(scene: Scene, subject: Iterable[Object]) -> None:
    """Stores a subject that the artist has chosen."""
    scene[SUBJECT_KEY] = json.dumps([thing.name_full for thing in subject])


def recall_subject(scene: Scene) -> list[Object]:
    """The stored subject's objects that still exist; empty without a stored subject."""
    try:
        names = json.loads(scene.get(SUBJECT_KEY, "[]"))
    except (TypeError, ValueError):  # somebody else's file
        return []
    wanted = {name for name in names if isinstance(name, str)} if isinstance(names, list) else set()
    return [thing for thing in scene.objects if thing.name_full in wanted]


def forget_subject(scene: Scene) -> None:
    """Forgets the stored subject: the next one is found automatically."""
    if SUBJECT_KEY in scene:
        del scene[SUBJECT_KEY]
