# SPDX-License-Identifier: GPL-3.0-or-later
"""A preview: values that are in the scene for as long as a vibe runs, and can be taken away without a trace.

It is no part of the snapshot: the vibe's result is written where the artist's values are. What the artist changes while
a preview is shown stays changed.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import bpy
from bpy.types import Object, Scene

from ..core import rendered, stored_journal
from ..core.journal import Journal
from ..scene import bindings

KEY = "vibe_preview"


def show(
    scene: Scene, values: Mapping[str, Sequence[float]], subject: Sequence[Object], pivot: Sequence[float]
) -> None:
    """Shows values in place of those that are shown; a failure, as of `bindings.write`, shows none."""
    _take_away(scene)
    journal = Journal()
    try:
        bindings.put(journal, scene, values, subject, pivot)
    except BaseException:
        journal.undo()
        raise
    finally:
        rendered.layer(scene).update()
    shown = Journal()
    shown.extend(journal)  # the first record of each value
    shown.remember()
    stored_journal.store(scene, KEY, shown)


def exists(scene: Scene) -> bool:
    """True if one is shown."""
    return KEY in scene


def hide(scene: Scene) -> None:
    """Takes the preview away, if there is one; the scene is the artist's."""
    if exists(scene):
        _take_away(scene)
        rendered.layer(scene).update()


def hide_all() -> None:
    """Takes it away from every scene: one that an undo or a file has brought back, and that no vibe shows."""
    for scene in bpy.data.scenes:
        if scene.is_editable:
            hide(scene)


def _take_away(scene: Scene) -> None:
    if not exists(scene):
        return
    journal = stored_journal.sound(scene, KEY)
    del scene[KEY]  # first: it counts as a user of what is to be removed
    journal.undo()
