# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender properties for the schema's options."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from types import MappingProxyType
from typing import Any

import bpy
from bpy.props import BoolProperty, IntProperty, StringProperty

from ..core import compat
from ..core.schema_import import options

_Update = Callable[[Any, bpy.types.Context], None]


def declare(
    name: str,
    preferences: bool,
    table: Iterable[options.Option] = options.TABLE,
    updates: Mapping[str, _Update] = MappingProxyType({}),
) -> type:
    """A class whose annotations are properties, to be inherited by the one that Blender registers.

    Args:
        preferences: For the add-on's preferences, else for the scene.
        table: The options; those with choices, whose titles are the panel's, are left out.
        updates: Option to what is called when it changes.
    """
    rows = [row for row in table if row.panel and row.panel.preferences == preferences and not row.choices]
    properties = {row.name: _property(row, updates.get(row.name)) for row in rows}
    return type(name, (), {"__annotations__": properties, "__module__": __name__})


def _property(row: options.Option, update: _Update | None) -> Any:
    panel = row.panel
    assert panel is not None
    facts: dict[str, Any] = {"name": panel.title, "description": panel.description}
    if isinstance(row.default, bool):
        return BoolProperty(**facts, default=row.default)
    if isinstance(row.default, int):
        bounds = panel.bounds or row.bounds
        facts |= {"min": bounds[0], "max": bounds[1]} if bounds else {}
        return IntProperty(**facts, default=row.default)
    if update:
        facts["update"] = update
    if panel.suggestions:
        facts |= {
            "search": lambda _owner, _context, _text: panel.suggestions,
            "search_options": {"SUGGESTION"},
        }
    facts |= {"options": {"TEXTEDIT_UPDATE"}} if panel.live else {}
    facts |= {"subtype": "FILE_PATH", "options": compat.RELATIVE_PATHS} if panel.path else {}
    return StringProperty(**facts, default=panel.default, maxlen=panel.length)
