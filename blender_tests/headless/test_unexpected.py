# SPDX-License-Identifier: GPL-3.0-or-later
"""What nobody expected, on Blender's side: one line, a log, no file."""

import sys

from headless_runs import save_scene
from vibe_render import batch
from vibe_render.render import final_render


def test_a_fault_is_one_line_and_a_log(tmp_path, monkeypatch, capfd):
    def broken(*arguments, **options):
        raise TypeError('enum "" not found in\n(BW, RGB)')

    shot, out, logs = save_scene(tmp_path / "shot.blend"), tmp_path / "out", tmp_path / "logs"
    held = shot.read_bytes()
    monkeypatch.setenv("XDG_STATE_HOME", str(logs))
    monkeypatch.setattr(final_render, "render_picture", broken)
    monkeypatch.setattr(sys, "argv", ["batch.py", "apply", "noir", str(shot), f"--out={out}"])
    assert batch.main() == 1
    (line,) = [line for line in capfd.readouterr().err.splitlines() if line.startswith("vibe: ")]
    (log,) = logs.rglob("*.log")
    assert line.startswith("vibe: Something broke while rendering before: TypeError: enum")
    assert str(log) in line
    assert "in broken" in log.read_text()
    assert not list(out.iterdir())
    assert shot.read_bytes() == held
