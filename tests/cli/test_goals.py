# SPDX-License-Identifier: Apache-2.0
"""Goals on the command line: `vibe explain --goals` writes them, `vibe run --goals` checks them before Blender starts."""

import json

import pytest
from command_line import assert_refused, vibe

from proxy_renderer.goals import written
from proxy_renderer.goals.resolve import goals_of
from proxy_renderer.words.parser import parse
from proxy_renderer.words.types import SceneDescription

MESH = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 1 3 4\nf 2 3 4\n"
PROMPT = "glossy teal vase, golden hour, cosy, no fog"


@pytest.fixture
def mesh(tmp_path):
    path = tmp_path / "thing.obj"
    path.write_text(MESH)
    return path


def run(mesh, *more):
    return vibe("run", mesh, "--out", mesh.parent / "out", *more, cwd=mesh.parent)


def test_what_explain_writes_can_be_read(tmp_path):
    done = vibe("explain", PROMPT, "--goals", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    path = tmp_path / "goals.json"
    path.write_text(done.stdout, "utf-8")
    scene = SceneDescription(materials={"Subject": "subject", "Surroundings": "surroundings"})
    goals, expected = written.read(path).within(scene), goals_of(parse(PROMPT, scene))
    assert goals.parsed.prompt == PROMPT
    assert goals.classes == expected.classes
    assert [(w.word, w.quantity, w.effects, w.claims) for w in goals.wishes] == [
        (w.word, w.quantity, w.effects, w.claims) for w in expected.wishes
    ]


def test_a_prompt_that_names_no_look_has_no_goals(tmp_path):
    assert_refused(vibe("explain", "xqzt wrrgl", "--goals", cwd=tmp_path), "names a look")


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (
            '{"words": [{"word": "x", "slot": "grade", "wishes": [{"quantity": "shine"}]}]}',
            ["words[0].wishes[0].quantity"],
        ),
        ('{"words": []}', ["goals.words has 0 words", "1 to 500"]),
        ("not JSON", ["no JSON"]),
        ("", ["is empty"]),
    ],
)
def test_bad_goals_are_one_line_and_leave_nothing(mesh, content, words):
    path = mesh.parent / "goals.json"
    path.write_text(content)
    assert_refused(run(mesh, "--goals", path), *words)
    assert not (mesh.parent / "out").exists()


def test_goals_that_are_missing_are_one_line(mesh):
    assert_refused(run(mesh, "--goals", "nowhere.json"), "no list of goals nowhere.json", "Check the path")
    assert not (mesh.parent / "out").exists()


def test_a_prompt_and_goals_are_too_much(mesh):
    path = mesh.parent / "goals.json"
    path.write_text(json.dumps(written.as_json(goals_of(parse(PROMPT, SceneDescription())))))
    assert_refused(run(mesh, "--goals", path, "--prompt", PROMPT), "a prompt and goals", "--prompt and --goals")
    assert not (mesh.parent / "out").exists()
