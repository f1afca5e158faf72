# SPDX-License-Identifier: Apache-2.0
"""Which wishes win, over many drawn prompts: what must be true of every one of them."""

from __future__ import annotations

import random
from functools import cache
from itertools import combinations, product

import pytest
from goal_parts import ROOM, drawn, plan_of, read

from proxy_renderer.claims.from_goals import claims_of
from proxy_renderer.goals.resolve import Goals, contradicts, goals_of, resolved
from proxy_renderer.goals.wish import Wish, wishes_of
from proxy_renderer.schema.parameters import SURFACES
from proxy_renderer.words.lexicon.entries import OWNERS
from proxy_renderer.words.lexicon.vocabulary import shipped_vocabulary
from proxy_renderer.words.parser import parse
from proxy_renderer.words.types import Parsed, SceneDescription

VOCABULARY = shipped_vocabulary()
SEEDS = (1, 2, 3)
TARGET = ("kind", "region", "owners", "lights", "phrases", "role")
NUMBER = 220


@cache
def goals_drawn(seed: int) -> tuple[tuple[str, Goals], ...]:
    return tuple((prompt, goals_of(parsed)) for prompt, parsed in drawn(seed, NUMBER))


@cache
def alone() -> dict[str, Goals]:
    """The goals of each look word that is the whole prompt."""
    return {name: goals_of(parse(name, ROOM, VOCABULARY)) for name in VOCABULARY.entries}


def every() -> list[tuple[str, Goals]]:
    return [row for seed in SEEDS for row in goals_drawn(seed)]


def signed(wish: Wish) -> tuple:
    return wish.word, wish.attribute.entry, wish.quantity, wish.named, wish.effects, wish.claims


def test_the_drawn_prompts_are_worth_it():
    """Without conflicts the tests below would show nothing."""
    lost = [each for _, goals in every() for each in goals.lost]
    assert len(lost) > 200
    assert sum(each.is_news for each in lost) > 20
    assert {each.wish.quantity for each in lost} >= {"brightness", "light_color", "color", "saturation", "haze"}


def test_resolving_is_deterministic():
    for (prompt, parsed), (_, goals) in zip(drawn(SEEDS[0], NUMBER), goals_drawn(SEEDS[0]), strict=True):
        again = goals_of(parsed)
        assert again.wishes == goals.wishes, prompt
        assert again.lost == goals.lost, prompt


def test_resolving_what_is_kept_loses_nothing():
    for prompt, goals in every():
        again = resolved(goals.parsed, goals.wishes)
        assert not again.lost, prompt
        assert again.wishes == goals.wishes, prompt


def test_resolving_all_wishes_again_changes_nothing():
    for prompt, goals in every():
        wishes = [*goals.wishes, *(each.wish for each in goals.lost)]
        again = resolved(goals.parsed, wishes)
        assert sorted(map(id, again.wishes)) == sorted(map(id, goals.wishes)), prompt


def test_every_wish_is_kept_or_lost_once_and_in_the_order_of_the_prompt():
    for prompt, goals in every():
        wishes = wishes_of(goals.parsed.attributes, VOCABULARY)
        found = [*goals.wishes, *(each.wish for each in goals.lost)]
        assert sorted(map(repr, found)) == sorted(map(repr, wishes)), prompt
        kept = list(map(signed, goals.wishes))
        everything = iter(map(signed, wishes))
        assert all(wish in everything for wish in kept), prompt


def test_no_two_kept_wishes_contradict_each_other():
    for prompt, goals in every():
        ranked = sorted(goals.wishes, key=lambda wish: wish.rank)
        assert not [pair for pair in combinations(ranked, 2) if contradicts(*pair)], prompt


def test_no_two_kept_wishes_claim_intervals_that_have_nothing_in_common():
    """Of the same part of the image, and said of the same lights and materials."""
    for prompt, goals in every():
        for first, second in combinations(goals.wishes, 2):
            one, other = first.attribute, second.attribute
            same = all(getattr(one, name) == getattr(other, name) for name in TARGET)
            if not same or first.word == second.word:
                continue
            for a, b in product(first.claims, second.claims):
                if (a.part, a.measure, a.color) == (b.part, b.measure, b.color):
                    assert max(a.lower, b.lower) <= min(a.upper, b.upper), (prompt, str(a), str(b))


def test_a_word_of_which_nothing_is_seen_changes_nothing():
    """What only supports a class or a claim is given up with it; of a material each quantity counts by itself."""
    given_up = 0
    for prompt, goals in every():
        seen = {id(each.wish.attribute) for each in goals.lost if each.wish.is_seen}
        seen -= {id(wish.attribute) for wish in goals.wishes if wish.is_seen}
        left = [wish for wish in goals.wishes if id(wish.attribute) in seen]
        assert all(wish.attribute.slot in SURFACES for wish in left), prompt
        given_up += sum(not each.wish.is_seen and id(each.wish.attribute) in seen for each in goals.lost)
    assert given_up > 20


