# SPDX-License-Identifier: Apache-2.0
"""`python -m lab binding`: what counts as bound right, with the real reader, and with labels that are right and wrong."""

import json

import pytest
from labeled_scene import sentence, write_folder

from lab.bench.binding import run
from lab.bench.binding.judge import judge
from lab.bench.binding.reading import read
from lab.train.sentences import read_folder
from proxy_renderer.schema import VibeError
from proxy_renderer.words.lexicon.vocabulary import shipped_vocabulary


@pytest.fixture
def verdict(tmp_path):
    """Judges one sentence with its labels."""

    def judged(text, *words):
        (labeled,) = read_folder(write_folder(tmp_path, sentences=sentence(text, *words)))
        vocabulary = shipped_vocabulary()
        return judge(labeled, read(text, labeled.scene, vocabulary), vocabulary)

    return judged


RIGHT = [
    ("red hull", "red", "HullPaint"),
    ("red hull", "red", "subject | HullPaint"),
    ("glossy", "glossy", "subject"),
    ("glossy", "glossy", "HullPaint + SeatCloth"),
    ("grey background", "grey", "surroundings"),
    ("the red sign", "red", "light:NeonSign"),
    ("pink sky", "pink", "sky"),
    ("no fog", "no fog", "air"),
    ("warm light", "warm", "light"),
    ("warm light", "warm", "light:Ceiling + light:Desk Lamp + light:NeonSign"),
    ("cold desk lamp", "cold", "light:Desk Lamp"),
    ("blue fill light", "blue", "fill"),
    ("blue rim light", "blue", "rim"),
    ("soft shadows", "soft", "light"),
    ("noir", "noir", "picture"),
    ("cosy", "cosy", "picture"),
    ("foggy morning at the harbor", "morning", "picture"),
    ("at 5 pm, glossy hull", "5 pm", "picture"),
    ("glossy hull, remove the crate", "remove the crate", "none"),
]
WRONG = [
    ("red hull", "red", "SeatCloth"),
    ("red hull", "red", "subject"),
    ("red hull", "red", "none"),
    ("red hull", "red", "picture"),
    ("glossy", "glossy", "HullPaint"),
    ("glossy", "glossy", "surroundings"),
    ("grey floor", "grey", "surroundings"),
    ("warm light", "warm", "light:Desk Lamp"),
    ("cold desk lamp", "cold", "light"),
    ("cold desk lamp", "cold", "key"),
    ("blue fill light", "blue", "rim"),
    ("pink sky", "pink", "air"),
    ("noir", "noir", "light"),
    ("zorgly glossy hull", "zorgly", "HullPaint"),
]


@pytest.mark.parametrize(("text", "word", "target"), RIGHT)
def test_a_word_is_bound_right(verdict, text, word, target):
    (only,) = [w for w in verdict(text, (word, target)).words if w.word.text == word]
    assert only.right


@pytest.mark.parametrize(("text", "word", "target"), WRONG)
def test_a_word_is_bound_wrong(verdict, text, word, target):
    judged = verdict(text, (word, target))
    assert not judged.words[0].right
    assert not judged.right


def test_a_word_that_the_reader_passes_over_is_missing(verdict):
    judged = verdict("zorgly glossy hull", ("zorgly", "HullPaint"), ("glossy", "HullPaint"))
    assert [w.right for w in judged.words] == [False, True]
    assert judged.words[0].found == ()
    assert judged.words[0].overlap == 0.0


def test_an_attribute_without_a_label_spoils_the_sentence_but_no_word(verdict):
    judged = verdict("red hull, glossy floor", ("red", "HullPaint"))
    assert judged.words[0].right
    assert [reach.attribute.entry for reach in judged.extra] == ["glossy"]
    assert not judged.right


def test_what_a_mood_stands_for_is_not_counted_beside_it(verdict):
    assert verdict("cosy", ("cosy", "picture")).right


def test_the_side_that_a_light_comes_from_needs_no_label(verdict):
    assert verdict("cold light from the left", ("cold", "light")).right
    assert verdict("red hull, light from the left", ("red", "HullPaint")).extra


def test_words_that_are_there_twice_are_told_apart_by_their_things(verdict):
    labels = ("matte", "Concrete"), ("matte", "HullPaint")
    assert verdict("matte floor and crate, matte hull", ("matte", "Concrete"), labels[1]).words[1].right
    assert verdict("the matte floor, the matte hull", *labels).right
    assert not verdict("the matte floor, the matte hull", *labels[::-1]).right


def test_materials_that_are_partly_right_overlap(verdict):
    judged = verdict("glossy", ("glossy", "HullPaint"))
    assert judged.words[0].overlap == 0.5


def test_the_rest_is_all_but_what_is_named_before(verdict):
    labels = ("red", "HullPaint + SeatCloth"), ("grey", "others")
    assert verdict("red car, grey background", ("red", "subject"), labels[1]).words[1].right
    assert not verdict("red hull, grey background", ("red", "HullPaint"), labels[1]).words[1].right
    assert not verdict("red car, grey floor", ("red", "subject"), labels[1]).words[1].right


def test_a_sentence_that_is_refused_has_no_word_right_but_those_for_nothing(verdict):
    judged = verdict("zorgly", ("zorgly", "none"))
    assert judged.error
    assert judged.right
    assert not verdict("zorgly", ("zorgly", "picture")).right


def test_figures_are_written_and_sentences_shown_only_if_asked_for(tmp_path, capsys):
    text = sentence("red hull", ("red", "SeatCloth")) + sentence("cosy", ("cosy", "picture"), kind="short")
    folder, out = write_folder(tmp_path, sentences=text), tmp_path / "out"
    out.mkdir()
    results = run(out, str(folder))
    assert (results["words"]["held"], results["words"]["asked"]) == (1, 2)
    assert results["by_sentence"]["list"]["sentences"]["held"] == 0
    assert results["by_target"]["picture"]["words"]["share"] == 1.0
    assert results["milliseconds"]["median"] > 0
    assert "red hull" not in capsys.readouterr().out + (out / "results.json").read_text(encoding="utf-8")
    (missed,) = run(out, str(folder), misses=True)["misses"]
    assert missed["words"] == [{"word": "red", "wanted": "SeatCloth", "found": ["red → HullPaint"]}]
    assert "red hull" in capsys.readouterr().out
    assert json.loads((out / "results.json").read_text(encoding="utf-8"))["misses"] == [missed]


def test_only_sentences_of_a_kind(tmp_path):
    folder = write_folder(tmp_path, sentences=sentence("red hull", ("red", "HullPaint")))
    assert run(tmp_path, str(folder), kind="list")["sentences"]["asked"] == 1
    with pytest.raises(VibeError, match="of the kind"):
        run(tmp_path, str(folder), kind="lamps")
