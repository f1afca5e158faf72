# SPDX-License-Identifier: GPL-3.0-or-later
"""Background work: runs a function in a daemon thread while Blender stays usable. No bpy here."""

from __future__ import annotations

import threading
from collections.abc import Callable
from concurrent.futures import Future
from typing import Any


def begin(act: Callable[[], Any]) -> Future:
    """Runs `act` in a daemon thread; returns the future of its result or exception. `act` must not use `bpy`."""
    future: Future = Future()

    def work() -> None:
        try:
            future.set_result(act())
        except BaseException as error:  # raised where the result is read
            future.set_exception(error)

    threading.Thread(target=work, daemon=True).start()
    return future
