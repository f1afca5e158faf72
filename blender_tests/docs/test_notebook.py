# SPDX-License-Identifier: GPL-3.0-or-later
"""The notebook of the examples runs, and finds the light that it hides."""

import importlib
import json
import sys
from pathlib import Path

import matplotlib
import pytest

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"


@pytest.mark.slow
def test_the_notebook_finds_the_light_again(tmp_path, monkeypatch):
    matplotlib.use("Agg")
    (tmp_path / "examples").mkdir()
    monkeypatch.syspath_prepend(str(EXAMPLES))
    monkeypatch.setattr(sys, "argv", ["blender", "--", str(tmp_path / "out" / "examples" / "bust.blend")])
    script = importlib.import_module("bust")
    script.b.run(script.build)

    monkeypatch.chdir(tmp_path / "examples")  # where the notebook lies
    names = {}
    for cell in json.loads((EXAMPLES / "differentiate.ipynb").read_text(encoding="utf-8"))["cells"]:
        if cell["cell_type"] == "code":
            exec("".join(cell["source"]), names)
    assert names["losses"][-1] < names["losses"][0] / 20
    assert ((names["found"] - names["hidden"]).abs() < names["scale"] / 4).all()
    assert all(value.grad.abs() > 0 for value in names["values"].values())
