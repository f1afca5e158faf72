# SPDX-License-Identifier: Apache-2.0
"""A reference image beside words: which of the two wins, and what relative words do to it. Goals of a picture as JSON."""

from __future__ import annotations

import json
from dataclasses import replace

import pytest
from goal_parts import ROOM, plan_of, read

from proxy_renderer.claims.from_goals import claims_of
from proxy_renderer.goals import written
from proxy_renderer.goals.relative import goals_with_picture
from proxy_renderer.goals.resolve import Goals
from proxy_renderer.goals.wish import Wish
from proxy_renderer.planning.acting import goals_without_rig
from proxy_renderer.planning.types import LightPlan
from proxy_renderer.schema import VibeError
from proxy_renderer.schema.parameters import PICTURE
from proxy_renderer.words.lexicon.quantities import quantities, read_claim
from proxy_renderer.words.lexicon.vocabulary import shipped_vocabulary
from proxy_renderer.words.types import Attribute, Parsed, SceneDescription

VOCABULARY = shipped_vocabulary()
MIDTONES = "picture midtone_cast 8,18..12,22"
SHADOWS = "picture shadow_cast 3,0..5,2"
MEDIAN = "picture median 40..46"
BLACK = "picture black_point 3..7"
GROUND = "surroundings lightness 30..36"


def fact(measure: str, value: float, part: str = "picture") -> str:
    return f"{part} {measure} {value:g}..{value:g} x0"


def picture(*texts: str, name: str = "a.jpg") -> list[Wish]:
    """A wish for each claim of a picture."""
    word = Attribute(f"{name}: look", name, PICTURE, "whole", "whole")
    claims = map(read_claim, texts)
    return [Wish(word, quantities().of_claim(claim), claims=(claim,)) for claim in claims]


def beside(prompt: str, *texts: str) -> Goals:
    goals = read(prompt) if prompt else Goals(Parsed(""))
    return goals.with_picture(picture(*texts))


def claimed(goals: Goals) -> dict[tuple[str, str], tuple]:
    """Measure and whether a picture says it -> interval."""
    said = claims_of(goals, VOCABULARY)
    return {(c.measure, c.word[:6] == "a.jpg:"): (c.lower, c.upper) for c in said if c.word}


def warmth(ends: tuple) -> float:
    return ends[0][1] + 0.5 * ends[0][0]


@pytest.mark.parametrize(
    ("prompt", "text", "word"),
    [
        ("teal shadows", SHADOWS, "teal"),
        ("purple light", MIDTONES, "purple"),
        ("red wall", GROUND, "red"),
        ("dark background", GROUND, "dark background"),
        ("vignette", "picture vignette 9..14", "vignette"),
        ("copper vase", "subject cast 1,2..5,6 or +0", "copper"),
    ],
)
def test_a_word_settles_what_a_picture_says_of_the_same(prompt, text, word):
    goals = beside(prompt, text, MEDIAN)
    (lost,) = (each for each in goals.lost if each.wish.of_picture)
    assert lost.winner.word == word
    assert not lost.is_news  # as anybody expects
    assert [str(claim) for wish in goals.pictured for claim in wish.claims] == [MEDIAN]
    rows = written.as_json(goals)["words"]
    assert [
        w["gave_way_to"] for row in rows for w in row["wishes"] if "a.jpg" in row["word"] and "gave_way_to" in w
    ] == [word]


@pytest.mark.parametrize("prompt", ["gray light", "glossy vase", "teal vase", "brighter"])
def test_what_a_word_is_not_about_stays_the_picture_s(prompt):
    goals = beside(prompt, MIDTONES, MEDIAN, fact("lightness", 40.0))
    assert len(goals.pictured) == 3
    assert not [each for each in goals.lost if each.wish.of_picture]


def test_words_come_before_a_picture_however_weak_they_are():
    wishes = [*read("cosy, rainy, golden hour").wishes, *picture(MEDIAN)]
    ranked = sorted(wishes, key=lambda wish: wish.rank)
    assert ranked[-1].of_picture


