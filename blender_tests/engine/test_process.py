# SPDX-License-Identifier: GPL-3.0-or-later
"""The engine's process from Blender's side, without a real engine: what several threads send, and what the panel forgets."""

import io
import threading
import time
from types import SimpleNamespace

from vibe_render.engine.process import Engine
from vibe_render.ui.engine_state import EngineState

from proxy_renderer.schema import VibeError, messages


class SlowPipe:
    """Takes a message in pieces, as a pipe that is nearly full."""

    def __init__(self):
        self.written = bytearray()

    def write(self, data):
        for start in range(0, len(data), 40):
            self.written += data[start : start + 40]
            time.sleep(0.001)

    def flush(self):
        pass


def test_messages_of_several_threads_arrive_whole():
    engine, pipe = Engine(), SlowPipe()
    engine._process = SimpleNamespace(stdin=pipe, poll=lambda: None)
    prompts = {f"{number} {'red ' * 50}" for number in range(8)}
    requests = [messages.Glance("hash", "job", prompt) for prompt in prompts]
    senders = [threading.Thread(target=engine.send, args=(request,)) for request in requests]
    for sender in senders:
        sender.start()
    for sender in senders:
        sender.join()
    assert {message.prompt for message in messages.read(io.BytesIO(bytes(pipe.written)))} == prompts


def test_closing_forgets_what_is_known_of_the_engine():
    state = EngineState()
    fresh = dict(vars(state))
    state.problem, state.outcome, state.succeeded = VibeError("None.", "Set it up."), "failed", False
    state._choice = "/somewhere"
    state.close()
    assert vars(state) == fresh


def test_closing_makes_no_new_state():
    """A class that knows more is closed like any other."""

    class Counted(EngineState):
        made = 0

        def __init__(self, name):
            super().__init__()
            self.name = name
            Counted.made += 1

    state = Counted("ours")
    state.close()
    assert (state.name, Counted.made) == ("ours", 1)
