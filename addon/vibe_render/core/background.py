# SPDX-License-Identifier: GPL-3.0-or-later
"""Background work: a function in a daemon thread while Blender stays usable. No bpy here."""

from __future__ import annotations

import threading
from collections.abc import Callable
from concurrent.futures import Future
from typing import TypeVar

T = TypeVar("T")


def begin(act: Callable[[], T]) -> Future[T]:
    """Starts a function, which must not touch Blender's data, in a daemon thread; returns its result or exception."""
    future: Future[T] = Future()

    def work() -> None:
        try:
            future.set_result(act())
        except BaseException as error:  # it belongs to whoever asks for the result
            future.set_exception(error)

    threading.Thread(target=work, daemon=True).start()
    return future
