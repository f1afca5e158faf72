# SPDX-License-Identifier: Apache-2.0
"""Further sentences as goals: how far words go that compare, what serves them, and what stays of the rest."""

import json
import math

import pytest
import torch
from goal_parts import ROOM, plan_of, read

from proxy_renderer.claims.claim import Claim
from proxy_renderer.claims.from_goals import claims_of
from proxy_renderer.color.floats import oklab_from_srgb
from proxy_renderer.goals import written
from proxy_renderer.goals.further import further
from proxy_renderer.goals.resolve import goals_of
from proxy_renderer.planning.planner import plan
from proxy_renderer.rigs.chosen import chosen_rig
from proxy_renderer.schema import FAMILIES, Instance, sentences
from proxy_renderer.words.lexicon.rigs import rig_table
from proxy_renderer.words.lexicon.vocabulary import shipped_vocabulary
from proxy_renderer.words.parser import parse
from proxy_renderer.words.types import LightDescription, MaterialLook, SceneDescription

VOCABULARY = shipped_vocabulary()


def step(sentence):
    text, factor, compared = sentences.plain(sentence)
    return further(read(text), VOCABULARY, ROOM, factor, compared)


def change(sentence):
    """The measure that a sentence changes, and the middle of how far, in noticeable steps."""
    claim = next(c for c in claims_of(step(sentence), VOCABULARY) if c.word)
    assert claim.by
    return claim.measure, (claim.lower[0] + claim.upper[0]) / 2


@pytest.mark.parametrize(
    ("more", "less", "measure"),
    [
        ("warmer", "cooler", "warmth"),
        ("brighter", "darker", "lightness"),
        ("more fog", "less fog", "haze"),
        ("more vignette", "less vignette", "vignette"),
        ("more contrast", "less contrast", "contrast"),
        ("more saturated", "less saturated", "chroma"),
        ("harder shadows", "softer shadows", "hardness"),
        ("glossier", "less glossy", "gloss"),
    ],
)
def test_opposites_go_equally_far_in_opposite_directions(more, less, measure):
    (first, up), (second, down) = change(more), change(less)
    assert (first, second) == (measure, measure)
    assert up > 0.0
    assert down == pytest.approx(-up)


@pytest.mark.parametrize("sentence", ["the rim light a bit brighter", "bring the rim light up"])
def test_a_light_that_is_there_keeps_its_place_when_it_gets_brighter(sentence):
    effects = {effect.name for wish in step(sentence).wishes for effect in wish.effects}
    assert "power" in effects
    assert effects <= {"power", "strength"}


def test_a_factor_is_of_the_word_that_it_stands_before():
    alone, beside = step("more contrast"), step("half as red, more contrast")
    (contrast,) = (w for w in beside.wishes if any(e.name == "contrast" for e in w.effects))
    assert contrast.effects in [w.effects for w in alone.wishes]
    foggy, both = step("twice as much fog"), step("twice as much fog, more contrast")
    assert foggy.wishes[0].effects == both.wishes[0].effects


def test_a_light_that_is_called_by_its_name_is_no_setup():
    lights = {"Window Light": LightDescription("AREA"), "Sun": LightDescription("SUN")}
    text, factor, _ = sentences.plain("window light too strong, bring it down a bit")
    goals = further(
        goals_of(parse(text, SceneDescription(lights=lights))), VOCABULARY, SceneDescription(lights=lights), factor
    )
    assert chosen_rig(goals, rig_table(), VOCABULARY) is None
    wished = {(effect.name, wish.attribute.lights) for wish in goals.wishes for effect in wish.effects}
    assert wished
    assert {name for name, _ in wished} <= {"power", "strength"}
    assert {lights for _, lights in wished} == {("Window Light",)}


@pytest.mark.parametrize("sentence", ["a cool rim light", "warm key light", "a blue fill light"])
def test_the_color_of_one_light_leaves_the_world(sentence):
    owners = {effect.owner for wish in step(sentence).wishes for effect in wish.effects}
    assert owners
    assert "world" not in owners


