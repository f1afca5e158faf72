# SPDX-License-Identifier: GPL-3.0-or-later
"""A vibe by goals in a file: the same values as by the prompt that they are of, and a preset that has them."""

import json

import pytest
from headless_runs import QUICK, run_headless, save_scene

from proxy_renderer.goals.written import read


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """The folders of a run by a prompt, of one by the goals in its report, and of one by those in its preset."""
    folder = tmp_path_factory.mktemp("goals")
    shot = save_scene(folder / "shot.blend")
    looks = {
        "prompt": "--prompt=dark oak box, glossy, cosy, cool light",
        "report": f"--goals={folder / 'prompt' / 'report.json'}",
        "preset": f"--goals={folder / 'prompt' / 'preset.json'}",
    }
    for name, look in looks.items():
        code, output = run_headless("run", shot, look, f"--out={folder / name}", *QUICK)
        assert code == 0, output
    return {name: folder / name for name in looks}


def report(folder):
    return json.loads((folder / "report.json").read_text("utf-8"))


@pytest.mark.slow
def test_goals_give_the_values_of_their_prompt(runs):
    first = report(runs["prompt"])
    values = {key: row["after"] for key, row in first["parameters"].items()}
    assert any(row["moved"] for row in first["parameters"].values())
    for name in ("report", "preset"):
        again = report(runs[name])
        assert {key: row["after"] for key, row in again["parameters"].items()} == values, name
        assert again["goals"] == first["goals"], name
        assert again["prompt"] == first["prompt"], name
        assert again["understood"]["whole"] == first["understood"]["whole"], name
        assert [row["word"] for row in again["claims"]] == [row["word"] for row in first["claims"]], name


@pytest.mark.slow
def test_the_preset_of_a_run_has_its_goals(runs):
    for name, folder in runs.items():
        preset = json.loads((folder / "preset.json").read_text("utf-8"))
        assert preset["goals"] == report(folder)["goals"], name
        assert preset["prompt"] == report(folder)["prompt"], name
        assert read(folder / "preset.json").wishes


@pytest.mark.slow
def test_goals_that_are_wrong_are_one_line_and_leave_nothing(tmp_path):
    shot = save_scene(tmp_path / "shot.blend")
    (tmp_path / "goals.json").write_text('{"words": [{"word": "x", "slot": "none"}]}')
    code, output = run_headless("run", shot, f"--goals={tmp_path / 'goals.json'}", f"--out={tmp_path / 'out'}", *QUICK)
    assert code == 2, output
    (line,) = [line for line in output.splitlines() if line.startswith("vibe: ")]
    assert "goals.words[0].slot is 'none'" in line
    assert "Traceback" not in output
    assert not (tmp_path / "out").exists() or not any((tmp_path / "out").iterdir())
