# SPDX-License-Identifier: GPL-3.0-or-later
"""What the panel knows of a prompt from its marks."""

import pytest
from vibe_render.core.schema_import import messages
from vibe_render.run.word_readings import WordReadings


@pytest.mark.parametrize(
    ("target", "paints"),
    [("lights", False), ("image", False), ("air", False), ("subject", True), ("Cup + Saucer", True)],
)
def test_words_that_describe_things_may_paint(target, paints):
    readings = WordReadings()
    word = messages.WordReading("warm", "understood", candidates=[target, "Cup"])
    readings.newest = messages.Readings("warm", [messages.WordReading("hm", "left out"), word])
    assert readings.may_paint(" warm ") == paints
    assert readings.may_paint("warm cup")  # not read yet
