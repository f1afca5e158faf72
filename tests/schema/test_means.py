# SPDX-License-Identifier: Apache-2.0
"""Which parameters may serve which kind of word."""

import pytest

from proxy_renderer.schema import GROUPS
from proxy_renderer.schema.parameters import MEANS, may_serve
from proxy_renderer.words.lexicon.entries import OWNERS, SLOTS
from proxy_renderer.words.lexicon.vocabulary import shipped_vocabulary


def test_every_slot_has_means_and_every_mean_is_a_group():
    assert {*MEANS} == {*SLOTS}
    assert all(groups <= {*GROUPS} for groups in MEANS.values())


@pytest.mark.parametrize("slot", ["lighting", "atmosphere", "grade", "mood", "setting"])
def test_no_word_but_one_about_surfaces_paints(slot):
    assert not may_serve("material", slot)
    assert may_serve("light", slot)


def test_a_color_paints_only_where_the_prompt_itself_says_it():
    assert may_serve("material", "color")
    assert not may_serve("material", "color", cause="sterile")
    assert may_serve("world", "color", cause="sterile")


def test_the_vocabulary_keeps_to_them():
    for entry in shipped_vocabulary().entries.values():
        assert all(
            may_serve(OWNERS[e.owner], entry.slot)
            for e in (*entry.effects, *(e for m in entry.never for e in m.effects))
        ), entry.name
