# SPDX-License-Identifier: Apache-2.0
"""Names of mixed colors against what people called so in the XKCD survey, on names that nothing was fitted to."""

from __future__ import annotations

import math
import zlib

import pytest

from lab.bench.sealed.prompts import survey_colors
from proxy_renderer.color.floats import oklab_from_srgb, srgb_from_hex
from proxy_renderer.schema import Values
from proxy_renderer.words.lexicon.vocabulary import default_vocabulary
from proxy_renderer.words.parser import Understood, parse
from proxy_renderer.words.types import SceneDescription

COLORS = default_vocabulary().colors
SURVEY = dict(survey_colors())


def color_of(name: str) -> Values | None:
    """What a vase is painted that is called this."""
    found = [a.color for a in parse(f"a {name} vase", SceneDescription()).attributes if a.color]
    return found[0] if len(found) == 1 else None


def polar(srgb: Values) -> tuple[float, float, float]:
    """OKLab lightness and chroma, in hundredths, and hue in degrees."""
    light, a, b = (100 * c for c in oklab_from_srgb(srgb))
    return light, math.hypot(a, b), math.degrees(math.atan2(b, a)) % 360


def apart(one: Values, other: Values) -> float:
    """OKLab distance, in hundredths."""
    return 100 * math.dist(oklab_from_srgb(one), oklab_from_srgb(other))


def held_out(first: set[str], second: set[str]) -> dict[str, Values]:
    """Names of two words that the list lacks: of the half of the survey that the shares were not fitted to."""
    pairs = {name: name.replace("/", " ").split() for name in SURVEY if zlib.crc32(name.encode()) % 2}
    return {
        name: SURVEY[name]
        for name, words in pairs.items()
        if len(words) == 2 and name not in COLORS and words[0] in first and words[1] in second
    }


def distances(names: dict[str, Values]) -> list[float]:
    """How far each is from what is understood, the nearest first; infinite where it is no color, or several."""
    said = {name: color_of(name) for name in names}
    return sorted(math.inf if (c := said[name]) is None else apart(c, srgb) for name, srgb in names.items())


BASIC = {"grey", "brown", "red", "orange", "yellow", "green", "teal", "blue", "purple", "pink"}


def test_two_basic_colors_are_one_as_people_call_it() -> None:
    """Read as two colors they were twice as far."""
    off = distances(held_out(BASIC, BASIC))
    assert len(off) > 15
    assert off[len(off) // 2] < 7.0
    assert off[int(0.8 * len(off))] < 12.0


def test_shades_of_pale_and_of_strong_colors_are_what_people_call_so() -> None:
    """ "Dark cream" is no gray; "bright green" is brighter than green."""
    off = distances(held_out({"light", "dark", "pale", "bright"}, set(COLORS) - {*default_vocabulary().synonyms}))
    assert len(off) > 25
    assert off[len(off) // 2] < 6.5
    assert off[int(0.8 * len(off))] < 13.0


def test_a_basic_color_before_another_tinges_it() -> None:
    """ "Purple brown" is a brown, not purple and brown at once, which is magenta."""
    brown, purple, said = COLORS["brown"], COLORS["purple"], color_of("purple brown")
    assert said is not None
    assert polar(said)[1] < min(polar(brown)[1], polar(purple)[1]) + 3
    assert apart(said, srgb_from_hex("#673a3f")) < 12


def test_between_green_and_blue_lies_teal() -> None:
    """OKLab's own way from green to blue is half blue; people's is not."""
    said = color_of("greenish blue")
    assert said is not None
    assert 180 < polar(said)[2] < 225


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("lightblue", "light blue"),
        ("bluegreen", "blue green"),
        ("blue/green", "blue green"),
        ("grey-blue", "grey blue"),
    ],
)
def test_spelling_changes_no_color(one: str, other: str) -> None:
    assert color_of(one) == color_of(other) is not None


@pytest.mark.parametrize("pair", ["teal orange", "black white", "red green", "orange blue"])
def test_what_no_color_can_be_stays_two(pair: str) -> None:
    assert color_of(pair) is None


def test_shades_of_mixtures_and_very() -> None:
    plain, light, very = (color_of(name) for name in ("bluish green", "light bluish green", "very light bluish green"))
    assert plain is not None
    assert light is not None
    assert very is not None
    assert polar(plain)[0] + 5 < polar(light)[0] < polar(very)[0] - 5


@pytest.mark.parametrize("name", ["dark blue", "dark green", "dark red"])
def test_very_dark_is_darker_than_what_the_list_calls_dark(name: str) -> None:
    dark, very = color_of(name), color_of(f"very {name}")
    assert dark is not None
    assert very is not None
    assert polar(very)[0] < polar(dark)[0] - 2
    assert abs((polar(very)[2] - polar(dark)[2] + 180) % 360 - 180) < 30


@pytest.mark.parametrize("number", ["#c8102e", "#00A0B0", "#123abc"])
@pytest.mark.parametrize(
    "prompt", ["{} vase", "the vase is {}", "glossy {} vase, warm light", "Vase: {}", "Vase in {}"]
)
def test_a_color_may_be_a_number(prompt, number):
    scene = SceneDescription("Vase", {"Vase": "subject"}, {"Clay": "subject"}, {"Vase": ("Clay",)})
    (color,) = [a for a in parse(prompt.format(number), scene).attributes if a.color]
    assert color.color == srgb_from_hex(number.lower())
    assert color.region == "subject"
    (word,) = [w for w in Understood(prompt.format(number), scene).words if w.text == number.lower()]
    assert prompt.format(number)[slice(*word.place)] == number


@pytest.mark.parametrize("text", ["#c8102", "#c8102e1", "#vase", "#1"])
def test_other_numbers_are_no_colors(text):
    assert not any(a.color for a in parse(f"glossy vase {text}", SceneDescription()).attributes)
