# SPDX-License-Identifier: Apache-2.0
"""Manifests: what they mean, and that a mistake in one is found, with its place, before anything starts."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from proxy_renderer.batch.command import guess
from proxy_renderer.batch.manifest import load
from proxy_renderer.schema import VibeError

ROOT = Path(__file__).parents[2]
GOOD = """
scenes = ["shots/*.blend", "cup.obj"]
prompts = [
    "noir",
    "misty, cool blue fog",
]
seeds = [0, 7]

[options]
size = 256

[scene."shots/b*"]
prompts = ["golden hour"]
lock = "material/*"
"""


@pytest.fixture
def place(tmp_path):
    """A folder with scenes; they are never opened."""
    (tmp_path / "shots").mkdir()
    for name in ("shots/a.blend", "shots/b.blend", "cup.obj"):
        (tmp_path / name).write_text(name)
    return tmp_path


def read(place, text):
    (place / "m.toml").write_text(text)
    return list(load(place / "m.toml", place / "out")[0])


def test_scenes_times_prompts_times_seeds(place):
    jobs = read(place, GOOD)
    assert [(j.scene, j.prompt, j.seed) for j in jobs[:4]] == [
        ("shots/a.blend", "noir", 0),
        ("shots/a.blend", "noir", 7),
        ("shots/a.blend", "misty, cool blue fog", 0),
        ("shots/a.blend", "misty, cool blue fog", 7),
    ]
    assert [(j.scene, j.prompt) for j in jobs[4:6]] == [("shots/b.blend", "golden hour")] * 2
    assert len(jobs) == 4 + 2 + 4
    assert "--size=256" in jobs[0].arguments
    assert "--seed=7" in jobs[1].arguments
    assert "--lock=material/*" in jobs[4].arguments
    assert not any(a.startswith("--lock") for a in jobs[0].arguments)
    assert len({j.name for j in jobs}) == len(jobs)


def names(place, text=GOOD):
    return [job.name for job in read(place, text)]


def test_a_name_depends_on_what_the_result_depends_on_and_on_nothing_else(place):
    before = names(place)
    assert names(place, GOOD + "\n[limits]\nminutes = 5\n") == before
    assert all(a != b for a, b in zip(before, names(place, GOOD.replace("256", "128")), strict=True))
    shutil.copytree(place, place / "moved")
    assert names(place / "moved") == before
    (place / "shots" / "b.blend").write_text("other content")
    changed = names(place)
    assert [a == b for a, b in zip(before, changed, strict=True)] == [True] * 4 + [False] * 2 + [True] * 4


def test_linked_files_count_if_they_are_named(place):
    (place / "wood.png").write_text("oak")
    text = 'files = ["*.png"]' + GOOD
    before = names(place, text)
    assert names(place, text) == before
    (place / "wood.png").write_text("walnut")
    assert not set(names(place, text)) & set(before)


def test_prompts_of_a_file(place):
    (place / "looks.txt").write_text("# ours\nnoir\n\n  golden hour\nnoir\n")
    jobs = read(place, 'scenes = ["cup.obj"]\nprompts = "looks.txt"\n')
    assert [j.prompt for j in jobs] == ["noir", "golden hour"]


def test_results_are_no_scenes(place):
    left = place / "out" / "jobs" / "x"
    left.mkdir(parents=True)
    (left / "vibed.blend").write_text("x")
    jobs = read(place, 'scenes = ["**/*.blend"]\nprompts = ["noir"]\n')
    assert [j.scene for j in jobs] == ["shots/a.blend", "shots/b.blend"]


TOGETHER = """
prompts = ["noir"]
[[shots]]
name = "cup"
scenes = ["shots/a.blend"]
cameras = "Wide"
[[shots]]
name = "hall"
scenes = ["shots/*.blend"]
frames = [1, 50]
grade_each = true
size = 128
"""


def test_shots_that_share_a_look_are_one_job(place):
    cup, hall = read(place, TOGETHER)
    assert (cup.scene, cup.source.name, cup.more) == ("cup", "a.blend", ())
    assert "--cameras=Wide" in cup.arguments
    assert (hall.source.name, [p.name for p in hall.more]) == ("a.blend", ["b.blend"])
    assert {"--frames=1,50", "--grade-each", "--size=128"} <= set(hall.arguments)
    (place / "shots" / "b.blend").write_text("other content")
    again = read(place, TOGETHER)
    assert again[0].name == cup.name
    assert again[1].name != hall.name


def test_what_to_take_over_needs_a_picture(place):
    with pytest.raises(VibeError, match="there is none"):
        read(place, GOOD.replace("size = 256", 'like-only = "light"'))


LIKE = """
scenes = ["shots/*.blend"]

