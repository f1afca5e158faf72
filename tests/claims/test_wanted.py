# SPDX-License-Identifier: Apache-2.0
"""From words to claims."""

import math

import pytest
import torch

from proxy_renderer.claims.claim import Claim
from proxy_renderer.claims.from_goals import claims_of, light_claims
from proxy_renderer.claims.measures import MEASURES
from proxy_renderer.color.floats import lab_from_srgb, oklab_from_srgb, srgb_from_hex
from proxy_renderer.goals.resolve import goals_of
from proxy_renderer.schema import FAMILIES, VibeError
from proxy_renderer.schema.messages import word_states
from proxy_renderer.words.lexicon.entries import OWNERS, read_wishes
from proxy_renderer.words.lexicon.quantities import quantities
from proxy_renderer.words.lexicon.vocabulary import default_vocabulary
from proxy_renderer.words.parser import parse
from proxy_renderer.words.types import SceneDescription

SCENE = SceneDescription(
    "vase",
    {"vase": "subject", "Table": "surroundings"},
    {"Clay": "subject", "Wood": "surroundings"},
    {"vase": ("Clay",), "Table": ("Wood",)},
)


def claims(prompt: str) -> list[Claim]:
    vocabulary = default_vocabulary()
    return [c for c in claims_of(goals_of(parse(prompt, SCENE, vocabulary)), vocabulary) if c.word]


def asked(prompt: str) -> set[tuple[str, str]]:
    return {(c.measure, c.part) for c in claims(prompt)}


def test_every_measure_and_every_parameter_has_a_quantity() -> None:
    table = quantities()
    assert {row.rpartition(" ")[2] for row in table.measures} == set(MEASURES)
    assert {name for name in FAMILIES if not name.startswith("camera")} == {
        f"{OWNERS[owner]}/{name.partition(' ')[0]}"
        for owner, _, name in (row.partition("/") for row in table.parameters)
    }


@pytest.mark.parametrize(
    ("prompt", "wanted"),
    [
        ("glossy", {("gloss", "subject")}),
        ("thick fog", {("haze", "surroundings")}),
        ("dark and moody, lit from the left", {("lightness", "picture"), ("light_right", "subject")}),
        ("a dark background", {("lightness", "surroundings")}),
        ("blue light", {("tint", "picture")}),
        ("the vase is gold", {("tint", "subject"), ("unscattered", "subject")}),
        ("a glass vase", {("unscattered", "subject")}),
        ("the table is chrome", {("sharpness", "surroundings")}),
        ("velvet", {("sheen", "subject")}),
        ("ground fog", {("mist_below", "subject"), ("haze", "surroundings")}),
        ("teal shadows and orange highlights", {("shadow_cast", "picture"), ("highlight_cast", "picture")}),
    ],
)
def test_words_claim_what_they_are_about(prompt: str, wanted: set[tuple[str, str]]) -> None:
    assert wanted <= asked(prompt)


@pytest.mark.parametrize(
    ("name", "code", "impostor"), [("yellow", "#ffdd00", "#bca030"), ("navy blue", "#001146", "#2c4a80")]
)
def test_a_pale_or_dark_color_is_not_its_neighbor(name: str, code: str, impostor: str) -> None:
    """What cannot be shown as it is named is still no mustard, and no plain blue."""
    (claim,) = [c for c in claims(f"{name} vase") if c.measure == "color"]
    lightness = [100 * oklab_from_srgb(srgb_from_hex(c))[0] for c in (code, impostor)]
    shown = 100 * oklab_from_srgb(claim.color or (0, 0, 0))[0]
    assert claim.lower[0] <= shown <= claim.upper[0]
    assert not claim.lower[0] <= lightness[1] <= claim.upper[0]
    assert abs(lightness[0] - shown) < 15


@pytest.mark.parametrize("color", ["orange", "teal", "green", "magenta"])
@pytest.mark.parametrize("tones", ["shadows", "highlights"])
def test_a_color_of_shadows_or_highlights_is_their_cast(color: str, tones: str) -> None:
    (cast,) = [c for c in claims(f"{color} {tones}, matte vase") if c.measure.endswith("_cast")]
    assert cast.measure.startswith(tones[:-1])
    assert cast.part == "picture"
    assert cast.lower[0] > 0
    named = lab_from_srgb(cast.color or (0, 0, 0))[1:]
    assert sum(x * y for x, y in zip(cast.direction, named, strict=True)) > 20


