# SPDX-License-Identifier: Apache-2.0
"""A process and all that it has started: Blender, its engine, and what they start."""

from __future__ import annotations

import contextlib

import psutil


def memory(number: int) -> int:
    """Bytes that a process and all it has started hold together; 0 if it is gone."""
    total = 0
    for process in _family(number):
        with contextlib.suppress(psutil.Error):
            total += process.memory_info().rss
    return total


def kill(number: int) -> None:
    """Ends a process and all it has started, the youngest first."""
    for process in reversed(_family(number)):
        with contextlib.suppress(psutil.Error):
            process.kill()


def _family(number: int) -> list[psutil.Process]:
    try:
        first = psutil.Process(number)
        return [first, *first.children(recursive=True)]
    except psutil.Error:
        return []