[options]
like = "stills/dusk.jpg"
like-only = ["light", "air"]
"""


def test_a_picture_beside_the_manifest_is_enough_and_counts_by_its_content(place, tmp_path):
    (place / "stills").mkdir()
    (place / "stills" / "dusk.jpg").write_text("one")
    jobs = read(place, LIKE)
    assert [j.prompt for j in jobs] == ["", ""]
    assert f"--like={(place / 'stills' / 'dusk.jpg').resolve()}" in jobs[0].arguments
    assert "--like-only=air" in jobs[0].arguments
    names = [j.name for j in jobs]
    moved = tmp_path / "elsewhere"
    shutil.copytree(place, moved, ignore=shutil.ignore_patterns("elsewhere"))
    assert [j.name for j in read(moved, LIKE)] == names
    (place / "stills" / "dusk.jpg").write_text("two")
    assert not {j.name for j in read(place, LIKE)} & set(names)
    with_words = read(place, 'prompts = ["but colder"]' + LIKE)
    assert [j.prompt for j in with_words] == ["but colder"] * 2


GOALS = """
scenes = ["shots/*.blend"]

[options]
goals = "goals/dusk.json"
"""
WORDS = '{"words": [{"word": "x", "slot": "grade", "wishes": [{"quantity": "contrast", "class": "high"}]}]}'


def test_goals_beside_the_manifest_take_the_place_of_a_prompt(place):
    (place / "goals").mkdir()
    (place / "goals" / "dusk.json").write_text(WORDS)
    jobs = read(place, GOALS)
    assert [j.prompt for j in jobs] == ["", ""]
    assert f"--goals={(place / 'goals' / 'dusk.json').resolve()}" in jobs[0].arguments
    with pytest.raises(VibeError, match="a prompt and goals"):
        read(place, 'prompts = ["noir"]' + GOALS)


def test_the_name_of_a_job_depends_on_its_goals(place, tmp_path):
    (place / "goals").mkdir()
    (place / "goals" / "dusk.json").write_text(WORDS)
    names = [j.name for j in read(place, GOALS)]
    moved = tmp_path / "elsewhere"
    shutil.copytree(place, moved, ignore=shutil.ignore_patterns("elsewhere"))
    assert [j.name for j in read(moved, GOALS)] == names
    (place / "goals" / "dusk.json").write_text(WORDS.replace("high", "low"))
    assert not {j.name for j in read(place, GOALS)} & set(names)


@pytest.mark.parametrize(
    ("old", "new", "at", "words"),
    [
        ('name = "hall"', "", " > shots > 2", ["a name of their own"]),
        ('name = "hall"', 'name = "cup"', " > shots > 2", ["a name of their own"]),
        ("[1, 50]", '["x"]', " > shots > 2 > frames", ["'x' names no frames"]),
        ("[1, 50]", "1.5", " > shots > 2 > frames", ["frames = [1, 50, 100]"]),
        ("size = 128", "sice = 128", " > shots > 2 > sice", ["'sice'", "cameras"]),
        ("size = 128", 'groups = "camera"', " > shots > 2", ["keep their cameras"]),
        ("shots/*.blend", "cup.obj", " > shots > 2", ["Only .blends"]),
        ("shots/*.blend", "hall/*.blend", " > shots > 2 > scenes > hall/*.blend", ["'hall/*.blend'"]),
    ],
)
def test_mistakes_in_shots_are_found_with_their_place(place, old, new, at, words):
    assert old in TOGETHER
    with pytest.raises(VibeError) as caught:
        read(place, TOGETHER.replace(old, new))
    assert f"m.toml{at}: " in caught.value.message, caught.value.message
    assert all(word in str(caught.value) for word in words), str(caught.value)


@pytest.mark.parametrize(
    ("old", "new", "at", "words"),
    [
        ("seeds = [0, 7]", "seeds = [0, 7", " is not TOML", ["line 9"]),
        ("seeds", "sedes", " > sedes", ["'sedes'", "scenes, prompts, seeds"]),
        ("[0, 7]", "[0, -7]", " > seeds", ["seeds = [0, 1]"]),
        ("cup.obj", "mug.obj", " > scenes > mug.obj", ["'mug.obj'"]),
        ("shots/*.blend", "shot/*.blend", " > scenes > shot/*.blend", ["'shot/*.blend'"]),
        ("misty, cool blue fog", "qwrtz xkcd", " > prompts > qwrtz xkcd", ["Nothing in the prompt", "teal"]),
        ("misty, cool blue fog", " ", " > prompts >  ", ["The prompt is empty"]),
        ("size = 256", "sice = 256", " > options > sice", ["'sice'", "size"]),
        ("size = 256", 'size = "256"', " > options > size", ["size cannot be '256'", "size = 512"]),
        ("size = 256", "size = 7", " > options > size", ["out of range", "32 to 8192"]),
        ("size = 256", "seed = 7", " > options > seed", ["'seed'", "at the top"]),
        ("size = 256", 'groups = ["lights"]', " > options > groups", ["'lights'", "material"]),
        ("size = 256", 'vocabulary = "mine.toml"', " > options > vocabulary", ["mine.toml", "Check the path"]),
        ("size = 256", 'like = "still.jpg"', " > options > like", ["no picture", "still.jpg", "Check the path"]),
        (
            "size = 256",
            'goals = "dusk.json"',
            " > options > goals",
            ["no list of goals", "dusk.json", "Check the path"],
        ),
        ("size = 256", 'goals = "cup.obj"', " > options > goals", ["no JSON", "vibe explain"]),
        ("size = 256", "goals = 3", " > options > goals", ["goals cannot be 3"]),
        ("size = 256", "like = 3", " > options > like", ["like cannot be 3"]),
        ("size = 256", 'like-only = "mood"', " > options > like-only", ["'mood'", "light, grade"]),
        ("shots/b*", "shots/c*", " > scene > shots/c*", ["'shots/c*'", "shots/a.blend"]),
        ('lock = "material/*"', 'lock = "stuff/*"', " > scene > shots/b* > lock", ["'stuff/*'"]),
        ('lock = "material/*"', "lock = 3", " > scene > shots/b* > lock", ["lock cannot be 3"]),
        ('lock = "material/*"', 'vocabulary = "x"', " > scene > shots/b*", ["[options]"]),
        ("[options]", "[limits]\nminutes = 0\n[options]", " > limits > minutes", ["minutes cannot be 0"]),
        ("[options]", "[limits]\nhours = 1\n[options]", " > limits > hours", ["'hours'", "minutes"]),
        ("[options]", "[limits]\ncores = 1.5\n[options]", " > limits > cores", ["whole number"]),
    ],
)
def test_mistakes_are_found_with_their_place(place, old, new, at, words):
    assert old in GOOD
    with pytest.raises(VibeError) as caught:
        read(place, GOOD.replace(old, new))
    error = caught.value
    assert f"m.toml{at}: " in error.message
    assert error.remedy
    assert all(word in str(error) for word in words), str(error)


def batch(place, *arguments):
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT), str(ROOT / "addon")])}
    command = [sys.executable, "-m", "proxy_renderer.cli", "batch", "m.toml", *arguments]
    return subprocess.run(command, cwd=place, env=environment, capture_output=True, text=True, timeout=120)


def test_the_command_says_it_in_one_line_and_leaves_nothing(place):
    (place / "m.toml").write_text(GOOD.replace("noir", "qwrtz"))
    done = batch(place, "--out", "out")
    assert done.returncode == 2
    assert done.stderr.startswith("vibe: m.toml > prompts > qwrtz: ")
    assert len(done.stderr.splitlines()) == 1
    assert not (place / "out").exists()


def test_a_dry_run_tells_the_plan_and_does_nothing(place):
    (place / "m.toml").write_text(GOOD)
    done = batch(place, "--out", "out", "--dry-run", "--workers", "2")
    assert done.returncode == 0, done.stderr
    assert "10 jobs: 0 done, 10 to do" in done.stdout
    assert "4  shots/a.blend" in done.stdout
    assert "with 2 workers" in done.stdout
    assert not (place / "out").exists()


@pytest.mark.parametrize("scenes", ["", "scenes = []\n"])
def test_a_group_alone_needs_no_scenes_and_its_shots_take_their_time(place, scenes):
    group = '[[shots]]\nname = "g"\nscenes = ["shots/*.blend"]\n'
    times = []
    for cameras in ("", 'cameras = ["Wide", "Close"]\n'):
        (place / "m.toml").write_text(f'{scenes}prompts = ["noir"]\n{group}{cameras}')
        (job,) = load(place / "m.toml", place / "out")[0]
        assert job.scene == "g"
        times.append(guess(job))
    assert times[1] > 1.5 * times[0]
