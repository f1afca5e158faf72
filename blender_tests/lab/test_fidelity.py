# SPDX-License-Identifier: GPL-3.0-or-later
"""`python -m lab fidelity` through the real command: scenes built by Blender, Cycles' references, the proxy."""

import json
import random

import bpy
import pytest
from benches import bench
from PIL import Image
from vibe_render.core import rendered

from lab.blender.move import STEP, move
from lab.blender.scenes.build import WORLDS, build
from lab.blender.scenes.catalog import CATALOG
from lab.blender.scenes.fingerprint import fingerprint
from lab.blender.scenes.recipe import features
from lab.blender.scenes.set_catalog import SET_CATALOG
from lab.blender.scenes.shapes import SHAPES
from proxy_renderer.schema import FAMILIES, Instance

SMALL = "--size=48", "--samples=32"
BY_NAME = {recipe.name: recipe for recipe in CATALOG}


@pytest.mark.slow
def test_the_command_measures_caches_and_survives_a_broken_scene(tmp_path):
    out, cache = tmp_path / "out", tmp_path / "cache"
    first = bench("fidelity", out, cache, *SMALL, "--only=[cg]l[ao][yb]*")
    assert first.returncode == 0, first.stdout + first.stderr
    results = json.loads((out / "results.json").read_text())
    assert sorted(results["scenes"]) == ["clay_head", "globe"]
    for row in results["scenes"].values():
        assert not row["cached"]
        assert 0 < row["delta_e"] < 6  # so small a picture is all edges and noise
        assert row["delta_e"] < row["p95"]
        assert row["ssim"] > 0.5
        assert 0 < row["anchored_still_delta_e"] < row["delta_e"]
        assert 0 < row["anchored_delta_e"] < row["delta_e"] + 1
    assert results["mean_delta_e"] == pytest.approx(
        sum(row["delta_e"] for row in results["scenes"].values()) / 2, abs=1e-3
    )
    assert results["features"]["image texture"]["delta_e"] == results["scenes"]["globe"]["delta_e"]
    with Image.open(out / "contact.png") as sheet:
        assert sheet.width > 3 * 256

    # One reference cannot be written: that scene fails, the other one comes from the cache.
    broken = cache / results["scenes"]["clay_head"]["reference"]
    broken.unlink()
    broken.mkdir()
    second = bench("fidelity", out, cache, *SMALL, "--only=[cg]l[ao][yb]*")
    assert second.returncode == 1, second.stdout + second.stderr
    assert "clay_head: FAILED" in second.stdout
    again = json.loads((out / "results.json").read_text())
    assert list(again["failed"]) == ["clay_head"]
    assert again["scenes"]["globe"]["cached"]
    assert again["scenes"]["globe"]["delta_e"] == results["scenes"]["globe"]["delta_e"]


def test_a_name_that_no_scene_has(tmp_path):
    done = bench("fidelity", tmp_path, tmp_path / "cache", "--only=unicorn")
    assert done.returncode == 2
    assert "unicorn" in done.stderr
    assert "clay_head" in done.stderr


def test_the_set_covers_what_the_issue_names():
    assert len(CATALOG) == len(BY_NAME) >= 40
    covered = {f for recipe in CATALOG for f in features(recipe, SHAPES[recipe.shape][1])}
    wanted = """open,closed,thin,many objects,200k triangles,floor,no floor,dielectric,metal,coat,sheen,emission,glass,
        roughness 0,roughness 0.1,roughness 0.25,roughness 0.5,roughness 0.8,roughness 1,point light,sun light,
        spot light,area light,1 light,2 lights,3 lights,4 lights,constant world,HDRI world,no fog,thin fog,medium fog,
        thick fog,low fog,image texture,procedural texture,AgX,Filmic,Standard,Khronos PBR Neutral,grade,
        transparent film,alpha"""
    assert {" ".join(name.split()) for name in wanted.split(",")} <= covered
    assert {recipe.world.picture for recipe in CATALOG} - {""} == set(WORLDS)


@pytest.mark.parametrize("recipe", SET_CATALOG, ids=lambda recipe: recipe.name)
def test_sets_are_of_several_things_that_the_camera_sees(recipe):
    scene, subject = build(recipe, 0)
    to_clip = rendered.frustum(scene)
    seen = [o for o in subject if rendered.in_frame(to_clip, o, o.matrix_world)]
    assert len(seen) >= 2
    assert len({o.data.materials[0].name for o in seen}) >= 2


@pytest.mark.parametrize(("name", "lamps"), [("set_lounge", ["Window"]), ("set_bedroom", ["Shade"])])
def test_in_a_room_only_its_lamp_glows(name, lamps):
    recipe = next(each for each in SET_CATALOG if each.name == name)
    _, subject = build(recipe, 0)
    names = {"Stuff 0"}
    assert [o.name for o in subject if o.data.materials[0].name in names] == lamps


@pytest.mark.parametrize("name", ["knot", "rock"])
def test_large_meshes_are_large(name):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    (thing,) = SHAPES[name][0](random.Random(0))
    thing.data.calc_loop_triangles()
    assert 180_000 < len(thing.data.loop_triangles) < 220_000


@pytest.mark.slow
def test_a_fingerprint_is_of_the_content():
    recipe = BY_NAME["globe"]
    first = fingerprint(build(recipe, 0)[0])
    scene, _ = build(recipe, 0)
    assert fingerprint(scene) == first
    assert fingerprint(build(recipe, 1)[0]) != first
    scene, _ = build(recipe, 0)
    light = next(o for o in scene.objects if o.type == "LIGHT")
    light.location.x += 0.01
    assert fingerprint(scene) != first


def test_a_move_is_small_and_moves_nothing_in_space():
    instances = [
        Instance(FAMILIES["material/roughness"], "A", (0.5,)),
        Instance(FAMILIES["material/base_color"], "A", (0.2, 0.9, 0.0)),
        Instance(FAMILIES["light/power"], "Key", (100.0,), 16.0),
        Instance(FAMILIES["light/azimuth"], "Key", (10.0,)),
        Instance(FAMILIES["camera/azimuth"], "", (10.0,)),
        Instance(FAMILIES["volume/density"], "", (0.0,), 0.2),
    ]
    given = {i.key: i for i in instances}
    moved = move(given, random.Random(1))
    assert set(moved) == {"material/A/roughness", "material/A/base_color", "light/Key/power"}
    for key, values in moved.items():
        i = given[key]
        for value, before, low, high in zip(values, i.value, i.lower, i.upper, strict=True):
            unit = i.parameter.scale.to_unit
            assert abs(unit(value, low, high) - unit(before, low, high)) <= STEP + 1e-6
        assert values != i.value
    assert moved == move(given, random.Random(1))
