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
    """Removes data-blocks after the `with` block, whatever happens inside; yields the first."""
    try:
        yield block
    finally:
        bpy.data.batch_remove((block, *others))
