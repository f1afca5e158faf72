# SPDX-License-Identifier: Apache-2.0
"""The quantity that a parameter belongs to."""

import pytest

from proxy_renderer.schema import VibeError
from proxy_renderer.words.lexicon.quantities import quantities


def test_the_most_specific_row_counts():
    table = quantities()
    assert table.of_parameter("rim", "light/power", "") == "rim"
    assert table.of_parameter("key", "light/power", "") == "brightness"


def test_a_parameter_without_a_quantity_is_named():
    with pytest.raises(VibeError, match="camera/fov"):
        quantities().of_parameter("camera", "camera/fov", "")
