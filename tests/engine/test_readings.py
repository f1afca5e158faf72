# SPDX-License-Identifier: Apache-2.0
"""How each word of a prompt is understood while it is typed."""

import time

import pytest

from proxy_renderer.engine.live import readings
from proxy_renderer.words.types import LightDescription, SceneDescription

SCENE = SceneDescription(
    objects={"vase_01": "subject", "Lemons": "subject", "Table": "surroundings"},
    materials={"Glaze": "subject", "Peel": "subject", "Wood": "surroundings"},
    object_materials={"vase_01": ("Glaze",), "Lemons": ("Peel",), "Table": ("Wood",)},
    lights={"Desk Lamp": LightDescription("POINT", "key")},
)


def read(prompt, *target):
    return readings(prompt, SCENE, target)


def test_words_come_in_order_with_what_they_describe():
    found = read("glossy teal vase, yellow lemons, slight vignette")
    assert [word.text for word in found.words] == ["glossy", "teal", "yellow", "slight vignette"]
    assert {word.state for word in found.words} == {"understood"}
    assert "vase" in found.words[1].meaning
    assert "lemons" in found.words[2].meaning.lower()


def test_a_misspelled_word_is_taken_for_the_known_one():
    (guess,) = (word for word in read("glosy red vase").words if word.state == "guessed")
    assert guess.text == "glosy"
    assert "taken for “glossy”" in guess.meaning


def test_an_unknown_word_is_not_used_and_offers_known_ones():
    (left,) = (word for word in read("a sumptuous mood, red vase").words if word.state == "left out")
    assert left.text == "sumptuous"
    assert len(left.others) == 2
    again = read(f"a {left.others[0]} mood, red vase")
    assert all(word.state == "understood" for word in again.words)


def test_where_nothing_is_understood_known_words_are_offered_too():
    found = read("sumptuous")
    assert [(word.text, word.state) for word in found.words] == [("sumptuous", "left out")]
    assert found.words[0].others
    assert found.note


def test_what_is_left_out_is_said_where_it_stands():
    words = read("red vase, blorfy, warm light").words
    assert [word.text for word in words if word.state == "left out"] == ["blorfy"]
    assert [word.text.split()[0] for word in words] == ["red", "blorfy", "warm"]


def test_a_mood_is_one_word_whatever_it_stands_for():
    assert [word.text for word in read("noir").words] == ["noir"]


@pytest.mark.parametrize("prompt", ["", "   ", "qwxz", "\x00", "x" * 5000, "<b>", "🦊"])
def test_nothing_and_nonsense(prompt):
    found = read(prompt)
    assert not [word for word in found.words if word.state == "understood"]
    assert found.prompt == prompt
    assert bool(found.note) == bool(prompt.strip()) or found.words


def test_messages_survive_the_wire():
    from proxy_renderer.schema import messages

    found = read("a sumptuous red vase")
    assert messages.decode(messages.encode(found)) == found


@pytest.mark.parametrize(
    ("target", "means"), [("Lemons", "Lemons"), ("Desk Lamp", "Desk Lamp"), ("not used", "not used")]
)
def test_the_marks_say_what_a_word_was_told_to_describe(target, means):
    (word,) = read("warm vase", f"warm={target}").words
    assert means in word.meaning
    assert word.candidates[0] == target


def test_a_target_that_is_gone_is_said_with_its_remedy_and_can_be_taken_back():
    found = read("warm vase", "warm=Kettle")
    assert "Kettle" in found.note
    assert [word.key for word in found.words] == ["warm"]


def test_candidates_come_first_and_nothing_is_offered_that_a_word_cannot_say():
    glossy, vignette = read("glossy vase, vignette").words
    assert glossy.candidates[0] == "vase_01"
    assert {"Lemons", "Table", "not used"} <= {*glossy.targets}
    assert not {*glossy.candidates} & {*glossy.targets}
    offered = {*vignette.candidates, *vignette.targets}
    assert "image" in offered
    assert not offered & {"Lemons", "Table", "Desk Lamp", "world"}


def test_equal_words_are_told_apart():
    first, second = read("red vase, red table").words
    assert (first.key, second.key) == ("red#1", "red#2")
    first, second = read("red vase, red table", "red#2=Lemons").words
    assert (first.candidates[0], second.candidates[0]) == ("vase_01", "Lemons")


def test_a_word_is_clickable_where_nothing_else_is_understood():
    found = read("teal water")
    assert found.note
    (teal,) = (word for word in found.words if word.key == "teal")
    assert teal.state == "left out"
    assert "vase_01" in (*teal.candidates, *teal.targets)


def test_a_scene_of_thousands_is_read_at_once():
    kinds = ("Chair", "Table", "Cup", "Vase Lid")
    names = [f"{kinds[number % 4]}.{number:04d}" for number in range(2000)]
    scene = SceneDescription(
        objects=dict.fromkeys(names, "subject"),
        materials={f"{name} Paint": "subject" for name in names},
        object_materials={name: (f"{name} Paint",) for name in names},
    )
    readings("glossy red", scene)
    start = time.process_time()
    readings("glossy red chairs", scene)
    assert time.process_time() - start < 0.5  # .05 on an idle machine; 5 when limbs were looked for in pairs
