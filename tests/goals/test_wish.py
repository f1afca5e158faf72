# SPDX-License-Identifier: Apache-2.0
"""What a word wishes for: each wish is about one quantity, softly said and denied words ask for less, or for the opposite."""

from __future__ import annotations

from dataclasses import replace

import pytest
from goal_parts import ROOM, read

from proxy_renderer.goals.wish import PAINTED, Wish, wishes_of
from proxy_renderer.schema import FAMILIES
from proxy_renderer.schema.parameters import may_serve
from proxy_renderer.words.lexicon.entries import OWNERS, EntryWish
from proxy_renderer.words.lexicon.quantities import quantities
from proxy_renderer.words.lexicon.vocabulary import shipped_vocabulary
from proxy_renderer.words.types import Attribute

VOCABULARY = shipped_vocabulary()
ENTRIES = [entry for entry in VOCABULARY.entries.values() if entry.wishes]
TABLE = quantities()


def said(entry: str, **changes) -> Attribute:
    """A word as a prompt says it of everything."""
    found = VOCABULARY.entries[entry]
    light = found.slot in ("lighting", "mood")
    kind, region = ("light", "whole") if light else ("subject", "subject")
    return replace(Attribute(entry, entry, found.slot, region, kind), **changes)


def wishes(entry: str, **changes) -> dict[str, Wish]:
    """The wishes of a word, by quantity."""
    found = wishes_of([said(entry, **changes)], VOCABULARY)
    assert len({wish.quantity for wish in found}) == len(found)
    return {wish.quantity: wish for wish in found}


def meanings(entry) -> list[EntryWish]:
    return [*entry.wishes, *entry.never]


def test_each_meaning_of_the_vocabulary_is_about_one_quantity():
    for entry in ENTRIES:
        for meaning in meanings(entry):
            effects = {TABLE.of_parameter(e.owner, e.family, e.mode) for e in meaning.effects}
            claims = {TABLE.of_claim(claim) for claim in meaning.claims}
            assert effects | claims <= {meaning.quantity}, entry.name
            assert not meaning.named or meaning.named in TABLE.by_name[meaning.quantity].classes, entry.name
        for half in (entry.wishes, entry.never):
            names = [meaning.quantity for meaning in half]
            assert len(names) == len(set(names)), entry.name


@pytest.mark.parametrize("denied", [False, True])
@pytest.mark.parametrize("strength", [0.5, 1.0, 1.4])
def test_each_wish_is_about_one_quantity(denied, strength):
    for entry in ENTRIES:
        for name, wish in wishes(entry.name, negated=denied, strength=strength).items():
            effects = {TABLE.of_parameter(e.owner, e.family, e.mode) for e in wish.effects}
            assert effects <= {name}, entry.name
            assert {TABLE.of_claim(claim) for claim in wish.claims} <= {name}, entry.name
            assert not wish.named or wish.named in wish.about.classes, entry.name
            assert wish.effects or wish.claims or wish.named, entry.name


def test_a_class_brings_its_claims_last():
    for entry in ENTRIES:
        for wish in wishes(entry.name).values():
            own = wish.about.classes.get(wish.named, ())
            assert wish.claims[len(wish.claims) - len(own) :] == own, entry.name


def test_a_word_said_softly_names_its_class_only_where_the_quantity_says_so():
    tested = {True: 0, False: 0}
    for entry in ENTRIES:
        loud, soft = wishes(entry.name), wishes(entry.name, strength=0.5)
        for name, wish in loud.items():
            if not wish.named:
                continue
            quantity = TABLE.by_name[name]
            expected = quantity.softer.get(wish.named, wish.named) if quantity.softly else ""
            if name in soft:
                assert soft[name].named == expected, entry.name
                assert soft[name].toward == (expected or wish.named), entry.name
                tested[quantity.softly] += 1
            else:  # nothing else was meant by it
                assert not wish.effects, entry.name
                assert not expected, entry.name
    assert min(tested.values()) > 20


@pytest.mark.parametrize(
    ("prompt", "quantity", "named"),
    [
        ("slightly glossy", "finish", ""),
        ("a bit warm light", "light_color", "warm"),
        ("slightly thick fog", "haze", "light"),
        ("very glossy", "finish", "glossy"),
    ],
)
def test_soft_words_in_prompts(prompt, quantity, named):
    found = [wish for wish in read(prompt).wishes if wish.quantity == quantity]
    assert [wish.named for wish in found] == [named]


