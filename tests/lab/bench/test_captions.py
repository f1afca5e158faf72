# SPDX-License-Identifier: Apache-2.0
"""`python -m lab binding --captions`: labels from the form of other people's captions, and prompts that have none."""

import json

import pytest

from lab.bench.binding import prompts, run
from lab.bench.binding.caption_files import pair, sentence
from lab.bench.binding.captions import summary
from lab.bench.binding.explaining import measured
from lab.bench.binding.judge import judge
from lab.bench.binding.reading import read
from proxy_renderer.schema import VibeError
from proxy_renderer.words.lexicon.vocabulary import shipped_vocabulary
from proxy_renderer.words.types import Parsed


@pytest.fixture
def figures(tmp_path):
    """Measures a file of captions with this content."""

    def of(name, content, **options):
        (tmp_path / name).write_text(content, encoding="utf-8")
        return run(tmp_path, captions=str(tmp_path / name), **options)

    return of


@pytest.mark.parametrize(
    ("text", "parts"),
    [
        ("a green bench and a blue bowl", [("green", 2, "bench"), ("blue", 20, "bowl")]),
        ("Rubber gloves and a wooden jewelry box.", [("Rubber", 0, "gloves"), ("wooden", 20, "jewelry box")]),
        ("a red car in front of a house and a blue bus", []),
        ("The glass jar and metallic lid hold rubber bands", []),
        ("a red car, a green bus and a blue bike", []),
        ("sunflowers and a red pot", []),
    ],
)
def test_the_form_of_a_caption_gives_its_labels(text, parts):
    assert pair(text) == parts


def test_two_things_of_one_name_have_no_labels():
    assert sentence("a red car and a blue car", pair("a red car and a blue car")) is None


def test_words_bound_wrong_and_words_left_out_are_counted_apart(figures, capsys):
    content = "a red bench and a blue bowl\na zorgly cup and a red vase\nA dog sits in the sun.\n"
    results = figures("colors.txt", content)
    assert (results["words"]["held"], results["words"]["asked"]) == (3, 4)
    assert (results["left_out"], results["wrong"], results["skipped"]) == (1, 0, 1)
    assert results["captions"]["held"] == 1
    assert "zorgly" not in capsys.readouterr().out
    (missed,) = figures("colors.txt", content, misses=True)["misses"]
    assert missed["words"] == [{"word": "zorgly", "wanted": "cup", "found": []}]
    assert "zorgly" in capsys.readouterr().out


def test_a_word_that_reaches_the_other_thing_is_bound_wrong():
    text, vocabulary = "a red bench and a blue bowl", shipped_vocabulary()
    swapped = sentence(text, [("red", 2, "bowl"), ("blue", 18, "bench")])
    figures = summary([judge(swapped, read(text, swapped.scene, vocabulary), vocabulary)], skipped=0)
    assert (figures["wrong"], figures["left_out"], figures["captions"]["held"]) == (2, 0, 0)


def test_metadata_tells_the_colors_and_what_has_none_is_skipped(figures):
    rows = [
        {"tag": "color_attr", "prompt": "a photo of a red cup and a blue wine glass",
         "include": [{"class": "cup", "color": "red"}, {"class": "wine glass", "color": "blue"}]},
        {"tag": "counting", "prompt": "a photo of three cups", "include": [{"class": "cup", "count": 3}]},
    ]  # fmt: skip
    results = figures("metadata.jsonl", "\n".join(map(json.dumps, rows)))
    assert (results["words"]["held"], results["words"]["asked"], results["skipped"]) == (2, 2, 1)


PROMPTS = "Prompt\tCategory\nglossy red teapot, zorgly lid\tArts\nwhat is the meaning of it\tAbstract\n"


def test_prompts_without_labels_are_understood_or_refused(figures, capsys):
    results = figures("prompts.tsv", PROMPTS)
    assert (results["understood"]["held"], results["understood"]["asked"]) == (1, 2)
    assert (results["entire"], results["refused"], results["faults"], results["slow"]) == (0, 1, [], 0)
    assert "zorgly" not in capsys.readouterr().out
    assert figures("prompts.tsv", PROMPTS, misses=True)["unused"]["zorgly"] == 1


@pytest.mark.parametrize(
    "error", [ZeroDivisionError("zorgly"), VibeError("No remedy."), VibeError("Two\nlines.", "Mend it.")]
)
def test_any_other_error_is_a_fault(figures, monkeypatch, error):
    def explained(text, whole):
        if "teapot" in text:
            raise error
        return Parsed(text)

    monkeypatch.setattr(prompts, "explained", explained)
    (fault,) = figures("prompts.tsv", PROMPTS)["faults"]
    assert "teapot" in fault


@pytest.mark.parametrize(
    ("name", "content", "says"),
    [
        ("none.txt", "A dog sits in the sun.", "labels"),
        ("other.jsonl", '{"text": "a red cup"}', "GenEval"),
        ("other.tsv", "Text\na red cup", "Prompt"),
    ],
)
def test_files_of_another_form_are_refused(figures, name, content, says):
    with pytest.raises(VibeError, match=says) as caught:
        figures(name, content)
    assert caught.value.remedy


def test_a_file_that_is_not_there_is_refused(tmp_path):
    with pytest.raises(VibeError, match="cannot be read"):
        run(tmp_path, captions=str(tmp_path / "none.txt"))


@pytest.mark.parametrize("options", [{"kind": "lamps"}, {"folds": 2}])
def test_options_of_labeled_sentences_are_refused(figures, options):
    with pytest.raises(VibeError, match="no kinds"):
        figures("colors.txt", "a red bench and a blue bowl", **options)


def test_sentences_are_put_together_to_forty_words():
    one = sentence("a red bench and a blue bowl", pair("a red bench and a blue bowl"))
    assert measured([one] * 4)["prompts"] == 0
    timed = measured([one] * 11)
    assert timed["prompts"] == 2
    assert 0 < timed["median"] <= timed["percentile_90"]
