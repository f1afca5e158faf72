# SPDX-License-Identifier: Apache-2.0
"""Goals as JSON: what is written is read again, in the same scene and in another one."""

from __future__ import annotations

import json
from dataclasses import fields, replace

import pytest
from goal_parts import ROOM, drawn, exact, plan_of, read

from proxy_renderer.claims.from_goals import claims_of
from proxy_renderer.goals import written
from proxy_renderer.goals.resolve import Goals, goals_of
from proxy_renderer.goals.wish import Wish
from proxy_renderer.planning.advice import compose
from proxy_renderer.rigs.chosen import chosen_rig
from proxy_renderer.schema.preset import Preset
from proxy_renderer.words.lexicon.rigs import rig_table
from proxy_renderer.words.lexicon.vocabulary import shipped_vocabulary
from proxy_renderer.words.types import Attribute, SceneDescription

VOCABULARY = shipped_vocabulary()
UNWRITTEN = {"guess", "place", "look"}
"""Fields of a word that say how it was typed and bound, and nothing of what it wishes for."""


def through_json(goals: Goals, scene: SceneDescription = ROOM) -> Goals:
    text = json.dumps(written.as_json(goals), ensure_ascii=False, allow_nan=False)
    return written.from_json(json.loads(text)).within(scene)


def said(attribute: Attribute) -> dict:
    return {f.name: getattr(attribute, f.name) for f in fields(attribute) if f.name not in UNWRITTEN}


def content(wish: Wish) -> tuple:
    return (
        said(wish.attribute),
        wish.quantity,
        wish.named,
        wish.effects,
        wish.claims,
        wish.strength,
        wish.rank,
        wish.is_seen,
    )


@pytest.mark.parametrize("seed", [21, 22, 23])
def test_what_is_written_is_read_again(seed):
    """Words, wishes, winners, claims, ranges, captions: all that is searched by."""
    softly = shaded = lost = 0
    for prompt, parsed in drawn(seed, 120):
        goals = goals_of(exact(parsed))
        again = through_json(goals)
        assert list(map(said, again.parsed.attributes)) == list(map(said, goals.parsed.attributes)), prompt
        assert list(map(content, again.wishes)) == list(map(content, goals.wishes)), prompt
        pairs = [sorted((e.wish.word, e.wish.quantity, e.winner.word) for e in g.lost) for g in (goals, again)]
        assert pairs[0] == pairs[1], prompt
        assert again.classes == goals.classes, prompt
        assert sorted(again.notes()) == sorted(goals.notes()), prompt
        assert claims_of(again, VOCABULARY) == claims_of(goals, VOCABULARY), prompt
        assert dict(plan_of(again).items()) == dict(plan_of(goals).items()), prompt
        captions = [compose(g.parsed, g.overruled, VOCABULARY) for g in (goals, again)]
        assert captions[0] == captions[1], prompt
        softly += any(wish.toward != wish.named for wish in goals.wishes if not wish.attribute.color)
        shaded += any(a.shades for a in goals.parsed.attributes)
        lost += bool(goals.lost)
    assert min(softly, shaded, lost) > 3


def test_what_is_read_is_written_the_same():
    for prompt, parsed in drawn(24, 120):
        raw = written.as_json(goals_of(parsed))
        assert written.as_json(written.from_json(raw).within(ROOM)) == raw, prompt


@pytest.mark.parametrize("prompt", ["rembrandt lighting", "golden hour, cosy", "silhouette, cool light"])
def test_the_rig_is_the_same(prompt):
    goals = read(prompt)
    rigs = [chosen_rig(each, rig_table(), VOCABULARY) for each in (goals, through_json(goals))]
    assert rigs[0] is not None
    assert rigs[0].rig == rigs[1].rig


@pytest.mark.parametrize("prompt", ["dunkle Eiche, warmes Licht", "la taza es roja, luz fría", "表面は光沢のある赤"])
def test_a_prompt_of_another_language_is_the_same(prompt):
    goals = goals_of(exact(read(prompt).parsed))
    again = through_json(goals)
    assert goals.wishes
    assert list(map(content, again.wishes)) == list(map(content, goals.wishes))
    assert claims_of(again, VOCABULARY) == claims_of(goals, VOCABULARY)


@pytest.mark.parametrize(
    ("times", "strength"), [(1, 1.8), (2, 3.0), (3, 3.0), (190, 3.0)], ids=("once", "twice", "thrice", "190")
)
def test_a_word_that_is_said_very_strongly_can_be_written(times, strength):
    goals = read(f"{'extremely ' * times}glossy vase, {'extremely ' * min(times, 3)}cosy")
    assert max(a.strength for a in goals.parsed.attributes) == strength
    assert list(map(content, through_json(goals).wishes)) == list(map(content, goals.wishes))
    assert plan_of(goals)


@pytest.mark.parametrize("times", [1, 2, 4, 100])
def test_a_word_that_is_said_very_softly_can_be_written(times):
    goals = read(f"{'slightly ' * times}glossy vase")
    assert goals.parsed.attributes[0].strength == max(0.5**times, 0.05)
    assert list(map(content, through_json(goals).wishes)) == list(map(content, goals.wishes))


def test_colors_are_rounded_to_six_digits():
    goals = read("the vase is bright gunmetal")
    (color,) = (a.color for a in goals.parsed.attributes if a.color)
    (back,) = (a.color for a in through_json(goals).parsed.attributes if a.color)
    assert back == pytest.approx(color, abs=0.5 / 255)


