# SPDX-License-Identifier: GPL-3.0-or-later
"""A journal in a custom property of its scene, where it is saved, undone and redone with what it describes.

It is checked when it is read: files come from other people, and may be damaged. Nothing that it may do goes beyond taking
back a vibe: numbers, flags, data-blocks, links, nodes and keyframes.
"""

from __future__ import annotations

import json
from typing import Any

from bpy.types import ID, Scene

from .journal import Journal

VERSION = 1
_MOST = 100_000  # data-blocks that a stored journal may name
_COLLECTIONS = {
    "actions",
    "cameras",
    "collections",
    "lights",
    "materials",
    "meshes",
    "node_groups",
    "objects",
    "worlds",
}
_TEXTS = {"link": {"DATA", "OBJECT"}}
"""Properties that hold text, and what it may be. The only other one is the name of a light group."""


class Newer(Exception):
    """It was stored by a newer version of ours."""


class Damaged(Exception):
    """It is not what a journal writes."""


def load(scene: Scene, key: str) -> Journal:
    """The journal in a property of the scene, which has it; raises `Newer` or `Damaged`."""
    stored = scene[key]
    try:
        if stored["version"] > VERSION:
            raise Newer
        count = min(int(stored["count"]), _MOST)
        ids = [scene if i == stored["self"] else stored["ids"].get(str(i)) for i in range(count)]
        entries = json.loads(stored["entries"])
        if not isinstance(entries, list) or not all(_is_entry(entry, count) for entry in entries):
            raise Damaged
    except (TypeError, ValueError, KeyError, AttributeError, RecursionError) as error:
        raise Damaged from error
    return Journal(entries, [i if i is None or isinstance(i, ID) else None for i in ids])


def sound(scene: Scene, key: str) -> Journal:
    """The journal in a property of the scene; an empty one where there is none, or one that cannot be read."""
    try:
        return load(scene, key) if key in scene else Journal()
    except (Newer, Damaged):
        return Journal()


def store(scene: Scene, key: str, journal: Journal) -> None:
    """Puts a journal of changes in the scene's file into a property."""
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


def _is_entry(entry: Any, count: int) -> bool:
    """True if this is an entry that a journal of so many data-blocks writes."""
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
            return _is_old(name, old, count)
    return False


def _is_old(name: str, old: Any, count: int) -> bool:
    """True if this is a value that a property may have had."""
    if isinstance(old, dict):
        return _is_index(old.get("id"), count)
    if isinstance(old, str):
        return name == "lightgroup" or old in _TEXTS.get(name, ())
    return old is None or _are_numbers(old)


def _are_numbers(value: Any) -> bool:
    return all(isinstance(v, bool | int | float) for v in (value if isinstance(value, list) else [value]))


def _is_index(value: Any, count: int) -> bool:
    return isinstance(value, int) and 0 <= value < count