def test_a_bit_is_half_and_much_is_twice_of_the_plain_word():
    for word in ("warmer", "less fog", "darker"):
        plain = change(word)[1]
        for small in ("a bit", "a touch", "slightly"):
            assert change(f"{small} {word}")[1] == pytest.approx(plain / 2), small
        for large in ("much", "a lot"):
            assert change(f"{large} {word}")[1] == pytest.approx(2 * plain), large


@pytest.mark.parametrize(
    ("sentence", "sign"),
    [("fog thinner", -1), ("the fog is too thick", -1), ("thicker fog", 1), ("a bit less fog", -1)],
)
def test_the_noun_of_a_comparison_is_no_wish_of_its_own(sentence, sign):
    (wish,) = step(sentence).wishes
    assert wish.quantity == "haze"
    assert wish.claims[0].lower[0] * sign > 0.0


@pytest.mark.parametrize(
    "sentence", ["lamp off", "kill the lamp", "brighten the lamp", "the lamp less bright", "dimmer lamp", "red lamp"]
)
def test_words_about_a_light_that_is_there_set_up_no_rig(sentence):
    scene = SceneDescription(lights={"Floor Lamp": LightDescription("POINT"), "Sun": LightDescription("SUN")})
    text, factor, compared = sentences.plain(sentence)
    goals = further(goals_of(parse(text, scene)), VOCABULARY, scene, factor, compared)
    assert {wish.attribute.lights for wish in goals.wishes} == {("Floor Lamp",)}
    assert chosen_rig(goals, rig_table(), VOCABULARY) is None


def test_less_of_a_color_takes_it_away_and_more_brings_it():
    beige = (0.8, 0.65, 0.6)
    look = MaterialLook(color=beige, share=0.2)
    scene = SceneDescription(
        objects={"Wall": "surroundings"},
        materials={"Paint": "surroundings"},
        object_materials={"Wall": ("Paint",)},
        looks={"Paint": look},
    )

    def red_of(sentence):
        goals = further(goals_of(parse(sentence, scene)), VOCABULARY, scene)
        return oklab_from_srgb(goals.wishes[0].attribute.color)[1]

    own = oklab_from_srgb(beige)[1]
    assert (
        red_of("wall much less red")
        < red_of("wall less red")
        < own
        < red_of("wall a bit redder")
        < red_of("wall redder")
    )


def test_a_color_of_nothing_is_a_cast_of_the_image():
    (wish,) = step("less magenta").wishes
    assert (wish.quantity, wish.claims[0].measure, wish.claims[0].part) == ("cast", "tint", "picture")
    assert wish.claims[0].upper[0] < 0.0
    assert not any(effect.owner == "material" for effect in wish.effects)


def test_a_lamp_is_its_light_and_its_glowing_bulb():
    scene = SceneDescription(
        objects={"Lamp Bulb": "surroundings"},
        materials={"Glass": "surroundings"},
        object_materials={"Lamp Bulb": ("Glass",)},
        lights={"Floor Lamp": LightDescription("POINT"), "Sun": LightDescription("SUN")},
        glows=("Glass",),
        looks={"Glass": MaterialLook(glows=True, worn={"Lamp Bulb": 0.01})},
    )
    (wish,) = further(goals_of(parse("lamps dimmer", scene)), VOCABULARY, scene).wishes
    assert {*wish.attribute.lights} == {"Floor Lamp", "material/Glass"}


def test_a_lower_light_stays_on_its_side():
    (wish,) = step("key lower").wishes
    assert [effect.name for effect in wish.effects] == ["elevation"]
    assert wish.claims[0].upper[0] < 0.0


def test_the_color_of_a_light_moves_with_its_words():
    scene = SceneDescription(lights={"Sun": LightDescription("SUN"), "Lamp": LightDescription("POINT")})
    (wish,) = further(goals_of(parse("sun more orange", scene)), VOCABULARY, scene).wishes
    assert {effect.name for effect in wish.effects} == {"color", "temperature"}
    assert wish.attribute.lights == ("Sun",)


