# SPDX-License-Identifier: GPL-3.0-or-later
"""What comes after a vibe, in a real Blender window: the result in sight, presets, files, further sentences, light mix."""

import os

import pytest
from window_walk import SIZES

pytestmark = [pytest.mark.slow, pytest.mark.timeout(2500)]  # minutes where others use the machine too


@pytest.mark.parametrize("way", ["tour", "tour_double"])
def test_the_decision_is_in_sight(walk, way):
    """At 900 pixels, and at twice the size of everything: every word that is measured is visible, and Keep needs no scrolling."""
    observed = walk(way)
    assert observed["visible"]
    assert observed["missed"] == []
    _, below, page = observed["keep"]
    assert page == 0
    assert below < int(SIZES[way][1]) * 0.85


def test_a_preset_is_saved_found_and_put_on_another_scene(walk):
    """Keep keeps; the picture grid finds by words; Apply says what it changed, and Revert takes it back."""
    observed = walk("presets")
    assert observed["kept"]
    assert observed["saved"] == observed["chosen"]
    assert observed["applied"]
    assert observed["preset_revert_restores"]


def test_without_an_engine_the_panel_says_so_and_the_rest_works(walk):
    """Earlier prompts, locks, a preset, compare, strength, Revert; nothing is downloaded offline."""
    observed = walk("without_engine")
    assert observed["vibe_it_waits"]
    assert observed["recalled"] == "noir, one hard light"
    assert observed["unlocked"]
    assert observed["preset"] == "Moonlight"
    assert 0.3 < observed["strength"] < 0.9
    assert len(observed["powers_on_the_way"]) > 5, "the light follows while the slider is dragged"
    for shown in ("dimmed", "before_shows_before", "rendered", "revert_restores"):
        assert observed[shown], shown
    assert "no Vibe engine" in observed["tested"]
    assert observed["offline_sets_up_nothing"]
    assert observed["asks_before_it_downloads"]
    assert observed["esc_sets_up_nothing"]


def test_presets_and_looks_as_files(walk):
    """A preset is saved beside ours, renamed, exported, deleted and imported; assets come back by drag and drop."""
    observed = walk("files")
    assert observed["saved"] == "Moonlight 2"
    assert observed["renamed"] == observed["imported"] == "Blue Night"
    assert observed["exported"] == ["blue-night.jpg", "blue-night.json"]
    assert observed["deleted"]
    assert set(observed["assets"]) == {"Moonlight Light Rig", "Moonlight Grade", "Moonlight World"}
    assert observed["rig"] == ["LIGHT", "LIGHT"]


def test_a_picture_is_given_instead_of_words(walk):
    """A file whose path is typed is what the look comes from; an image of the .blend and a render slot are taken as well."""
    observed = walk("still")
    assert not observed["like_failure"]
    assert observed["like_changes"]
    assert all("dusk.png" in word for word in observed["like_words"])
    assert observed["like_words"]
    assert observed["like_image"] == "dusk.png"
    assert observed["like_slot"] == "render slot 1"


def test_a_further_sentence_and_its_steps(walk):
    """What is typed goes on from the result; a step is shown and switched off with a click, and undone by one undo step."""
    observed = walk("further")
    assert observed["failure"] == ""
    assert observed["sentences"][1:] == ["much darker"]
    for seen in ("further_changes", "show_restores", "undo_restores", "off_restores"):
        assert observed[seen], seen


def test_a_light_is_mixed_by_its_slider(walk):
    """The image follows the slider; Apply is one undo step; the compositor has the light group until Revert."""
    observed = walk("light_mix")
    (name,) = observed["factor"]
    assert observed["images_on_the_way"] > 3
    assert observed["changed"] == [f"{name}.energy", f"{name}.color"]
    assert observed["light_groups"] == [name]
    for seen in ("scene_stays", "undo_restores", "revert_restores"):
        assert observed[seen], seen


@pytest.mark.skipif("VIBE_WINDOW_OUT" not in os.environ, reason="takes ten minutes; its parts are tested one by one")
def test_an_artists_hour(walk):
    """Sentences, a change by hand, light mix, keyframes, a checked sequence and final frames; Revert takes all of it back."""
    observed = walk("hour")
    assert [len(steps) for steps in observed["sentences"]][:3] == [2, 3, 4]
    assert observed["frames_checked"] >= 4
    for seen in ("hand_made_stays", "first_look_at_its_frame", "revert_restores", "no_keyframes_stay"):
        assert observed[seen], seen