def test_what_stays_and_what_is_named_are_kept():
    goals = through_json(read("keep the wall, a teal vase on a glossy table"))
    assert goals.parsed.protected == ("material/Plaster",)
    assert {(each.name, each.region) for each in goals.parsed.objects} >= {("vase", "subject")}


def test_without_a_winner_the_loser_wins():
    """Conflicts are resolved anew: whoever removes a word from a file need not look for what gave way to it."""
    raw = written.as_json(read("matte vase, glossy vase"))
    (loser,) = (w for w in raw["words"] if any("gave_way_to" in wish for wish in w["wishes"]))
    assert loser["word"] == "glossy"
    assert not [w for w in written.from_json(raw).within(ROOM).wishes if w.named == "glossy"]
    raw["words"].remove(next(w for w in raw["words"] if w["word"] == "matte"))
    alone = written.from_json(raw).within(ROOM)
    assert {w.named for w in alone.wishes if w.quantity == "finish"} == {"glossy"}
    assert not alone.lost


def test_the_least_that_can_be_written():
    """A file by hand: no version, no prompt, no look of the vocabulary."""
    wish = {"quantity": "contrast", "class": "high", "image": ["picture contrast 68.. or +10"]}
    goals = written.from_json({"words": [{"word": "my look", "slot": "grade", "wishes": [wish]}]}).within(ROOM)
    assert goals.classes == {"contrast": "high"}
    assert [c.word for c in claims_of(goals, VOCABULARY) if c.word] == ["my look"]
    assert goals.parsed.prompt == ""
    assert plan_of(goals)
    assert compose(goals.parsed, goals.overruled).subject == "a vase"


def test_a_light_of_its_own_color_needs_no_look():
    """A word of a file may be no entry of the vocabulary, next to a color of light that would hide the subject's."""
    words = [
        {"word": "orange", "slot": "color", "color": "#ff7f00", "wishes": [{"quantity": "color"}]},
        {
            "word": "purple",
            "slot": "color",
            "color": "#8000ff",
            "target": {"kind": "light", "region": "whole"},
            "wishes": [{"quantity": "light_color", "parameters": ["lights/color gel @ !1"]}],
        },
        {"word": "mine", "slot": "grade", "wishes": [{"quantity": "contrast", "class": "high"}]},
    ]
    assert plan_of(written.from_json({"words": words}).within(ROOM))


class TestAnotherScene:
    """What describes a material or a light that is not there describes all of its region."""

    ELSEWHERE = SceneDescription("cup", {"cup": "subject"}, {"Glaze": "subject"}, {"cup": ("Glaze",)})

    def test_materials_that_are_missing_are_named_in_a_note(self):
        goals = through_json(read("the vase is copper, cool light"), self.ELSEWHERE)
        (copper,) = (a for a in goals.parsed.attributes if a.entry.startswith("copper"))
        assert copper.owners == ()
        assert copper.region == "subject"
        (note,) = goals.parsed.notes
        assert note.startswith("'copper' described Clay, which this scene lacks: it describes the subject instead")

    def test_what_is_there_stays_bound_and_has_no_note(self):
        both = replace(ROOM, materials={"Clay": "subject", "Wood": "surroundings"})
        goals = through_json(read("the vase is copper, the wall is matte"), both)
        assert {a.word: a.owners for a in goals.parsed.attributes} == {"copper": ("Clay",), "matte": ()}
        assert len(goals.parsed.notes) == 1

    def test_lights_that_are_missing_are_named_in_a_note(self):
        raw = written.as_json(read("cool light"))
        raw["words"][0]["target"]["lights"] = ["Key", "Desk lamp"]
        goals = written.from_json(raw).within(ROOM)
        assert goals.parsed.attributes[0].lights == ("Key",)
        (note,) = goals.parsed.notes
        assert "Desk lamp" in note
        assert "Key" not in note

    def test_a_wish_is_bound_as_its_word_is(self):
        goals = through_json(read("the vase is copper"), self.ELSEWHERE)
        assert goals.wishes
        assert {id(w.attribute) for w in goals.wishes} <= set(map(id, goals.parsed.attributes))

    def test_the_notes_reach_the_plan(self):
        goals = through_json(read("the wall is matte, glossy vase"), replace(ROOM, materials={"Clay": "subject"}))
        assert any("'matte' described Plaster" in note for note in plan_of(goals).notes)


class TestFiles:
    """Goals are read from a file of their own, from a preset, and from a report."""

    @pytest.fixture
    def raw(self):
        return written.as_json(read("teal vase, golden hour"))

    def of(self, path) -> list[tuple]:
        return [content(w) for w in written.read(path).within(ROOM).wishes]

    def test_a_file_of_goals(self, raw, tmp_path):
        path = tmp_path / "goals.json"
        path.write_text(json.dumps(raw), "utf-8")
        assert self.of(path) == [content(w) for w in written.from_json(raw).within(ROOM).wishes]

    def test_a_preset(self, raw, tmp_path):
        path = tmp_path / "preset.json"
        path.write_text(Preset("Dusk", {"film": [{"contrast": [1.1]}]}, goals=raw).dumps(), "utf-8")
        assert self.of(path) == [content(w) for w in written.from_json(raw).within(ROOM).wishes]

    def test_a_report(self, raw, tmp_path):
        path = tmp_path / "report.json"
        path.write_text(json.dumps({"prompt": "…", "parameters": {}, "goals": raw, "rounds": 3}), "utf-8")
        assert self.of(path) == [content(w) for w in written.from_json(raw).within(ROOM).wishes]
