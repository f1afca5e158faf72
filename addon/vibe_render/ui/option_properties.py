# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender properties for the schema's options."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from bpy.props import BoolProperty, IntProperty, StringProperty

from ..core.schema_import import options


def declare(name: str, preferences: bool, table: Iterable[options.Option] = options.TABLE) -> type:
    """A class whose annotations are properties, to be inherited by the one that Blender registers.

    Args:
        name: Of the class.
        preferences: For the add-on's preferences, else for the scene.
        table: The options; those with choices, whose titles are the panel's, are left out.
    """
    rows = [row for row in table if row.panel and row.panel.preferences == preferences and not row.choices]
    return type(
        name, (), {"__annotations__": {row.name: _property(row) for row in rows}, "__module__": __name__}
    )


def _property(row: options.Option) -> Any:
    panel = row.panel
    assert panel is not None
    facts: dict[str, Any] = {"name": panel.title, "description": panel.description}
    if isinstance(row.default, bool):
        return BoolProperty(**facts, default=row.default)
    if isinstance(row.default, int):
        bounds = panel.bounds or row.bounds
        facts |= {"min": bounds[0], "max": bounds[1]} if bounds else {}
        return IntProperty(**facts, default=row.default)
    if panel.suggestions:
        facts |= {
            "search": lambda _owner, _context, _text: panel.suggestions,
            "search_options": {"SUGGESTION"},
        }
    facts |= {"options": {"TEXTEDIT_UPDATE"}} if panel.live else {}
    return StringProperty(**facts, default=panel.default, maxlen=panel.length)
