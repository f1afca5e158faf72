# SPDX-License-Identifier: Apache-2.0
"""Words count more than a picture."""

import math

from proxy_renderer.claims.claim import Claim
from proxy_renderer.reference.merge import together

TINT = Claim("a.jpg: orange midtones", "picture", "midtone_tint", "picture", (8.0, 18.0), (12.0, 22.0))
MEDIAN = Claim("a.jpg: tones", "picture", "median", "picture", (40.0,), (46.0,))


def word(measure, lower=-math.inf, upper=math.inf, part="picture"):
    return Claim("word", part, measure, part, (lower,), (upper,))


def test_of_one_measure_and_part_the_words_claim_stays_alone():
    claims = together([word("median", upper=20.0)], [MEDIAN, TINT])
    assert [c.measure for c in claims] == ["median", "midtone_tint"]
    assert claims[0].upper == (20.0,)


def test_colder_lets_tints_be_bluer_and_leaves_red_and_green():
    (_, tint) = together([word("warmth", upper=-8.0)], [TINT])
    assert tint.lower == (8.0, -math.inf)
    assert tint.upper == (12.0, 22.0)


def test_brighter_lets_tones_be_lighter():
    (_, median) = together([word("lightness", lower=70.0)], [MEDIAN])
    assert (median.lower, median.upper) == ((40.0,), (math.inf,))


def test_a_word_about_the_subject_leaves_the_picture_as_it_is():
    assert together([word("lightness", lower=70.0, part="subject")], [MEDIAN])[1] == MEDIAN


def test_what_holds_of_every_picture_takes_nothing_away():
    every = Claim("", "subject", "median", "picture", (0.0,), (1.0,))
    assert together([every], [MEDIAN])[1] == MEDIAN
