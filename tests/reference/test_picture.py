# SPDX-License-Identifier: Apache-2.0
"""Reading the picture that a look is taken from."""

import numpy as np
import pytest
from PIL import Image

from proxy_renderer.reference.picture import read_reference
from proxy_renderer.schema import VibeError


def test_a_picture_is_read_as_it_is_shown(tmp_path):
    Image.fromarray(np.full((2, 3, 3), (255, 128, 0), np.uint8)).save(tmp_path / "a.png")
    read = read_reference(tmp_path / "a.png")
    assert read.display.shape == (2, 3, 3)
    assert read.display[0, 0].tolist() == pytest.approx([1.0, 128 / 255, 0.0])
    assert read.linear is None
    assert read.alpha is None
    assert not read.panorama


def test_what_is_no_picture_is_said_in_a_line(tmp_path):
    (tmp_path / "a.png").write_text("no picture")
    with pytest.raises(VibeError, match="not a picture"):
        read_reference(tmp_path / "a.png")
