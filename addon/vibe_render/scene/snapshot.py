# SPDX-License-Identifier: GPL-3.0-or-later
"""Snapshot: a scene's values before a vibe, kept inside the .blend so that Revert works after reopening.

It keeps only values that were changed: a journal (see `core/journal.py`) in a custom property of the scene.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from bpy.types import Scene

from ..core import rendered, stored_journal
from ..core.journal import Journal
from ..core.schema_import import schema
from . import keyframes, steps
from .subject import forget_subject

KEY = "vibe_snapshot"


def take(scene: Scene) -> None:
    """Starts a snapshot of the scene as it is, for `revert`; keeps an existing one."""
    if not exists(scene):
        stored_journal.store(scene, KEY, Journal())


def exists(scene: Scene) -> bool:
    """True if the scene has a snapshot."""
    return KEY in scene


def forget(scene: Scene) -> None:
    """Keeps the scene and its keyframes as they are now: removes the snapshot and the list of steps."""
    for key in (KEY, steps.KEY):
        scene.pop(key, None)
    keyframes.forget(scene)


def revert(scene: Scene) -> list[str]:
    """Restores all values changed since `take`, removes the snapshot; returns, in words, what could not be restored."""
    journal = load(scene)
    lost = keyframes.take_away(scene)
    forget(scene)  # first: the property counts as a user of the blocks to remove
    forget_subject(scene)
    lost += journal.undo()
    rendered.layer(scene).update()
    return lost


def mark(scene: Scene) -> int | None:
    """The number of recorded entries, for `rollback`; None without a snapshot."""
    return len(load(scene).entries) if exists(scene) else None


def rollback(scene: Scene, first: int | None) -> None:
    """Undoes everything recorded since `mark` returned `first`; if `first` is None, removes the snapshot, too."""
    if not exists(scene):
        return
    journal = load(scene)
    del scene[KEY]
    journal.undo(first or 0)
    if first is not None:
        stored_journal.store(scene, KEY, journal)


@contextmanager
def rollback_on_failure(scene: Scene) -> Iterator[None]:
    """Undoes the changes recorded inside the block if the block raises an exception."""
    start, keyed = mark(scene), keyframes.are_shown(scene)
    try:
        yield
    except BaseException:
        if keyed:
            keyframes.bring_back(scene)
        rollback(scene, start)
        raise


@contextmanager
def transaction(scene: Scene) -> Iterator[Journal]:
    """Yields a journal for changes in the block: they join the snapshot, or are undone if the block raises."""
    whole = load(scene) if exists(scene) else Journal()  # first: a damaged one raises before any change
    journal, keyed = Journal(), keyframes.set_aside(scene)  # the keyframes would override the changes
    try:
        yield journal
    except BaseException:
        journal.undo()
        if keyed:
            keyframes.bring_back(scene)
        raise
    if journal.entries:
        whole.extend(journal)
        stored_journal.store(scene, KEY, whole)


@contextmanager
def undone(scene: Scene) -> Iterator[Journal]:
    """Yields a journal for changes that are undone at the end of the block."""
    journal = Journal()
    try:
        yield journal
    finally:
        journal.undo()
        rendered.layer(scene).update()


def load(scene: Scene) -> Journal:
    """The journal of all changes since `take`; raises VibeError without a snapshot, or for a newer or damaged one."""
    if not exists(scene):
        raise schema.VibeError("This scene has no snapshot to revert to.", "Only a vibed scene can be reverted.")
    try:
        return stored_journal.load(scene, KEY)
    except stored_journal.Newer as error:
        message = "This scene was vibed by a newer version of Vibe Render."
        raise schema.VibeError(message, "Update Vibe Render, then revert.") from error
    except stored_journal.Damaged as error:
        message = "What this scene was like before its vibe is damaged in this file."
        remedy = "Press Keep: the values stay as they are now, and the next vibe starts from them."
        raise schema.VibeError(message, remedy) from error
