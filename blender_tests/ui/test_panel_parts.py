# SPDX-License-Identifier: GPL-3.0-or-later
"""Small parts of the panel without a window: earlier prompts, the list of single values, the cache's buttons."""

import bpy
import pytest
from small_scenes import studio
from vibe_render.core import preferences
from vibe_render.run.result import cause
from vibe_render.run.state import addon_state
from vibe_render.ui import result, scope, setup, words
from vibe_render.ui.properties import declare

from proxy_renderer.schema.limits import LONGEST_PROMPT
from proxy_renderer.schema.options import table as options
from proxy_renderer.schema.options.table import TABLE, Option, Panel


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """The user's own folder, empty."""
    monkeypatch.setattr(words, "own_folder", lambda path: tmp_path)
    monkeypatch.setattr(preferences, "own_folder", lambda path: tmp_path / path)
    return tmp_path


def test_earlier_prompts_come_newest_first_and_once(folder, addon):
    for text in ("noir", "golden hour", "noir", "nebliger Morgen, grün"):
        words.remember(text)
    assert list(words.history()) == ["nebliger Morgen, grün", "noir", "golden hour"]
    assert bpy.ops.vibe.recall(prompt="golden hour") == {"FINISHED"}
    assert addon.vibe.prompt == "golden hour"
    for number in range(40):
        words.remember(str(number))
    assert list(words.history()) == [str(number) for number in range(39, 9, -1)]
    words.remember("copper cup", ["copper=Cup"])
    assert words.history()["copper cup"] == ["copper=Cup"]
    assert list(words.history())[:2] == ["copper cup", "39"]
    assert bpy.ops.vibe.clear_history() == {"FINISHED"}
    assert list(words.history()) == []


@pytest.mark.parametrize("content", ["{", "{}", "[1, null]", "\udcff"])
def test_a_damaged_history_is_an_empty_one(folder, content):
    (folder / "prompts.json").write_text(content, errors="surrogateescape")
    assert list(words.history()) == []
    words.remember("noir")
    assert list(words.history()) == ["noir"]


def test_the_list_has_every_value_and_says_which_must_stay(addon):
    studio(addon)
    bpy.data.materials["Body"].node_tree.nodes["Principled BSDF"].inputs["Roughness"].keyframe_insert(
        "default_value", frame=1
    )
    scope.fill(addon)
    rows = {row.name: row for row in bpy.context.window_manager.vibe_values.rows}
    assert rows["light/Area/power"].reason == ""
    assert "animated" in rows["material/Body/roughness"].reason
    bpy.data.objects.remove(bpy.data.objects["Area"])
    scope.fill(addon)
    assert "light/Area/power" not in bpy.context.window_manager.vibe_values.rows


def test_the_list_is_searched_by_title_and_key(addon):
    studio(addon)
    scope.fill(addon)
    values = bpy.context.window_manager.vibe_values

    class Search:
        """As much of Blender's list as the filter reads."""

        filter_name, bitflag_filter_item = "AREA power", 1 << 30

    flags, order = scope.VIBE_UL_values.filter_items(Search, bpy.context, values, "rows")
    assert [row.name for row, flag in zip(values.rows, flags, strict=True) if flag] == ["light/Area/power"]
    assert order == []


def test_locks_open_and_close(addon):
    assert not bpy.ops.vibe.unlock_all.poll()
    for key in ("light/Area/power", "film/exposure", "light/Area/power"):
        bpy.ops.vibe.lock(key=key)
    assert addon.vibe.locks.keys() == ["film/exposure"]
    assert addon.vibe.engine_options(bpy.context).lock == ("film/exposure",)
    assert bpy.ops.vibe.unlock_all() == {"FINISHED"}
    assert not addon.vibe.locks


