# SPDX-License-Identifier: GPL-3.0-or-later
"""The grade as a .cube file: its formula is the compositor group's, and OpenColorIO reads it back."""

import numpy as np
import PyOpenColorIO
import pytest
from test_grade import IDENTITY, reference
from vibe_render import lut

from proxy_renderer.schema import VibeError

LOOKS = [
    {"contrast": (1.4,), "saturation": (0.0,), "lift": (0.93, 0.93, 0.93)},
    {"gain": (1.15, 1.0, 0.85), "lift": (0.93, 1.0, 1.04), "saturation": (1.2,), "contrast": (1.15,)},
    {"midtone": (1.2, 1.0, 0.9), "hue": (20.0,), "grade_gamma": (0.9,), "grade_exposure": (-0.5,)},
]


def read(path, colors):
    """Display colors through the file, as OpenColorIO does it."""
    PyOpenColorIO.ClearAllCaches()
    step = PyOpenColorIO.FileTransform(str(path), interpolation=PyOpenColorIO.INTERP_TETRAHEDRAL)
    pixels = np.ascontiguousarray(colors, np.float32)
    PyOpenColorIO.Config.CreateRaw().getProcessor(step).getDefaultCPUProcessor().applyRGB(pixels)
    return pixels


def test_neutral_values_are_the_grades_own():
    inputs = {name: value if isinstance(value, tuple) else (value,) for name, value in IDENTITY.items()}
    assert lut.identity() == inputs


@pytest.mark.parametrize("values", LOOKS)
def test_formula_is_the_compositors(values):
    """Against the formula that test_grade compares Blender's compositor with."""
    colors = 2.0 ** np.random.default_rng(3).uniform(-8.0, 3.0, (32, 48, 3))
    plain = {name: v if len(v) == 3 else v[0] for name, v in values.items()}
    ours = lut.graded(colors.reshape(-1, 3), values)
    np.testing.assert_allclose(ours, reference(colors, **plain).reshape(-1, 3), rtol=1e-5, atol=1e-7)


@pytest.mark.parametrize("values", LOOKS)
def test_opencolorio_reads_it_back(tmp_path, values):
    """Exact at the file's own colors; between them, interpolation smooths the grade's corners near black."""
    lut.write(tmp_path / "look.cube", 'a "look"\n', values)
    random = np.random.default_rng(4)
    for colors, worst in (
        (random.integers(0, lut.SIZE, (20_000, 3)) / (lut.SIZE - 1), 1e-5),
        (random.uniform(0.0, 1.0, (20_000, 3)), None),
    ):
        wanted = lut.to_display(lut.graded(lut.to_linear(colors), values))
        off = np.abs(read(tmp_path / "look.cube", colors) - wanted)
        assert off.mean() < 1e-3
        assert worst is None or off.max() < worst
    assert 'TITLE "a look"' in (tmp_path / "look.cube").read_text()
    assert [path.name for path in tmp_path.iterdir()] == ["look.cube"]


def test_a_look_that_does_not_grade_changes_nothing(tmp_path):
    lut.write(tmp_path / "none.cube", "none", {})
    colors = np.random.default_rng(5).uniform(0.0, 1.0, (1000, 3))
    assert np.abs(read(tmp_path / "none.cube", colors) - colors).max() < 1e-5


def test_unwritable(tmp_path):
    with pytest.raises(VibeError, match="cannot be written"):
        lut.write(tmp_path / "missing" / "x.cube", "x", {})
