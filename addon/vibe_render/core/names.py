# SPDX-License-Identifier: GPL-3.0-or-later
"""Replaces names that are not valid UTF-8, from old files or some importers: Blender's Python cannot read them."""

from __future__ import annotations

from collections.abc import Iterator

import bpy
from bpy.types import ID, bpy_struct

from .schema_import import schema

_PARTS = ("nodes", "attributes", "uv_layers", "vertex_groups", "modifiers", "view_layers", "bones", "key_blocks")
"""Collections inside data-blocks whose items have a name, or refer to others by name."""
_replaced: list[str] = []  # names that `note` has not reported yet


def make_readable() -> None:
    """Rewrites names and other texts of the file that are not valid UTF-8. Raises VibeError for a linked data-block."""
    for struct in _structs():
        for name in (p.identifier for p in struct.bl_rna.properties if p.type == "STRING" and not p.is_readonly):
            try:
                getattr(struct, name)
            except UnicodeDecodeError as error:
                # A text that was cut inside a character loses that character; others are read as Latin-1.
                cut = error.reason == "unexpected end of data"
                text = error.object[: error.start].decode() if cut else error.object.decode("latin-1")
                block = struct if isinstance(struct, ID) else struct.id_data
                if not block.is_editable:
                    message = f'"{text}" in {bpy.path.basename(block.library.filepath)} is no UTF-8.'
                    raise schema.VibeError(message, "Rename it there and save that file again.") from error
                setattr(struct, name, text)
                if text not in _replaced:
                    _replaced.append(text)


def _structs() -> Iterator[bpy_struct]:
    """All data-blocks, and the parts of them that have names."""
    for name in (p.identifier for p in bpy.data.bl_rna.properties if p.type == "COLLECTION"):
        for block in getattr(bpy.data, name):
            for owner in filter(None, (block, getattr(block, "node_tree", None))):
                yield owner
                for part in _PARTS:
                    yield from getattr(owner, part, ())


def note() -> str:
    """A note for the artist on the names replaced since the last call; "" if there are none."""
    names = ", ".join(_replaced[:3]) + (f" and {len(_replaced) - 3} more" if len(_replaced) > 3 else "")
    _replaced.clear()
    return f"Names that are no UTF-8 cannot be read; they have been replaced: {names}." if names else ""
