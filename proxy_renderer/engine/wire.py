# SPDX-License-Identifier: Apache-2.0
"""The engine's end of the conversation with Blender, whose requests a thread hears while the loop runs."""

from __future__ import annotations

import queue
import threading
from typing import BinaryIO

from ..schema import VibeError, messages
from ..schema.messages import encode, read


class Wire:
    """The two ends of the conversation.

    A thread reads, so that "stop" is heard while the loop runs.

    Attributes:
        inbox: Requests in order; None when the other side has gone.
        anchored: Blender's answers to the engine's own requests.
        asked: Words whose reading is asked for, which nothing else holds up.
        stop: Set when the loop should end now.
    """

    def __init__(self, source: BinaryIO, sink: BinaryIO) -> None:
        self._source, self._sink = source, sink
        self._lock = threading.Lock()
        self.inbox: queue.Queue[messages.Message | VibeError | None] = queue.Queue()
        self.anchored: queue.Queue[messages.Anchored] = queue.Queue()
        self.asked: queue.Queue[messages.AskReadings] = queue.Queue()
        self.stop = threading.Event()
        threading.Thread(target=self._listen, daemon=True).start()

    def send(self, message: messages.Message) -> None:
        """Writes one message; quietly gives up when nobody listens any more."""
        try:
            with self._lock:
                self._sink.write(encode(message))
                self._sink.flush()
        except (BrokenPipeError, OSError):
            self.stop.set()

    def _listen(self) -> None:
        try:
            for message in read(self._source):
                if isinstance(message, messages.Vibe | messages.Glance):
                    self.stop.clear()
                    self.anchored = queue.Queue()  # what comes in it belongs to an earlier vibe
                elif isinstance(message, messages.Stop | messages.Quit):
                    self.stop.set()
                if isinstance(message, messages.Anchored):
                    self.anchored.put(message)
                elif isinstance(message, messages.AskReadings):
                    self.asked.put(message)
                elif not isinstance(message, messages.Stop):
                    self.inbox.put(message)
                if isinstance(message, messages.Quit):
                    return  # a thread that still reads would disturb the interpreter's end
        except VibeError as error:
            self.inbox.put(error)
        self.stop.set()
        self.inbox.put(None)