def test_every_loser_names_a_winner_that_is_kept():
    for prompt, goals in every():
        sought = {id(wish) for wish in goals.wishes}
        assert all(id(each.winner) in sought for each in goals.lost), prompt


@pytest.mark.parametrize(
    "prompt",
    [
        "solemn, pinkish lamp, magenta tint, summer evening, teal and orange",
        "hdr, tiger eye, crushed blacks, fridge light, mad max",
        "tile, solemn, summery, keep the vase",
    ],
)
def test_what_a_word_had_won_before_it_was_given_up_goes_back(prompt):
    """'teal and orange' loses what it is mainly about: its saturation then keeps nothing from 'solemn'."""
    goals = read(prompt)
    assert goals.lost
    sought = {id(wish) for wish in goals.wishes}
    assert all(id(each.winner) in sought for each in goals.lost)
    for each in goals.lost:
        if each.wish.is_seen:
            assert any(contradicts(*sorted((wish, each.wish), key=lambda w: w.rank)) for wish in goals.wishes), (
                each.wish.word
            )


def test_a_color_may_be_changed_by_one_number_and_by_three():
    """'Pale' multiplies all of a tint by one number, 'magenta tint' each of its components by another."""
    goals = read("the wall is pale hologram, very magenta tint")
    assert {each.wish.word for each in goals.lost} == {"very magenta tint"}
    assert plan_of(goals)


def test_no_word_wins_over_itself():
    for prompt, goals in every():
        assert all(each.wish.word != each.winner.word for each in goals.lost), prompt
        assert all(each.wish.attribute is not each.winner.attribute for each in goals.lost), prompt


def test_a_word_that_loses_its_range_loses_its_claim():
    """What is lost appears nowhere: no claim and no range quotes the word for a measure or a family that only lost wishes had."""
    tested = 0
    for prompt, goals in every():
        claims, entries = claims_of(goals, VOCABULARY), plan_of(goals)
        for each in goals.lost:
            word = each.wish.word
            mine = [wish for wish in goals.wishes if wish.word == word]
            if not mine:
                assert not [c for c in claims if c.word == word], (prompt, word)
                assert not [k for k, e in entries.items() if f"'{word}'" in e.reason], (prompt, word)
            measures = {c.measure for c in each.wish.claims} - {c.measure for w in mine for c in w.claims}
            if not any(w.attribute.color or w.quantity == "color" for w in mine):
                assert not [c for c in claims if c.word == word and c.measure in measures], (prompt, word)
            families = {e.family for e in each.wish.effects} - {e.family for w in mine for e in w.effects}
            quoted = f"'{each.wish.attribute.cause or each.wish.attribute.word}'"
            ranges = [
                key
                for key, entry in entries.items()
                if quoted in entry.reason and any(key_family(key) == family for family in families)
            ]
            assert not ranges, (prompt, word)
            tested += bool(measures or families)
    assert tested > 150


def key_family(key: str) -> str:
    parts = key.split("/")
    return f"{parts[0]}/{parts[-1]}"


def test_a_word_that_is_alone_has_its_claims_and_its_ranges():
    """Nothing stands in its way: each kept wish is claimed of the image, and has a range where the scene has the parameter."""
    tested = 0
    for name, goals in alone().items():
        if goals.lost or {a.entry for a in goals.parsed.attributes} != {name}:
            continue
        claims, entries = claims_of(goals, VOCABULARY), plan_of(goals)
        for wish in goals.wishes:
            for text in wish.claims:
                found = [c for c in claims if c.word == wish.word and c.measure == text.measure]
                assert found or _narrowed(text.measure, wish, goals), (name, str(text))
            strong = {e.family for e in wish.effects if not e.weak and e.owner not in ("rim", "fill", "others")}
            reached = {key_family(key) for key, e in entries.items() if f"'{wish.word}'" in e.reason or not e.reason}
            here = {family for family in strong if any(key_family(key) == family for key in entries)}
            assert not here or here & reached, (name, wish.quantity, here)
            tested += bool(wish.claims and here)
    assert tested > 300


def _narrowed(measure: str, wish: Wish, goals: Goals) -> bool:
    """Whether another wish of the word claims the same measure."""
    others = (w for w in goals.wishes if w is not wish)
    return any(c.measure == measure for w in others for c in w.claims)


def test_wishes_that_contradict_nothing_are_resolved_independently():
    """Two prompts that have no conflict with each other are together what they are alone."""
    draw, tested = random.Random(5), 0
    rows = every()
    for _ in range(1500):
        (one, first), (other, second) = draw.sample(rows, 2)
        all_first = [*first.wishes, *(each.wish for each in first.lost)]
        all_second = [*second.wishes, *(each.wish for each in second.lost)]
        if any(contradicts(a, b) or contradicts(b, a) for a in all_first for b in all_second):
            continue
        if {a.word for a in all_first} & {b.word for b in all_second}:
            continue
        together = resolved(Parsed(f"{one}, {other}"), [*all_first, *all_second])
        kept = {id(wish) for wish in together.wishes}
        assert kept == {id(wish) for goals in (first, second) for wish in goals.wishes}, (one, other)
        tested += bool(first.lost or second.lost)
    assert tested > 50


