# SPDX-License-Identifier: GPL-3.0-or-later
"""What is said of the words that a picture shows, and of those that it does not."""

from vibe_render.run.notes import claim_lines, words_shown


def row(word, holds, measure="warmth", thing="picture", after=3.2):
    return {
        "word": word,
        "thing": thing,
        "measure": measure,
        "says": {"warmth": "warmth", "color": "color", "separation": "distance from what is right around"}[
            measure
        ],
        "unit": {"warmth": "b*", "color": "OKLab", "separation": "Lab"}[measure],
        "wanted": "at least 8" if measure != "color" else "#cceede",
        "after": after,
        "holds": holds,
    }


ROWS = [
    row("warm", True),
    row("pale mint", False, "color", "wall", "#b09080"),
    row("cozy", True),
    row("cozy", False),
    row("lamp", None),
    row("", False, "separation", "subject", 2.0),
]


def test_a_word_is_shown_if_all_that_it_claims_holds():
    assert {word: not missing for word, missing in words_shown(ROWS).items()} == {
        "warm": True,
        "pale mint": False,
        "cozy": False,
    }


def test_what_is_missing_is_said_with_what_was_wanted():
    assert claim_lines(ROWS) == [
        "The picture shows: warm.",
        "It does not show 'pale mint': color of the wall is #b09080, wanted #cceede.",
        "It does not show 'cozy': warmth is 3.2 b*, wanted at least 8.",
        "Look at the subject: distance from what is right around of the subject is 2.0 Lab, wanted at least 8.",
    ]


def test_nothing_is_said_where_nothing_is_claimed():
    assert claim_lines([]) == []
