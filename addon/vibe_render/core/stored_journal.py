# SPDX-License-Identifier: GPL-3.0-or-later
"""A journal in a custom property of its scene: it is saved, undone and redone together with what it speaks of."""

from __future__ import annotations

import json

from bpy.types import ID, Scene

from . import journal_check
from .journal import Journal

VERSION = 1
_MOST = 100_000  # data-blocks that a stored journal may speak of


class Newer(Exception):
    """It was stored by a newer version of ours."""


class Damaged(Exception):
    """It is not what a journal writes."""


def load(scene: Scene, key: str) -> Journal:
    """The journal in a property.

    Args:
        key: Of the property, which is there.

    Raises:
        Newer: See there.
        Damaged: See there.
    """
    stored = scene[key]
    try:
        if stored["version"] > VERSION:
            raise Newer
        count = min(int(stored["count"]), _MOST)
        ids = [scene if i == stored["self"] else stored["ids"].get(str(i)) for i in range(count)]
        entries = journal_check.entries(json.loads(stored["entries"]), count)
    except (TypeError, ValueError, KeyError, AttributeError, RecursionError) as error:
        raise Damaged from error
    return Journal(entries, [i if i is None or isinstance(i, ID) else None for i in ids])


def store(scene: Scene, key: str, journal: Journal) -> None:
    """Puts a journal into a property.

    Args:
        journal: Of changes in the scene's file.
    """
    # Pointers instead of names: they survive renaming, saving and reopening.
    # The scene itself is left out: it must not count as its own user.
    ids = {str(i): block for i, block in enumerate(journal.ids) if block not in (None, scene)}
    scene[key] = {
        "version": VERSION,
        "entries": json.dumps(journal.entries),
        "count": len(journal.ids),
        "self": journal.ids.index(scene) if scene in journal.ids else -1,
        "ids": ids,
    }
