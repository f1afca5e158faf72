# SPDX-License-Identifier: Apache-2.0
"""The engine's process: answers requests on its standard streams.

Start it with `python -m proxy_renderer.engine.worker`. It says "ready" before it imports anything heavy,
then warms up while the other side exports the scene, and stays warm between vibes.
"""

from __future__ import annotations

import ctypes
import os
import queue
import sys
import threading
import time
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

from .. import __version__
from ..folders import cache_folder
from ..optimize.progress import BEFORE, PREVIEW
from ..schema import VibeError, atomic, errors, messages, schema_hash
from ..schema.messages import check_schema, encode, read

if TYPE_CHECKING:
    from torch import Tensor

    from ..optimize.known_picture import KnownPicture
    from ..optimize.looks import EarlyLook
    from .live import Glances
    from .session import EngineSession


_ANSWER_SECONDS = 600.0  # most that Blender may take to answer: it may be rendering something else first


class Wire:
    """The connection to Blender's process: sends messages, and sorts those that arrive into queues."""

    def __init__(self, source: BinaryIO, sink: BinaryIO) -> None:
        self._source, self._sink = source, sink
        self._lock = threading.Lock()
        # requests in order; None when the other side has gone
        self.inbox: queue.Queue[messages.Message | VibeError | None] = queue.Queue()
        self.anchored: queue.Queue[messages.Anchored] = queue.Queue()  # answers to the engine's own requests
        # requests to read a prompt; a thread of its own answers them without a delay
        self.asked: queue.Queue[messages.AskReadings] = queue.Queue()
        self.stop = threading.Event()  # set when the loop should end now
        threading.Thread(target=self._listen, daemon=True).start()  # hears "stop" while the loop runs

    def send(self, message: messages.Message) -> None:
        """Writes one message; quietly gives up when nobody listens any more."""
        try:
            with self._lock:
                self._sink.write(encode(message))
                self._sink.flush()
        except OSError:
            self.stop.set()

    def _listen(self) -> None:
        try:
            for message in read(self._source):
                if isinstance(message, messages.Vibe | messages.Glance):
                    self.stop.clear()
                    self.anchored = queue.Queue()  # answers that are still in it belong to an earlier vibe
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
    """Reports the search's progress to Blender's process, and tells the search when to end."""

    def __init__(self, wire: Wire, job: Path, wants_looks: bool = False) -> None:
        self._wire, self._job, self.wants_looks = wire, job, wants_looks
        self._previewed = self._reported = 0.0

    def stage(self, name: str) -> None:
        """Reports the name of a stage outside of the loop."""
        self._wire.send(messages.Stage(name))

    def begin(self, display: Tensor, lit: bool) -> None:
        """Sends the image (H, W, 3) of the artist's values; `lit`: False if it is black and the words add no light."""
        from .pictures import save_picture

        save_picture(display, self._job / BEFORE)
        self._wire.send(messages.Stage("looking for the look", BEFORE, lit))

    def look(self, look: EarlyLook) -> None:
        """Sends an early look; if its image is not drawn yet, the previous image stays."""
        self._wire.send(look_message(look, self._job))

    def step(self, progress: messages.Progress, display: Tensor) -> bool:
        """Reports a step and its image (H, W, 3); returns True if the search should end.

        Reports are sent at most ten times a second and after a round's last step, images at most once a second.
        """
        from .pictures import save_picture

        now = time.monotonic()
        if now - self._previewed > 1.0:
            save_picture(display, self._job / progress.preview)
            self._previewed = now
        if now - self._reported > 0.1 or progress.step == progress.steps:
            self._wire.send(progress)
            self._reported = now
        return self.stopped()

    def stopped(self) -> bool:
        """True if the search should end."""
        return self._wire.stop.is_set()

    def ask(self, request: messages.Anchor) -> messages.Anchored | None:
        """Blender's answer to a request for a render, an error if that fails or is late; None to end the search."""
        if not self.stopped():
            self._wire.send(request)
        end = time.monotonic() + _ANSWER_SECONDS
        while not self.stopped() and time.monotonic() < end:
            with suppress(queue.Empty):
                answer = self._wire.anchored.get(timeout=0.1)
                if answer.number == request.number:
                    return answer
        if self.stopped():
            return None
        return messages.Anchored(request.number, error=f"no answer within {_ANSWER_SECONDS:.0f} s")


def look_message(look: EarlyLook, job: Path) -> messages.LookSoFar:
    """The message of a look, whose image is written into the job folder."""
    from .pictures import save_picture

    if look.display is not None:
        save_picture(look.display, job / PREVIEW)
    values = {key: list(value) for key, value in look.values.items()}
    return messages.LookSoFar(values, "" if look.display is None else PREVIEW, dict(look.words))