def test_a_stronger_word_asks_for_the_same_with_more_strength():
    for entry in ENTRIES:
        plain, strong = wishes(entry.name), wishes(entry.name, strength=1.4)
        for name, wish in plain.items():
            assert (strong[name].effects, strong[name].claims) == (wish.effects, wish.claims), entry.name
            assert (wish.strength, strong[name].strength) == (1.0, 1.4)


def test_a_denied_word_never_asks_for_its_own_class():
    tested = 0
    for entry in ENTRIES:
        plain, denied = wishes(entry.name), wishes(entry.name, negated=True)
        for name, wish in denied.items():
            if wish.named and name in plain and plain[name].named:
                assert wish.named != plain[name].named, (entry.name, name)
                tested += 1
    assert tested > 20


def test_what_a_denied_word_has_in_common_with_its_opposite_is_not_asked_for():
    """Pastel colors and noir are both muted: "not pastel" says nothing of that."""
    assert "saturation" in wishes("pastel")
    assert "saturation" not in wishes("pastel", negated=True)
    assert wishes("pastel", negated=True)["contrast"].named == "high"


def test_a_denied_word_asks_for_its_opposite_mildly():
    tested = 0
    for entry in ENTRIES:
        opposite = VOCABULARY.opposite(entry)
        if entry.never or opposite is None:
            continue
        theirs, denied = wishes(opposite.name), wishes(entry.name, negated=True)
        for name, wish in denied.items():
            if name in theirs and entry.slot == opposite.slot:
                assert wish.effects == theirs[name].effects, entry.name
                assert wish.strength < 1.0, entry.name
                tested += 1
    assert tested > 50


def test_a_denied_word_without_opposite_leaves_parameters_where_they_change_nothing():
    tested = 0
    for entry in ENTRIES:
        if entry.never or entry.opposite:
            continue
        for wish in wishes(entry.name, negated=True).values():
            for effect in wish.effects:
                assert effect.lower == effect.upper == (FAMILIES[effect.family].default,), entry.name
                tested += 1
            assert not wish.claims or wish.named, entry.name
    assert tested > 30


@pytest.mark.parametrize(
    ("prompt", "quantity", "named"),
    [("not glossy", "finish", "matte"), ("no fog", "haze", "none"), ("not matte", "finish", "glossy")],
)
def test_denied_words_in_prompts(prompt, quantity, named):
    assert read(prompt).classes[quantity] == named


def test_a_denied_color_wishes_for_nothing():
    red = Attribute("not red", "red", "color", "subject", color=(0.8, 0.1, 0.1), negated=True)
    assert not wishes_of([red], VOCABULARY)
    (wish,) = wishes_of([replace(red, negated=False)], VOCABULARY)
    assert (wish.quantity, wish.named) == ("color", "red")


@pytest.mark.parametrize(
    ("kind", "quantity"),
    [
        ("subject", "color"),
        ("glow", "color"),
        ("surroundings", "surroundings_color"),
        ("sky", "surroundings_color"),
        ("fog", "haze_color"),
        ("light", "light_color"),
        ("ambience", "light_color"),
    ],
)
def test_a_color_is_that_of_what_it_describes(kind, quantity):
    color = Attribute("red", "red", "color", "whole", kind, color=(0.8, 0.1, 0.1))
    (wish,) = wishes_of([color], VOCABULARY)
    assert wish.quantity == quantity
    assert bool(wish.named) == (quantity in PAINTED)


def test_a_mood_and_what_it_stands_for_change_no_material():
    for entry in ENTRIES:
        for wish in wishes(entry.name, cause="some mood").values():
            assert all(OWNERS[e.owner] != "material" for e in wish.effects), entry.name
        for wish in wishes(entry.name).values():
            assert all(may_serve(OWNERS[e.owner], entry.slot) for e in wish.effects), entry.name


def test_words_that_are_no_look_wish_for_nothing():
    assert not wishes_of([Attribute("xyzzy", "xyzzy", "mood", "whole")], VOCABULARY)
    assert not read("keep the wall, teal vase").lost
    assert ROOM.lights
