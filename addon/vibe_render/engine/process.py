# SPDX-License-Identifier: GPL-3.0-or-later
"""Starts and ends the engine, the process that runs the search; talks to it in NUL-delimited JSON. No bpy here."""

from __future__ import annotations

import atexit
import contextlib
import os
import queue
import re
import subprocess
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import BinaryIO, TypeAlias, cast

from ..core.schema_import import errors, messages, schema
from .setup import engine_environment, find_python, own_group

_ABANDON_TIMEOUT = 10.0  # seconds that an engine may take to end a vibe that was given up

_REQUESTS = messages.Vibe | messages.Glance | messages.Finish | messages.Check
_ANSWERS = (messages.Result, messages.Glanced, messages.Finished, messages.Checked, messages.Error)

_Listener: TypeAlias = Callable[[messages.Message], None]
_Item: TypeAlias = messages.Message | schema.VibeError | None  # None: the engine's output has ended


class Engine:
    """The engine's process, which keeps running between vibes and ends with Blender.

    `python`: as `chosen` of `find_python`. `cache`: the folder of the engine's cache; None for the user's usual one.
    `listener`: a thread calls it with each stage and progress message. Methods raise a VibeError if the engine is not
    found, cannot be started, has another schema, reports an error or has ended.
    """

    def __init__(self, python: str = "", cache: Path | None = None, listener: _Listener | None = None) -> None:
        self._choice = python
        self._listener = listener  # called also while Blender is busy
        self._variables = {"VIBE_CACHE": str(cache)} if cache else {}
        self.log = errors.log_folder() / f"vibe-engine-{os.getpid()}.log"
        self._process: subprocess.Popen[bytes] | None = None
        self._inbox: queue.Queue[_Item] = queue.Queue()
        self._readings: queue.Queue[messages.Readings] = queue.Queue()
        self._busy = False  # the engine works on a request
        self._abandoned = False  # the request was given up: its answer is dropped
        self._abandoned_at = 0.0
        self._exit_error: schema.VibeError | None = None  # of an unexpected end; raised in every thread
        self._exit_lock, self._start_lock, self._send_lock = (threading.Lock() for _ in range(3))

    @property
    def alive(self) -> bool:
        """True if the process runs."""
        return self._process is not None and self._process.poll() is None

    def start(self) -> None:
        """Starts the process if it does not run; the process first sends `Ready`. Any thread may call this."""
        with self._start_lock:
            if self.alive:
                return
            python = find_python(self._choice)
            self._inbox, self._abandoned, self._busy, self._exit_error = queue.Queue(), False, False, None
            environment = {**engine_environment(), **self._variables}
            try:
                with self.log.open("wb") as log:
                    self._process = subprocess.Popen(
                        [python, "-m", "proxy_renderer.engine.worker"],
                        stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=log, env=environment, **own_group(),
                    )  # fmt: skip
            except OSError as error:
                message = f"The engine could not be started: {error}."
                raise schema.VibeError(message, f"Try {python} by hand.") from error
            output = cast(BinaryIO, self._process.stdout)
            threading.Thread(target=self._receive, args=(output, self._inbox), daemon=True).start()
            atexit.register(self.stop)

    def send(self, message: messages.Message) -> None:
        """Sends one message. Any thread may call this."""
        process = self._process
        if process is None or process.stdin is None:
            with self._exit_lock:  # another thread may be finding out why the engine ended
                raise self._exit_error or schema.VibeError("The engine is not running.", "Start it first.")
        try:
            with self._send_lock:
                process.stdin.write(messages.encode(message))
                process.stdin.flush()
                self._busy = self._busy or isinstance(message, _REQUESTS)
        except (OSError, ValueError) as error:
            raise self._report_exit() from error

    def poll(self) -> list[messages.Message]:
        """Messages since the last call, except `Readings`; never waits. Raises an error that the engine reports."""
        arrived: list[messages.Message] = []
        while True:
            try:
                item = self._inbox.get_nowait()
            except queue.Empty:
                return arrived
            if item is None:
                raise self._report_exit()
            if isinstance(item, _ANSWERS):
                self._busy = False
            if isinstance(item, schema.VibeError):
                raise item
            if isinstance(item, messages.Error):
                kind = errors.UnexpectedError if item.unexpected else schema.VibeError
                raise kind(item.message, item.remedy)
            if isinstance(item, messages.Ready):
                try:
                    messages.check_schema(item.schema, "engine")
                except schema.VibeError:
                    self.stop()
                    raise
            arrived.append(item)

    def poll_readings(self) -> messages.Readings | None:
        """The newest `Readings` (how a prompt's words are understood) since the last call; None if none has arrived."""
        newest = None
        while not self._readings.empty():
            newest = self._readings.get_nowait()
        return newest

    def abandon(self) -> None:
        """Gives up the request that the engine works on, and asks the engine to stop it."""
        if self._busy and self._abandoned:  # an earlier request that was given up has not ended yet
            self.stop(patience=0.2)
        elif self._busy:
            with contextlib.suppress(schema.VibeError):
                self.send(messages.Stop())
                self._abandoned, self._abandoned_at = True, time.monotonic()

    def settle(self) -> bool:
        """Drops messages of an abandoned request; returns True if the next one may be sent. Ends a hanging engine."""
        while self._abandoned:
            try:
                item = self._inbox.get_nowait()
            except queue.Empty:
                if time.monotonic() - self._abandoned_at > _ABANDON_TIMEOUT:
                    self.stop(patience=0.02)
                    self._abandoned = False
                return not self._abandoned
            self._abandoned = self._busy = isinstance(item, messages.Message) and not isinstance(item, _ANSWERS)
        return True

    def stop(self, patience: float = 3.0) -> None:
        """Asks the process to quit; terminates it, then kills it, each after `patience` seconds."""
        process, self._process = self._process, None
        atexit.unregister(self.stop)
        if process is None:
            return
        # If the engine hangs, a thread may be blocked in `send`: then the engine is ended without `Quit`.
        if self._send_lock.acquire(timeout=patience):
            with contextlib.suppress(OSError, ValueError):
                process.stdin.write(messages.encode(messages.Quit()))  # type: ignore[union-attr]
                process.stdin.close()  # type: ignore[union-attr]
            self._send_lock.release()
        for end in (lambda: None, process.terminate, process.kill):
            end()
            with contextlib.suppress(subprocess.TimeoutExpired):
                if process.wait(patience) == 0:
                    self.log.unlink(missing_ok=True)
                return

    def _report_exit(self) -> schema.VibeError:
        """The error to raise after the process has ended unexpectedly; the same object at each call."""
        with self._exit_lock:
            if self._exit_error:
                return self._exit_error
            code = None
            if self._process is not None:
                with contextlib.suppress(subprocess.TimeoutExpired):
                    code = self._process.wait(1.0)
            self.stop(patience=0.5)
            log = self.log.read_text(encoding="utf-8", errors="replace") if self.log.exists() else ""
            lines = log.strip().splitlines() or [""]
            last = next((line for line in reversed(lines) if re.match(r"\w+(Error|Exception)", line)), lines[-1])
            last_words = f" Its last words: {last}" if last else ""
            if code == -9 and not last:
                last_words = " Something ended it from outside: perhaps memory ran out."
            message = f"The engine stopped unexpectedly (exit code {code}).{last_words}"
            self._exit_error = schema.VibeError(message, f"Try again; if it happens again, see {self.log}.")
            return self._exit_error

    def _receive(self, stream: BinaryIO, inbox: queue.Queue[_Item]) -> None:
        """Puts `Readings` from `stream` into `_readings`, other messages into `inbox`; None into `inbox` at the end."""
        try:
            with stream:
                for message in messages.read(stream):
                    if isinstance(message, messages.Readings):
                        self._readings.put(message)
                        continue
                    inbox.put(message)
                    if self._listener and isinstance(message, messages.Stage | messages.Progress):
                        self._listener(message)
        except schema.VibeError as error:
            inbox.put(error)
        inbox.put(None)
