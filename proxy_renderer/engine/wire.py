# SPDX-License-Identifier: Apache-2.0
"""The engine's side of the conversation with Blender: messages in and out, and the observer of the loop that sends them."""

from __future__ import annotations

import queue
import threading
import time
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO, TypeVar

from ..optimize.progress import BEFORE, PREVIEW
from ..schema import VibeError, messages
from ..schema.messages import encode, read

if TYPE_CHECKING:
    from torch import Tensor

    from ..optimize.looks import EarlyLook
_PREVIEW_SECONDS = 1.0
_PROGRESS_SECONDS = 0.1
_ANSWER_SECONDS = 600.0  # most that Blender may take to answer: it may be rendering something else first
_Look = TypeVar("_Look", bound=messages.LookSoFar)


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


class RemoteObserver:
    """Tells the other side how the loop goes, and the loop when to end."""

    def __init__(self, wire: Wire, job: Path, wants_looks: bool = False) -> None:
        self._wire, self._job, self.wants_looks = wire, job, wants_looks
        self._previewed = self._reported = 0.0

    def stage(self, name: str) -> None:
        """Reports what is going on outside of the loop."""
        self._wire.send(messages.Stage(name))

    def begin(self, display: Tensor, lit: bool) -> None:
        """Shows the image (H, W, 3) of the artist's own values; Blender ends what is not `lit`."""
        from .pictures import save_picture

        save_picture(display, self._job / BEFORE)
        self._wire.send(messages.Stage("looking for the look", BEFORE, lit))

    def look(self, look: EarlyLook) -> None:
        """Hands a look over; one whose image is not drawn yet leaves the last image as it is."""
        self._wire.send(look_message(messages.LookSoFar, look, self._job))

    def step(self, progress: messages.Progress, display: Tensor) -> bool:
        """Reports a step, with its image (H, W, 3) about once a second; returns whether the loop should end."""
        from .pictures import save_picture

        now = time.monotonic()
        if now - self._previewed > _PREVIEW_SECONDS:
            save_picture(display, self._job / progress.preview)
            self._previewed = now
        if now - self._reported > _PROGRESS_SECONDS or progress.step == progress.steps:
            self._wire.send(progress)
            self._reported = now
        return self.stopped()

    def stopped(self) -> bool:
        """True to end the loop."""
        return self._wire.stop.is_set()

    def ask(self, request: messages.Anchor) -> messages.Anchored | None:
        """Has Blender render, and waits; its answer holds the error if that failed or is overdue; None if the loop is to end."""
        if not self._wire.stop.is_set():
            self._wire.send(request)
        end = time.monotonic() + _ANSWER_SECONDS
        while not self._wire.stop.is_set() and time.monotonic() < end:
            try:
                answer = self._wire.anchored.get(timeout=0.1)
            except queue.Empty:
                continue
            if answer.number == request.number:
                return answer
        if self._wire.stop.is_set():
            return None
        return messages.Anchored(request.number, error=f"no answer within {_ANSWER_SECONDS:.0f} s")


def look_message(kind: type[_Look], look: EarlyLook, job: Path) -> _Look:
    """The message of a look, whose image is written into the job folder."""
    from .pictures import save_picture

    if look.display is not None:
        save_picture(look.display, job / PREVIEW)
    values = {key: list(value) for key, value in look.values.items()}
    return kind(values, "" if look.display is None else PREVIEW, dict(look.words))