def test_cold_moves_all_casts_along_until_it_is_satisfied_and_keeps_their_pattern():
    goals = beside("cold light", MIDTONES, SHADOWS, fact("warmth", 20.0))
    alone, said = claimed(beside("", MIDTONES, SHADOWS)), claims_of(goals, VOCABULARY)
    midtones, shadows = (next(c for c in said if c.measure == m) for m in ("midtone_cast", "shadow_cast"))
    (cold,) = (c for c in said if c.measure == "warmth")
    way = cold.upper[0] - 20.0
    assert warmth((midtones.lower,)) == pytest.approx(8 / 2 + 18 + way)
    assert warmth((shadows.lower,)) == pytest.approx(3 / 2 + way)
    assert midtones.upper[0] - midtones.lower[0] == pytest.approx(4.0)
    assert midtones.lower[0] < alone["midtone_cast", True][0][0]  # less orange, not pink
    assert cold.upper[0] < 0.0


def test_a_word_that_the_picture_satisfies_leaves_it():
    goals = beside("warm light", MIDTONES, fact("warmth", 20.0))
    assert claimed(goals)["midtone_cast", True] == ((8.0, 18.0), (12.0, 22.0))


@pytest.mark.parametrize("own", [20.0, -20.0])
def test_colder_is_colder_than_the_picture_whatever_that_is(own):
    said = claimed(beside("colder", MIDTONES, fact("warmth", own)))
    (change,) = {c.change for w in read("colder").wishes for c in w.claims if c.measure == "warmth"}
    assert warmth(said["midtone_cast", True]) == pytest.approx(8 / 2 + 18 + 2.5 * change)
    assert own + 2.5 * change < said["warmth", False][1][0] < own + change


def test_brighter_lifts_the_middle_more_than_black():
    said = claimed(beside("brighter", MEDIAN, BLACK, fact("lightness", 43.0)))
    assert said["median", True][0][0] == pytest.approx(40.0 + 25.0, abs=5.0)
    assert said["black_point", True][0][0] < 12.0
    assert 53.0 < said["lightness", False][0][0] < 68.0


def test_of_two_words_of_one_measure_the_first_moves_the_picture():
    once, twice = (claimed(beside(p, MEDIAN, fact("lightness", 43.0))) for p in ("brighter", "brighter, bright"))
    assert once["median", True] == twice["median", True]


def test_without_what_the_picture_has_words_are_as_they_are_alone():
    assert claimed(beside("colder", MIDTONES))["warmth", False] == claimed(read("colder"))["warmth", False]


@pytest.mark.parametrize("prompt", ["colder", "warmer light", "more contrast", "kälter", "brighter"])
def test_words_that_compare_are_told_in_any_language(prompt):
    facts = [fact(measure, 30.0) for measure in ("warmth", "contrast", "lightness")]
    goals = beside(prompt, *facts)
    changes = [c.change for w in goals_with_picture(goals, VOCABULARY).wishes if not w.of_picture for c in w.claims]
    assert changes
    assert set(changes) == {None}


@pytest.mark.parametrize("prompt", ["cold light", "low contrast"])
def test_words_that_do_not_compare_keep_their_interval(prompt):
    goals = beside(prompt, fact("warmth", 30.0), fact("contrast", 50.0))
    said = [w.claims for w in goals_with_picture(goals, VOCABULARY).wishes if not w.of_picture]
    assert said == [w.claims for w in read(prompt).wishes]


def test_a_dark_picture_may_drown_and_one_of_the_same_scene_says_it_all():
    def every(*texts):
        return {(c.part, c.measure) for c in claims_of(beside("", *texts), VOCABULARY) if not c.word}

    light, dark, same = (every(MEDIAN), every("picture median 8..12"), every("picture mean in 0,0,1,1 1,2,3..4,5,6"))
    assert every() - light == {("picture", "drowned")}
    assert light - dark == {("subject", "drowned")}
    assert not {measure for _, measure in same} & {"burnt", "drowned", "separation"}


