# SPDX-License-Identifier: Apache-2.0
"""What nobody expected: a line that names a log, and not too many logs."""

import os

from proxy_renderer.schema import errors


def test_the_trace_is_in_the_log_that_the_line_names(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("LOCALAPPDATA", str(tmp_path))
    try:
        {}["gone"]
    except KeyError as error:
        fault = errors.to_show(error, "reading the scene")
    (log,) = tmp_path.rglob("*.log")
    assert str(fault) == f"Something broke while reading the scene: KeyError: 'gone'. Please report it with {log}."
    assert "test_faults.py" in log.read_text()


def test_old_logs_go(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("LOCALAPPDATA", str(tmp_path))
    folder = errors.log_folder()
    for number in range(30):
        log = folder / f"vibe-{number}.log"
        log.touch()
        os.utime(log, (number, number))
    assert sorted(int(log.stem[5:]) for log in errors.log_folder().iterdir()) == list(range(10, 30))
