# SPDX-License-Identifier: Apache-2.0
"""`python -m lab like`: what is drawn, how far values and pictures are from the truth, and the 2D methods beside it."""

import importlib.util
import json
from pathlib import Path

import numpy as np
import pytest
import torch
from PIL import Image

from lab.__main__ import main
from lab.bench.like import experiment, flat, table, trial, values
from lab.bench.like.tasks import FILTERS, PARTS, SETS, tasks
from lab.bench.wild import product
from proxy_renderer.color.tensors import blackbody
from proxy_renderer.schema import VibeError

MADE = {
    "before": {
        "light/Lamp/azimuth": [0.0],
        "light/Lamp/elevation": [0.0],
        "light/Lamp/temperature": [6500.0],
        "light/Lamp/power": [100.0],
        "film/exposure": [0.0],
    },
    "hidden": {
        "light/Lamp/azimuth": [90.0],
        "light/Lamp/elevation": [0.0],
        "light/Lamp/temperature": [3000.0],
        "light/Lamp/power": [200.0],
        "film/exposure": [0.5],
    },
    "roles": {"light/Lamp/azimuth": "key", "light/Lamp/power": "key", "film/exposure": ""},
}


@pytest.mark.parametrize("part", PARTS)
def test_a_seed_draws_the_same_again_and_fewer_are_the_first_of_more(part):
    first = list(tasks(part, 6, "a"))
    assert list(tasks(part, 12, "a"))[:6] == first
    assert [t.truth.set for t in tasks(part, 6, "b")] != [t.truth.set for t in first]
    assert {t.truth.set for t in tasks(part, 200, "a")} <= set(SETS)
    assert len({t.name for t in tasks(part, 12, "a")}) == 12


def test_another_scene_has_the_same_look():
    for task in tasks("transfer", 10, "a"):
        assert task.truth.set != task.shown.set
        assert task.truth.seed == task.shown.seed
        assert task.truth.groups == task.shown.groups


def test_every_filter_once():
    assert [t.photo_filter for t in tasks("filters", 99, "a")] == list(FILTERS)


def test_errors_of_what_stayed_and_of_what_was_found():
    start = values.key_light_errors(MADE, {})
    assert start["direction"] == pytest.approx(90.0)
    assert start["temperature"] == pytest.approx(3500.0, abs=100.0)
    assert start["level"] == pytest.approx(1.5)
    assert values.key_light_errors(MADE, MADE["hidden"]) == {"direction": 0.0, "temperature": 0.0, "level": 0.0}


def test_power_and_exposure_count_together():
    found = {**MADE["hidden"], "light/Lamp/power": [400.0], "film/exposure": [-0.5]}
    assert values.key_light_errors(MADE, found)["level"] == pytest.approx(0.0)


def test_a_lamps_color_is_part_of_its_temperature():
    warm = torch.tensor((1.0, 0.42, 0.13))  # about what 3000 K has in Rec.709, relative to 6500 K
    assert values.seen_temperature(blackbody(torch.tensor(4000.0))) == pytest.approx(4000.0, abs=50.0)
    assert values.seen_temperature(warm * blackbody(torch.tensor(6500.0))) == pytest.approx(3000.0, abs=400.0)


def test_values_are_read_off_a_report():
    rows = {"film/exposure": {"after": -0.5}, "film/gain": {"after": [1.0, 0.9, 0.8]}}
    assert values.found_in({"parameters": rows}) == {"film/exposure": [-0.5], "film/gain": [1.0, 0.9, 0.8]}


def test_a_lamp_alone_is_judged_without_the_pictures_exposure():
    made = MADE | {side: {k: v for k, v in MADE[side].items() if "film" not in k} for side in ("before", "hidden")}
    assert values.key_light_errors(made, {})["level"] == pytest.approx(1.0)
    assert values.key_light_errors(made, made["hidden"])["level"] == 0.0


def test_no_key_light_no_errors():
    assert values.key_light_errors({"before": {}, "hidden": {}, "roles": {}}, {}) == {}


def test_reinhard_gives_mean_and_spread():
    luck = np.random.default_rng(0)
    picture = (0.4 + 0.2 * luck.random((24, 24, 3))).astype(np.float32)
    like = (0.5 + 0.1 * luck.random((24, 24, 3)) * (1.0, 0.7, 0.4)).astype(np.float32)
    made = flat.reinhard(picture, like)
    assert np.allclose(made.mean((0, 1)), like.mean((0, 1)), atol=0.01)
    assert np.allclose(flat.reinhard(picture, picture), picture, atol=1e-3)


def test_2d_methods_that_are_not_installed_are_left_out():
    picture = np.random.default_rng(0).random((16, 16, 3), np.float32)
    made = flat.matched(picture, picture)
    assert ("histograms" in made) == bool(importlib.util.find_spec("skimage"))
    assert "Reinhard" in made


