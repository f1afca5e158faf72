# SPDX-License-Identifier: GPL-3.0-or-later
"""Snapshot: a scene's values before a vibe, kept inside the .blend so that Revert works after reopening.

Only what was touched is kept: a journal (see `core/journal.py`) in a custom property of the scene.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager

from bpy.types import ID, Scene

from ..core import journal_check
from ..core.journal import Journal
from ..core.schema_import import schema
from . import scene_context, stored_subject

KEY = "vibe_snapshot"
VERSION = 1
_MOST = 100_000  # data-blocks that a stored snapshot may speak of


def take(scene: Scene) -> None:
    """Starts a snapshot, which `revert` returns to; one that exists already stays."""
    if not exists(scene):
        _store(scene, Journal())


def exists(scene: Scene) -> bool:
    """Whether there is something to revert to."""
    return KEY in scene


def forget(scene: Scene) -> None:
    """Keeps the scene as it is now, for good."""
    if exists(scene):
        del scene[KEY]


def revert(scene: Scene) -> list[str]:
    """Restores every value, link and data-block that has been touched since `take`, and forgets it.

    Returns:
        What could not be restored because the artist has removed it meanwhile.

    Raises:
        VibeError: There is no snapshot, or one of a newer version, or a damaged one.
    """
    journal = _load(scene)
    forget(scene)  # first: it counts as a user of what is to be removed
    stored_subject.forget(scene)
    lost = journal.undo()
    scene_context.layer(scene).update()
    return lost


def mark(scene: Scene) -> int:
    """The number of recorded entries, for `rollback`."""
    return len(_load(scene).entries) if exists(scene) else 0


def rollback(scene: Scene, first: int) -> None:
    """Undoes everything recorded since `mark`; removes a snapshot that is then empty."""
    journal = _load(scene)
    forget(scene)
    journal.undo(first)
    if first:
        _store(scene, journal)


@contextmanager
def transaction(scene: Scene) -> Iterator[Journal]:
    """A journal for changes inside the block: kept in the snapshot, or undone after an exception."""
    whole = _load(scene) if exists(scene) else Journal()  # first: a damaged one stops us here
    journal = Journal()
    try:
        yield journal
    except BaseException:
        journal.undo()
        raise
    if journal.entries:
        whole.extend(journal)
        _store(scene, whole)


def _load(scene: Scene) -> Journal:
    if not exists(scene):
        raise schema.VibeError(
            "This scene has no snapshot to revert to.", "Only a vibed scene can be reverted."
        )
    stored = scene[KEY]
    try:
        if stored["version"] > VERSION:
            raise schema.VibeError(
                "This scene was vibed by a newer version of Vibe Render.", "Update Vibe Render, then revert."
            )
        count = min(int(stored["count"]), _MOST)
        ids = [scene if i == stored["self"] else stored["ids"].get(str(i)) for i in range(count)]
        entries = journal_check.entries(json.loads(stored["entries"]), count)
    except (TypeError, ValueError, KeyError, AttributeError, RecursionError) as error:
        raise schema.VibeError(
            "What this scene was like before its vibe is damaged in this file.",
            "Press Keep: the values stay as they are now, and the next vibe starts from them.",
        ) from error
    return Journal(entries, [i if i is None or isinstance(i, ID) else None for i in ids])


def _store(scene: Scene, journal: Journal) -> None:
    # Pointers instead of names: they survive renaming, saving and reopening.
    # The scene itself is left out: it must not count as its own user.
    ids = {str(i): block for i, block in enumerate(journal.ids) if block not in (None, scene)}
    scene[KEY] = {
        "version": VERSION,
        "entries": json.dumps(journal.entries),
        "count": len(journal.ids),
        "self": journal.ids.index(scene) if scene in journal.ids else -1,
        "ids": ids,
    }
