# SPDX-License-Identifier: Apache-2.0
"""`python -m lab`: its commands, and a user's mistakes in one line."""

import subprocess
import sys

import pytest

from lab.__main__ import TRAININGS, main
from lab.bench.options import BENCHES


def test_help_lists_every_command(capsys):
    with pytest.raises(SystemExit) as ended:
        main(["--help"])
    assert ended.value.code == 0
    told = capsys.readouterr().out
    first = {line.split()[0] for line in told.splitlines() if line.startswith("  ")}
    assert {*BENCHES, *TRAININGS} <= first


def test_mistakes_are_one_line(tmp_path, capsys):
    with pytest.raises(SystemExit) as ended:
        main(["beauty", "--out", str(tmp_path)])
    assert ended.value.code == 2
    assert "lab: " in capsys.readouterr().err
    assert main(["ladder", "--rungs", "magic", "--out", str(tmp_path)]) == 2
    assert capsys.readouterr().err.startswith("lab: No rung has a name like 'magic'")


@pytest.mark.parametrize("name", TRAININGS)
def test_what_makes_what_is_shipped_has_its_own_help(name, capsys):
    with pytest.raises(SystemExit) as ended:
        main([name, "--help"])
    assert ended.value.code == 0
    assert f"python -m lab {name}" in capsys.readouterr().out


def test_starting_loads_nothing_heavy():
    code = "import lab.__main__ as m; m.parser(); import sys; print('torch' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stdout.strip() == "False"
