# SPDX-License-Identifier: GPL-3.0-or-later
"""One Blender with a warm engine for many command lines: a worker of `vibe batch`.

Every line of the standard input is a command line of `batch.py`, as a JSON list. Each ends with a "result" or an
"error" event. The end of the input ends the process, also in the middle of a command.
"""

from __future__ import annotations

import json
import os
import queue
import sys
import threading

from ..core.schema_import import errors, schema
from ..engine.conversation import Conversation
from ..engine.process import Engine
from . import commands, vibe
from .arguments import parse
from .reporter import Reporter

_GRACE = 5.0
"""Seconds from the end of the input to the end of a busy process."""


def serve() -> None:
    """Runs the command lines of the standard input, one after the other, until it ends."""
    lines: queue.SimpleQueue[str | None] = queue.SimpleQueue()
    threading.Thread(target=_listen, args=(lines,), daemon=True).start()
    reporter, engine = Reporter(events=True), Engine()
    engine.start()
    conversation = Conversation(engine, reporter.engine)
    try:
        while line := lines.get():
            if not engine.alive:
                engine = Engine()
                engine.start()
                conversation = Conversation(engine, reporter.engine)
            try:
                _run_command(json.loads(line), reporter, conversation)
            except Exception as error:  # the next command opens a file of its own
                known = error if isinstance(error, schema.VibeError) else None
                reporter.error(known or errors.unexpected(error, reporter.doing))
                engine.stop(patience=0.1)  # it may be in the middle of something
    finally:
        engine.stop()


def _run_command(arguments: list[str], reporter: Reporter, conversation: Conversation) -> None:
    args = parse(arguments)
    if args.command == "run":
        vibe.run_with_engine(args, reporter, conversation)
    else:
        commands.COMMANDS[args.command](args, reporter)


def _listen(lines: queue.SimpleQueue[str | None]) -> None:
    """Reads in a thread, so that this process ends soon after its parent, also while Blender is busy."""
    for line in sys.stdin:
        lines.put(line)
    lines.put(None)
    threading.Event().wait(_GRACE)
    os._exit(1)