@pytest.mark.parametrize(
    ("sentence", "noun"),
    [
        ("brushed steel for the deck", "deck"),
        ("let the screens glow a little green", "screens"),
        ("mossier green on the rock", "rock"),
    ],
)
def test_a_look_without_its_object_is_left_out(sentence, noun):
    goals = step(sentence)
    assert not goals.wishes
    assert any(f"no '{noun}'" in note for note in goals.parsed.notes)


def test_a_place_in_the_image_is_no_setting():
    goals = step("more haze between the trees")
    assert {wish.quantity for wish in goals.wishes} == {"haze"}


def test_a_side_of_an_object_is_no_light():
    assert {wish.attribute.word for wish in step("the mug front, green").wishes} == {"green"}


def test_a_word_that_does_not_say_of_what_is_left_out():
    goals = step("less blur")
    assert not goals.wishes
    assert "does not name" in goals.parsed.notes[-1]


def test_twice_as_much_is_a_factor_of_the_value():
    goals = step("twice as much fog")
    effects = [str(effect) for wish in goals.wishes for effect in wish.effects]
    assert [text.split()[1] for text in effects] == ["times"]
    assert not [claim for wish in goals.wishes for claim in wish.claims]


@pytest.mark.parametrize(("sentence", "sign"), [("less glossy", -1.0), ("a bit glossier", 1.0)])
def test_a_finish_goes_one_way(sentence, sign):
    effects = {effect.name: effect for wish in step(sentence).wishes for effect in wish.effects}
    for name, way in (("roughness", -sign), ("coat", sign), ("specular", sign)):
        assert min(way * effects[name].lower[0], way * effects[name].upper[0]) == 0.0, name
        assert max(way * effects[name].lower[0], way * effects[name].upper[0]) > 0.0, name


@pytest.mark.parametrize("sentence", ["darker", "warmer light", "a bit moodier light", "softer shadows"])
def test_a_word_that_compares_sets_up_no_rig(sentence):
    goals = step(sentence)
    compared = [a for a in goals.parsed.attributes if not a.entry]
    if len(compared) == len(goals.parsed.attributes):
        assert chosen_rig(goals, rig_table(), VOCABULARY) is None


def test_only_values_of_the_word_may_move_and_only_near_where_they_are():
    plan = plan_of(step("warmer"))
    moving = {key for key, entry in plan.items() if entry.priority is not None}
    assert {key.rpartition("/")[2] for key in moving} <= {"temperature", "gain", "midtone", "exposure"}
    assert not {key for key in moving if key.startswith("material/")}


def test_color_words_hold_lightness_and_lightness_words_hold_color():
    held = {word: [c for c in claims_of(step(word), VOCABULARY) if not c.word] for word in ("warmer", "darker")}
    assert all(len(claims) > 8 for claims in held.values())
    assert all(math.isfinite(c.upper[0]) and math.isinf(c.upper[1]) for c in held["warmer"])
    assert all(c.measure == "chromaticity" and math.isfinite(c.upper[1]) for c in held["darker"])


def test_a_word_about_an_object_holds_all_of_the_rest():
    held = [c for c in claims_of(step("darker wall"), VOCABULARY) if not c.word]
    assert all(map(math.isfinite, (v for c in held for v in c.upper)))
    assert all(("surroundings", ("Plaster",)) in c.apart for c in held)


def test_what_the_sentence_leaves_alone_is_held_closely():
    held = [c for c in claims_of(step("warmer, but leave the wall"), VOCABULARY) if c.materials == ("Plaster",)]
    others = [c for c in claims_of(step("warmer"), VOCABULARY) if not c.word]
    assert len(held) == 1
    assert held[0].upper[0] < others[0].upper[0]
    assert all(map(math.isfinite, held[0].upper))


def test_further_goals_survive_json():
    goals = step("a bit warmer, less fog")
    raw = json.loads(json.dumps(written.as_json(goals)))
    again = written.from_json(raw).within(ROOM)
    assert raw["holds"] is True
    assert again.holds
    assert claims_of(again, VOCABULARY) == claims_of(goals, VOCABULARY)


