# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs `python -m lab` as a reader would."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]


def bench(name: str, out: Path, cache: Path | None, *options: str) -> subprocess.CompletedProcess[str]:
    """The measurement to its end, with what it printed."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT), str(ROOT / "addon")])}
    command = [sys.executable, "-m", "lab", name, f"--out={out}"]
    command += [f"--cache={cache}"] if cache else []
    return subprocess.run([*command, *options], env=environment, capture_output=True, text=True, timeout=300)
