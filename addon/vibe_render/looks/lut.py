# SPDX-License-Identifier: GPL-3.0-or-later
"""The grade as a .cube file for other programs: a table of how the node group Vibe Grade changes each color.

Input and output colors are display-referred: sRGB, Rec.709 primaries. In between, the grade's formula works on linear
light (see `scene/nodes/grade.py`). Vignette and bloom are left out, because they depend on more than the color. The
view transform is left out too: the file matches the compositor on images that were rendered with the view Standard.

Colors below black and above white are not clipped in the file. Programs interpolate between its colors and clip the
result. Near black, this is closer to the grade than interpolation between clipped colors.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from ..core.color import LUMA, to_linear, to_srgb
from ..core.files import whole
from ..core.schema_import import schema

SIZE = 65  # colors along each edge of the RGB cube: the largest usual number
LEFT_OUT = ("vignette", "glare")
_MIDDLE = 0.18


def neutral_grade() -> dict[str, tuple[float, ...]]:
    """Parameter name -> value with which the grade changes nothing, such as "contrast" -> (1.0,)."""
    rows = [p for p in schema.PARAMETERS if p.group == "film" and p.blender.startswith("Vibe Grade")]
    return {p.name: (p.default,) * p.components for p in rows}


def graded_colors(colors: np.ndarray, values: Mapping[str, Sequence[float]]) -> np.ndarray:
    """`colors` after the grade: (N, 3), scene-linear Rec.709; may be below 0.

    `colors` has the same shape and space, and is at least 0. `values` are by parameter name; missing ones are neutral.
    """
    v = {name: np.array(values.get(name, neutral)) for name, neutral in neutral_grade().items()}
    c = colors * 2.0 ** v["grade_exposure"]
    c = np.maximum(((c - 1.0) * (2.0 - v["lift"]) + 1.0) * v["gain"], 0.0) ** (1.0 / v["midtone"])
    c = _MIDDLE * (c / _MIDDLE) ** v["contrast"]
    luma = (c @ LUMA)[:, None]
    c = luma + (c - luma) * v["saturation"]
    if v["hue"] == 0.0 and v["grade_gamma"] == 1.0:  # these alone need values of at least 0
        return c
    return _turned(np.maximum(c, 0.0), v["hue"] / 60.0) ** v["grade_gamma"]


def _turned(c: np.ndarray, sixths: np.ndarray) -> np.ndarray:
    """Colors (N, 3), at least 0, with the HSV hue turned by sixths of a circle, as by the node Hue/Saturation/Value."""
    brightest, chroma = c.max(1, keepdims=True), np.ptp(c, 1, keepdims=True)
    r, g, b = ((brightest - c) / np.maximum(chroma, 1e-12)).T
    hue = np.select([r == 0, g == 0], [b - g, 2.0 + r - b], 4.0 + g - r)[:, None]
    away = np.abs((hue + sixths - np.array([0.0, 2.0, 4.0]) + 3.0) % 6.0 - 3.0)
    return brightest - chroma * np.clip(away - 1.0, 0.0, 1.0)


def write_cube(path: Path, name: str, values: Mapping[str, Sequence[float]]) -> None:
    """Writes a grade (`values`: as for `graded_colors`) to a .cube file titled `name`; raises VibeError if it fails."""
    title = "".join(c for c in name if c.isprintable() and c != '"')
    head = (
        "# Vibe Render: the grade of a look. In and out: sRGB (Rec.709 primaries, display-referred).\n"
        "# Without vignette, bloom and view transform: for pictures rendered with the view Standard.\n"
        f'TITLE "{title}"\nLUT_3D_SIZE {SIZE}\n'
    )
    # Graded colors of a regular grid over the sRGB cube: (SIZE³, 3) sRGB, not clipped, red changing fastest.
    steps = np.linspace(0.0, 1.0, SIZE)
    blue, green, red = np.meshgrid(steps, steps, steps, indexing="ij")
    colors = to_linear(np.stack([red, green, blue], -1).reshape(-1, 3))
    rows = to_srgb(graded_colors(colors, values))
    with whole(path) as part, part.open("w", encoding="utf-8", newline="\n") as file:
        file.write(head)
        file.write("%.6f %.6f %.6f\n" * len(rows) % tuple(rows.ravel().tolist()))
