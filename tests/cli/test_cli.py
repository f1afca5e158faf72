# SPDX-License-Identifier: Apache-2.0
"""Bad input to the real command: one clear line with the remedy, exit code 2, nothing left behind."""

import time
from pathlib import Path

import pytest
from command_line import assert_refused, vibe

from proxy_renderer.cli.main import parser
from proxy_renderer.inputs import check
from proxy_renderer.schema import BUDGETS, VibeError
from proxy_renderer.schema.options import checks

MESH = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 1 3 4\nf 2 3 4\n"


@pytest.fixture
def mesh(tmp_path):
    path = tmp_path / "thing.obj"
    path.write_text(MESH)
    return path


def run(mesh, *more, prompt="glossy teal", out="out"):
    return vibe("run", mesh, "--prompt", prompt, "--out", mesh.parent / out, *more, cwd=mesh.parent)


@pytest.mark.parametrize(
    ("scene", "words"),
    [
        ("missing.blend", ["no scene", "Check the path"]),
        (".", ["is a folder"]),
        ("notes.txt", [".blend", ".obj"]),
        ("empty.obj", ["is empty"]),
    ],
)
def test_scenes_that_cannot_be_one(tmp_path, scene, words):
    (tmp_path / "notes.txt").write_text("hello")
    (tmp_path / "empty.obj").touch()
    done = vibe("run", scene, "--prompt", "teal", "--out", "out", cwd=tmp_path)
    assert_refused(done, *words)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("prompt", "word"),
    [("", "empty"), (" \n\t", "empty"), ("teal " * 2000, "10000 characters"), ("xqzt wrrgl", "xqzt")],
)
def test_prompts_that_cannot_be_one(mesh, prompt, word):
    assert_refused(run(mesh, prompt=prompt), word)


@pytest.mark.parametrize(
    ("more", "words"),
    [
        (["--rounds", "0"], ["--rounds 0", "1 to"]),
        (["--steps", "-3"], ["--steps -3"]),
        (["--size", "7"], ["--size 7", "32"]),
        (["--samples", "many"], ["invalid int value", "--help"]),
        (["--speed", "fast"], ["--speed", "--help"]),
        (["--groups", "lights"], ["'lights'", "camera, light"]),
        (["--groups", ","], ["--groups"]),
        (["--lock", "lamp/Key"], ["'lamp/Key'", "light/Key"]),
        (["--frames", "1,end"], ["'end' names no frames", "1,50,100"]),
        (["--cameras", "Wide,Close"], ["Only .blends can share a look"]),
        (["--grade-each"], ["--grade-each is for several shots", "--cameras"]),
        (["--moments=1: noon; 9: night"], ["Moments belong to one .blend"]),
        (["--device", "gpu"], ["'gpu'", "cuda"]),
        (["--stage", "moon"], ["cyclorama"]),
        (["--vlm-model", "eyes", "--vlm-url", "localhost:11434"], ["'localhost:11434'", "http://"]),
    ],
)
def test_options_that_mean_nothing(mesh, more, words):
    assert_refused(run(mesh, *more), *words)
    assert not (mesh.parent / "out").exists()


def test_a_budget_decides_what_no_option_does():
    parsed = parser().parse_args(["run", "a.blend", "--prompt", "p", "--out", "o", "--steps", "7", "--effort", "quick"])
    checks.numbers(parsed)
    quick = BUDGETS["quick"]
    assert (parsed.rounds, parsed.steps, parsed.size) == (quick.rounds, 7, quick.size)


def test_an_output_folder_that_cannot_be_made(mesh):
    (mesh.parent / "taken").write_text("a file")
    assert_refused(run(mesh, out="taken/out"), "cannot be written", "--out")
    assert_refused(run(mesh, out="taken"), "cannot be written")


def test_a_stage_for_a_blend(tmp_path):
    (tmp_path / "a.blend").write_bytes(b"BLENDER-v502")
    assert_refused(
        vibe("run", "a.blend", "--prompt", "teal", "--out", "o", "--stage", "floor", cwd=tmp_path), "--stage"
    )


@pytest.mark.parametrize(
    ("more", "words"),
    [
        (["--moments=1: noon; 9: night", "--prompt=teal"], ["--moments gives the look", "Leave out --prompt"]),
        (["--markers", "--frames=5"], ["--markers gives the look", "Leave out --frames"]),
        (["--moments=1: noon; 9: night", "--markers"], ["Leave out --markers"]),
        (["--moments=1: noon; 9: xqzt"], ["'xqzt'"]),
        (["--moments=1: noon"], ["There is only one moment"]),
    ],
)
def test_moments_that_cannot_be_some(tmp_path, more, words):
    (tmp_path / "a.blend").write_bytes(b"BLENDER-v502")
    assert_refused(vibe("run", "a.blend", "--out", "o", *more, cwd=tmp_path), *words)
    assert not (tmp_path / "o").exists()


def test_presets_are_files_or_names(tmp_path, monkeypatch):
    """Which names there are, the Blender side knows."""
    monkeypatch.chdir(tmp_path)
    assert check.preset("golden hour") == "golden hour"
    Path("golden hour").write_text("{}")
    assert check.preset("golden hour") == str(tmp_path / "golden hour")
    for name in ("", "-x", "looks/noir", "noir.json"):
        with pytest.raises(VibeError):
            check.preset(name)


def test_other_commands_refuse_too(tmp_path, mesh):
    assert_refused(vibe("apply", "nope.json", mesh, "--out", "o", cwd=tmp_path), "no preset nope.json")
    assert_refused(vibe("revert", mesh, cwd=tmp_path), "not a .blend")
    assert_refused(vibe("dance", cwd=tmp_path), "'dance'")
    assert_refused(vibe(cwd=tmp_path), "COMMAND")


def test_the_command_starts_at_once(tmp_path):
    start = time.monotonic()
    done = vibe("--help", cwd=tmp_path)
    assert done.returncode == 0
    assert "doctor" in done.stdout
    assert time.monotonic() - start < 2.0  # measured 0.07 s; a heavy import would take far longer
