# SPDX-License-Identifier: Apache-2.0
"""A Blender that crashes: one line with its last words, a log, and nothing else is left."""

import signal
import sys

import pytest

from proxy_renderer.blender import launch
from proxy_renderer.schema.errors import UnexpectedError

BLENDER = """
import os, signal, sys, tempfile
out = sys.argv[-1]
open(f"{out}/.part-{os.getpid()}-abcd-after.png", "w").close()
tempfile.mkdtemp(prefix="blender_")
print('VIBE {"type": "stage", "name": "reading the scene"}')
print("Error: Manta has no domain")
print("Fra:1 Mem:11M")
sys.stdout.flush()
os.kill(os.getpid(), signal.SIGABRT)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="has no signals")
def test_a_crash_is_one_line_and_a_log(tmp_path, monkeypatch):
    out, scratch, logs = (tmp_path / name for name in ("out", "scratch", "logs"))
    for folder in (out, scratch):
        folder.mkdir()
    (out / ".part-1-mine.png").touch()
    script = tmp_path / "blender.py"
    script.write_text(BLENDER)
    monkeypatch.setattr(launch, "blender_side", lambda: script)
    monkeypatch.setattr(launch.tempfile, "tempdir", str(scratch))
    monkeypatch.setenv("XDG_STATE_HOME", str(logs))
    monkeypatch.setenv("HOME", str(logs))
    with pytest.raises(UnexpectedError) as crashed:
        launch.launch(["run", str(out)], out)
    assert "crashed while reading the scene (Aborted)" in crashed.value.message
    assert "Manta has no domain" in crashed.value.message
    (log,) = logs.rglob("*.log")
    assert str(log) in crashed.value.remedy
    assert "Fra:1 Mem:11M" in log.read_text()
    assert not list(scratch.iterdir())
    assert [path.name for path in out.iterdir()] == [".part-1-mine.png"]  # another process's


def test_last_words_are_not_the_trace():
    assert launch.last_words(["fine\n", "Fatal Python error: Aborted\n", '  File "a.py", line 1\n']) == "fine"
    assert launch.last_words([]) == ""


@pytest.fixture
def in_foreground():
    """Ctrl-C as in a terminal: a job in the background ignores it."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.skipif(sys.platform == "win32", reason="has no signals")
@pytest.mark.usefixtures("in_foreground")
def test_ctrl_c_is_ours_again_when_blender_has_ended(tmp_path, monkeypatch):
    """`vibe explain SCENE` goes on afterwards."""
    script = tmp_path / "blender.py"
    script.write_text('print(\'VIBE {"type": "result", "lines": []}\')')
    monkeypatch.setattr(launch, "blender_side", lambda: script)
    numbers = (signal.SIGINT, signal.SIGTERM)
    before = [signal.getsignal(number) for number in numbers]
    assert launch.launch(["export", "shot.blend"], tmp_path) == 0
    assert [signal.getsignal(number) for number in numbers] == before
    with pytest.raises(KeyboardInterrupt):
        signal.raise_signal(signal.SIGINT)
