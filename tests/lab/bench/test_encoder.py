# SPDX-License-Identifier: Apache-2.0
"""`python -m lab encoder` measures what it says on pictures that it makes itself."""

import json
from pathlib import Path

import numpy as np
import pytest
import torch
from PIL import Image

from lab.bench import encoder
from lab.bench.encoder.mistakes import save_mistakes
from lab.train.evaluate import Mistake
from lab.train.pictures.looks import NAMES


@pytest.mark.slow
def test_the_command_measures_and_writes(tmp_path: Path) -> None:
    results = encoder.run(tmp_path / "out", views=6, pairs=0, cache_folder=str(tmp_path / "cache"))
    written = json.loads((tmp_path / "out" / "results.json").read_text())
    assert all(0 <= written[name] <= 1 for name in ("attribute_flip", "swap", "synonym"))
    assert written["synonym"] <= written["synonym_by_language"] == results["synonym_by_language"]
    assert {*written["heads"]} == {*written["flips"]} == {*NAMES}
    assert {*written["sets"]} == {"meshes", "wordings", "raw wordings"}
    for asked in ("wordings", "raw wordings"):  # no wording of a vignette is kept back
        assert "vignette" not in written["sets"][asked]["flip_by_attribute"]
    assert written["heads"]["brightness"] > 0.8
    assert (tmp_path / "out" / "mistakes.png").is_file()


def test_no_mistake_leaves_no_sheet(tmp_path: Path) -> None:
    sheet = tmp_path / "mistakes.png"
    wrong = Mistake(torch.rand(3, 20, 20), "swap", "red on blue", "blue on red")
    save_mistakes([wrong] * 30, sheet)
    with Image.open(sheet) as picture:
        assert np.asarray(picture).std() > 10
    save_mistakes([], sheet)
    assert not sheet.exists()
