# SPDX-License-Identifier: GPL-3.0-or-later
"""The grade as a .cube file: its formula is the compositor group's, and OpenColorIO reads it back."""

import numpy as np
import PyOpenColorIO
import pytest
from grade_formula import IDENTITY, reference
from vibe_render.core.color import to_linear, to_srgb
from vibe_render.looks import library, lut, transfer

from proxy_renderer.schema import VibeError

LOOKS = [
    {"contrast": (1.4,), "saturation": (0.0,), "lift": (0.93, 0.93, 0.93)},
    {"gain": (1.15, 1.0, 0.85), "lift": (0.93, 1.0, 1.04), "saturation": (1.2,), "contrast": (1.15,)},
    {"midtone": (1.2, 1.0, 0.9), "hue": (20.0,), "grade_gamma": (0.9,), "grade_exposure": (-0.5,)},
]


def read(path, colors):
    """Display colors through the file, as OpenColorIO does it, and as a display shows them."""
    PyOpenColorIO.ClearAllCaches()
    step = PyOpenColorIO.FileTransform(str(path), interpolation=PyOpenColorIO.INTERP_TETRAHEDRAL)
    pixels = np.ascontiguousarray(colors, np.float32)
    PyOpenColorIO.Config.CreateRaw().getProcessor(step).getDefaultCPUProcessor().applyRGB(pixels)
    return pixels.clip(0.0, 1.0)


def test_neutral_values_are_the_grades_own():
    inputs = {name: value if isinstance(value, tuple) else (value,) for name, value in IDENTITY.items()}
    assert lut.neutral_grade() == inputs


@pytest.mark.parametrize("values", LOOKS)
def test_formula_is_the_compositors(values):
    """Against the formula that test_grade compares Blender's compositor with."""
    colors = 2.0 ** np.random.default_rng(3).uniform(-8.0, 3.0, (32, 48, 3))
    plain = {name: v if len(v) == 3 else v[0] for name, v in values.items()}
    ours = np.maximum(lut.graded_colors(colors.reshape(-1, 3), values), 0.0)
    np.testing.assert_allclose(ours, reference(colors, **plain).reshape(-1, 3), rtol=1e-5, atol=1e-7)


def off(folder, values, colors):
    """How far OpenColorIO with the file is from the grade, (N, 3)."""
    lut.write_cube(folder / "look.cube", 'a "look"\n', values)
    wanted = to_srgb(lut.graded_colors(to_linear(colors), values)).clip(0.0, 1.0)
    return np.abs(read(folder / "look.cube", colors) - wanted)


@pytest.mark.parametrize("values", LOOKS)
def test_opencolorio_reads_it_back(tmp_path, values):
    """Exact at the file's own colors; between them, nearly everywhere within 1e-3."""
    random = np.random.default_rng(4)
    assert off(tmp_path, values, random.integers(0, lut.SIZE, (20_000, 3)) / (lut.SIZE - 1)).max() < 1e-5
    between = off(tmp_path, values, random.uniform(0.0, 1.0, (20_000, 3)))
    assert between.mean() < 2e-4
    assert (between.max(1) < 1e-3).mean() > 0.9
    assert 'TITLE "a look"' in (tmp_path / "look.cube").read_text()
    assert [path.name for path in tmp_path.iterdir()] == ["look.cube"]


@pytest.mark.parametrize("path", sorted(library.SHIPPED.glob("*.json")), ids=lambda path: path.stem)
def test_the_looks_that_come_along_are_close_everywhere(tmp_path, path):
    """Also in the dark, where saturation takes colors below black, and the display's curve is steep."""
    film = transfer.load_preset(path).roles.get("film", [{}])[0]
    values = {name: value for name, value in film.items() if name in lut.neutral_grade()}
    random = np.random.default_rng(5)
    difference = off(tmp_path, values, random.uniform(0.0, 1.0, (20_000, 3)) * random.choice([1.0, 0.3], (20_000, 1)))
    more = values.get("saturation", [1.0])[0] > 1.0
    assert difference.max() < (0.03 if more else 0.01)
    assert difference.mean() < 2e-4


def test_a_look_that_does_not_grade_changes_nothing(tmp_path):
    lut.write_cube(tmp_path / "none.cube", "none", {})
    colors = np.random.default_rng(5).uniform(0.0, 1.0, (1000, 3))
    assert np.abs(read(tmp_path / "none.cube", colors) - colors).max() < 1e-5


def test_unwritable(tmp_path):
    with pytest.raises(VibeError, match="cannot be written"):
        lut.write_cube(tmp_path / "missing" / "x.cube", "x", {})
