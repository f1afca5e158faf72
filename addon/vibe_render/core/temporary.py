# SPDX-License-Identifier: GPL-3.0-or-later
"""Temporary data-blocks: removed from the file when they are no longer needed."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import bpy
from bpy.types import ID


@contextmanager
def temporary(block: Any, *others: ID) -> Iterator[Any]:
    """Yields `block`; removes `block` and `others` from the file after the `with` block, even after an exception."""
    try:
        yield block
    finally:
        bpy.data.batch_remove((block, *others))
