# SPDX-License-Identifier: Apache-2.0
"""Words count more than a picture, and move what it claims."""

import math

import pytest

from proxy_renderer.claims.claim import Claim
from proxy_renderer.reference.like import merged_claims

CAST = Claim("a.jpg: orange midtones", "picture", "midtone_cast", "picture", (8.0, 18.0), (12.0, 22.0))
SHADOWS = Claim("a.jpg: red shadows", "picture", "shadow_cast", "picture", (3.0, 0.0), (5.0, 2.0))
MEDIAN = Claim("a.jpg: tones", "picture", "median", "picture", (40.0,), (46.0,))
BLACK = Claim("a.jpg: tones", "picture", "black_point", "picture", (3.0,), (7.0,))


def word(measure, lower=-math.inf, upper=math.inf, part="picture", **more):
    return Claim("word", part, measure, part, (lower,), (upper,), **more)


def nothing(claim):
    return None


def having(value):
    return lambda claim: value


def warmth(claim):
    return claim.lower[1] + 0.5 * claim.lower[0]


def test_of_one_measure_and_part_the_words_claim_stays_alone():
    claims = merged_claims([word("median", upper=20.0)], [MEDIAN, CAST], nothing)
    assert [c.measure for c in claims] == ["median", "midtone_cast"]
    assert claims[0].upper == (20.0,)


def test_cold_moves_all_casts_along_until_it_holds_and_keeps_their_pattern():
    said, midtones, shadows = merged_claims([word("warmth", -30.0, -6.0)], [CAST, SHADOWS], having(20.0))
    assert warmth(midtones) == pytest.approx(warmth(CAST) - 26.0)
    assert warmth(shadows) == pytest.approx(warmth(SHADOWS) - 26.0)
    assert midtones.upper[0] - midtones.lower[0] == pytest.approx(4.0)
    assert midtones.lower[0] < CAST.lower[0]  # less orange, not pink
    assert (said.lower, said.upper) == ((-30.0,), (-6.0,))


def test_a_word_that_holds_in_the_picture_leaves_it():
    assert merged_claims([word("warmth", 9.0, 32.0)], [CAST], having(20.0))[1] == CAST


@pytest.mark.parametrize("own", [20.0, -20.0])
def test_colder_is_colder_than_the_picture_whatever_that_is(own):
    colder = word("warmth", -30.0, -6.0, change=-5.0, compares=True)
    said, cast = merged_claims([colder], [CAST], having(own))
    assert warmth(cast) == pytest.approx(warmth(CAST) - 12.5)
    assert own - 12.5 < said.upper[0] < own - 5.0
    assert said.change is None


def test_brighter_lifts_the_middle_more_than_black():
    brighter = word("lightness", lower=62.0, change=10.0, compares=True)
    said, median, black = merged_claims([brighter], [MEDIAN, BLACK], having(43.0))
    assert median.lower[0] == pytest.approx(65.0)
    assert black.lower[0] < 10.0
    assert 53.0 < said.lower[0] < 68.0


def test_a_word_about_the_subject_leaves_the_picture_as_it_is():
    assert merged_claims([word("lightness", lower=70.0, part="subject")], [MEDIAN], having(43.0))[1] == MEDIAN


def test_what_a_flat_picture_does_not_have_stays_as_in_words():
    rising = word("lightness", lower=70.0, change=10.0, compares=True)
    assert merged_claims([rising], [MEDIAN], nothing) == (rising, MEDIAN)


def test_what_holds_of_every_picture_takes_nothing_away():
    every = Claim("", "subject", "median", "picture", (0.0,), (1.0,))
    assert merged_claims([every], [MEDIAN], having(43.0))[1] == MEDIAN
