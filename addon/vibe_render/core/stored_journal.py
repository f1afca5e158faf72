# SPDX-License-Identifier: GPL-3.0-or-later
"""A journal in a custom property of its scene, where it is saved, undone and redone with what it describes; checked when it is read, for files come from other people."""

from __future__ import annotations

import json
from typing import Any

from bpy.types import ID, Scene

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
        entries = checked_entries(json.loads(stored["entries"]), count)
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


_COLLECTIONS = {"cameras", "collections", "lights", "materials", "meshes", "node_groups", "objects", "worlds"}
_TEXTS = {"link": {"DATA", "OBJECT"}}
"""The only properties that hold text, and what it may be."""


def checked_entries(raw: Any, count: int) -> list[dict[str, Any]]:
    """The entries of a journal of `count` data-blocks.

    Raises:
        ValueError: They are not what a journal writes.
    """
    if not isinstance(raw, list):
        raise ValueError("no list")
    for entry in raw:
        if not (isinstance(entry, dict) and _number(entry.get("id"), count) and _sound(entry, count)):
            raise ValueError(f"a strange entry: {str(entry)[:80]}")
    return raw


def _sound(entry: dict[str, Any], count: int) -> bool:
    op = entry.get("op")
    if op in ("slot", "compositor"):
        return True
    if op == "new":
        return entry.get("collection") in _COLLECTIONS
    path = entry.get("path")
    if not isinstance(path, str) or "animation_data" in path or "driver" in path:
        return False
    if op == "node":
        return isinstance(entry.get("node"), str)
    if op == "link":
        ends = [entry.get("source"), entry.get("target")]
        return all(map(_end, ends)) and (entry.get("old") is None or _end(entry["old"]))
    name = entry.get("name")
    is_property = op == "set" and isinstance(name, str) and name.isidentifier() and not name.startswith("_")
    return is_property and "old" in entry and _value(str(name), entry["old"], count)


def _value(name: str, old: Any, count: int) -> bool:
    if isinstance(old, dict):
        return _number(old.get("id"), count)
    if isinstance(old, str):
        return old in _TEXTS.get(name, ())
    numbers = old if isinstance(old, list) else [old]
    return old is None or all(isinstance(v, bool | int | float) for v in numbers)


def _number(value: Any, count: int) -> bool:
    return isinstance(value, int) and 0 <= value < count


def _end(value: Any) -> bool:
    return isinstance(value, list) and len(value) == 2 and all(isinstance(v, str) for v in value)
