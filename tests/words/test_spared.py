# SPDX-License-Identifier: Apache-2.0
"""What a prompt leaves out ("everything but the crate"), and what it lists together ("the car and the crate")."""

import pytest

from proxy_renderer.words.lexicon.vocabulary import shipped_vocabulary
from proxy_renderer.words.model import reading
from proxy_renderer.words.types import SceneDescription

HARBOR = SceneDescription(
    objects={"Hut": "subject", "Hut_roof": "subject", "Ferry": "surroundings", "Pier": "surroundings"},
    materials={"Hut": "subject", "Roof": "subject", "Hull": "surroundings", "Planks": "surroundings"},
    object_materials={"Hut": ("Hut",), "Hut_roof": ("Roof",), "Ferry": ("Hull",), "Pier": ("Planks",)},
)


def read(prompt):
    return reading(prompt, HARBOR, shipped_vocabulary())


def targets(prompt, kind):
    """Names of all targets of a kind that the look words of a prompt may have."""
    return {pair.target.names for each in read(prompt).pairs for pair in each if pair.target.kind == kind}


@pytest.mark.parametrize(
    ("prompt", "spared"),
    [
        ("everything but the ferry matte white", ["ferry"]),
        ("everything white but the ferry", ["ferry"]),
        ("all except the ferry and the pier in grey", ["ferry", "pier"]),
        ("everything grey, the pier excepted", ["pier"]),
        ("the hut red, not the roof", ["roof"]),
        ("everything chrome, the ferry not", ["ferry"]),
        ("everything white but the ferry red", []),
        ("the hut white but the ferry red", []),
        ("all but the ferry goes dull", ["ferry"]),
        ("no fog, red pier", []),
    ],
)
def test_what_is_left_out_is_marked(prompt, spared):
    assert [m.text for m in read(prompt).mentions if m.excepted and m.members == 1] == spared


def test_the_rest_is_without_what_is_left_out():
    assert targets("everything but the ferry white", "others") == {frozenset({"Hut", "Roof", "Planks"})}


def test_a_word_that_no_name_has_leaves_out_the_subject():
    assert targets("everything except the zorp white", "others") == {frozenset({"Hull", "Planks"})}


def test_a_thing_may_be_meant_without_its_parts():
    assert frozenset({"Hut"}) in targets("hut red, not the roof", "things")
    assert frozenset({"Hut"}) in targets("hut red, roof black", "things")


def test_a_list_is_one_noun_besides_its_own():
    assert frozenset({"Hull", "Planks"}) in targets("ferry and pier white", "things")
    assert frozenset({"Hull", "Planks"}) in targets("ferry and zorp pier white", "things")
    assert frozenset({"Hull", "Planks"}) not in targets("move the ferry and make the pier white", "things")


def test_a_list_over_a_comma_is_in_the_clause_that_it_ends_in():
    white = next(row for row in read("hut, ferry and pier white").pairs if row[0].look.text == "white")
    facts = {f for pair in white if len(pair.target.names) > 2 and pair.target.kind == "things" for f in pair.features}
    assert "before, same clause: joined" in facts
