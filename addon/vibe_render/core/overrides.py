# SPDX-License-Identifier: GPL-3.0-or-later
"""Temporary changes of settings."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import bpy


@contextmanager
def changed(owner: bpy.types.bpy_struct, **values: Any) -> Iterator[None]:
    """Sets properties inside the block and restores the old values afterwards, in reverse order.

    Properties that this version of Blender does not have are left out.
    """
    old = []
    try:
        for name, value in values.items():
            if name in owner.bl_rna.properties:
                before = getattr(owner, name)
                # arrays are views into Blender's data: keep what they hold now
                old.append((name, before[:] if hasattr(before, "__len__") else before))
                setattr(owner, name, value)
        yield
    finally:
        for name, value in reversed(old):
            setattr(owner, name, value)
