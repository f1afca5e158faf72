# SPDX-License-Identifier: Apache-2.0
"""What the engine asks of the C library's allocator."""

from __future__ import annotations

import ctypes
import sys

_TRIM_THRESHOLD, _MMAP_THRESHOLD = -1, -3  # of mallopt(3)
_KEPT = 2**30  # bytes


def keep_freed_memory() -> None:
    """Has glibc keep up to a gigabyte of what is freed; elsewhere nothing changes.

    An array over 32 MB is else the system's again as soon as it is freed, and the next one is cleared page by page: a step
    of a picture of 2048² took twice as long for that.
    """
    if sys.platform != "linux":
        return
    library = ctypes.CDLL(None)
    if hasattr(library, "mallopt"):
        library.mallopt(_MMAP_THRESHOLD, _KEPT)
        library.mallopt(_TRIM_THRESHOLD, _KEPT)
