# SPDX-License-Identifier: Apache-2.0
"""Today's use of a picture and a render: color transfer from one flat picture to another.

scikit-image, pilgram and color-matcher come with `pip install -e '.[lab]'` in a clone; color-matcher is under the GPL and runs as
a program of its own.
"""

from __future__ import annotations

import importlib.util
import subprocess
import sys
import tempfile
from importlib import import_module
from pathlib import Path

import numpy as np
import torch
from PIL import Image

from proxy_renderer.color.constants import REC709_FROM_XYZ, WHITE
from proxy_renderer.color.tensors import lab_from_srgb, srgb_from_linear
from proxy_renderer.schema import VibeError

_MATCHER = """
import sys
import numpy as np
from color_matcher import ColorMatcher

source, target, made, method = sys.argv[1:]
np.save(made, ColorMatcher(src=np.load(source), ref=np.load(target), method=method).main())
"""
"""Script that runs color-matcher, in a process of its own. Its command line stretches every picture to the whole range."""
_METHOD = "mvgd"
"""The best of its methods on hidden looks (Pitié and Kokaram 2007, by Hahne)."""


def matched(picture: np.ndarray, like: np.ndarray) -> dict[str, np.ndarray]:
    """A picture with another's colors, by each method that is installed and does not fail.

    Args:
        picture: (H, W, 3) sRGB-encoded, in [0, 1].

    Returns:
        Pictures like the first, by method.
    """
    found: dict[str, np.ndarray | None] = {"Reinhard": reinhard(picture, like)}
    if importlib.util.find_spec("skimage"):
        exposure = import_module("skimage.exposure")
        found["histograms"] = exposure.match_histograms(picture, like, channel_axis=-1)
    if importlib.util.find_spec("color_matcher"):
        found["color-matcher"] = _by_color_matcher(picture, like)
    return {name: np.clip(made, 0.0, 1.0).astype(np.float32) for name, made in found.items() if made is not None}


def reinhard(picture: np.ndarray, like: np.ndarray) -> np.ndarray:
    """Mean and spread of each channel of CIE Lab as in the other picture (Reinhard et al., "Color Transfer between Images", 2001)."""
    source, target = (lab_from_srgb(torch.as_tensor(p, dtype=torch.float32)).reshape(-1, 3) for p in (picture, like))
    spread = target.std(0) / source.std(0).clamp_min(1e-4)
    lab = (source - source.mean(0)) * spread + target.mean(0)
    return _srgb_from_lab(lab).reshape(picture.shape).numpy()


def filtered(picture: Image.Image, name: str) -> Image.Image:
    """A picture with a photo filter on it.

    Raises:
        VibeError: pilgram is not installed.
    """
    if not importlib.util.find_spec("pilgram"):
        raise VibeError("The photo filters are not installed.", "pip install -e '.[lab]' in the clone.")
    made: Image.Image = getattr(import_module("pilgram"), name)(picture)
    return made.convert("RGB")


def _srgb_from_lab(lab: torch.Tensor) -> torch.Tensor:
    y = (lab[:, 0] + 16) / 116
    curved = torch.stack((y + lab[:, 1] / 500, y, y - lab[:, 2] / 200), -1)
    low = (curved - 4 / 29) * 108 / 841
    xyz = torch.where(curved > 6 / 29, curved**3, low) * torch.tensor(WHITE)
    return srgb_from_linear((xyz @ torch.tensor(REC709_FROM_XYZ).T).clamp(0.0, 1.0))


def _by_color_matcher(picture: np.ndarray, like: np.ndarray) -> np.ndarray | None:
    """None where it fails, as it does on pictures of one color."""
    with tempfile.TemporaryDirectory() as folder:
        source, target, made = (str(Path(folder) / f"{name}.npy") for name in ("source", "target", "made"))
        for path, colors in ((source, picture), (target, like)):
            np.save(path, colors.astype(np.float64))
        command = [sys.executable, "-c", _MATCHER, source, target, made, _METHOD]
        done = subprocess.run(command, check=False, capture_output=True)
        return np.load(made) if done.returncode == 0 else None
