# SPDX-License-Identifier: GPL-3.0-or-later
"""Validates a stored journal: files come from other people, and may be damaged.

Nothing that it may do goes beyond taking back a vibe: numbers, flags, data-blocks, links and nodes.
"""

from __future__ import annotations

from typing import Any

_COLLECTIONS = {"cameras", "collections", "lights", "materials", "meshes", "node_groups", "objects", "worlds"}
_TEXTS = {"link": {"DATA", "OBJECT"}}
"""The only properties that hold text, and what it may be."""


def entries(raw: Any, count: int) -> list[dict[str, Any]]:
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