def test_medians_and_failures():
    def row(delta_e, code=0):
        apart = {"before": {"delta_e": 9.0, "mse": 1.0}, "after": {"delta_e": delta_e, "mse": 0.1}}
        done = {
            "differences": apart,
            "errors": {"level": delta_e},
            "errors_before": {"level": 5.0},
            "words_seconds": 10.0,
        }
        row = {"task": f"t{delta_e}", "part": "recovery", "code": code, "error": "it broke", "seconds": 12.0}
        return row | (done if code == 0 else {})

    results = table.summary([row(1.0), row(2.0), row(6.0), row(0.0, code=2)])
    part = results["parts"]["recovery"]
    assert (part["tasks"], part["done"]) == (4, 3)
    assert part["entries"]["after"]["delta_e"]["median"] == 2.0
    assert part["entries"]["after"]["delta_e"]["interval"] == [1.0, 6.0]
    assert part["errors"]["level"]["before"]["median"] == 5.0
    assert results["extra_seconds"]["median"] == 2.0
    assert results["failed"] == {"t0.0": "it broke"}
    table.show(results)
    assert "FAILED" in table.line(row(0.0, code=2))
    assert table.median([])["median"] is None


@pytest.mark.parametrize(
    ("options", "word"), [({"count": 0}, "--tasks 0"), ({"parts": "songs"}, "songs"), ({"parts": ""}, "part")]
)
def test_bad_input(tmp_path, options, word):
    with pytest.raises(VibeError, match=word):
        experiment.run(tmp_path, **options)


def ended(scene, prompt, folder, options, *_):
    """A vibe that finds the picture to a shade, without Blender."""
    RUNS.append(folder.name)
    picture = next(Path(o.removeprefix("--like=")) for o in options if o.startswith("--like="))
    (folder / "out").mkdir(parents=True)
    shade = Image.open(picture).convert("RGB").point(lambda v: min(v + 2, 255))
    shade.save(folder / "out" / "after.png")
    Image.new("RGB", shade.size, (128, 128, 128)).save(folder / "out" / "before.png")
    report = {"parameters": {"light/Lamp/azimuth": {"after": 80.0}}, "timings": {"engine: loop": 1.0}}
    (folder / "out" / "report.json").write_text(json.dumps(report))
    return product.Ended(0, 3.0, 0, "")


def hidden(kind, name, folder, seed, groups, size, samples):
    """A scene and the picture of a hidden look, without Blender."""
    luck = np.random.default_rng(len(seed) + len(name))
    pixels = (255 * luck.random((12, 16, 3))).astype(np.uint8)
    Image.fromarray(pixels).save(folder / "goal.png")
    (folder / "scene.blend").touch()
    return {**MADE, "subject": ["Thing"]}


RUNS: list[str] = []


def test_parts_take_turns_and_a_second_run_does_only_what_is_missing(tmp_path, monkeypatch):
    monkeypatch.setattr(product, "vibe", ended)
    monkeypatch.setattr(trial.blender, "command", hidden)
    RUNS.clear()
    first = experiment.run(tmp_path, 1, "recovery,transfer", size=16, samples=1)
    assert len(RUNS) == 2
    again = experiment.run(tmp_path, 2, "recovery,transfer", size=16, samples=1)
    assert len(RUNS) == 4
    assert [row["part"] for row in again["rows"]] == ["recovery", "transfer"] * 2
    assert again["rows"][:2] == first["rows"]
    kept = json.loads((tmp_path / "results.json").read_text())
    entries = kept["parts"]["recovery"]["entries"]
    assert entries["after"]["delta_e"]["median"] < 2.0 < entries["before"]["delta_e"]["median"]
    assert kept["parts"]["recovery"]["errors"]["direction"]["after"]["median"] == pytest.approx(10.0)
    moved = kept["parts"]["transfer"]["entries"]
    assert moved[trial.TOLD]["delta_e"] != moved["Reinhard"]["delta_e"]
    assert trial.TOLD not in kept["parts"]["recovery"]["entries"]
    assert list(tmp_path.glob("contact*.png"))


def test_the_command_line_reaches_it(tmp_path, monkeypatch):
    monkeypatch.setattr(product, "vibe", ended)
    monkeypatch.setattr(trial.blender, "command", hidden)
    options = ["--tasks", "1", "--parts", "recovery", "--effort", "quick", "--size", "32"]
    assert main(["like", "--out", str(tmp_path), *options]) == 0
    assert json.loads((tmp_path / "results.json").read_text())["effort"] == "quick"


@pytest.mark.slow
def test_a_hidden_look_is_recovered_from_end_to_end(tmp_path):
    results = experiment.run(tmp_path, 1, "recovery", size=64, samples=4, effort="quick")
    assert results["failed"] == {}
    entries = results["parts"]["recovery"]["entries"]
    assert entries["after"]["delta_e"]["median"] < 0.6 * entries["before"]["delta_e"]["median"]