@pytest.mark.parametrize(
    ("prompt", "dusk"), [("a vase as the sun goes down", True), ("a vase at three in the afternoon", False)]
)
def test_a_low_sun_is_warm_and_not_bright(prompt: str, dusk: bool) -> None:
    assert (("lightness", "picture") in asked(prompt)) is dusk
    (warm,) = [c for c in claims(prompt) if (c.measure, c.part) == ("warmth", "picture")]
    assert warm.lower[0] > 0
    assert warm.upper[0] <= 30, "a low sun leaves other colors than orange"


def test_a_thing_is_measured_by_its_materials() -> None:
    (color,) = [c for c in claims("the table is red") if c.measure == "color"]
    assert color.materials == ("Wood",)
    assert color.thing == "table"


def test_light_is_measured_on_what_no_word_colors() -> None:
    (warm,) = [c for c in claims("warm light, a deep blue background") if c.measure == "warmth"]
    assert warm.apart == (("surroundings", ()),)


def test_the_light_of_a_place_is_not_measured_on_what_the_place_is_made_of() -> None:
    (noon,) = (c for c in claims("noon in the desert") if c.measure == "warmth")
    assert noon.apart == (("surroundings", ()),)
    (desert,) = (c for c in claims("in the desert") if c.measure == "warmth")
    assert not desert.apart
    (sunset,) = (c for c in claims("sunset") if (c.measure, c.part) == ("warmth", "picture"))
    assert sunset.apart == (("sky", ()),)  # which has its own claim, and may be all orange


def test_one_of_several_lights_colors_a_part_of_the_picture() -> None:
    assert ("tint", "picture") in asked("blue light")
    for prompt in ("red light from the left, blue light from the right", "warm key light, blue rim light"):
        assert ("accent", "picture") in asked(prompt)
        assert ("tint", "picture") not in asked(prompt)


def test_a_light_of_a_color_is_no_light_of_the_other_side() -> None:
    """A morning is warm, unless its light is said to be pale blue."""
    assert ("warmth", "picture") in asked("winter morning")
    assert ("warmth", "picture") in asked("winter morning, golden light")
    assert ("warmth", "picture") not in asked("winter morning, pale blue light")
    assert ("warmth", "picture") not in asked("cool mood, orange light")


def test_the_time_of_day_says_how_light_a_setting_is() -> None:
    (light,) = [c for c in claims("desert dunes at dusk") if (c.measure, c.part) == ("lightness", "picture")]
    assert light.upper[0] < 50


@pytest.mark.parametrize("name", ["icy blue", "lavender", "pastel pink", "mint"])
def test_a_pale_color_is_not_gray(name: str) -> None:
    (color,) = [c for c in claims(f"a {name} vase") if c.measure == "color"]
    light = (color.lower[0] + color.upper[0]) / 2
    middle = [(a + b) / 2 for a, b in zip(color.lower, color.upper, strict=True)]
    assert color.miss(torch.tensor([light, 0.0, 0.0]), None) > 1
    assert color.miss(torch.tensor([light, 0.8 * middle[1], 0.8 * middle[2]]), None) <= 1


def test_a_black_void_is_nearly_black() -> None:
    (dark,) = [c for c in claims("gold vase in a black void") if c.part == "surroundings"]
    assert dark.upper[0] < 15
    assert dark.change is None


def test_a_material_has_its_color_or_not_but_light_may_be_a_change() -> None:
    """Gold that is only less blue than before is no gold; light that is less blue than before is warmer."""
    (gold,) = [c for c in claims("the vase is gold") if c.measure == "tint"]
    (blue,) = [c for c in claims("blue light") if c.measure == "tint"]
    assert gold.change is None
    assert blue.change


def test_in_colored_light_a_picture_has_no_other_tint_and_two_lights_share_it() -> None:
    """In green light it is green, not turquoise; with a magenta one besides it is neither all over."""
    tint, beside = (next(c for c in claims("green light") if c.measure == m) for m in ("tint", "off_hue"))
    assert sum(a * b for a, b in zip(tint.direction, beside.direction, strict=True)) == pytest.approx(0.0)
    assert beside.lower == tuple(-end for end in beside.upper)
    assert not [c for c in claims("green light, magenta light") if c.measure == "off_hue"]
    (pale,) = [c for c in claims("pale blue light") if c.measure == "tint"]
    assert pale.lower[0] < 0.6 * tint.lower[0]


