# SPDX-License-Identifier: GPL-3.0-or-later
"""Cycles pictures for the encoder: pairs that differ in one attribute, with masks and labels."""

from pathlib import Path

import numpy as np

from lab.train.pictures import cycles, looks


def test_pairs_are_rendered_with_labels(tmp_path: Path) -> None:
    cycles.build(tmp_path / "real", pairs=2, first_seed=11, size=48, samples=4)
    real = cycles.load(tmp_path / "real")
    assert real["pictures"].shape == (4, 3, 48, 48)
    assert real["labels"].shape == (4, len(looks.NAMES))
    assert [kind == -1 for kind in real["flipped"]] == [True, False, True, False]
    for first in (0, 2):
        pair = real["pictures"][first : first + 2].astype(float)
        assert np.abs(pair[0] - pair[1]).mean() > 0.2
        assert 0.01 < (real["masks"][first] > 127).mean() < 0.9
        assert np.array_equal(real["masks"][first], real["masks"][first + 1])
