# SPDX-License-Identifier: Apache-2.0
"""Times of day that are told by the clock, by the sun or by another time, and directions with an adverb."""

import pytest

from proxy_renderer.words.lexicon.vocabulary import default_vocabulary
from proxy_renderer.words.parser import parse
from proxy_renderer.words.types import SceneDescription


def entries(prompt: str) -> list[str]:
    """The entries that a prompt says itself."""
    return [a.entry for a in parse(prompt, SceneDescription()).attributes if not a.cause]


@pytest.mark.parametrize(
    ("told", "meant"),
    [
        ("at two in the morning", "night"),
        ("3 a.m.", "night"),
        ("five in the morning", "pre dawn"),
        ("nine in the morning", "morning light"),
        ("four in the afternoon", "afternoon light"),
        ("seven in the evening", "sunset"),
        ("eleven at night", "night"),
        ("one at night", "night"),
        ("at 5 pm", "golden hour"),
        ("at 6:45", "sunrise"),
        ("12 pm", "noon"),
        ("12 am", "night"),
        ("at 17:30", "golden hour"),
        ("while the sun is slowly sinking", "sunset"),
        ("the sun is about to set behind the hills", "sunset"),
        ("now that the sun is gone", "twilight"),
        ("when the sun comes up over the hills", "sunrise"),
        ("the sun's directly overhead", "noon"),
        ("the sun hangs low", "low sun"),
        ("shortly after sunset", "twilight"),
        ("after nightfall", "night"),
        ("before the sun rises", "pre dawn"),
        ("an hour after dawn", "morning light"),
        ("lit from directly overhead", "top light"),
        ("light from right behind", "back light"),
    ],
)
def test_a_time_that_is_told_is_the_one_that_is_named(told: str, meant: str) -> None:
    assert entries(f"red vase, {told}") == ["red", meant]
    assert meant in default_vocabulary().entries


@pytest.mark.parametrize(
    "prompt",
    ["two red lamps", "red vase, 16:9", "red vase, 8k, f/2", "red cup before the window", "twelve red cups in the sun"],
)
def test_other_numbers_and_places_are_no_times(prompt: str) -> None:
    times = {"night", "pre dawn", "sunrise", "morning light", "noon", "golden hour", "sunset", "twilight"}
    assert not times & {*entries(prompt)}


def test_after_dark_stays_what_the_vocabulary_has() -> None:
    assert entries("red vase after dark") == ["red", "night"]


def test_frozen_is_cold_where_nothing_can_be_made_of_ice() -> None:
    assert "cool tones" in entries("Make everything feel frozen.")
    assert "ice" in entries("a frozen lake")
