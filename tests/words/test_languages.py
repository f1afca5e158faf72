# SPDX-License-Identifier: Apache-2.0
"""Prompts in German, French, Spanish, Japanese and Chinese: lexicons, glosses, and what is said in the artist's own words."""

from pathlib import Path

import pytest

from lab.train import sentences
from lab.train.sentences import read_folder
from lab.train.sentences.glossed import glossed
from lab.train.sentences.stand_in import stand_in
from proxy_renderer.planning.captions import compose
from proxy_renderer.schema import VibeError
from proxy_renderer.words.foreign import cut, gloss
from proxy_renderer.words.lexer import Lexer
from proxy_renderer.words.lexicon.languages import lexicons, load
from proxy_renderer.words.lexicon.vocabulary import shipped_vocabulary
from proxy_renderer.words.parser import parse
from proxy_renderer.words.types import SceneDescription

GARAGE = SceneDescription(
    objects={"carShell": "subject", "Wand": "surroundings"},
    materials={"CarPaint": "subject", "Putz": "surroundings"},
    object_materials={"carShell": ("CarPaint",), "Wand": ("Putz",)},
)
LEXICON = '[language]\nname = "Test"\nspaces = true\n'


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
        ("dunkelblaues Auto, warme Schreibtischlampe", "dark blue car, warm desk lamp"),
        ("voiture bleu foncé très brillante", "high gloss dark blue car"),
        ("el sillón es más oscuro que la mesa", "armchair is more dark than table"),
        ("車はマットな赤、窓からの冷たい光", "car is matte red, window cool light"),
        ("墙上的瓷砖是浅绿色，没有雾", "wall tile is light green, without fog"),
        ("シンク以外はすべて白", "except sink everything white"),
        ("rotes Auto vor der Wand", "red car in front of Wand"),
        ("Lampe aus, Scheinwerfer an", "lamp off, headlight switched on"),
        ("Lampe aus Messing", "lamp of brass"),
        ("el sillón más oscuro que la mesa", "more dark armchair than table"),
        ("影はくっきり、床は白", "shadow is crisp, floor is white"),
        ("un beignet glacé, une boule de glace", "glazed donut, ice cream"),
        ("kälteres Licht, kalter Nebel", "cooler light, cool fog"),
        ("椅子比地板暗", "chair than floor dark"),
        ("椅子は床より暗い", "chair is than floor dark"),
        ("光線再柔和一點", "light more soft"),
        ("film noir", "film noir"),
        ("glossy teal car, 柔らかい光", "glossy teal car, soft light"),
    ],
)
def test_a_prompt_is_glossed_word_by_word(text, meant):
    assert english(text) == meant


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
    [
        ("影はふんわり", ["影", "は", "ふんわり"]),
        ("墙刷成白的", ["墙", "刷成", "白", "的"]),
        ("C4D墙", ["C4D", "墙"]),
        ("黒い液体", ["黒い", "液", "体"]),
    ],
)
def test_letters_without_spaces_are_cut_where_most_is_known(letters, words):
    assert cut(letters, {"影", "は", "黒い", "液", "墙", "白", "的"}) == words


def test_of_things_that_are_called_alike_the_one_in_the_scene_is_meant():
    balls = SceneDescription(
        objects={"Sphere": "subject"}, materials={"M": "subject"}, object_materials={"Sphere": ("M",)}
    )
    dials = SceneDescription(
        objects={"Dial": "subject"}, materials={"M": "subject"}, object_materials={"Dial": ("M",)}
    )
    assert english("esfera roja", balls) == "red sphere"
    assert english("esfera roja", dials) == "red dial"


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


@pytest.mark.parametrize(
    ("row", "said"),
    [
        ('[colors]\n"red" = "rot"', "line 4: 'colors' is no table"),
        ('[looks]\n"red" = ["rot"]', "line 5: 'red' is no text"),
        ('[looks]\n"red" = "rot"\n"blue" = "rot"', "line 5: 'rot' is in two rows"),
        ('endings = "e"', "line 4: 'e' of the endings has no '/'"),
        ('particles = "aus"', "line 4: 'aus' of the particles has no '/'"),
        ('[looks]\n"red" = "rot', "line 5"),
    ],
)
def test_a_mistake_in_a_lexicon_names_file_line_and_remedy(tmp_path, row, said):
    path = tmp_path / "test.toml"
    path.write_text(LEXICON + row + "\n", encoding="utf-8")
    with pytest.raises(VibeError) as caught:
        load(path)
    assert said in caught.value.message
    assert str(path) in caught.value.message
    assert caught.value.remedy


def test_the_lexicons_that_are_shipped_are_the_five_of_the_manual():
    manual = Path(__file__).parents[2] / "docs" / "guide" / "languages.md"
    text = manual.read_text(encoding="utf-8")
    assert all(lexicon.name in text for lexicon in lexicons())
