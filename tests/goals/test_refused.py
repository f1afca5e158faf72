# SPDX-License-Identifier: Apache-2.0
"""Goals that cannot be used: one line that names the field, and a remedy."""

from __future__ import annotations

import copy
import json
import random
from collections.abc import Iterator
from typing import Any

import pytest
from goal_parts import ROOM, drawn, plan_of, read

from proxy_renderer.claims.from_goals import claims_of
from proxy_renderer.goals import written
from proxy_renderer.goals.resolve import goals_of
from proxy_renderer.inputs import check
from proxy_renderer.planning.advice import compose
from proxy_renderer.rigs.chosen import chosen_rig
from proxy_renderer.schema import VibeError
from proxy_renderer.words.lexicon.rigs import rig_table
from proxy_renderer.words.lexicon.vocabulary import shipped_vocabulary

MISSING = object()


def assert_one_line(error: VibeError, *words: str) -> None:
    assert error.message
    assert error.remedy
    assert "\n" not in str(error)
    assert len(str(error)) < 1500
    assert "Vocabulary" not in str(error)
    for word in words:
        assert word in str(error), str(error)


def changed(path: str, value: Any) -> dict[str, Any]:
    """Goals of a prompt with a field replaced: "words.0.target.kind"."""
    raw = written.as_json(read("teal vase, very golden hour, cosy"))
    *steps, last = [int(step) if step.isdigit() else step for step in path.split(".")]
    place: Any = raw
    for step in steps:
        place = place[step]
    if value is MISSING:
        del place[last]
    else:
        place[last] = value
    return raw


