# SPDX-License-Identifier: GPL-3.0-or-later
"""What `vibe bench paper` measures, on real renders: a glossy ball scores glossier than a matte one, and so on."""

import json

import bpy
import numpy as np
import pytest
from vibe_render.bench.camera_hits import save_camera_hits
from vibe_render.bench.paper import build_set
from vibe_render.bench.scenes import making
from vibe_render.bench.scenes.sets import SETS
from vibe_render.export import reading
from vibe_render.render import final_render
from vibe_render.scene import bindings
from vibe_render.scene.stage import parts
from vibe_render.scene.subject import SubjectChoice

from proxy_renderer.bench import blender
from proxy_renderer.bench.paper import finished, measures
from proxy_renderer.bench.paper.pairs import read_pairs
from proxy_renderer.bench.paper.visible import visibility

SIZE, SAMPLES = 96, 16


class Studio:
    """A ball on a floor before a row of posts; `shoot` renders it with other values, by key."""

    def __init__(self, folder):
        bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True, load_ui=False)
        self.folder, self.scene = folder, bpy.context.scene
        self.scene.render.resolution_x = self.scene.render.resolution_y = SIZE
        ball = making.ball("Ball", 0.9, (0.0, 0.0, 0.9))
        ball.data.materials.append(parts.material("Ball", (0.35, 0.12, 0.1), roughness=0.4))
        stone = parts.material("Stone", (0.3, 0.3, 0.3), roughness=0.9)
        parts.floor(self.scene, 40.0, stone)
        for i in range(6):
            post = making.ball(f"Post {i}", 0.5, (-6.0 + 2.4 * i, 7.0, 0.8), 12)
            post.data.materials.append(stone)
        corners = np.array([(-1.1, 0, 0), (1.1, 0, 2.0)])
        pivot = np.array([0.0, 0.0, 0.9])
        parts.camera(self.scene, corners, (0.0, 12.0), fov=38.0, fill=0.6, pivot=pivot)
        parts.area_light(self.scene, "Key", (-50.0, 40.0), 5.0, 0.6, 0.7, pivot)
        parts.world(self.scene, (0.4, 0.4, 0.4), strength=0.4)
        self.job = reading.export_scene(self.scene, folder / "job", SubjectChoice(("Ball",)))
        self.start = {key: tuple(i.value) for key, i in self.job.instances.items()}

    def shoot(self, clear=False, **values):
        """The picture at these values; names have "__" for the slash."""
        wanted = {key.replace("__", "/"): (v if isinstance(v, tuple) else (v,)) for key, v in values.items()}
        left = bindings.write(
            self.scene, self.start | wanted, self.job.analysis.objects, self.job.analysis.pivot
        )
        assert not [key for key in left if key in wanted], left
        for old in self.folder.glob("*.png"):
            old.unlink()
        final_render.render(self.scene, self.folder / "after.png", SIZE, SAMPLES)
        if clear:
            final_render.render_clear(self.scene, self.folder / "clear.png", SIZE, SAMPLES)
        final_render.render_mask(self.scene, self.folder / "mask.png", SIZE, self.job.analysis.objects)
        save_camera_hits(self.job.analysis, self.folder / "after.npz", SIZE)
        return finished.load(self.folder, "after")


@pytest.fixture(scope="module")
def studio(tmp_path_factory):
    return Studio(tmp_path_factory.mktemp("studio"))


@pytest.fixture(scope="module")
def plain(studio):
    return studio.shoot()


def test_a_glossy_ball_is_glossier_than_a_matte_one(studio, plain):
    matte, glossy = (studio.shoot(material__Ball__roughness=r) for r in (0.95, 0.08))
    low, middle, high = (measures.gloss(s, "subject") for s in (matte, plain, glossy))
    assert low + 1.5 < middle < high - 1.5


def test_fog_is_seen_and_darkness_and_a_flat_grade_are_none(studio):
    thin, thick = (measures.fog(studio.shoot(clear=True, volume__density=d), "picture") for d in (0.03, 0.15))
    dark = measures.fog(studio.shoot(clear=True, film__exposure=-2.0, film__contrast=0.7), "picture")
    assert abs(dark) < 0.02 < 0.04 < thin < thick - 0.1


def test_a_vignette_darkens_the_corners(studio, plain):
    dark = studio.shoot(film__vignette=0.6)
    assert measures.vignette(dark, "picture") > measures.vignette(plain, "picture") + 5.0


def test_light_comes_from_where_the_lamp_is(studio, plain):
    right = studio.shoot(light__Key__azimuth=50.0)
    top = studio.shoot(light__Key__azimuth=0.0, light__Key__elevation=80.0)
    assert measures.light_right(plain, "subject") < -0.25 < 0.25 < measures.light_right(right, "subject")
    assert measures.light_up(top, "subject") > 0.6


def test_a_small_lamp_is_harder_than_a_large_one(studio, plain):
    soft = studio.shoot(light__Key__size=6.0)
    assert measures.hardness(plain, "surroundings") > measures.hardness(soft, "surroundings") + 0.15


def test_tungsten_is_warm_and_shade_is_cool(studio):
    warm, cool = (studio.shoot(light__Key__temperature=k, film__gamma=1.0) for k in (2600.0, 12000.0))
    assert measures.warmth(warm, "surroundings") > measures.warmth(cool, "surroundings") + 10.0


def test_a_black_picture_hides_the_subject_and_a_close_camera_cuts_it(studio, plain):
    good = visibility(plain, plain, silhouette=False)
    black = visibility(studio.shoot(film__exposure=-8.0), plain, silhouette=False)
    near = visibility(studio.shoot(camera__distance=2.4), plain, silhouette=False)
    assert good.whole > 0.8
    assert black.whole < 0.1
    assert near.frame < 0.6 * good.frame


@pytest.mark.slow
def test_runs_follow_one_another_and_a_bad_one_does_not_end_them(tmp_path):
    quick = ["--rounds=1", "--steps=1", "--size=48", "--samples=2", "--no-anchor", "--vlm-model=off"]
    rows = [
        {
            "name": "bad",
            "set": "duck",
            "clear": False,
            "arguments": ["--prompt=glossy", "--encoder=none/x", *quick],
        },
        {"name": "good", "set": "duck", "clear": True, "arguments": ["--prompt=red, foggy", *quick]},
    ]
    work = tmp_path / "runs.json"
    work.write_text(json.dumps([row | {"folder": str(tmp_path / row["name"])} for row in rows]))
    told = {e["name"]: e for e in blender.scenes("*", [f"--work={work}"], "paper") if e["type"] != "names"}
    assert told["bad"]["type"] == "failed"
    assert "none/x" in told["bad"]["message"]
    assert told["good"]["type"] == "scene", told
    before, after = (finished.load(tmp_path / "good", which) for which in ("before", "after"))
    assert after.materials[after.material[30, 20]] == "Duck"
    assert measures.warmth(after, "subject") > measures.warmth(before, "subject") + 10
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
