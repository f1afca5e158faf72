# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel's pictures: before and after in one, also where their sizes differ."""

import numpy as np
import pytest
from PIL import Image
from vibe_render.ui import drawing


def picture(path, color, size):
    Image.new("RGB", size, color).save(path)
    return path


@pytest.mark.parametrize(("before", "after"), [((192, 108), (512, 288)), ((108, 192), (288, 512))])
def test_before_and_after_are_both_seen(tmp_path, before, after):
    """The engine's first picture is small, and the last is as large as was asked for."""
    paths = picture(tmp_path / "a.png", (255, 0, 0), before), picture(tmp_path / "b.png", (0, 0, 255), after)
    drawing.icon(*paths)  # has no number without a window
    _, pictures = drawing._slots[False, paths]
    pixels = drawing._pixels(pictures["vibe"])
    colors = pixels.view(np.uint8).reshape(*pixels.shape, 4)[..., :3]
    red, blue = ((colors[..., channel] > 250).mean() for channel in (0, 2))
    assert red == pytest.approx(blue)
    assert red > 0.45
    drawing.free_icons()


@pytest.mark.parametrize("size", [(192, 108), (108, 192), (64, 64)])
def test_the_middle_of_a_variant_is_seen(tmp_path, size):
    path = tmp_path / "a.png"
    image = Image.new("RGB", size, (0, 0, 255))
    left, top = ((n - min(size)) // 2 for n in size)
    image.paste((255, 0, 0), (left, top, left + min(size), top + min(size)))
    image.save(path)
    drawing.icon(path, square=True)
    _, pictures = drawing._slots[True, (path,)]
    pixels = drawing._pixels(pictures["vibe"])
    assert pixels.shape == (min(size), min(size))
    assert (pixels.view(np.uint8).reshape(*pixels.shape, 4)[..., 0] > 250).all()
    drawing.free_icons()


def test_a_picture_that_is_resized_keeps_its_corners():
    corners = np.array([[1, 2], [3, 4]], np.int32)
    larger = drawing.resized(corners, 5, 7)
    assert larger.shape == (5, 7)
    assert larger[[0, 0, -1, -1], [0, -1, 0, -1]].tolist() == [1, 2, 3, 4]
    assert drawing.resized(corners, 2, 2).tolist() == corners.tolist()
