# SPDX-License-Identifier: Apache-2.0
"""Frames and looks as people write them in `--moments`."""

import pytest

from proxy_renderer.schema import VibeError
from proxy_renderer.schema.options import checks


def test_frames_and_looks():
    text = " -5 :noon;\n120: the cup: copper, at 17:30 ;200:moonlit night;"
    assert checks.timed(text) == [(-5, "noon"), (120, "the cup: copper, at 17:30"), (200, "moonlit night")]


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("noon", "'noon' is no frame with a look"),
        ("1: noon; golden hour; 9: night", "'golden hour' is no frame with a look"),
        ("1: noon; 9:", "'9:' is no frame with a look"),
        ("1.5: noon; 9: night", "'1.5: noon' is no frame"),
        ("1: noon", "There is only one moment"),
        (";", "There are no moments"),
        ("9: noon; 1: night", "Frame 1, 'night', does not come after frame 9"),
        ("9: noon; 9: night", "Frame 9, 'night', does not come after frame 9"),
    ],
)
def test_what_is_not_written_so(text, problem):
    with pytest.raises(VibeError) as caught:
        checks.timed(text)
    assert caught.value.message.startswith(problem)
    assert caught.value.remedy