def serve(source: BinaryIO, sink: BinaryIO) -> None:
    """Answers requests until the other side quits or closes the stream. A failure becomes an `Error` message."""
    wire = Wire(source, sink)
    wire.send(messages.Ready(schema_hash(), __version__))
    warming = threading.Thread(target=_warm_up, daemon=True)
    warming.start()
    warming.join()
    threading.Thread(target=_read_words, args=(wire,), daemon=True).start()
    session: EngineSession | None = None
    glances: Glances | None = None
    while True:
        request = wire.inbox.get()
        if request is None or isinstance(request, messages.Quit):
            return
        try:
            if isinstance(request, VibeError):
                raise request
            if isinstance(request, messages.Vibe):
                goes_on = request.options.get("goes_on", False)
                known = session.last_picture if session and goes_on else None
                session = None
                session = _vibe(wire, request, known)
            elif isinstance(request, messages.Glance):
                from .live import Glances

                glances = glances or Glances()
                wire.send(_glance(wire, request, glances))
            elif session is None:
                raise VibeError("There is nothing to finish or to check.", "Send a vibe first.")
            elif isinstance(request, messages.Finish):
                wire.send(session.finish(request))
            elif isinstance(request, messages.Check):
                wire.send(session.check(request))
        except Exception as error:
            wire.send(_error(request, error))


def _error(request: messages.Message | VibeError, error: Exception) -> messages.Error:
    """The message for an error that was raised while a request was answered."""
    if isinstance(error, MemoryError):
        return messages.Error("The engine ran out of memory.", "Use a smaller --size or a lighter scene.")
    if isinstance(error, OSError) and atomic.is_full(error):
        folder = getattr(request, "job", "") or Path(getattr(request, "compare_out", "")).parent
        return messages.Error(f"There is no room left on the disk, in {folder}.", "Make room there.")
    shown = errors.to_show(error, "the engine was at work")
    return messages.Error(shown.message, shown.remedy, unexpected=shown is not error)


def _vibe(wire: Wire, request: messages.Vibe, known: KnownPicture | None) -> EngineSession:
    """Carries out one vibe, sends its result, and returns its session.

    A further sentence starts from `known`, the last anchor of the previous vibe; None for other vibes.
    """
    check_schema(request.schema, "add-on")
    options = messages.Options.from_dict(request.options)
    job = Path(request.job)
    observer = RemoteObserver(wire, job, request.looks)
    observer.stage("loading the engine")
    from .session import EngineSession

    shots = request.shots or [messages.Shot(request.job, "", "")]
    session = EngineSession(shots, request.prompt, options, observer, request.vlm_key, known)
    result = session.run()
    if request.looks:  # the panel shows the prediction
        observer.stage("drawing the prediction")
        session.draw()
    wire.send(result)
    if not request.looks:
        session.draw()
    return session


def _glance(wire: Wire, request: messages.Glance, glances: Glances) -> messages.Glanced:
    """The answer to a request for a first look; empty if no word is known yet, or the request was stopped."""
    check_schema(request.schema, "add-on")
    look = glances.look(request, wire.stop.is_set)
    if look is None:
        return messages.Glanced({})
    return messages.Glanced(**vars(look_message(look, Path(request.job))), before=BEFORE)


def _read_words(wire: Wire) -> None:
    """Answers requests to read a prompt, in an endless loop; of several that wait, only the newest."""
    from . import live

    while True:
        request = wire.asked.get()
        while not wire.asked.empty():
            request = wire.asked.get()
        try:
            check_schema(request.schema, "add-on")
            answer = live.answer(request)
        except Exception as error:  # the panel shows it, and the next character is another try
            answer = messages.Readings(request.prompt, note=_error(request, error).message)
        wire.send(answer)


def _warm_up() -> None:
    """Imports torch, and loads the embedded encoder and the vocabulary; errors are reported when a vibe needs them."""
    if sys.platform == "linux":
        # Nobody has asked yet. At a priority of 10, of 19, an engine on a busy machine took a minute to be warm.
        os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), 5)
    with suppress(VibeError):
        from ..guidance.encoder import load_encoder
        from ..words.lexicon.vocabulary import default_vocabulary
        from . import live, session  # noqa: F401

        load_encoder(None, "cpu")
        default_vocabulary()


def keep_freed_memory() -> None:
    """Has glibc, on Linux, keep up to 1 GiB of freed memory.

    By default, glibc returns arrays over 32 MB to the system, which clears the pages of new ones: steps at 2048² pixels
    took twice as long.
    """
    if sys.platform == "linux" and hasattr(library := ctypes.CDLL(None), "mallopt"):
        for threshold in (-3, -1):  # M_MMAP_THRESHOLD and M_TRIM_THRESHOLD of mallopt(3)
            library.mallopt(threshold, 2**30)


def main() -> None:
    """Runs the worker on this process's standard streams.

    Blender may render at the same time, so torch's threads sleep instead of spinning while they wait for a core. There are
    half as many threads as logical processors, because often two of these share a core. The loop's images are small: two
    threads on one core used a fifth more processor time than one thread, and were not faster.
    """
    os.environ.setdefault("OMP_WAIT_POLICY", "PASSIVE")
    os.environ.setdefault("OMP_NUM_THREADS", str(max((os.cpu_count() or 1) // 2, 1)))
    # torch's default is a temporary folder
    os.environ.setdefault("TORCHINDUCTOR_CACHE_DIR", str(cache_folder("compiled")))
    keep_freed_memory()
    sink = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())  # whatever else prints must not break the protocol
    serve(sys.stdin.buffer, sink)


if __name__ == "__main__":
    main()
