# SPDX-License-Identifier: Apache-2.0
"""Who wins a conflict: what is said, what is said of one thing, and what says most about it."""

from __future__ import annotations

from typing import Any

import pytest
from goal_parts import drawn, plan_of, read

from proxy_renderer.claims.from_goals import claims_of
from proxy_renderer.goals.resolve import Goals, Lost, goals_of
from proxy_renderer.goals.wish import Wish
from proxy_renderer.words.lexicon.entries import Effect, parse_effect
from proxy_renderer.words.lexicon.quantities import read_claim
from proxy_renderer.words.lexicon.vocabulary import shipped_vocabulary
from proxy_renderer.words.types import Attribute, SceneDescription

SEEN = (read_claim("picture contrast 60.."),)
STRONG, LATE = parse_effect("film/contrast 1..1.2 !1"), parse_effect("film/contrast 1..1.2 !3")
DEFAULT, CHANGES = parse_effect("film/contrast 1..1.2 ? !1"), parse_effect("material/tint times 1..1.2 !1")
ONE = {"owners": ("Clay",)}
WORSE = {"vague": True, "breadth": 9}


def wish(slot: str = "grade", quantity: str = "contrast", effect: Effect = STRONG, **more: Any) -> Wish:
    """A wish that is seen unless its effect is a default."""
    wide = {name: more.pop(name) for name in ("vague", "breadth") if name in more}
    claims = () if effect is DEFAULT else SEEN
    return Wish(Attribute("x", "x", slot, "subject", **more), quantity, effects=(effect,), claims=claims, **wide)


@pytest.mark.parametrize(
    ("first", "later"),
    [
        (wish("setting", cause="mood", effect=LATE, **WORSE), wish(effect=DEFAULT, **ONE)),
        (wish(cause="mood", **WORSE), wish("material", "finish", **ONE)),
        (wish("material", "finish", cause="mood", **WORSE), wish("setting", "contrast", LATE, **ONE)),
        (wish(**WORSE), wish(cause="mood", **ONE)),
        (wish("color", "color", CHANGES, **ONE, **WORSE), wish("color", "color", color=(0.5, 0.1, 0.1))),
        (wish(role="rim", **WORSE), wish()),
        (wish("color", "color", LATE, color=(0.5, 0.1, 0.1), **WORSE), wish("material", "color")),
        (wish("material", "color", LATE, **WORSE), wish("color", "color", CHANGES)),
        (wish(effect=LATE, breadth=9), wish(vague=True)),
        (wish(effect=LATE, breadth=1), wish(breadth=2)),
        (wish(), wish(effect=LATE)),
    ],
    ids=(
        "default",
        "usual",
        "place",
        "implied",
        "one thing",
        "one light",
        "color",
        "change",
        "vague",
        "breadth",
        "main",
    ),
)
def test_each_criterion_comes_before_those_that_follow(first, later):
    """The winner is worse in all that counts less."""
    assert first.rank < later.rank


def lost_to(prompt: str) -> set[tuple[str, str, str]]:
    """Loser, winner and quantity of each conflict."""
    return {(each.wish.word, each.winner.word, each.wish.quantity) for each in read(prompt).lost}


def both_ways(first: str, second: str) -> list[str]:
    return [f"{first}, {second}", f"{second}, {first}"]


def by_contradiction(goals: Goals) -> list[Lost]:
    """Those of the lost wishes that contradict the winner themselves: they say what is to be seen."""
    return [each for each in goals.lost if each.wish.is_seen]


@pytest.mark.parametrize(
    ("said", "mood", "quantity"),
    [
        ("cool light", "cosy", "light_color"),
        ("bright light", "gloomy", "brightness"),
        ("muted colors", "festive", "saturation"),
        ("low contrast", "dramatic", "contrast"),
        ("hard light", "romantic", "hardness"),
    ],
)
def test_what_is_said_wins_over_what_a_mood_stands_for(said, mood, quantity):
    for prompt in both_ways(said, mood):
        goals = read(prompt)
        winners = {e.winner.attribute.entry for e in goals.lost if (e.wish.word, e.wish.quantity) == (mood, quantity)}
        assert winners, prompt
        assert not [e for e in goals.lost if e.winner.implied and not e.wish.implied], prompt


