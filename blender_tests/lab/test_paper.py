# SPDX-License-Identifier: GPL-3.0-or-later
"""What `python -m lab paper` measures, on real renders: a glossy ball scores glossier than a matte one, and so on."""

import json

import bpy
import pytest
from studio import Studio

from lab.bench import blender
from lab.bench.paper import finished, measures
from lab.bench.paper.pairs import read_pairs
from lab.bench.paper.visible import visibility
from lab.blender.paper import build_set
from lab.blender.scenes.sets import SETS


@pytest.fixture(scope="module")
def studio(tmp_path_factory):
    return Studio(tmp_path_factory.mktemp("studio"))


@pytest.fixture(scope="module")
def plain(studio):
    return studio.shoot()


def test_a_glossy_ball_is_glossier_than_a_matte_one(studio, plain):
    matte, glossy = (studio.shoot(material__Ball__roughness=r) for r in (0.95, 0.08))
    low, middle, high = (measures.taken("gloss", s, "subject") for s in (matte, plain, glossy))
    assert low + 1.5 < middle < high - 1.5


def test_fog_is_seen_and_darkness_and_a_flat_grade_are_none(studio):
    thin, thick = (measures.fog(studio.shoot(clear=True, volume__density=d), "picture") for d in (0.03, 0.15))
    dark = measures.fog(studio.shoot(clear=True, film__exposure=-2.0, film__contrast=0.7), "picture")
    assert abs(dark) < 0.02 < 0.04 < thin < thick - 0.1


def test_a_vignette_darkens_the_corners(studio, plain):
    dark = studio.shoot(film__vignette=0.6)
    assert measures.taken("vignette", dark, "picture") > measures.taken("vignette", plain, "picture") + 5.0


def test_light_comes_from_where_the_lamp_is(studio, plain):
    right = studio.shoot(light__Key__azimuth=50.0)
    top = studio.shoot(light__Key__azimuth=0.0, light__Key__elevation=80.0)
    assert (
        measures.taken("light_right", plain, "subject") < -0.25 < 0.25 < measures.taken("light_right", right, "subject")
    )
    assert measures.taken("light_up", top, "subject") > 0.6


def test_a_small_lamp_is_harder_than_a_large_one(studio, plain):
    soft = studio.shoot(light__Key__size=6.0)
    assert measures.taken("hardness", plain, "surroundings") > measures.taken("hardness", soft, "surroundings") + 0.15


def test_tungsten_is_warm_and_shade_is_cool(studio):
    warm, cool = (studio.shoot(light__Key__temperature=k, film__gamma=1.0) for k in (2600.0, 12000.0))
    assert measures.taken("warmth", warm, "surroundings") > measures.taken("warmth", cool, "surroundings") + 10.0


def test_a_black_picture_hides_the_subject_and_a_close_camera_cuts_it(studio, plain):
    good = visibility(plain, plain, silhouette=False)
    black = visibility(studio.shoot(film__exposure=-8.0), plain, silhouette=False)
    near = visibility(studio.shoot(camera__distance=2.4), plain, silhouette=False)
    assert good.whole > 0.8
    assert black.whole < 0.1
    assert near.frame < 0.6 * good.frame


@pytest.mark.slow
def test_runs_follow_one_another_and_a_bad_one_does_not_end_them(tmp_path):
    quick = ["--rounds=1", "--steps=1", "--size=48", "--samples=2", "--no-anchor", "--vlm-model=off", "--figures"]
    rows = [
        {"name": "bad", "set": "duck", "clear": False, "arguments": ["--prompt=glossy", "--encoder=none/x", *quick]},
        {"name": "good", "set": "duck", "clear": True, "arguments": ["--prompt=red, foggy", *quick]},
    ]
    work = tmp_path / "runs.json"
    work.write_text(json.dumps([row | {"folder": str(tmp_path / row["name"]), "environment": {}} for row in rows]))
    told = {e["name"]: e for e in blender.scenes("*", [f"--work={work}"], "paper") if e["type"] != "names"}
    assert told["bad"]["type"] == "failed"
    assert "none/x" in told["bad"]["message"]
    assert told["good"]["type"] == "scene", told
    before, after = (finished.load(tmp_path / "good", which) for which in ("before", "after"))
    assert after.materials[after.material[30, 20]] == "Duck"
    assert measures.taken("warmth", after, "subject") > measures.taken("warmth", before, "subject") + 10
    assert after.clear is not None
    assert before.clear is None


def test_every_set_can_be_built_and_has_what_its_prompts_name():
    for pair in read_pairs():
        if pair.set:
            names = SETS[pair.set].materials
            assert len(names) == len(SETS[pair.set].recipe.finishes)
            regions = {ask.region for ask in pair.asks}
            assert regions <= {"subject", "surroundings", "picture", *names}, pair.name
    assert build_set("table") == ["Cup", "Table", "Cup Handle", "Table Leg"]
    assert {"Cup", "Table", "Backdrop"} <= {m.name for m in bpy.data.materials}
