# SPDX-License-Identifier: Apache-2.0
"""The measures of `python -m lab fidelity` against values that are known."""

import math

import pytest
import torch

from lab.bench import cache, metrics, table
from lab.bench.sheet import error_picture
from proxy_renderer import folders

GRAY = torch.full((32, 40, 3), 0.5)


def noise(seed):
    return torch.rand(32, 40, 3, generator=torch.Generator().manual_seed(seed))


def test_equal_pictures():
    same = metrics.difference(noise(1), noise(1))
    assert same.delta_e == same.p95 == same.lighter == 0
    assert same.ssim == pytest.approx(1)
    assert same.psnr == math.inf


def test_black_and_white_are_a_hundred_apart():
    found = metrics.difference(torch.ones(16, 16, 3), torch.zeros(16, 16, 3))
    assert found.delta_e == pytest.approx(100, abs=1e-3)
    assert found.lighter == pytest.approx(100, abs=1e-3)
    assert found.psnr == pytest.approx(0)
    assert found.ssim == pytest.approx(1e-4 / (1 + 1e-4), rel=1e-3)


def test_psnr_of_a_known_error():
    assert metrics.difference(GRAY + 0.1, GRAY).psnr == pytest.approx(20, abs=1e-3)


def test_the_percentile_is_of_the_pixels():
    picture = GRAY.clone()
    picture[:4] = 0.9  # an eighth of the rows
    found = metrics.difference(picture, GRAY)
    worst = float(metrics.delta_e_map(picture, GRAY)[0].max())
    assert found.p95 == pytest.approx(worst)
    assert found.delta_e == pytest.approx(worst / 8, rel=1e-5)


def test_ssim_falls_with_structure_lost_and_not_with_a_little_light():
    assert metrics.ssim(noise(1), noise(2)) < 0.3
    assert metrics.ssim(GRAY + 0.01, GRAY) > 0.99


def test_error_pictures_are_red_where_too_light_and_blue_where_too_dark():
    picture = GRAY.clone()
    picture[:, :20] += 0.2
    picture[:, 20:] -= 0.2
    error = error_picture(picture, GRAY)
    light, dark = error.getpixel((5, 5)), error.getpixel((35, 5))
    assert light[0] > 2 * light[2]
    assert dark[2] > 2 * dark[0]
    assert error_picture(GRAY, GRAY).getextrema() == ((0, 0),) * 3


def row(delta_e, *features, **more):
    return {"features": list(features), "delta_e": delta_e, "psnr": math.inf, **more}


def test_means_are_per_feature_and_leave_out_what_is_infinite():
    scenes = {"a": row(1.0, "metal"), "b": row(3.0, "metal", "fog", psnr=30.0)}
    found = table.summary(scenes, {"c": "it broke"})
    assert found["mean_delta_e"] == 2
    assert found["mean_psnr"] == 30
    assert found["features"]["metal"] == {"scenes": 2, "delta_e": 2, "psnr": 30}
    assert found["features"]["fog"]["delta_e"] == 3
    assert found["failed"] == {"c": "it broke"}
    assert "anchored_mean_delta_e" not in found


def test_anchored_figures_have_the_names_that_the_readme_quotes():
    found = table.summary({"a": row(1.0, anchored_delta_e=0.4, anchored_still_delta_e=0.2)}, {})
    assert found["anchored_mean_delta_e"] == 0.4
    assert found["anchored_still_mean_delta_e"] == 0.2


def test_the_cache_follows_the_option_then_the_variable(monkeypatch, tmp_path):
    monkeypatch.setenv(folders.CACHE, str(tmp_path / "variable"))
    assert cache.folder(str(tmp_path / "option")) == tmp_path / "option"
    assert cache.folder() == tmp_path / "variable" / "fidelity"
    monkeypatch.delenv(folders.CACHE)
    assert cache.folder().parts[-2:] == ("vibe-render", "fidelity")
