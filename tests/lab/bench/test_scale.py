# SPDX-License-Identifier: Apache-2.0
"""Exponents of known costs, the plot, and what is measured once and kept."""

import json
import xml.etree.ElementTree as ElementTree

import pytest

from lab.bench.scale import experiment
from lab.bench.scale.fit import exponent
from lab.bench.scale.plot import plot
from proxy_renderer.schema import VibeError


@pytest.mark.parametrize("power", [0.0, 0.5, 1.0, 2.0])
def test_a_power_is_found_exactly(power):
    sizes = [1, 10, 100, 1000]
    found = exponent(sizes, [3 * size**power for size in sizes])
    assert (found.slope, found.last) == pytest.approx((power, power), abs=1e-9)
    assert found.margin == pytest.approx(0.0, abs=1e-6)


def test_what_is_paid_once_flattens_the_whole_but_not_the_end():
    sizes = [1, 10, 100, 1000]
    found = exponent(sizes, [50 + size for size in sizes])
    assert found.slope < 0.5 < 0.7 < found.last
    assert found.slope + found.margin > found.last


def test_two_points_have_no_interval():
    assert exponent([1, 4], [1.0, 2.0]).margin == float("inf")


def test_the_plot_is_small_and_has_every_curve():
    curves = {"step": [(1, 0.1), (10, 0.2)], "search": [(1, 2.0), (10, 9.0)]}
    drawn = plot({"lights": curves, "shots": curves})
    assert len(drawn) < 20_000
    paths = [p for p in ElementTree.fromstring(drawn).iter() if p.get("stroke-width") == "2"]
    assert len(paths) == 2 * 2 + 2  # and the legend


def costs(seconds):
    return {phase: {"processor": seconds, "wall": seconds, "memory": 1.0} for phase in experiment.PHASES}


def test_an_axis_ends_where_it_takes_too_long_and_goes_on_later(tmp_path, monkeypatch):
    monkeypatch.setattr(experiment, "_point", lambda sizes: costs(0.1 * sizes["lights"]))
    first = experiment.run(tmp_path, "lights", limit=5)
    assert list(first["points"]["lights"]) == ["1", "4", "16"]
    assert first["stopped"] == {"lights": [64]}
    assert first["exponents"]["lights"]["step"]["processor"]["slope"] == pytest.approx(1.0)
    monkeypatch.setattr(experiment, "_point", lambda sizes: costs(7.0))
    again = experiment.run(tmp_path, "lights", limit=100)
    assert again["points"]["lights"]["16"] == first["points"]["lights"]["16"]
    assert again["points"]["lights"]["64"] == costs(7.0)
    assert again["stopped"] == {}
    assert json.loads((tmp_path / "results.json").read_text())["points"] == again["points"]
    assert (tmp_path / "scale.svg").is_file()


def test_a_point_that_fails_is_told_and_the_others_stay(tmp_path, monkeypatch):
    def point(sizes):
        if sizes["shots"] > 1:
            raise VibeError("memory ran out", "Measure smaller sizes.")
        return costs(1.0)

    monkeypatch.setattr(experiment, "_point", point)
    results = experiment.run(tmp_path, "shots", limit=100)
    assert list(results["failed"]) == ["shots 4"]
    assert list(results["points"]["shots"]) == ["1"]


def test_an_unknown_size_is_refused(tmp_path):
    with pytest.raises(VibeError, match="No size"):
        experiment.run(tmp_path, "hair", limit=1)