@pytest.mark.parametrize(
    ("path", "value", "words"),
    [
        # missing
        ("words", MISSING, ["goals.words", "0 words", "1 to 500"]),
        ("words.0.word", MISSING, ["goals.words[0] has no 'word'", "a text in quotes"]),
        ("words.0.slot", MISSING, ["goals.words[0] has no 'slot'"]),
        ("words.0.wishes.0.quantity", MISSING, ["goals.words[0].wishes[0] has no 'quantity'"]),
        ("words.1.wishes.0", {"quantity": "contrast"}, ["wishes[0] wishes for nothing", "class, parameters or image"]),
        # wrong type
        ("version", "1", ["goals.version", "finite number"]),
        ("version", True, ["goals.version"]),
        ("prompt", 3, ["goals.prompt", "a text in quotes"]),
        ("stays", "Wall", ["goals.stays", "a list"]),
        ("stays", [1], ["goals.stays", '["...", "..."]']),
        ("objects", {}, ["goals.objects", "a list"]),
        ("words", {}, ["goals.words", "a list"]),
        ("words.0", "teal", ["goals.words[0] is no object", "{...}"]),
        ("words.0.word", None, ["goals.words[0]", "word"]),
        ("words.0.word", " ", ["goals.words[0].word is empty"]),
        ("words.0.target", [], ["goals.words[0].target"]),
        ("words.0.target.materials", "Clay", ["goals.words[0].target.materials", "a list"]),
        ("words.0.denied", 1, ["goals.words[0].denied", "true or false"]),
        ("words.0.strength", "very", ["goals.words[0].strength"]),
        ("words.0.shades", [[1, 2, 3]], ["goals.words[0].shades", "four"]),
        ("words.0.shades", [[1, 2, 3, 1e300]], ["goals.words[0].shades"]),
        ("words.0.english", 1, ["goals.words[0].english"]),
        ("words.0.wishes", "none", ["goals.words[0].wishes", "a list"]),
        ("words.0.wishes.0", [], ["goals.words[0].wishes[0] is no object"]),
        ("words.0.wishes.0.parameters", {}, ["wishes[0].parameters"]),
        ("words.0.wishes.0.parameters", [3], ["wishes[0].parameters"]),
        ("words.0.wishes.0.gave_way_to", 3, ["wishes[0].gave_way_to"]),
        ("words.0.vague", "yes", ["goals.words[0].vague"]),
        # unknown
        ("wish", [], ["unknown field 'wish'", "words"]),
        ("words.0.colour", "#ff0000", ["goals.words[0] has an unknown field 'colour'", "color"]),
        ("words.0.target.material", [], ["goals.words[0].target has an unknown field", "materials"]),
        ("words.0.wishes.0.classes", "x", ["wishes[0] has an unknown field 'classes'"]),
        ("objects", [{"name": "x", "region": "subject", "size": 1}], ["goals.objects[0]", "'size'"]),
        ("words.0.slot", "mode", ["goals.words[0].slot is 'mode'", "grade, mood"]),
        ("words.0.target.region", "sky", ["goals.words[0].target.region", "subject, surroundings, whole"]),
        ("words.0.wishes.0.quantity", "shine", ["wishes[0].quantity is 'shine'", "finish"]),
        ("words.0.wishes.0.class", "mauve", ["wishes[0].class is 'mauve'", "teal"]),
        ("words.0.wishes.0.toward", "mauve", ["wishes[0].toward is 'mauve'"]),
        ("words.0.wishes.0.image", ["subject prettiness 1.."], ["wishes[0].image", "prettiness", "chroma"]),
        ("words.0.wishes.0.image", ["roof chroma 1.."], ["wishes[0].image", "roof", "subject"]),
        ("words.0.wishes.0.image", ["very red"], ["wishes[0].image", "'very red' is not a claim"]),
        ("words.0.wishes.0.image", ["subject chroma 9..1"], ["wishes[0].image", "Swap them"]),
        ("words.0.wishes.0.image", ["subject tint 9.."], ["wishes[0].image", "#rrggbb"]),
        ("words.0.wishes.0.parameters", ["film/beauty 1..2"], ["wishes[0].parameters", "names no parameter"]),
        ("words.0.wishes.0.parameters", ["sun/power 1..2"], ["wishes[0].parameters", "OWNER/PARAMETER"]),
        ("words.0.wishes.0.parameters", ["more contrast"], ["wishes[0].parameters", "is not an effect"]),
        ("words.0.wishes.0.parameters", ["film/contrast 2..1"], ["wishes[0].parameters", "Swap them"]),
        ("words.0.wishes.0.parameters", ["film/contrast nan..nan"], ["wishes[0].parameters", "finite"]),
        ("words.0.wishes.0.parameters", ["film/contrast 1e999..1e999"], ["wishes[0].parameters", "finite"]),
        ("words.0.wishes.0.parameters", ["film/contrast 1,1..2,2"], ["wishes[0].parameters", "1 numbers"]),
        ("words.0.wishes.0.parameters", ["film/contrast camera 1..2"], ["wishes[0].parameters", "no mode"]),
        ("words.0.wishes.0.parameters", ["film/contrast color #ff0000"], ["wishes[0].parameters", "no mode"]),
        ("words.0.wishes.0.parameters", ["material/base_color shade 0.1..0.2"], ["wishes[0].parameters", "2 numbers"]),
        ("words.0.wishes.0.parameters", ["light/power times -1..1"], ["wishes[0].parameters", "negative"]),
        ("words.0.wishes.0.parameters", ["light/power 0..1"], ["wishes[0].parameters", "above 0"]),
        # paint by what may not paint
        (
            "words.1.wishes.0.parameters",
            ["material/roughness 0..0.1"],
            ["lighting", "may not change a material", "finish"],
        ),
        ("words.0.implied_by", "cosy", ["may not change a material"]),
        ("words.0.slot", "mood", ["of slot mood may not change a material"]),
        # numbers and colors
        ("version", 2, ["version 2", "version 1"]),
        ("version", float("nan"), ["goals.version"]),
        ("version", 10**400, ["goals.version"]),
        ("words.0.strength", float("nan"), ["goals.words[0].strength"]),
        ("words.0.strength", float("inf"), ["goals.words[0].strength"]),
        ("words.0.strength", -1, ["goals.words[0].strength is -1", "0 to 3"]),
        ("words.0.strength", 10**400, ["goals.words[0].strength"]),
        ("words.0.color", "red", ["goals.words[0].color is 'red'", "#rrggbb"]),
        ("words.0.color", "#12345", ["goals.words[0].color", "#rrggbb"]),
        ("words.0.color", "#gggggg", ["goals.words[0].color", "#rrggbb"]),
        # a text that would not fit into a line
        ("words.0.slot", "a\nb" + "c" * 5000, ["goals.words[0].slot"]),
        ("words.0.wishes.0.parameters", ["a\nb"], ["wishes[0].parameters"]),
        ("words.0.wishes.0.image", ["a\nb"], ["wishes[0].image"]),
        ("a\nb", 1, ["unknown field"]),
    ],
)
def test_a_field_that_is_wrong_is_named(path, value, words):
    with pytest.raises(VibeError) as caught:
        written.from_json(changed(path, value))
    assert_one_line(caught.value, *words)


@pytest.mark.parametrize("raw", [[], "goals", 3, None, True, [{"word": "x"}]])
def test_what_is_no_object_is_refused(raw):
    with pytest.raises(VibeError) as caught:
        written.from_json(raw)
    assert_one_line(caught.value, "goals is no object", "{...}")


