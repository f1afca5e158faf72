# SPDX-License-Identifier: GPL-3.0-or-later
"""batch.py whose engine is killed, at every kind of work that it has for it: one clear line, and no file at all."""

import os
import signal
import subprocess
import sys
import time

import pytest
from headless_runs import BATCH_PY, QUICK, save_scene

STAGES = {
    "looking": ('"progress"', 500),
    "waiting for an anchor": ("comparing with Cycles", 1),
    "composing the pictures": ("rendering with Cycles", 1),
}


@pytest.mark.slow
@pytest.mark.parametrize("stage", STAGES)
def test_an_engine_that_dies_leaves_nothing(tmp_path, stage):
    heard, rounds = STAGES[stage]
    shot, out = save_scene(tmp_path / "shot.blend"), tmp_path / "out"
    held = shot.read_bytes()
    command = [sys.executable, str(BATCH_PY), "--events", "run", str(shot), "--prompt=blue box", f"--out={out}"]
    command += [*QUICK, f"--rounds={rounds}", f"--steps={rounds + 1}"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, encoding="utf-8") as process:
        assert any(heard in line for line in process.stdout)
        (engine,) = children(process.pid)
        os.kill(engine, signal.SIGSTOP)  # what it is asked next, it is in the middle of
        end = time.monotonic() + 60.0
        while stage.startswith("composing") and not list(out.glob(".part-*-preset.json")):
            assert time.monotonic() < end
            time.sleep(0.05)
        os.kill(engine, signal.SIGKILL)
        output = process.stdout.read()
    assert process.wait() == 2, output
    assert "engine stopped unexpectedly" in output
    assert "Traceback" not in output
    assert not any(out.iterdir())
    assert shot.read_bytes() == held


def children(pid):
    """The processes that a process has started."""
    listed = subprocess.run(["ps", "-o", "pid=", "--ppid", str(pid)], capture_output=True, text=True).stdout
    return [int(number) for number in listed.split()]
