# SPDX-License-Identifier: GPL-3.0-or-later
"""Stores journals in custom properties of the scene: Blender saves, undoes and redoes them together with it."""

from __future__ import annotations

import json
from typing import Any

from bpy.types import ID, Scene

from .journal import Journal

VERSION = 1
_MOST = 100_000  # data-blocks that a stored journal may name
_COLLECTIONS = {
    "actions", "cameras", "collections", "lights", "materials", "meshes", "node_groups", "objects", "worlds",
}  # fmt: skip


class Newer(Exception):
    """The journal was stored by a newer version of Vibe Render."""


class Damaged(Exception):
    """The stored data is not what `store` writes."""


def load(scene: Scene, key: str) -> Journal:
    """The journal in the scene's custom property `key`, which has to exist. Raises `Newer` or `Damaged`."""
    stored = scene[key]
    try:
        if stored["version"] > VERSION:
            raise Newer
        count = min(int(stored["count"]), _MOST)
        ids = [scene if i == stored["self"] else stored["ids"].get(str(i)) for i in range(count)]
        entries = json.loads(stored["entries"])
        # Files may be damaged or come from other people: entries can do no more than take back a vibe.
        if not isinstance(entries, list) or not all(_is_entry(entry, count) for entry in entries):
            raise Damaged
    except (TypeError, ValueError, KeyError, AttributeError, RecursionError) as error:
        raise Damaged from error
    return Journal(entries, [i if i is None or isinstance(i, ID) else None for i in ids])


def sound(scene: Scene, key: str) -> Journal:
    """The journal in the scene's custom property `key`; an empty one if there is none, or if it cannot be read."""
    try:
        return load(scene, key) if key in scene else Journal()
    except (Newer, Damaged):
        return Journal()


def store(scene: Scene, key: str, journal: Journal) -> None:
    """Stores a journal in the scene's custom property `key`."""
    # Pointers instead of names: they survive renaming, saving and reopening.
    # The scene itself is left out: it must not count as its own user.
    ids = {str(i): block for i, block in enumerate(journal.ids) if block not in (None, scene)}
    own = journal.ids.index(scene) if scene in journal.ids else -1
    stored = {"version": VERSION, "entries": json.dumps(journal.entries)}
    scene[key] = stored | {"count": len(journal.ids), "self": own, "ids": ids}


def _is_entry(entry: Any, count: int) -> bool:
    """True if `entry` has the form that `Journal` writes, and refers to one of `count` data-blocks."""
    if not (isinstance(entry, dict) and _is_index(entry.get("id"), count)):
        return False
    path = entry.get("path")
    match entry:
        case {"op": "slot" | "compositor"}:
            return True
        case {"op": "new", "collection": collection}:
            return collection in _COLLECTIONS
        case _ if not isinstance(path, str) or "animation_data" in path or "driver" in path:
            return False
        case (
            {"op": "node", "node": str()}
            | {"op": "lightgroup", "name": str()}
            | {"op": "action", "had": bool(), "slot": str()}
            | {"op": "curve", "curve": str(), "index": int()}
            | {"op": "link", "source": [str(), str()], "target": [str(), str()], "old": None | [str(), str()]}
        ):
            return True
        case {"op": "held", "curve": str(), "key": str(), "index": int(), "keys": list(keys), "was": was}:
            return all(map(_are_numbers, [*keys, was]))
        case {"op": "set", "name": str(name), "old": old} if name.isidentifier() and name[0] != "_":
            if isinstance(old, dict):
                return _is_index(old.get("id"), count)
            if isinstance(old, str):
                return name == "lightgroup" or (name == "link" and old in ("DATA", "OBJECT"))
            return old is None or _are_numbers(old)
    return False


def _are_numbers(value: Any) -> bool:
    return all(isinstance(v, bool | int | float) for v in (value if isinstance(value, list) else [value]))


def _is_index(value: Any, count: int) -> bool:
    return isinstance(value, int) and 0 <= value < count
