# SPDX-License-Identifier: Apache-2.0
"""Labeled sentences: those of the clone load, mistakes in a file are found, and a scene without Blender can be planned for."""

import functools
from collections import Counter
from pathlib import Path

import pytest
from labeled_scene import SCENES, SENTENCES, sentence, write_folder

from lab.train import sentences
from lab.train.sentences import read_folder
from lab.train.sentences.labels import LabelTarget
from lab.train.sentences.stand_in import stand_in
from proxy_renderer.goals.resolve import goals_of
from proxy_renderer.planning.planner import plan
from proxy_renderer.schema import VibeError
from proxy_renderer.words.parser import parse

FOLDERS = sorted({path.parent for path in Path(sentences.__file__).parent.glob("*/sentences_*.toml")})
of_folder = functools.cache(read_folder)  # reading the thousands of the clone takes half a minute
ENGLISH = [f for f in FOLDERS if (f / "scenes.toml").is_file() and not f.name.endswith("_native")]


@pytest.mark.parametrize("folder", FOLDERS, ids=lambda folder: folder.name)
def test_the_sentences_of_the_clone_are_well_formed(folder):
    labeled = of_folder(folder)
    kinds = Counter(each.kind for each in labeled)
    several, many = (60, 6) if folder.name == "exchanges" else (100, 10) if folder in ENGLISH else (20, 8)
    assert len(labeled) >= several
    assert len(kinds) > many
    assert all(each.text[w.start : w.end] == w.text for each in labeled for w in each.words)


def test_there_are_sentences_to_develop_with():
    assert "development" in [folder.name for folder in FOLDERS]


def test_no_sentence_is_both_developed_with_and_held_out():
    texts = [text for folder in FOLDERS for text in {each.text for each in of_folder(folder)}]
    assert not [text for text, count in Counter(texts).items() if count > 1]


def test_a_folder_is_read(tmp_path):
    (one,) = read_folder(write_folder(tmp_path))
    assert [(w.text, w.start, str(w.targets[0])) for w in one.words] == [("red", 0, "HullPaint"), ("warm", 10, "light")]
    assert one.scene.materials_of("subject") == {"HullPaint", "SeatCloth"}
    assert one.scene.materials_of("surroundings") == {"Concrete", "CrateWood", "NeonSign"}


@pytest.mark.parametrize(
    ("written", "targets"),
    [
        ("subject | HullPaint", [LabelTarget("subject"), LabelTarget("materials", frozenset({"HullPaint"}))]),
        ("HullPaint + Concrete", [LabelTarget("materials", frozenset({"HullPaint", "Concrete"}))]),
        ("light:Ceiling + light:NeonSign", [LabelTarget("lights", frozenset({"Ceiling", "NeonSign"}))]),
        ("light:NeonSign + Concrete", [LabelTarget("materials", frozenset({"NeonSign", "Concrete"}))]),
    ],
)
def test_targets_are_read(tmp_path, written, targets):
    (one,) = read_folder(write_folder(tmp_path, sentences=sentence("red hull", ("red", written))))
    assert list(one.words[0].targets) == targets


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('name = "garage"', 'name = "Garage 1"', "lower-case"),
        ('kind = "car"', 'kind = "bus"', "'bus' is no kind"),
        ('["Hull", "Seat"]', '["Hull", "Door"]', "Door"),
        ('Hull = ["HullPaint"]', 'Hull = "HullPaint"', "no list of names"),
        ("[0.5, 0.9, 0.2]", "[0.5, 0.9]", "'Sign' is"),
        ('glows = ["NeonSign"]', 'glows = ["Neon"]', "'Neon'"),
        ('role = "fill"', 'role = "key"', "both are the key"),
        ('type = "POINT"', 'type = "LASER"', "'LASER' is no type"),
        ("sky = true", "sky = 1", "neither true nor false"),
        ("sky = true", "skies = true", "'skies' is not known"),
    ],
)
def test_a_mistake_in_a_scene_is_found(tmp_path, old, new, said):
    assert old in SCENES
    with pytest.raises(VibeError, match=r"scenes\.toml > (scene|sentence) > \d+") as refused:
        read_folder(write_folder(tmp_path, scenes=SCENES.replace(old, new)))
    assert said in refused.value.message
    assert refused.value.remedy


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('["red", "HullPaint"]', '["red", "Paint"]', "'Paint' is not in 'garage'"),
        ('["warm", "light"]', '["warm", "light:Sun"]', "'light:Sun'"),
        ('["warm", "light"]', '["cold", "light"]', "'cold' does not stand in the text"),
        ('["warm", "light"]', '["re", "light"]', "'re' does not stand"),
        ('["warm", "light"]', '["warm"]', "no pair"),
        ('scene = "garage"', 'scene = "barn"', "'barn' is no scene"),
        ('kind = "list"', 'kind = "poem"', "'poem' is no kind"),
    ],
)
def test_a_mistake_in_a_sentence_is_found(tmp_path, old, new, said):
    assert old in SENTENCES
    with pytest.raises(VibeError) as refused:
        read_folder(write_folder(tmp_path, sentences=SENTENCES.replace(old, new)))
    assert "sentences_01.toml > sentence > 1" in refused.value.message
    assert said in refused.value.message


def test_a_sentence_that_is_there_twice_is_refused(tmp_path):
    with pytest.raises(VibeError, match="twice"):
        read_folder(write_folder(tmp_path, sentences=SENTENCES * 2))


def test_a_folder_without_sentences_is_refused(tmp_path):
    with pytest.raises(VibeError, match=r"no scenes\.toml"):
        read_folder(tmp_path)
    with pytest.raises(VibeError, match="with a sentence"):
        read_folder(write_folder(tmp_path, sentences=""))


def test_a_labeled_scene_is_planned_for_without_blender(tmp_path):
    (one,) = read_folder(write_folder(tmp_path))
    scene = stand_in(one.scene)
    parsed = parse("red hull, cold desk lamp", scene.scene)
    decided = plan(goals_of(parsed), scene.instances, scene.scene)
    assert decided["material/HullPaint/base_color"].priority is not None
    assert decided["material/SeatCloth/base_color"].priority is None
    assert decided["light/Desk Lamp/temperature"].lower[0] > 6500
    assert decided["light/Ceiling/temperature"].priority is None
    assert scene.scene.emitters["NeonSign"].azimuth > 90
