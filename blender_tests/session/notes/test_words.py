# SPDX-License-Identifier: GPL-3.0-or-later
"""What people are told about their words."""

from vibe_render.run.notes import word_notes


def test_words_left_out_guesses_and_contradictions_are_told():
    understood = {"ignored": ["second", "dragon", "second"], "guesses": {"shny": "glossy"}, "notes": ["A beats B."]}
    told = word_notes({"understood": understood})
    assert told == ["Left out: second, dragon", "“shny” was taken for “glossy”", "A beats B."]
    assert word_notes({}) == []