def test_more_words_than_a_person_writes_are_refused():
    word = {"word": "x", "slot": "grade", "wishes": []}
    written.from_json({"words": [word] * 500})
    with pytest.raises(VibeError) as caught:
        written.from_json({"words": [word] * 501})
    assert_one_line(caught.value, "501 words", "1 to 500")


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"not JSON", ["no JSON", "vibe explain"]),
        (b"", ["no JSON"]),
        (b"\xff\xfe\x00", ["no JSON"]),
        (b'{"words": ' + b"[" * 100_000, ["no JSON"]),
        (b'{"words": [' + b"9" * 10_000 + b"]}", ["no JSON"]),
        (b"[" * 900 + b"]" * 900, ["goals is no object"]),
        (b"[]", ["goals is no object"]),
        (b"NaN", ["goals is no object"]),
        (b" " * 2_000_001, ["larger than 2 MB"]),
        (b"{}", ["neither words nor goals", "vibe explain"]),
        (b'{"goals": {}}', ["neither words nor goals"]),
        (b'{"goals": [1]}', ["goals is no object"]),
        (b'{"format": "vibe-preset", "version": 12, "roles": {}}', ["neither words nor goals"]),
        (b'{"format": "vibe-preset", "version": 12, "goals": {"words": 1}}', ["goals.words"]),
    ],
)
def test_a_file_that_holds_no_goals(tmp_path, content, words):
    path = tmp_path / "goals.json"
    path.write_bytes(content)
    with pytest.raises(VibeError) as caught:
        written.read(path)
    assert_one_line(caught.value, *words)


@pytest.mark.parametrize(
    ("name", "word"), [("missing.json", "no list of goals"), (".", "is a folder"), ("empty.json", "empty")]
)
def test_a_path_that_is_no_file(tmp_path, monkeypatch, name, word):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "empty.json").touch()
    with pytest.raises(VibeError) as caught:
        check.goals(name)
    assert_one_line(caught.value, word, name)


def test_a_good_file_is_named_by_its_whole_path(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "goals.json").write_text(json.dumps(written.as_json(read("teal vase"))))
    assert check.goals("goals.json") == str((tmp_path / "goals.json").resolve())
    assert check.goals("") == ""


POOL: tuple[Any, ...] = (
    None, True, 0, -1, 1.5, 10**400, float("nan"), "", "x", "\n", [], {}, [1], ["x"], [[1, 2, 3, 4]],
    "#ff0000", "mood", "color", "material", "subject", "surroundings", "whole", "light", "fog", "world", "key", "others",
    "glossy", "warm", "noir", "finish", "brightness", "light_color", "rim light", ["light/power times 0..0"],
    ["material/roughness 0..0.1"], ["world/color shown @"], ["picture contrast 1..2"], ["subject tint #ff0000 5.."],
    ["volume/color albedo #ffffff"], ["material/base_color color own"], ["film/contrast -5..500"], ["film/lift cast @"],
    ["material/base_color 0.1..0.2"], ["light/azimuth sides 1..2"], ["film/contrast 1.1..1.2 !0"], ["light/cone 1..2"],
)  # fmt: skip
"""What a field is replaced by: right for some, wrong for others."""
FIELDS = (
    "class",
    "toward",
    "color",
    "strength",
    "denied",
    "implied_by",
    "shades",
    "english",
    "vague",
    "look",
    "lights",
    "role",
)


def paths(value: Any, start: tuple = ()) -> Iterator[tuple]:
    """The way to every value in a JSON value, its own left out."""
    if start:
        yield start
    for key, each in value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ():
        yield from paths(each, (*start, key))


def mutated(raw: dict[str, Any], draw: random.Random) -> dict[str, Any]:
    """A copy with one or two values removed, replaced or added."""
    copied = copy.deepcopy(raw)
    for _ in range(draw.randint(1, 2)):
        *steps, last = draw.choice([*paths(copied)])
        place: Any = copied
        for step in steps:
            place = place[step]
        how = draw.random()
        if how < 0.15:
            place.pop(last)
        elif how < 0.4 and isinstance(place, dict):
            place[draw.choice(FIELDS)] = copy.deepcopy(draw.choice(POOL))
        else:
            place[last] = copy.deepcopy(draw.choice(POOL))
    return copied


def test_whatever_a_file_holds_is_refused_in_one_line_or_can_be_used():
    """Goals with drawn mistakes: no traceback while they are read, and none while they are resolved, claimed and planned."""
    draw, vocabulary, refused, used = random.Random(31), shipped_vocabulary(), 0, 0
    for _, parsed in drawn(32, 40):
        raw = written.as_json(goals_of(parsed))
        for _ in range(25):
            try:
                read_goals = written.from_json(mutated(raw, draw))
            except VibeError as error:
                assert_one_line(error)
                refused += 1
                continue
            goals = read_goals.within(ROOM)
            claims_of(goals, vocabulary)
            plan_of(goals)
            compose(goals.parsed, goals.overruled, vocabulary)
            chosen_rig(goals, rig_table(), vocabulary)
            again = written.from_json(json.loads(json.dumps(written.as_json(goals), allow_nan=False)))
            assert len(again.within(ROOM).wishes) == len(goals.wishes)
            used += 1
    assert refused > 300
    assert used > 80
