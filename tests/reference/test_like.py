# SPDX-License-Identifier: Apache-2.0
"""A reference image, and its claims next to those of words."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import OpenEXR
import pytest
import torch
from PIL import Image
from tiny_job import write_job

from proxy_renderer.claims.claim import Claim
from proxy_renderer.color.arrays import srgb_from_linear
from proxy_renderer.optimize.shots import picture_size
from proxy_renderer.reference.like import Reference, merged_claims
from proxy_renderer.render.proxy import Proxy
from proxy_renderer.scene import load_scene
from proxy_renderer.schema.options.table import Options

CAST = Claim("a.jpg: orange midtones", "picture", "midtone_cast", "picture", (8.0, 18.0), (12.0, 22.0))
SHADOWS = Claim("a.jpg: red shadows", "picture", "shadow_cast", "picture", (3.0, 0.0), (5.0, 2.0))
MEDIAN = Claim("a.jpg: tones", "picture", "median", "picture", (40.0,), (46.0,))
BLACK = Claim("a.jpg: tones", "picture", "black_point", "picture", (3.0,), (7.0,))


def word(measure, lower=-math.inf, upper=math.inf, part="picture", **more):
    return Claim("word", part, measure, part, (lower,), (upper,), **more)


def nothing(claim):
    return None


def having(value):
    return lambda claim: value


def warmth(claim):
    return claim.lower[1] + 0.5 * claim.lower[0]


def test_of_one_measure_and_part_the_words_claim_stays_alone():
    claims = merged_claims([word("median", upper=20.0)], [MEDIAN, CAST], nothing)
    assert [c.measure for c in claims] == ["median", "midtone_cast"]
    assert claims[0].upper == (20.0,)


def test_cold_moves_all_casts_along_until_it_holds_and_keeps_their_pattern():
    said, midtones, shadows = merged_claims([word("warmth", -30.0, -6.0)], [CAST, SHADOWS], having(20.0))
    assert warmth(midtones) == pytest.approx(warmth(CAST) - 26.0)
    assert warmth(shadows) == pytest.approx(warmth(SHADOWS) - 26.0)
    assert midtones.upper[0] - midtones.lower[0] == pytest.approx(4.0)
    assert midtones.lower[0] < CAST.lower[0]  # less orange, not pink
    assert (said.lower, said.upper) == ((-30.0,), (-6.0,))


def test_a_word_that_holds_in_the_picture_leaves_it():
    assert merged_claims([word("warmth", 9.0, 32.0)], [CAST], having(20.0))[1] == CAST


@pytest.mark.parametrize("own", [20.0, -20.0])
def test_colder_is_colder_than_the_picture_whatever_that_is(own):
    colder = word("warmth", -30.0, -6.0, change=-5.0, compares=True)
    said, cast = merged_claims([colder], [CAST], having(own))
    assert warmth(cast) == pytest.approx(warmth(CAST) - 12.5)
    assert own - 12.5 < said.upper[0] < own - 5.0
    assert said.change is None


def test_brighter_lifts_the_middle_more_than_black():
    brighter = word("lightness", lower=62.0, change=10.0, compares=True)
    said, median, black = merged_claims([brighter], [MEDIAN, BLACK], having(43.0))
    assert median.lower[0] == pytest.approx(65.0)
    assert black.lower[0] < 10.0
    assert 53.0 < said.lower[0] < 68.0


def test_a_word_about_the_subject_leaves_the_picture_as_it_is():
    assert merged_claims([word("lightness", lower=70.0, part="subject")], [MEDIAN], having(43.0))[1] == MEDIAN


def test_what_a_flat_picture_does_not_have_stays_as_in_words():
    rising = word("lightness", lower=70.0, change=10.0, compares=True)
    assert merged_claims([rising], [MEDIAN], nothing) == (rising, MEDIAN)


def test_what_holds_of_every_picture_takes_nothing_away():
    every = Claim("", "subject", "median", "picture", (0.0,), (1.0,))
    assert merged_claims([every], [MEDIAN], having(43.0))[1] == MEDIAN


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    return load_scene(write_job(tmp_path_factory.mktemp("job")))


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
        said.append(reference(cutout(tmp_path / f"{number}.png", around), scene).of_any_scene(()))
    first = {(c.measure, c.part, c.box): (c.lower, c.upper) for c in said[0]}
    assert "midtone_cast" in {measure for measure, _, _ in first}
    for claims in said[1:]:
        for claim in claims:
            lower, upper = first[claim.measure, claim.part, claim.box]
            assert np.allclose(claim.lower, lower, atol=0.1)
            assert np.allclose(claim.upper, upper, atol=0.1)
    opaque = reference(cutout(tmp_path / "opaque.png", (255, 0, 0), 255), scene).of_any_scene(())
    ends = {(c.measure, c.part, c.box): (c.lower, c.upper) for c in opaque}
    assert ends != first


def test_what_is_transparent_in_linear_light_does_not_count(tmp_path, scene):
    ramp = np.linspace(0.02, 3.0, 60, dtype=np.float32)[None, :, None] * np.array(
        (1.0, 0.8, 0.5, 0.0), np.float32
    )
    said = []
    for number, around in enumerate(
        [(8.0, 0.0, 8.0, 0.0), (0.0, 0.0, 0.0, 0.0)]
    ):  # light of a flame has no alpha
        pixels = np.full((90, 120, 4), around, np.float32)
        pixels[20:70, 30:90] = ramp + np.array((0, 0, 0, 1), np.float32)
        with OpenEXR.File({"type": OpenEXR.scanlineimage}, {"RGBA": pixels}) as file:
            file.write(str(tmp_path / f"{number}.exr"))
        said.append(reference(tmp_path / f"{number}.exr", scene).of_any_scene(()))
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
    claims = reference(tmp_path / "half.png", scene, like_same=True).claims((), seen)
    boxes = [claim.box for claim in claims if claim.box]
    assert boxes
    assert all(box[0] >= 0.5 for box in boxes)


def test_colder_is_measured_against_the_picture(tmp_path, scene):
    ramp = np.linspace(0.1, 1.0, 120)[None, :, None] * np.array([230, 170, 90]) * np.ones((90, 1, 1))
    Image.fromarray(ramp.astype(np.uint8)).save(tmp_path / "warm.png")
    found = reference(tmp_path / "warm.png", scene)
    colder = Claim("colder", "picture", "warmth", "picture", (-30.0,), (-6.0,), change=-5.0, compares=True)
    alone = {c.measure: c for c in found.of_any_scene(())}
    beside = {c.measure: c for c in found.of_any_scene((colder,))}
    assert beside["warmth"].upper[0] > 0.0  # of a warm picture: less warm, and not as cold as ice
    for measure in ("shadow_cast", "midtone_cast", "highlight_cast"):
        assert beside[measure].upper[1] == pytest.approx(alone[measure].upper[1] - 10.0)