def test_the_cache_is_measured_and_cleared_but_not_during_a_vibe(folder, addon, monkeypatch):
    setup._measured.clear()
    place = preferences.cache_folder(bpy.context)
    assert setup.cache_size(place) == "Empty"
    assert not bpy.ops.vibe.clear_cache.poll()
    (place / "deep").mkdir(parents=True)
    (place / "deep" / "answer.json").write_bytes(bytes(1500))
    beside = place.parent / "mine.txt"
    beside.write_text("the artist's")
    setup._measured.clear()
    assert setup.cache_size(place) == "1.5 kB in 1 file"
    monkeypatch.setattr(addon_state, "running", True)
    assert not bpy.ops.vibe.clear_cache.poll()
    monkeypatch.setattr(addon_state, "running", False)
    assert bpy.ops.vibe.clear_cache() == {"FINISHED"}
    assert not place.exists()
    assert beside.is_file()
    assert setup.cache_size(place) == "Empty"


@pytest.mark.parametrize(
    ("reason", "short"),
    [
        ("'night' (dark night scene)", "“night”"),
        ("'noir' means 'hard light'", "“noir”"),
        ("'painter's light' (soft)", "“painter's light”"),
        ("model: warmer", "model: warmer"),
        ("", ""),
    ],
)
def test_reasons_are_short_where_a_word_says_it(reason, short):
    assert cause(reason) == short


@pytest.mark.parametrize(
    ("difference", "engine", "words", "good"),
    [
        (0.04, "CYCLES", "matches Cycles (ΔE 0.1; 1 is just visible)", True),
        (1.0, "CYCLES", "is close to Cycles", True),
        (3.2, "CYCLES", "differs from Cycles", False),
        (0.1, "BLENDER_EEVEE", "Preview is Cycles. EEVEE may look different", False),
    ],
)
def test_agreement_is_said_in_words_and_of_cycles_alone(difference, engine, words, good):
    text, is_good = result.agreement(difference, engine)
    assert words in text
    assert is_good is good


def test_moving_strength_shows_the_look_again(addon):
    addon.vibe.show_original = True
    addon.vibe.strength = 0.5
    assert not addon.vibe.show_original


def test_properties_of_options_come_from_the_table(addon, monkeypatch):
    """A made-up option has one; those of the panel and of the preferences have their titles, bounds and defaults."""
    sparkle = Option("sparkle", 3, "how much", "effort", bounds=(1, 9), panel=Panel("Sparkle", "How much", (1, 5)))
    monkeypatch.setattr(options, "TABLE", (*options.TABLE, sparkle))
    extended = {"__annotations__": declare(preferences=False)}
    sparkling = type("VibeSparkling", (bpy.types.PropertyGroup,), extended)
    bpy.utils.register_class(sparkling)
    try:
        found = sparkling.bl_rna.properties["sparkle"]
        assert (found.name, found.description, found.default) == ("Sparkle", "How much", 3)
        assert (found.hard_min, found.hard_max) == (1, 5)
    finally:
        bpy.utils.unregister_class(sparkling)
    scene = bpy.types.Scene.bl_rna.properties["vibe"].fixed_type.properties
    own = setup.VibePreferences.bl_rna.properties
    rows = [row for row in TABLE if row.panel]
    assert len(rows) > 10
    for row in rows:
        found = (own if row.panel.preferences else scene)[row.name]
        assert (found.name, found.description) == (row.panel.title, row.panel.description)
        if type(row.default) is int:
            assert (found.default, (found.hard_min, found.hard_max)) == (row.default, row.panel.bounds or row.bounds)
    addon.vibe.prompt = "x" * (LONGEST_PROMPT + 1)
    assert len(addon.vibe.prompt) == LONGEST_PROMPT


def test_the_engine_is_told_what_the_panel_and_the_preferences_hold(addon):
    addon.vibe.effort = "CUSTOM"
    addon.vibe.rounds, addon.vibe.top_k, addon.vibe.anchor = 7, 5, False
    addon.vibe.lock = "light/Key, film/exposure"
    told = addon.vibe.engine_options(bpy.context)
    assert (told.rounds, told.top_k, told.anchor, told.starts) == (7, 5, False, 1)
    assert told.lock == ("light/Key", "film/exposure")
    assert (told.device, told.encoder, told.camera) == ("auto", "", False)