def test_where_light_comes_from_is_for_the_word_that_says_it() -> None:
    """A haunted house is lit from below, unless the prompt says where from."""
    sides = {"light_right", "light_up", "light_front"}
    assert [c.measure for c in claims("haunted house") if c.measure in sides] == ["light_up"]
    both = [c.measure for c in claims("haunted house, light from the right") if c.measure in sides]
    assert both == ["light_right"]


def test_between_pale_colors_smaller_differences_are_seen() -> None:
    """A lavender may lack less of its chroma than a cobalt; how light it is counts alike."""
    pale, strong = (
        next(c for c in claims(f"{name} vase") if c.measure == "color").notice
        for name in ("dusty lavender", "cobalt blue")
    )
    assert isinstance(pale, tuple)
    assert isinstance(strong, tuple)
    assert pale[0] == strong[0] == MEASURES["color"].notice
    assert pale[1] < 0.7 * strong[1]


def test_what_a_mood_means_is_claimed_in_the_words_of_the_prompt() -> None:
    assert {c.word for c in claims("very cozy")} == {"very cozy"}


def test_no_claims_its_opposite_and_no_color_claims_nothing() -> None:
    (haze,) = [c for c in claims("no fog") if c.measure == "haze"]
    assert haze.upper[0] < 0.2
    assert not [c for c in claims("not red, glossy") if c.measure == "color"]


def test_of_words_that_contradict_each_other_one_claims() -> None:
    assert len([c for c in claims("matte, glossy vase") if c.measure == "gloss"]) == 1


def test_very_asks_for_more_of_a_change_and_slightly_for_less() -> None:
    change = {
        prompt: next(c.change for c in claims(prompt) if c.measure == "warmth")
        for prompt in ("slightly warm light", "warm light", "very warm light")
    }
    assert change["slightly warm light"] < change["warm light"] < change["very warm light"]


@pytest.mark.parametrize(
    "text", ["warm", "picture warmth", "picture warmth ..", "picture heat 1..2", "wall warmth 1..2", "picture warmth 3..1",
             "picture warmth 8.. or -4", "picture tint 3..", "picture warmth #ff0000 3.."],
)  # fmt: skip
def test_mistakes_in_claims_are_said(text: str) -> None:
    with pytest.raises(VibeError, match="'"):
        read_wishes([text])


def test_a_word_shows_if_judges_see_all_that_it_claims() -> None:
    rows = [
        {"word": word, "holds": holds, "already": already, "sure": sure}
        for word, holds, already, sure in (
            ("noir", True, False, True),
            ("noir", False, False, True),
            ("red", True, False, True),
            ("red", True, True, True),
            ("teal", True, True, True),
            ("velvet", True, False, True),
            ("velvet", True, True, False),
            ("gone", None, False, True),
            ("", False, False, True),
        )
    ]
    states = {"noir": "missed", "red": "visible", "teal": "already", "velvet": "unmeasured"}
    assert word_states(rows) == states
    shared = [{**rows[0], "also": ["hard"]}, {**rows[1], "also": ["midnight"]}]
    assert word_states(shared) == {"noir": "missed", "hard": "visible", "midnight": "missed"}


def test_what_judges_did_not_see_is_not_sure() -> None:
    """A change below that which they saw, a measure that told them nothing, and a thing that hardly fills any of the image."""
    (metal,) = (c for c in claims("metal vase") if c.measure == "unscattered")
    steps = quantities().seen["unscattered"] * MEASURES["unscattered"].notice
    before = torch.tensor([metal.lower[0]])
    assert metal.is_sure(before, before + 1.01 * steps, 1.0)
    assert not metal.is_sure(before, before + 0.9 * steps, 1.0)
    assert metal.is_sure(before, before, 1.0)  # was so already
    (gloss,) = (c for c in claims("glossy vase") if c.measure == "gloss")
    assert not gloss.is_sure(torch.tensor([0.0]), torch.tensor([60.0]), 1.0)
    (red,) = (c for c in claims("red vase") if c.measure == "color")
    core = torch.tensor([(a + b) / 2 for a, b in zip(red.lower, red.upper, strict=True)])
    assert red.is_sure(torch.zeros(3), core, 0.2)
    assert not red.is_sure(torch.zeros(3), core, 0.001)


