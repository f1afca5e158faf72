# SPDX-License-Identifier: GPL-3.0-or-later
"""What the panel knows of a prompt from its marks."""

import pytest
from vibe_render.core.schema_import import messages
from vibe_render.run.word_readings import WordReadings


@pytest.mark.parametrize(
    ("target", "paints"),
    [
        ("lights", ()),
        ("image", ()),
        ("air", ()),
        ("subject", ("subject",)),
        ("Cup + Saucer", ("Cup", "Saucer")),
    ],
)
def test_words_that_describe_things_may_paint(target, paints):
    readings = WordReadings()
    word = messages.WordReading("warm", "understood", candidates=[target, "Cup"])
    readings.newest = messages.Readings("warm", [messages.WordReading("hm", "left out"), word])
    assert readings.painted(" warm ") == {*paints}
    assert readings.painted("warm cup") == {"subject"}  # not read yet
