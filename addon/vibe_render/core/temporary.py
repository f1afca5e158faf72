# SPDX-License-Identifier: GPL-3.0-or-later
"""Data-blocks of ours that a file has only for a moment."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TypeVar

import bpy
from bpy.types import ID

Block = TypeVar("Block", bound=ID)
_PLURALS = {"MESH": "meshes", "NODETREE": "node_groups"}
"""Kind of data-block -> its collection in `bpy.data`; the others have an "s"."""


@contextmanager
def temporary(block: Block, *others: ID) -> Iterator[Block]:
    """Removes data-blocks after the `with` block, in this order, whatever happens inside; yields the first."""
    try:
        yield block
    finally:
        for each in (block, *others):
            kind = each.id_type
            getattr(bpy.data, _PLURALS.get(kind, f"{kind.lower()}s")).remove(each)
