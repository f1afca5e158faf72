# SPDX-License-Identifier: GPL-3.0-or-later
"""Engines that are killed or hang: a clear message, the scene as it was, and a next vibe that works."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import bpy
import pytest
from dump import contents, difference
from vibe_render.run import session
from vibe_render.run.state import addon_state
from vibing import advance, fails

STAGES = {  # when it is reached, with how many steps
    "starting": (lambda running: running.stage == session.READING, 2),
    "asked": (lambda running: running.asked, 2),
    "waiting for an anchor": (lambda running: running.stage == session.ANCHORING, 2),
    "looking": (lambda running: running.progress, 1000),
    "writing its pictures": (lambda running: running.stage == "Drawing the prediction", 2),
}


@pytest.mark.slow
def test_killed_at_each_stage_and_then_a_vibe(addon):
    """Each next one comes as far as to its own end, the last to its result, and back."""
    before, settings = contents(), addon.vibe
    settings.anchor, settings.rounds, settings.size = True, 1, 256  # large: the last pictures take a while
    for until, settings.steps in STAGES.values():
        running = advance(until)
        os.kill(running._engine._process.pid, signal.SIGKILL)
        assert "stopped unexpectedly" in fails(running)
        assert addon_state.failure.remedy
        assert difference(before, contents()) == {}
    settings.size = 64
    assert bpy.ops.vibe.run() == {"FINISHED"}
    assert settings.changes
    assert addon_state.failure is None
    assert bpy.ops.vibe.revert() == {"FINISHED"}
    assert difference(before, contents()) == {}


def test_given_up_for_its_silence(addon, monkeypatch):
    before = contents()
    monkeypatch.setattr(session, "SILENT", 1.0)
    running = advance(lambda r: r.asked)
    hung = running._engine._process
    os.kill(hung.pid, signal.SIGSTOP)
    time.sleep(1.2)
    while running.silence < session.SILENT:  # what it had said before
        assert running.advance()
        time.sleep(0.3)
    addon_state.cancel()
    assert hung.wait(10)  # killed, a process needs a moment to give its memory back
    assert difference(before, contents()) == {}


@pytest.mark.slow
def test_an_engine_that_hangs_when_given_up_does_not_hold_up_the_next(addon, monkeypatch):
    from vibe_render.engine import process

    monkeypatch.setattr(process, "_ABANDON_TIMEOUT", 0.5)
    running = advance(lambda r: r.asked)
    hung = running._engine._process
    os.kill(hung.pid, signal.SIGSTOP)
    addon_state.cancel()
    advance(lambda r: r.asked)
    assert hung.wait(10)
    addon_state.cancel()


ORPHAN = """
import os, signal, sys, time
from pathlib import Path
from vibe_render.engine.process import Engine
engine = Engine("", Path(sys.argv[1]))
engine.start()
print(engine._process.pid, flush=True)
os.kill(os.getpid(), signal.SIGKILL)
"""


@pytest.mark.slow
def test_no_engine_outlives_its_blender(tmp_path):
    """Not even one that is killed, and so cannot say goodbye."""
    command = [sys.executable, "-c", ORPHAN, str(tmp_path / "log")]
    done = subprocess.run(command, capture_output=True, text=True)
    pid, end = int(done.stdout), time.monotonic() + 120.0
    while _lives(pid) and time.monotonic() < end:
        time.sleep(0.2)
    assert not _lives(pid)


def _lives(pid):
    state = Path(f"/proc/{pid}/stat")
    return state.exists() and state.read_text().rpartition(")")[2].split()[0] != "Z"
