# SPDX-License-Identifier: Apache-2.0
"""Prompts in German, French, Spanish, Japanese and Chinese: lexicons, glosses, and what is said in the artist's own words."""

import tomllib
from collections import Counter
from pathlib import Path

import pytest

from lab.train import sentences
from lab.train.sentences import read_folder
from lab.train.sentences.glossed import glossed
from lab.train.sentences.stand_in import stand_in
from proxy_renderer import words
from proxy_renderer.planning.advice import compose
from proxy_renderer.words.foreign import cut, gloss
from proxy_renderer.words.lexer import Lexer
from proxy_renderer.words.lexicon.languages import TABLES, lexicons, listed
from proxy_renderer.words.lexicon.vocabulary import shipped_vocabulary
from proxy_renderer.words.parser import parse
from proxy_renderer.words.types import SceneDescription

GARAGE = SceneDescription(
    objects={"carShell": "subject", "Wand": "surroundings"},
    materials={"CarPaint": "subject", "Putz": "surroundings"},
    object_materials={"carShell": ("CarPaint",), "Wand": ("Putz",)},
)
LANGUAGES = sorted(Path(words.__file__).with_name("languages").glob("*.toml"))


def english(text: str, scene: SceneDescription = GARAGE) -> str:
    return gloss(text, scene, shipped_vocabulary()).english


@pytest.mark.parametrize("lexicon", lexicons(), ids=lambda lexicon: lexicon.name)
def test_every_look_word_of_a_lexicon_is_one_in_english(lexicon):
    lexer = Lexer(shipped_vocabulary(), SceneDescription())
    unknown = []
    for wording in lexicon.looks:
        tokens = [token for clause in lexer.clauses(wording) for token in clause]
        if not any(t.entry or t.color or t.adjective or t.lists or t.unsure for t in tokens):
            unknown.append(wording)
    assert not unknown


@pytest.mark.parametrize("lexicon", lexicons(), ids=lambda lexicon: lexicon.name)
def test_a_lexicon_has_the_basic_colors_and_hundreds_of_words(lexicon):
    basic = ("black", "white", "grey", "brown", "red", "orange", "yellow", "green", "blue", "purple", "pink")
    assert [color for color in basic if color not in lexicon.looks] == []
    assert len(lexicon.looks) > 300
    assert len(lexicon.things) > 150


@pytest.mark.parametrize(
    ("text", "meant"),
    [
        ("voiture bleu foncé très brillante", "car dark blue high gloss"),
        ("車はマットな赤、窓からの冷たい光", "car is matte red, window cool light"),
        ("墙上的瓷砖是浅绿色，没有雾", "wall tile is light green, without fog"),
        ("シンク以外はすべて白", "except sink everything white"),
        ("rotes Auto vor der Wand", "red car in front of Wand"),
        ("film noir", "film noir"),
        ("glossy teal car, 柔らかい光", "glossy teal car, soft light"),
    ],
)
def test_a_prompt_is_glossed_word_by_word(text, meant):
    assert english(text) == meant


@pytest.mark.parametrize("text", ["kein Nebel", "pas de brouillard", "sin niebla", "霧なし", "雾不要了"])
def test_what_is_negated_is_so_in_every_language(text):
    (fog,) = [a for a in parse(text, GARAGE).attributes if a.kind == "fog"]
    assert fog.negated or fog.entry == "clear air"


@pytest.mark.parametrize(
    ("text", "entry"),
    [
        ("das Auto in mattem Rot", "red"),
        ("la voiture est rouge", "red"),
        ("coche rojo", "red"),
        ("赤い車", "red"),
        ("红色的汽车", "red"),
    ],
)
def test_a_color_is_bound_to_the_thing_it_is_said_of(text, entry):
    parsed = parse(text, GARAGE)
    (color,) = [a for a in parsed.attributes if a.color]
    assert color.entry == entry
    assert color.owners == ("CarPaint",)
    assert color.place is not None
    assert text[slice(*color.place)] in color.word or color.word in text


@pytest.mark.parametrize(
    ("letters", "words"),
    [("影はふんわり", ["影", "は", "ふんわり"]), ("墙刷成白的", ["墙", "刷成", "白", "的"]), ("C4D墙", ["C4D", "墙"])],
)
def test_letters_without_spaces_are_cut_where_most_is_known(letters, words):
    assert cut(letters, {"影", "は", "黒い", "液", "墙", "白", "的"}) == words


def test_labels_go_where_the_words_of_a_sentence_go():
    (sentence, *_) = read_folder(Path(sentences.__file__).parent / "french")
    read = glossed(sentence, stand_in(sentence.scene).scene, shipped_vocabulary())
    assert read.text == english(sentence.text, stand_in(sentence.scene).scene)
    assert [(word.text, word.target) for word in read.words] == [
        ("midnight blue", sentence.words[0].target),
        ("silver", sentence.words[1].target),
        ("red", sentence.words[2].target),
    ]


def test_people_read_their_own_words_and_the_encoder_reads_english():
    parsed = parse("sehr glänzendes Auto aus dunkler Eiche, kein Nebel", GARAGE)
    words = [a.word for a in parsed.attributes if not a.cause]
    assert "sehr glänzendes" in words
    assert "kein Nebel" in words
    assert "Eiche" not in compose(parsed).subject
    assert parsed.prompt == "sehr glänzendes Auto aus dunkler Eiche, kein Nebel"


def test_what_a_lexicon_lacks_is_said_in_english():
    notes = parse("rotes Auto mit Schnörkelzeug", GARAGE).notes
    assert any("read as German" in note and "'Schnörkelzeug'" in note for note in notes)


def test_english_sentences_are_not_taken_for_other_languages():
    labeled = read_folder(Path(sentences.__file__).parent / "development")[::5]
    read = [gloss(s.text, stand_in(s.scene).scene, shipped_vocabulary()).language for s in labeled]
    assert sum(map(bool, read)) <= 1  # "chrom", "goldn": typed so in German too


@pytest.mark.parametrize("path", LANGUAGES, ids=lambda path: path.stem)
def test_a_lexicon_has_its_settings_and_no_wording_twice_in_a_table(path):
    content = tomllib.loads(path.read_text("utf-8"))
    settings = content.pop("language")
    assert {"name", "spaces"} <= settings.keys() <= {"name", "spaces", "endings"}
    assert all(pair.count("/") == 1 for pair in listed(settings.get("endings", "")))
    assert content.keys() <= {*TABLES}
    for table in content.keys() - {"things"}:
        counts = Counter(w for row in content[table].values() for w in {*listed(row)})
        assert [wording for wording, count in counts.items() if count > 1] == []


def test_the_lexicons_that_are_shipped_are_the_five_of_the_manual():
    manual = Path(__file__).parents[2] / "docs" / "guide" / "languages.md"
    text = manual.read_text(encoding="utf-8")
    assert all(lexicon.name in text for lexicon in lexicons())