@pytest.mark.parametrize(
    ("said", "usual", "quantity"),
    [("matte", "chrome", "finish"), ("golden hour", "rainy", "light_color"), ("cool light", "desert", "light_color")],
)
def test_what_is_said_wins_over_what_is_usual(said, usual, quantity):
    for prompt in both_ways(said, usual):
        assert (usual, quantity) in {(loser, what) for loser, _, what in lost_to(prompt)}, prompt


@pytest.mark.parametrize(
    ("prompt", "loser"),
    [
        ("silk, the vase is lacquered wood", "silk"),
        ("wool, keep the table, a ceramic vase", "wool"),
        ("slightly steel, the vase is dark smoked glass", "slightly steel"),
    ],
)
def test_what_is_said_of_one_thing_wins_over_what_is_said_of_all(prompt, loser):
    goals = read(prompt)
    losers = [each for each in goals.lost if each.wish.word == loser]
    assert losers
    assert all(each.winner.attribute.owners and not each.wish.attribute.owners for each in losers)
    assert not [each for each in goals.lost if each.winner.word == loser]


def test_what_only_changes_a_color_comes_last():
    for prompt in both_ways("pastel surface", "darker surface"):
        losers = by_contradiction(read(prompt))
        assert {each.wish.attribute.entry for each in losers} == {"darker surface"}, prompt


@pytest.mark.parametrize(
    ("color", "material"), [("teal", "oak"), ("pink", "leather"), ("pink", "gold"), ("white", "asphalt")]
)
def test_a_named_color_wins_over_the_color_of_a_material(color, material):
    """The material keeps the rest: its finish and its substance."""
    for prompt in (f"a {color} {material} vase", f"the vase is {material}, a {color} vase"):
        goals = read(prompt)
        painting = sorted((wish for wish in goals.wishes if wish.quantity == "color"), key=lambda wish: wish.rank)
        assert painting[0].attribute.entry == color, prompt
        entries = plan_of(goals)
        assert f"'{color}'" in entries["material/Clay/base_color"].reason, prompt
        assert f"'{material}'" not in entries["material/Clay/base_color"].reason, prompt
        assert f"'{material}'" in entries["material/Clay/metallic"].reason, prompt
        claims = [c for c in claims_of(goals, shipped_vocabulary()) if c.measure in ("color", "tint")]
        assert {c.word for c in claims} == {color}, prompt


def test_a_color_of_what_lies_around_rules_out_what_a_place_usually_has():
    for prompt in both_ways("purple background", "forest"):
        goals = read(prompt, SceneDescription())
        assert ("forest", "purple") in {(each.wish.word, each.winner.word) for each in goals.lost}, prompt
        claims = claims_of(goals, shipped_vocabulary())
        assert not [c for c in claims if c.word == "forest" and c.part == "surroundings"], prompt


def test_a_main_wish_wins_over_a_vague_one():
    """A time of day is about the light as a whole: what is about its color alone comes first."""
    for prompt in both_ways("golden hour", "cool light"):
        assert ("golden hour", "cool light", "light_color") in lost_to(prompt), prompt


@pytest.mark.parametrize("seed", [11, 12])
def test_no_drawn_prompt_breaks_the_order(seed):
    """What counts for more never gives way: a default to a wish, what is usual to what is said, a mood to the prompt."""
    for prompt, parsed in drawn(seed, 150):
        for each in by_contradiction(goals_of(parsed)):
            wish, winner = each.wish, each.winner
            assert winner.usual <= wish.usual or not winner.is_seen, (prompt, wish.word, winner.word)
            if winner.usual == wish.usual and winner.is_seen:
                assert winner.implied <= wish.implied, (prompt, wish.word, winner.word)