def test_each_measure_says_what_it_is_of_a_thing() -> None:
    for measure in MEASURES.values():
        assert measure.sentence.count(" the {}") == 1
        assert "{" not in measure.says
        assert not measure.says.endswith((" of", " on", " in", " the"))


@pytest.mark.parametrize(
    ("before", "after", "already"),
    [(12.0, 12.5, True), (12.0, 20.0, False), (5.0, 12.0, False), (12.0, 9.5, True), (12.0, 1.0, False)],
)
def test_what_held_before_was_so_already_unless_there_is_noticeably_more_of_it(
    before: float, after: float, already: bool
) -> None:
    """Of an open end that is farther in, of an interval or a color nearer to its middle."""
    warm = Claim("warm", "picture", "warmth", "picture", (10.0,), (math.inf,))
    assert warm.was_so(torch.tensor([before]), torch.tensor([after])) == already
    (red,) = (c for c in claims("red vase") if c.measure == "color")
    core = torch.tensor([(a + b) / 2 for a, b in zip(red.lower, red.upper, strict=True)])
    edge = core + torch.tensor([(red.upper[0] - red.lower[0]) / 2, 0.0, 0.0])
    assert red.was_so(edge, edge)
    assert not red.was_so(edge, core)


def test_a_mood_counts_less_and_has_too_much_sooner() -> None:
    (said,) = [c for c in claims("warm light") if c.measure == "warmth"]
    (meant,) = [c for c in claims("romantic") if c.measure == "warmth"]
    assert meant.weight < said.weight
    assert meant.upper[0] < said.upper[0]
    assert meant.lower == said.lower


def test_white_fog_is_light_and_hides_as_much() -> None:
    white, black, green = (
        {c.measure: c for c in claims(f"{name}, a vase")} for name in ("white fog", "black smoke", "green fog")
    )
    assert white["air_lightness"].lower[0] > 60
    assert black["air_lightness"].upper[0] < 40
    assert "air_lightness" not in green
    assert all(each["haze"].lower[0] >= 0.4 for each in (white, black, green))


def test_a_color_that_is_one_has_its_hue() -> None:
    """A blue of another hue is missed, the same blue in more or less chroma is not; of a pale color hue says less."""
    for name, apart in (("greenish blue", 50.0), ("red", 35.0), ("teal", 50.0)):
        (claim,) = (c for c in claims(f"{name} vase") if c.measure == "color")
        light, strong, _ = ((a + b) / 2 for a, b in zip(claim.lower, claim.upper, strict=True))
        turned = [strong * f(math.radians(apart)) for f in (math.cos, math.sin)]
        assert claim.miss(torch.tensor([light, *turned]), None) > 1
        assert claim.miss(torch.tensor([light, 0.8 * strong, 0.0]), None) == 0
        shown = oklab_from_srgb(claim.color or (0, 0, 0))
        assert claim.oklab((light, strong, 0.0))[1:] == pytest.approx([100 * v for v in shown[1:]])


def test_what_a_word_is_all_about_goes_before_what_another_has_among_other_things() -> None:
    """Dusk is dark and cool, but warm where a warm lamp is on; of noon's hard shadows the words for them are asked."""
    (dusk,) = (c for c in claims("dusk") if c.measure == "warmth")
    (lamp,) = (c for c in claims("dusk, warm light") if c.measure == "warmth")
    assert dusk.upper[0] < 0 < lamp.lower[0]
    assert lamp.word == "warm light"
    assert "lightness" in {c.measure for c in claims("dusk, warm light") if c.word == "dusk"}
    (shadows,) = (c for c in claims("noon, hard shadows") if c.measure == "hardness")
    assert shadows.word == "hard shadows"


def test_a_gray_picture_is_no_sepia() -> None:
    (sepia,) = (c for c in claims("sepia") if c.measure == "brown_distance")
    gray, brown = torch.tensor([5.0]), torch.tensor([1.0])
    assert sepia.miss(gray, None) > 1
    assert sepia.miss(brown, None) == 0


def test_a_change_is_enough_near_an_interval_or_with_any_wherever_it_ends() -> None:
    """ "A warm picture" is no longer blue; "a paler wall" may still be dark."""
    near, anywhere = (Claim("", "", "warmth", "picture", (95.0,), (math.inf,), change=5.0, near=n) for n in (1, 0))
    before, risen = torch.tensor([20.0]), torch.tensor([26.0])
    assert near.miss(risen, before) > 1
    assert anywhere.miss(risen, before) == 0
    assert anywhere.miss(before, before) > 1


