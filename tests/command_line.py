# SPDX-License-Identifier: Apache-2.0
"""The real command `vibe`, and how it refuses what cannot be used."""

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]


def vibe(*arguments, cwd):
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT), str(ROOT / "addon")])}
    command = [sys.executable, "-m", "proxy_renderer.cli", *map(str, arguments)]
    return subprocess.run(command, cwd=cwd, env=environment, capture_output=True, text=True, timeout=240)


def assert_refused(done, *words):
    """Exit code 2, one line on stderr that holds the words, and no traceback anywhere."""
    assert done.returncode == 2, done.stderr
    assert len(done.stderr.strip().splitlines()) == 1, done.stderr
    assert "Traceback" not in done.stdout + done.stderr
    for word in words:
        assert word in done.stderr
