# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings of many versions of Blender: assigned for good in what is ours, or for a while in what is not."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import bpy


def assign(owner: bpy.types.bpy_struct, **values: Any) -> None:
    """Sets properties, in this order. Those that this version of Blender does not have are left out."""
    for name, value in values.items():
        if name in owner.bl_rna.properties:
            setattr(owner, name, value)


@contextmanager
def changed(owner: bpy.types.bpy_struct, **values: Any) -> Iterator[None]:
    """Sets properties inside the block and restores the old values afterwards, in reverse order.

    Left as they are: properties that this version of Blender does not have, and those whose present value it would
    not take back, such as a choice in an older file that it has dropped.
    """
    old = []
    try:
        for name, value in values.items():
            if name in owner.bl_rna.properties:
                before = getattr(owner, name)
                # arrays are views into Blender's data: keep what they hold now
                before = before[:] if hasattr(before, "__len__") else before
                try:
                    setattr(owner, name, before)
                except TypeError:
                    continue
                old.append((name, before))
                setattr(owner, name, value)
        yield
    finally:
        for name, value in reversed(old):
            setattr(owner, name, value)
