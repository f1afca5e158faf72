# SPDX-License-Identifier: Apache-2.0
"""What guidance by encoders costs, beside each other."""

import logging

import pytest

from lab.bench.speed import encoders


@pytest.mark.slow
def test_each_encoder_takes_its_time_and_warnings_are_back():
    told = encoders.milliseconds()
    assert set(told) == {"embedded", "ViT-B-32, random weights"}
    assert min(told.values()) > 0.0
    assert logging.getLogger().isEnabledFor(logging.WARNING)
