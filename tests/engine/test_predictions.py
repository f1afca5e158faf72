# SPDX-License-Identifier: Apache-2.0
"""How far predictions are said to be from Cycles' picture."""

import numpy as np
import pytest

from proxy_renderer.engine import pictures

BLACK = np.zeros((10, 10, 3), np.float32)


def test_the_subject_and_the_worst_pixels_are_told_apart_from_the_mean():
    after, subject = BLACK.copy(), np.zeros((10, 10), np.float32)
    after[0] = 1.0
    subject[0, :5] = subject[1, :5] = 1.0
    figures = pictures.apart(BLACK, after, subject)
    assert figures["mean"] == pytest.approx(10, abs=1e-2)
    assert figures["subject"] == pytest.approx(50, abs=1e-2)
    assert figures["p95"] == pytest.approx(100, abs=1e-2)


def test_a_subject_that_nobody_sees_has_no_figure():
    assert set(pictures.apart(BLACK, BLACK, BLACK[..., 0])) == {"mean", "p95"}
