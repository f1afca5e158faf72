# SPDX-License-Identifier: GPL-3.0-or-later
"""One real point of `python -m lab scale`: a scene of the sizes that are asked for, and costs for every phase."""

import pytest

from lab.bench import blender
from lab.bench.scale import experiment
from proxy_renderer.scene import load_scene

SIZES = {"triangles": 600, "lights": 3, "materials": 3, "pixels": 32, "shots": 2}


def test_the_scene_has_the_sizes(tmp_path):
    blender.command("scale", tmp_path, *(SIZES[name] for name in ("triangles", "lights", "materials", "shots")))
    scenes = [load_scene(tmp_path / str(number)) for number in range(SIZES["shots"])]
    assert len(scenes[0].mesh.faces) == pytest.approx(SIZES["triangles"], rel=0.1)
    assert (len(scenes[0].lights), len(scenes[0].materials)) == (SIZES["lights"], SIZES["materials"])
    key = "camera/azimuth"
    assert scenes[0].instances[key].value != scenes[1].instances[key].value


@pytest.mark.slow
def test_every_phase_costs_something():
    costs = experiment._point(SIZES)
    assert tuple(costs) == experiment.PHASES
    assert all(row["processor"] > 0 and row["wall"] > 0 for row in costs.values())