def test_what_a_rig_shows_comes_before_a_picture():
    word = Attribute("neon", "", "lighting", "whole", "light")
    neon = Wish(word, "light_color", claims=(read_claim("picture accent #ff00aa 12.. or +12"),))
    goals = goals_without_rig(beside("", MIDTONES, MEDIAN), LightPlan(shown=(neon,)))
    assert [each.winner.word for each in goals.lost] == ["neon"]
    assert [c.measure for c in claims_of(goals, VOCABULARY) if c.word] == ["accent", "median"]


def parsed_of(texts: list[str], parameters: list[str], **word) -> dict:
    return {
        "words": [
            {
                "word": "a.jpg",
                "look": "a.jpg",
                "slot": "picture",
                "target": {"kind": "whole", "region": "whole"},
                **word,
            }
            | {"wishes": [{"quantity": "cast", "image": texts, "parameters": parameters}]}
        ]
    }


def test_a_written_picture_is_read_again_and_is_in_no_caption():
    goals = beside("teal vase", MIDTONES, "subject cast 1,2..5,6 or +0 x0.5 (it is warm: (very))")
    again = written.from_json(json.loads(json.dumps(written.as_json(goals)))).within(ROOM)
    assert [w.claims for w in again.wishes] == [w.claims for w in goals.wishes]
    assert [a.word for a in again.parsed.attributes] == [a.word for a in goals.parsed.attributes]
    assert claims_of(again, VOCABULARY) == claims_of(goals, VOCABULARY)
    assert plan_of(again) == plan_of(goals)


def test_ranges_come_from_the_parameters_of_a_written_picture():
    raw = parsed_of([MIDTONES], ["film/gain 0.7..1.3 !2", "lights/color 0.08..1 !1"])
    plan = plan_of(written.from_json(raw).within(ROOM))
    moving = {key for key, entry in plan.items() if entry.priority is not None}
    assert moving == {key for key in plan if key == "film/gain" or (key[:6] == "light/" and key[-6:] == "/color")}
    assert plan["film/gain"].reason == "free to come to look like a.jpg"
    red, _, blue = plan["light/Key/color"].lower
    assert red > blue  # the hue of the cast


def test_what_is_said_of_a_material_that_is_missing_is_left_out():
    goals = beside("", MEDIAN).with_picture(picture(MEDIAN))
    clay = replace(
        picture("thing mean 1,2,3..4,5,6")[0],
        attribute=Attribute("a.jpg: Clay", "a.jpg", PICTURE, "whole", "whole", owners=("Clay",), thing="Clay"),
    )
    raw = written.as_json(goals.with_picture([*picture(MEDIAN), clay]))
    here, elsewhere = (written.from_json(raw).within(scene) for scene in (ROOM, SceneDescription()))
    assert (len(here.pictured), len(elsewhere.pictured)) == (2, 1)
    assert elsewhere.parsed.notes == ["'a.jpg: Clay' described Clay, which this scene lacks: it is left out."]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("picture midtone_cast 8..12", "2 numbers, joined by commas"),
        ("picture midtone_cast 8,18..12,22,3", "2 numbers"),
        ("picture mean 1,2..3,4", "3 numbers"),
        ("picture median 1,2..3,4", "one number"),
        ("picture midtone_cast 8,30..12,22", "lower end above the upper"),
        ("picture midtone_cast 8,18..12,22 or +3", "change"),
        ("picture median in 0,0,1 40..46", "'in 0,0,0.5,1'"),
        ("picture median in 0.5,0,0.5,1 40..46", "shares of the frame"),
        ("picture median in 0,0,1,2 40..46", "shares of the frame"),
        ("picture median 40..46 y2", "not a claim"),
        ("picture median 1.2.3..4", "not a claim"),
    ],
)
def test_bad_numbers_and_boxes_are_refused_with_their_place(text, words):
    with pytest.raises(VibeError) as caught:
        written.from_json(parsed_of([text], []))
    assert str(caught.value).startswith("goals.words[0].wishes[0].image: ")
    assert words in str(caught.value)


def test_effects_that_a_picture_cannot_have_are_refused():
    with pytest.raises(VibeError, match=r"goals.words\[0\].wishes\[0\].parameters: a reference image cannot have"):
        written.from_json(parsed_of([], ["world/color color #ff0000 !1"]))