def test_of_two_words_of_one_rank_the_first_wins_whichever_it_is():
    """Swapped, winner and loser change places."""
    draw, tested = random.Random(6), 0
    wishes = [
        wish
        for goals in alone().values()
        for wish in goals.wishes
        if wish.is_seen and wish.attribute.slot not in SURFACES
    ]
    by_rank: dict[tuple, list[Wish]] = {}
    for wish in wishes:
        by_rank.setdefault((wish.rank, wish.quantity), []).append(wish)
    groups = [group for group in by_rank.values() if len(group) > 1]
    for _ in range(4000):
        first, second = draw.sample(draw.choice(groups), 2)
        if not contradicts(first, second):
            continue
        assert contradicts(second, first), (first.word, second.word)
        for pair in ((first, second), (second, first)):
            goals = resolved(Parsed(""), pair)
            assert goals.wishes == (pair[0],)
            assert [(each.wish, each.winner) for each in goals.lost] == [(pair[1], pair[0])]
        tested += 1
    assert tested > 300


def test_no_mood_paints():
    for prompt, goals in every():
        for wish in (*goals.wishes, *(each.wish for each in goals.lost)):
            painting = [e for e in wish.effects if OWNERS[e.owner] == "material"]
            assert not painting or not wish.implied, prompt
            assert not painting or wish.attribute.slot in SURFACES, prompt


def test_notes_are_for_what_was_said_only():
    for prompt, goals in every():
        moods = {wish.word for wish in goals.wishes if wish.implied}
        moods |= {each.wish.word for each in goals.lost if each.wish.implied}
        said = {a.word for a in goals.parsed.attributes if not a.cause}
        for note in goals.notes():
            loser, winner = note.split("'")[1], note.split("'")[3]
            assert {loser, winner} <= said, (prompt, note)
            assert "\n" not in note


def of_haze(goals: Goals) -> list[tuple[str, str]]:
    return [(wish.word, wish.named) for wish in goals.wishes if wish.quantity == "haze" and wish.named]


@pytest.mark.parametrize("order", ["no fog, {}", "{}, no fog"])
def test_no_mood_brings_the_fog_back_that_the_prompt_rules_out(order):
    """Of all moods and styles that mean haze, though the measures of "none" and "light" overlap."""
    foggy = [name for name, goals in alone().items() if any(w.implied for w in goals.wishes) and of_haze(goals)]
    assert "ghostly" in foggy
    for name in foggy:
        goals = goals_of(parse(order.format(name), ROOM, VOCABULARY))
        assert of_haze(goals) == [("no fog", "none")], name


@pytest.mark.parametrize("place", ["desert", "beach", "snowy forest", "cave"])
def test_light_of_a_named_color_has_no_warmth_of_a_place(place):
    for color in ("purple", "teal", "green", "blue"):
        goals = goals_of(parse(f"{color} light, {place}", ROOM, VOCABULARY))
        asked = [c for c in claims_of(goals, VOCABULARY) if c.word and c.measure == "warmth"]
        assert not asked, (color, place)


def test_a_note_says_that_a_material_has_not_its_own_color():
    """Of all materials with a color, painted in the opposite one; a color of about that hue is news to nobody."""
    colors = {"teal": "orange", "orange": "teal"}
    for material in ("oak", "walnut", "copper", "leather"):
        notes = {c: list(goals_of(parse(f"{c} {material} table", ROOM, VOCABULARY)).notes()) for c in colors}
        assert any(f"'{material}' gives way to 'teal'" in note for note in notes["teal"]), material
        assert not notes["orange"], material


@pytest.mark.parametrize("phrase", ["deep blacks", "inky blacks", "rich blacks"])
def test_blacks_are_shadows_and_no_color_of_the_image(phrase: str) -> None:
    goals = goals_of(parse(f"hard light, {phrase}", SceneDescription()))
    assert not any(wish.attribute.color for wish in goals.wishes)
    assert any(wish.word == phrase for wish in goals.wishes)


def test_a_black_that_is_said_of_nothing_does_not_tint_the_light() -> None:
    goals = goals_of(parse("soft light, deep black", SceneDescription()))
    assert not any(wish.attribute.color for wish in goals.wishes)


def test_a_style_that_is_gray_gives_way_to_named_colors_and_a_gray_image_does_not():
    def is_gray(prompt):
        wishes = goals_of(parse(prompt, ROOM, VOCABULARY)).wishes
        return any(c.measure == "chroma" and c.upper[0] < 10.0 for wish in wishes for c in wish.claims)

    assert is_gray("film noir")
    assert not is_gray("film noir, red vase")
    assert is_gray("black and white, red vase")