def test_words_that_contradict_each_other_are_named():
    notes = list(step("warmer light, cooler light").notes())
    assert len(notes) == 1
    assert "warmer" in notes[0]
    assert "cooler" in notes[0]


def test_the_ends_of_a_further_claim_count_from_the_image():
    claim = Claim("warmer", "picture", "warmth", "picture", (2.0,), (4.0,), by=True)
    before = torch.tensor([10.0])
    step = claim.notice
    assert claim.interval(before) == ((10.0 + 2.0 * step,), (10.0 + 4.0 * step,))
    assert claim.miss(torch.tensor([10.0 + 3.0 * step]), before) == 0.0
    assert claim.miss(before, before) == pytest.approx(2.0)
    assert not claim.was_so(before, before)


def test_the_sky_is_not_kept_where_the_sentence_changes_it():
    scene = SceneDescription(objects={"Hill": "surroundings"}, materials={"Rock": "surroundings"})
    assert "world" in parse("darker, but leave the background as it is", scene).protected
    assert "world" not in parse("darker sky, but leave the background as it is", scene).protected


@pytest.mark.parametrize("kelvins", [2200.0, 2800.0, 4000.0, 9000.0])
def test_a_lamp_a_bit_cooler_is_one_step_cooler(kelvins):
    lamp = Instance(FAMILIES["light/temperature"], "Key", (kelvins,), role="key")
    plan_ = plan(step("the key a bit cooler"), {lamp.key: lamp}, ROOM)
    lower, upper = plan_[lamp.key].lower[0], plan_[lamp.key].upper[0]
    assert 1.1 * kelvins < lower <= upper < 1.3 * kelvins


def test_a_named_color_wins_over_less_of_the_present_one():
    assert {wish.word for wish in step("vase less yellow, more like rose gold").wishes} == {"rose gold"}


@pytest.mark.parametrize(
    ("sentence", "sign"), [("softer shadows", 1.0), ("soften that shadow", 1.0), ("harder light", -1.0)]
)
def test_lights_grow_for_softer_shadows_and_shrink_for_harder_ones(sentence, sign):
    sizes = [e for wish in step(sentence).wishes for e in wish.effects if e.name in ("size", "angle")]
    assert sizes
    assert all(sign * (e.lower[0] + e.upper[0]) > 0.0 and e.lower[0] * e.upper[0] == 0.0 for e in sizes)


def test_verbs_and_places_of_a_sentence_are_no_looks():
    assert not step("fade the pale blotches at the bottom").wishes
    assert {wish.word for wish in step("let the snowy peaks catch some pink light").wishes} == {"slightly pink"}
    assert "dark purple" in {wish.word for wish in step("I'd rather have the wall dark purple, not red").wishes}


def test_a_rim_light_is_a_light_though_the_scene_has_a_rim():
    lights = {"Vibe Rim": LightDescription("AREA", "fill"), "Key": LightDescription("AREA", "key")}
    scene = SceneDescription(
        objects={"Rim": "subject", "Head Light": "subject"}, materials={"Rim": "subject"}, lights=lights
    )
    goals = further(goals_of(parse("rim light stronger", scene)), VOCABULARY, scene)
    assert {wish.attribute.lights for wish in goals.wishes} == {("Vibe Rim",)}


def test_a_further_edge_light_does_not_flood_what_is_around():
    held = [c for c in claims_of(step("a blue rim light"), VOCABULARY) if not c.word]
    assert {c.part for c in held if c.box} == {"surroundings"}
    assert not [c for c in claims_of(step("a blue fill light"), VOCABULARY) if not c.word and c.box]


def test_the_sun_that_shines_is_moved_before_one_that_is_off():
    lights = {"Sun": LightDescription("SUN", "fill"), "Vibe Key Sun": LightDescription("SUN", "key")}
    scene = SceneDescription(lights=lights)
    (wish,) = further(goals_of(parse("lower sun", scene)), VOCABULARY, scene).wishes
    assert wish.attribute.lights[0] == "Vibe Key Sun"