@pytest.mark.parametrize("word", ["darker", "lighter", "faded", "vivid"])
def test_what_a_surface_is_more_of_can_be_reached(word: str) -> None:
    """A middling surface that has changed by twice what is asked for has changed enough."""
    compared = [c for c in claims(f"the vase is {word}") if not c.near]
    assert compared
    for claim in compared:
        assert claim.change
        before = torch.tensor([40.0])
        assert claim.miss(before + 2 * claim.change, before) == 0


def test_places_claim_what_is_seen_of_them() -> None:
    lush = next(c for c in claims("in a forest") if c.measure == "tint")
    assert lush.part == "surroundings"
    assert lush.direction[0] < 0  # green
    assert {("tint", "picture"), ("warmth", "picture")} <= asked("in an ice cave")
    silent = [
        e.name
        for e in default_vocabulary().entries.values()
        if e.slot == "setting" and not any(m.claims or m.named for m in e.wishes)
    ]
    assert not silent


def test_a_named_color_of_what_lies_around_rules_out_what_a_place_is_usually_like() -> None:
    assert ("tint", "surroundings") not in asked("in a forest, purple background")
    assert ("lightness", "picture") in asked("in a forest, purple background")
    assert not [c for c in claims("underwater, orange light") if c.measure == "warmth" and c.upper[0] < 0]


def test_a_gray_place_is_not_gray_in_light_of_a_color() -> None:
    assert ("chroma", "surroundings") in asked("in a gallery, soft light")
    for light in ("sunset", "blue hour", "red light"):
        assert ("chroma", "surroundings") not in asked(f"in a gallery, {light}")


@pytest.mark.parametrize("place", ["beach", "snowfall", "salt flats"])
def test_night_comes_before_a_bright_place_and_a_bright_weather(place: str) -> None:
    (light,) = (c for c in claims(f"{place} at night") if (c.measure, c.part) == ("lightness", "picture"))
    assert light.upper[0] < 40


def test_sunshine_is_bright_and_hard() -> None:
    for word in ("sunny", "sunshine", "bright sun", "harsh midday"):
        wanted = {c.measure: c for c in claims(word)}
        assert wanted["hardness"].lower[0] > 0.3
        assert wanted["lightness"].lower[0] > 50
    assert {c.measure: c for c in claims("cloudy")}["hardness"].upper[0] < 0.4


def test_colored_light_is_no_dark_light() -> None:
    """Unless words for that are there: a tint is not had by exposing less."""

    def floor(prompt: str) -> list[float]:
        vocabulary = default_vocabulary()
        every = claims_of(goals_of(parse(prompt, SCENE, vocabulary)), vocabulary)
        return [c.lower[0] for c in every if (c.measure, c.part, c.word) == ("lightness", "picture", "")]

    (green,), (blue,) = floor("toxic green light"), floor("deep blue light")
    assert green > 40 > blue
    assert not floor("green light at night")
    assert not floor("green vase")


def test_the_colors_of_a_mood_are_claimed_in_its_name_and_opposed_ones_in_parts_of_the_picture() -> None:
    lights = [c for c in claims("vaporwave") if c.measure in ("tint", "accent")]
    assert {c.measure for c in lights} == {"accent"}
    assert {c.word for c in claims("vaporwave")} == {"vaporwave"}
    assert all(c.weight < 1 for c in lights)


@pytest.mark.parametrize("matter", ["walnut", "leather", "green glass"])
def test_a_material_with_a_color_of_its_own_is_tinted_by_it_unless_another_one_is_named(matter: str) -> None:
    assert ("tint", "subject") in asked(f"a {matter} vase")
    assert ("tint", "subject") not in asked("a concrete vase")
    assert ("color", "subject") in asked("a blue leather vase")
    assert ("tint", "subject") not in asked("a blue leather vase")
    assert ("tint", "subject") in asked("a leather vase, blue background")


