# SPDX-License-Identifier: GPL-3.0-or-later
"""What is said of the words that a picture shows, and of those that it does not."""

from vibe_render.run.notes import verdict_lines


def row(word, state, missing="", why=""):
    return {"word": word, "state": state, "missing": missing, "why": why, "unlock": ""}


ROWS = [
    row("warm", "visible"),
    row("teal", "already"),
    row("pale mint", "missed", "color of the wall is #b09080, wanted #cceede", "it conflicts with 'warm'"),
    row("velvet", "unmeasured"),
    row("red", "missed", why="the scene has no object that it could describe"),
    row("", "missed", "distance from what is right around of the subject is 2.0 Lab, wanted at least 8"),
]


def test_each_state_has_its_words_and_each_miss_its_reason():
    assert verdict_lines(ROWS) == [
        "The picture shows: warm.",
        "Was so already: teal.",
        "Set, not measured: velvet.",
        "It does not show 'pale mint': color of the wall is #b09080, wanted #cceede; it conflicts with 'warm'.",
        "It does not show 'red': the scene has no object that it could describe.",
        "Look at the subject: distance from what is right around of the subject is 2.0 Lab, wanted at least 8.",
    ]


def test_nothing_is_said_where_nothing_is_claimed():
    assert verdict_lines([]) == []
