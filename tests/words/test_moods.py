# SPDX-License-Identifier: Apache-2.0
"""What moods stand for gives way to what the prompt itself says."""

import pytest

from proxy_renderer.goals.resolve import goals_of
from proxy_renderer.words.parser import parse
from proxy_renderer.words.types import SceneDescription

SCENE = SceneDescription(
    "vase",
    {"vase": "subject", "Wall": "surroundings"},
    {"Clay": "subject", "Plaster": "surroundings"},
    {"vase": ("Clay",), "Wall": ("Plaster",)},
)


def given_up(prompt: str) -> set[str]:
    """Entries that moods stand for and that do not count."""
    return {a.entry for a in goals_of(parse(prompt, SCENE)).overruled if a.cause}


@pytest.mark.parametrize(
    ("prompt", "lost", "kept"),
    [
        ("energetic, on a dark blue background", {"bright light"}, {"vivid"}),
        ("energetic, on a yellow background", set(), {"bright light", "vivid"}),
        ("gloomy, in green fog", {"cool light"}, {"dim light"}),
        ("gloomy, on a white background", {"dim light"}, {"cool light"}),
        ("gloomy, a crimson vase", {"muted"}, {"dim light"}),
        ("festive, deep blue background", {"warm light"}, {"vivid"}),
        ("cheerful, gray background", {"vivid"}, {"bright light"}),
    ],
)
def test_a_mood_gives_way_to_colors_that_are_named(prompt: str, lost: set[str], kept: set[str]) -> None:
    assert lost <= given_up(prompt)
    assert not kept & given_up(prompt)


def test_what_the_prompt_says_itself_stays() -> None:
    assert not goals_of(parse("bright light, dark blue background", SCENE)).overruled
