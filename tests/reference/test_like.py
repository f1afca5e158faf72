# SPDX-License-Identifier: Apache-2.0
"""A reference image, its wishes, and what they claim and let change."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import OpenEXR
import pytest
import torch
from PIL import Image
from tiny_job import write_job

from proxy_renderer.claims.claim import Claim
from proxy_renderer.claims.from_goals import claims_of
from proxy_renderer.color.arrays import srgb_from_linear
from proxy_renderer.goals.resolve import Goals, goals_of
from proxy_renderer.goals.written import as_json, from_json
from proxy_renderer.optimize.scene_facts import described
from proxy_renderer.optimize.shots import picture_size
from proxy_renderer.planning.advice import OfflineAdvisor
from proxy_renderer.reference.like import LikeAdvisor, Reference
from proxy_renderer.render.proxy import Proxy
from proxy_renderer.scene import load_scene
from proxy_renderer.schema.options.table import Options
from proxy_renderer.words.lexicon.vocabulary import default_vocabulary
from proxy_renderer.words.parser import parse
from proxy_renderer.words.types import Parsed


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    return load_scene(write_job(tmp_path_factory.mktemp("job")))


def no_view():
    raise AssertionError("asked for only where the picture shows the same scene")


def claims_of_picture(found: Reference, scene) -> list[Claim]:
    """The claims of a picture alone."""
    goals = Goals(Parsed("")).with_picture(found.wishes(scene.instances.values(), no_view))
    return [c for c in claims_of(goals, default_vocabulary()) if c.word]


def reference(path: Path, scene, **options) -> Reference:
    found = Reference.of(Options(like=str(path), **options), scene)
    assert found is not None
    return found


def test_a_render_in_linear_light_looks_as_the_scene_shows_it(tmp_path, scene):
    proxy = Proxy(scene, picture_size(scene.resolution, 96))
    with torch.no_grad():
        render = proxy.render({})
    with OpenEXR.File({"type": OpenEXR.scanlineimage}, {"RGB": np.ascontiguousarray(render.linear)}) as file:
        file.write(str(tmp_path / "goal.exr"))
    found = reference(tmp_path / "goal.exr", scene)
    found.compare(render.display)
    assert found.same
    plain = torch.from_numpy(srgb_from_linear(found.picture.linear).clip(0, 1))
    by_view, by_curve = (float((d - render.display).abs().mean()) for d in (found.display, plain))
    assert by_view < 0.01
    assert by_curve > 4 * by_view


def cutout(path: Path, around: tuple[int, int, int], alpha: int = 0) -> Path:
    """A gray ramp in the middle; around it a color that is transparent."""
    pixels = np.zeros((90, 120, 4), np.uint8)
    pixels[..., :3], pixels[..., 3] = around, alpha
    pixels[20:70, 30:90, :3] = np.linspace(40, 220, 60, dtype=np.uint8)[None, :, None]
    pixels[20:70, 30:90, 3] = 255
    Image.fromarray(pixels).save(path)
    return path


def test_what_is_transparent_does_not_count(tmp_path, scene):
    said = []
    for number, around in enumerate([(255, 0, 0), (0, 0, 0), (255, 255, 255)]):
        said.append(claims_of_picture(reference(cutout(tmp_path / f"{number}.png", around), scene), scene))
    first = {(c.measure, c.part, c.box): (c.lower, c.upper) for c in said[0]}
    assert "midtone_cast" in {measure for measure, _, _ in first}
    for claims in said[1:]:
        for claim in claims:
            lower, upper = first[claim.measure, claim.part, claim.box]
            assert np.allclose(claim.lower, lower, atol=0.1)
            assert np.allclose(claim.upper, upper, atol=0.1)
    opaque = claims_of_picture(reference(cutout(tmp_path / "opaque.png", (255, 0, 0), 255), scene), scene)
    ends = {(c.measure, c.part, c.box): (c.lower, c.upper) for c in opaque}
    assert ends != first


def test_what_is_transparent_in_linear_light_does_not_count(tmp_path, scene):
    ramp = np.linspace(0.02, 3.0, 60, dtype=np.float32)[None, :, None] * np.array((1.0, 0.8, 0.5, 0.0), np.float32)
    said = []
    for number, around in enumerate([(8.0, 0.0, 8.0, 0.0), (0.0, 0.0, 0.0, 0.0)]):  # light of a flame has no alpha
        pixels = np.full((90, 120, 4), around, np.float32)
        pixels[20:70, 30:90] = ramp + np.array((0, 0, 0, 1), np.float32)
        with OpenEXR.File({"type": OpenEXR.scanlineimage}, {"RGBA": pixels}) as file:
            file.write(str(tmp_path / f"{number}.exr"))
        said.append(claims_of_picture(reference(tmp_path / f"{number}.exr", scene), scene))
    assert "midtone_cast" in {claim.measure for claim in said[0]}
    for one, other in zip(*said, strict=True):
        assert np.allclose((one.lower, one.upper), (other.lower, other.upper), atol=0.1)


def test_of_this_scene_only_what_is_seen_is_compared(tmp_path, scene):
    proxy = Proxy(scene, picture_size(scene.resolution, 96))
    with torch.no_grad():
        display, seen = proxy.render({}).display, proxy.gbuffer({})
    alpha = np.full(display.shape[:2], 255, np.uint8)
    alpha[:, : alpha.shape[1] // 2] = 0
    colors = (255 * display.numpy()).round().astype(np.uint8)
    Image.fromarray(np.concatenate([colors, alpha[..., None]], -1)).save(tmp_path / "half.png")
    found = reference(tmp_path / "half.png", scene, like_same=True)
    wishes = found.wishes(scene.instances.values(), lambda: seen)
    boxes = [claim.box for wish in wishes for claim in wish.claims if claim.box]
    assert boxes
    assert all(box[0] >= 0.5 for box in boxes)


@pytest.fixture(scope="module")
def warm(tmp_path_factory) -> Path:
    ramp = np.linspace(0.1, 1.0, 120)[None, :, None] * np.array([230, 170, 90]) * np.ones((90, 1, 1))
    path = tmp_path_factory.mktemp("pictures") / "warm.png"
    Image.fromarray(ramp.astype(np.uint8)).save(path)
    return path


def test_written_goals_list_statements_of_one_word_once(warm, scene):
    goals = Goals(Parsed("")).with_picture(reference(warm, scene).wishes(scene.instances.values(), no_view))
    said = [word["word"] for word in as_json(goals)["words"]]
    assert len(said) == len(set(said)) > 3


def test_colder_is_measured_against_the_picture(warm, scene):
    wishes = reference(warm, scene).wishes(scene.instances.values(), no_view)
    alone, beside = (
        {c.measure: c for c in claims_of(goals.with_picture(wishes), default_vocabulary()) if c.word}
        for goals in (Goals(Parsed("")), goals_of(parse("colder", described(scene))))
    )
    assert beside["warmth"].upper[0] > 0.0  # of a warm picture: less warm, and not as cold as ice
    for measure in ("shadow_cast", "midtone_cast", "highlight_cast"):
        assert beside[measure].upper[1] == pytest.approx(alone[measure].upper[1] - 10.0)


def test_a_picture_beside_words_has_ranges_of_its_own_and_words_keep_theirs(warm, scene):
    advice = LikeAdvisor(
        reference(warm, scene), OfflineAdvisor(goals_of(parse("strong vignette", described(scene)))), no_view
    ).advise(None, scene.instances, described(scene))
    reasons = {key: entry.reason for key, entry in advice.plan.items() if entry.priority is not None}
    assert "strong vignette" in reasons["film/vignette"]
    assert reasons["film/gain"] == reasons["light/Key/color"] == "free to come to look like warm.png"


def test_what_the_prompt_says_stays_is_left_alone_beside_a_picture(warm, scene):
    words = OfflineAdvisor(goals_of(parse("keep the key light, strong vignette", described(scene))))
    plan = LikeAdvisor(reference(warm, scene), words, no_view).advise(None, scene.instances, described(scene)).plan
    moving = {key for key, entry in plan.items() if entry.priority is not None}
    assert "light/Sun/strength" in moving
    assert not {key for key in moving if key.startswith("light/Key/")}


@pytest.mark.parametrize("same", [False, True])
def test_written_goals_of_a_picture_are_searched_alike_without_it(warm, scene, same):
    """Claims and ranges, in full; what is read is what was searched by."""
    proxy = Proxy(scene, picture_size(scene.resolution, 96))
    found = LikeAdvisor(reference(warm, scene, like_same=same), None, lambda: proxy.gbuffer({}))
    advice = found.advise(proxy.render({}).display, scene.instances, described(scene))
    raw = json.loads(json.dumps(as_json(advice.goals), allow_nan=False))
    again = from_json(raw).within(described(scene))
    assert claims_of(again, default_vocabulary()) == claims_of(advice.goals, default_vocabulary())
    entries = OfflineAdvisor(again).advise(None, scene.instances, described(scene)).plan
    moving = {key: entry for key, entry in entries.items() if entry.priority is not None}
    assert moving == {key: entry for key, entry in advice.plan.items() if entry.priority is not None}
    assert len(moving) > 10
