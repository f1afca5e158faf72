# SPDX-License-Identifier: Apache-2.0
"""Fitting the reader: weights that are fitted make what is right likely, and scenes left out are left out."""

import json

import pytest
from labeled_scene import sentence, write_folder

from lab.train.binding import accuracy, examples, fit, write
from lab.train.sentences import read_folder
from proxy_renderer.words.lexicon.vocabulary import shipped_vocabulary
from proxy_renderer.words.model import FILE

SENTENCES = "".join(
    sentence(text, *words)
    for text, *words in [
        ("red hull, warm light", ("red", "HullPaint"), ("warm", "light")),
        ("blue seat", ("blue", "SeatCloth")),
        ("glossy crate", ("glossy", "CrateWood")),
        ("hull green", ("green", "HullPaint")),
        ("the crate is yellow", ("yellow", "CrateWood")),
        ("cold desk lamp", ("cold", "light:Desk Lamp")),
        ("grey floor and black seat", ("grey", "Concrete"), ("black", "SeatCloth")),
    ]
)


@pytest.fixture
def every(tmp_path):
    return examples(read_folder(write_folder(tmp_path, sentences=SENTENCES)), shipped_vocabulary())


def test_fitted_weights_find_what_is_right(every):
    weights = fit(every, 0.1).weights
    assert sum(len(e.decided) for e in every) == 9
    assert accuracy([(e, weights) for e in every]) > accuracy([(e, {}) for e in every]) + 0.3


def test_each_fold_is_fitted_without_its_scenes(every):
    (weights,) = fit(every, 0.1, folds=2).without.values()  # all are of one scene
    assert not weights


def test_the_file_says_what_made_it(tmp_path):
    write(tmp_path / "w.json", {"a": 1.234, "b": 0.001}, "command", {"right": 0.5})
    assert json.loads((tmp_path / "w.json").read_text()) == {
        "made by": "command",
        "figures": {"right": 0.5},
        "weights": {"a": 1.23},
    }
    assert json.loads(FILE.read_text())["made by"].startswith("python -m ")
