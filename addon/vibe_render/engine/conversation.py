# SPDX-License-Identifier: GPL-3.0-or-later
"""Requests to the engine and its answers, received by a thread while Blender renders. No bpy here."""

from __future__ import annotations

import os
import queue
import signal
import socket
import threading
from collections.abc import Callable
from typing import Any, TypeVar

from ..core.schema_import import messages, schema
from .process import Engine

_Answer = TypeVar("_Answer", messages.Result, messages.Finished)


class Conversation:
    """Requests and answers, one after the other, with one engine.

    Args:
        tell: Called from a thread with every stage and progress message.
    """

    def __init__(self, engine: Engine, tell: Callable[[messages.Message], None]) -> None:
        self._engine, self._tell = engine, tell
        self._answers: queue.Queue[messages.Message | schema.VibeError] = queue.Queue()
        self._asked = False
        self._interrupted = False
        threading.Thread(target=self._listen, daemon=True).start()

    def ask(self, request: messages.Vibe | messages.Finish) -> None:
        """Sends a request. If `stop` was called before, the vibe ends with its first best look.

        Raises:
            VibeError: The engine is gone.
        """
        self._engine.send(request)
        self._asked = True
        if self._interrupted:
            self._engine.send(messages.Stop())

    def wait(
        self, kind: type[_Answer], serve: Callable[[messages.Anchor], messages.Anchored] | None = None
    ) -> _Answer:
        """Waits for the answer to the last request.

        Args:
            serve: Renders the anchors that the engine asks for meanwhile.

        Raises:
            VibeError: The engine reports an error, or is gone.
        """
        while True:
            try:
                answer = self._answers.get(timeout=0.2)  # lets signals through
            except queue.Empty:
                continue
            if isinstance(answer, schema.VibeError):
                raise answer
            if serve and isinstance(answer, messages.Anchor):
                self._engine.send(serve(answer))
            if isinstance(answer, kind):
                return answer

    def stop(self) -> None:
        """Asks for the best look so far."""
        self._interrupted = True
        if self._asked:
            self._engine.send(messages.Stop())

    def _listen(self) -> None:
        try:
            for message in self._engine.messages():
                if isinstance(message, messages.Stage | messages.Progress):
                    self._tell(message)
                else:
                    self._answers.put(message)
        except schema.VibeError as error:
            self._answers.put(error)


def on_interrupt(act: Callable[[], Any]) -> None:
    """Calls `act`, from a thread, at the first Ctrl-C or SIGTERM; a second one ends the process.

    Python runs signal handlers between its own instructions, of which there are none while Cycles
    renders: so a thread reads the signals' numbers from a socket.
    """
    reading, writing = socket.socketpair()
    writing.setblocking(False)
    for number in (signal.SIGINT, signal.SIGTERM, getattr(signal, "SIGBREAK", None)):
        if number is not None:
            signal.signal(number, lambda number, frame: None)
    signal.set_wakeup_fd(writing.fileno(), warn_on_full_buffer=False)

    def watch() -> None:
        with writing:  # kept open for as long as somebody listens
            reading.recv(1)
            act()
            reading.recv(1)
            os._exit(130)

    threading.Thread(target=watch, daemon=True).start()
