# SPDX-License-Identifier: Apache-2.0
"""Measures which scene-linear color a view transform shows as a given display color, and writes view_colors.txt.

Run `python -m proxy_renderer.train.view_colors CONFIG.OCIO` once per change of Blender's views; needs `opencolorio`.
"""

from __future__ import annotations

import itertools
import sys

import numpy as np

from ..color.arrays import oklab_from_srgb
from ..planning.display import VIEW_COLORS

VIEWS = ("AgX", "Filmic")
STEPS = 11  # of the grid of display colors, per component
_LIGHTNESS_WEIGHT = 0.35  # colors out of reach: rather too dark than too pale


def _show(linear: np.ndarray, processor) -> np.ndarray:
    """Display sRGB in [0, 1] of (N, 3) linear colors."""
    shown = np.ascontiguousarray(linear, dtype=np.float32).copy()
    processor.applyRGB(shown)
    return np.clip(shown, 0, 1)


def _oklab(srgb: np.ndarray) -> np.ndarray:
    """OKLab (Ottosson 2020), scaled to CIELAB's numbers, whose blues would be matched by violet."""
    return oklab_from_srgb(srgb) * (100.0, 300.0, 300.0)


def _error(lab: np.ndarray, target: np.ndarray) -> np.ndarray:
    """Squared difference from target colors, weighted as CIE94: hue counts more than chroma does."""
    chroma, wanted = np.hypot(lab[..., 1], lab[..., 2]), np.hypot(target[..., 1], target[..., 2])
    flat = ((lab - target)[..., 1:] ** 2).sum(-1)
    hue = np.maximum(flat - (chroma - wanted) ** 2, 0)
    lightness = _LIGHTNESS_WEIGHT * (lab - target)[..., 0]
    return lightness**2 + ((chroma - wanted) / (1 + 0.045 * wanted)) ** 2 + hue / (1 + 0.015 * wanted) ** 2


def invert(processor) -> np.ndarray:
    """(STEPS**3, 3) linear colors whose display is nearest to the grid's, by a search from coarse to fine."""
    steps = np.linspace(0, 1, STEPS)
    targets = _oklab(np.array(list(itertools.product(steps, repeat=3))))
    levels = np.concatenate([[2e-4], np.geomspace(1e-3, 12, 34)])
    candidates = np.array(list(itertools.product(levels, repeat=3)))
    labs = _oklab(_show(candidates, processor))
    best = np.stack([candidates[np.argmin(_error(labs, t))] for t in targets])
    random = np.random.default_rng(0)
    for width in np.geomspace(0.3, 0.01, 24):
        tries = best[:, None] * np.exp(random.normal(0, width, (len(best), 64, 3)))
        tries[:, 0] = best
        tries = np.clip(tries, 1e-4, 12)
        error = _error(_oklab(_show(tries.reshape(-1, 3), processor)).reshape(tries.shape), targets[:, None])
        best = tries[np.arange(len(best)), error.argmin(1)]
    return best


def main(config: str) -> None:
    """Writes the table beside this file."""
    import PyOpenColorIO as ocio

    settings = ocio.Config.CreateFromFile(config)
    lines = [
        "# Scene-linear Rec.709 that each view shows as an sRGB display color: a grid of",
        f"# {STEPS} x {STEPS} x {STEPS} display colors, blue fastest. Written by train/view_colors.py.",
    ]
    for view in VIEWS:
        shown = ocio.DisplayViewTransform(src="Linear Rec.709", display="sRGB", view=view)
        table = invert(settings.getProcessor(shown).getDefaultCPUProcessor())
        lines += [f"[{view}]", *(" ".join(f"{v:.4g}" for v in row) for row in table)]
    VIEW_COLORS.write_text("\n".join(lines) + "\n", "utf-8")


if __name__ == "__main__":
    main(sys.argv[1])