def test_a_gray_material_is_about_as_light_as_it_is() -> None:
    """Snow is white and coal black; metals and glass are as light as what they show."""
    (snow,), (coal,) = (of(f"{matter} vase", "lightness", "subject") for matter in ("snow", "soot"))
    assert coal.upper[0] < 40.0 < 55.0 < snow.lower[0]
    (concrete,) = of("concrete vase", "lightness", "subject")
    assert coal.upper[0] < (concrete.lower[0] + concrete.upper[0]) / 2 < snow.lower[0]
    for mirroring in ("chrome vase", "glass vase", "red vinyl vase"):
        assert not of(mirroring, "lightness", "subject")


def test_what_is_gray_by_its_material_is_not_colored_for_being_fresh() -> None:
    assert of("fresh vase", "chroma", "subject")
    assert not of("fresh asphalt vase", "chroma", "subject")
    assert of("fresh oak vase", "chroma", "subject")


def of(prompt: str, measure: str, part: str) -> list[Claim]:
    return [c for c in claims(prompt) if (c.measure, c.part) == (measure, part)]


def test_of_two_words_for_one_measure_the_one_that_goes_further_counts_too() -> None:
    """A film noir is black and white, though muted colors are colors; what contradicts the first word does not count."""
    muted, noir = of("muted colors, film noir", "chroma", "picture")
    assert {muted.word, noir.word} == {"muted colors", "film noir"}
    assert min(muted.upper[0], noir.upper[0]) == of("film noir", "chroma", "picture")[0].upper[0]
    assert len(of("vivid colors, film noir", "chroma", "picture")) == 1


def test_what_a_place_usually_is_gives_way_around_the_subject_to_what_is_said_of_the_picture() -> None:
    assert of("in a museum", "chroma", "surroundings")
    assert not of("in a museum, vivid colors", "chroma", "surroundings")
    assert of("in a museum, muted colors", "chroma", "surroundings")


def test_a_picture_burns_out_only_where_words_ask_for_white() -> None:
    def kept(prompt: str) -> bool:
        said = claims_of(goals_of(parse(prompt, SCENE, default_vocabulary())), default_vocabulary())
        return any((c.measure, c.part) == ("burnt", "picture") for c in said)

    assert kept("golden hour")
    assert not kept("white background")
    assert not kept("high key")


def test_no_channel_is_clipped_and_nothing_is_gaudy_unless_words_ask_for_it() -> None:
    def kept(prompt: str) -> set[str]:
        said = claims_of(goals_of(parse(prompt, SCENE, default_vocabulary())), default_vocabulary())
        return {c.measure for c in said if not c.word} & {"clipped", "colorfulness"}

    assert kept("golden hour") == {"clipped", "colorfulness"}
    assert kept("white background") == {"colorfulness"}
    assert kept("glowing letters") == {"colorfulness"}
    assert kept("vivid colors") == {"clipped"}


def test_a_rig_does_not_ask_for_paint_that_a_word_contradicts() -> None:
    """Moonlight on a red vase is cool around it, and does not make it pale."""
    light = [Claim("moonlight", "subject", m, "subject", *ends) for m, ends in (
        ("highlight_warmth", ((-math.inf,), (-1.5,))), ("standing_out", ((4.0,), (math.inf,))), ("key_to_fill", ((1.0,), (math.inf,))),
    )]  # fmt: skip
    painted = {(c.measure, c.part) for c in light_claims(light, claims("red vase"))}
    assert painted == {("highlight_warmth", "picture"), ("key_to_fill", "subject")}
    assert [*light_claims(light, claims("glossy vase"))] == light


def test_a_weak_word_asks_for_less_at_both_ends():
    """Of many words: the end that is asked for, and the one where there is too much."""
    checked = set()
    for name in [*sorted(default_vocabulary().entries)[::12], "vignette", "warm light"]:
        plain = {(c.measure, c.part, c.direction): c for c in claims(name) if c.change}
        for claim in claims(f"slightly {name}"):
            strong = plain.get((claim.measure, claim.part, claim.direction))
            named = strong and claim.change and not claim.color and claim.weight == 1.0  # no mood, no color
            if not named or claim.word == strong.word:
                continue
            near = (strong.lower[0] - claim.lower[0]) if claim.change > 0 else (claim.upper[0] - strong.upper[0])
            far = (strong.upper[0] - claim.upper[0]) if claim.change > 0 else (claim.lower[0] - strong.lower[0])
            assert near > 0, claim
            assert far > 0 or math.isinf(claim.upper[0] - claim.lower[0]), claim
            checked.add(claim.measure)
    assert checked >= {"vignette", "warmth"}
