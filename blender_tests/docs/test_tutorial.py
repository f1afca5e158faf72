# SPDX-License-Identifier: GPL-3.0-or-later
"""The tutorial's commands, in their order, with the smallest budget."""

import json
import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
TUTORIAL = ROOT / "docs" / "start" / "tutorial.md"
SMALL = {"run": "--rounds 1 --steps 4 --size 96 --samples 4 --no-anchor", "apply": "--size 96 --samples 4"}
"""What makes a command quick, by its first word; later options win."""


def commands():
    """The lines of the tutorial's shell blocks."""
    blocks = re.findall(r"^```sh\n(.*?)^```", TUTORIAL.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
    return [line for block in blocks for line in block.splitlines()]


def printed():
    """The lines that the tutorial says that `vibe explain` prints."""
    block = re.search(r"^```text\n(.*?)^```", TUTORIAL.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)[1]
    return [line for line in block.splitlines() if line != "…"]


def arguments(line):
    """What runs for a line: this Python, this clone's code, a small budget."""
    program, *words = shlex.split(line)
    if program == "python":
        return [sys.executable, str(ROOT / words[0]), *words[1:]]
    assert program == "vibe", line
    more = shlex.split(SMALL.get(words[0], ""))
    if "--variants" in words:
        more += ["--variants", "2"]
    return [sys.executable, "-m", "proxy_renderer.cli", *words, *more]


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_the_tutorial_runs_from_the_first_command_to_the_last(tmp_path):
    (tmp_path / "out").mkdir()
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT), str(ROOT / "addon")])}
    lines = commands()
    assert len(lines) == 7
    for line in lines:
        done = subprocess.run(arguments(line), cwd=tmp_path, env=environment, capture_output=True, text=True)
        assert done.returncode == 0, (line, done.stdout, done.stderr)
        if line.startswith("vibe explain"):
            assert [each for each in printed() if each not in done.stdout.splitlines()] == []
    teal = tmp_path / "out" / "teal"
    promised = re.findall(r"^\| (`.*?`) \|", TUTORIAL.read_text(encoding="utf-8"), re.MULTILINE)
    names = [name for row in promised for name in re.findall(r"`(.*?)`", row)]
    assert len(names) == 7
    assert all((teal / name).is_file() for name in names)
    assert (tmp_path / "out/looks/variants.png").is_file()
    assert (tmp_path / "out/looks/preset-2.json").is_file()
    locked = json.loads((tmp_path / "out/mist/report.json").read_text())["parameters"]
    materials = [p for key, p in locked.items() if key.startswith("material/")]
    assert materials
    assert all(p["before"] == p["after"] for p in materials)
