# SPDX-License-Identifier: Apache-2.0
"""The pictures of what was found, at full size, as the proxy draws them, and how far they are from Cycles."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from PIL import Image

from ..color.differences import ciede2000
from ..color.tensors import lab_from_srgb
from ..optimize.pipeline import Outcome
from ..optimize.shots import draw
from ..render.proxy import Proxy, Render
from .pictures import image, save_picture

PREDICTION = "prediction.png"
PICTURES = {
    "shown": PREDICTION,
    "before_last_anchor": "prediction-earlier.png",
    "unanchored": "prediction-unanchored.png",
}
"""The predictions that figures are taken of. The last anchor was taken at the very values that are shown, so what the
proxy can foretell is the second one: it is corrected by an anchor that was taken elsewhere."""


def variant(number: int) -> str:
    """The file name of a variant's picture; they count from 1."""
    return f"variant-{number}.png"


@dataclass(frozen=True)
class Predicted:
    """The predictions of a shot.

    Attributes:
        names: Which of `PICTURES` there are.
        mask: The share of each pixel that the subject covers, as an image.
    """

    names: list[str]
    mask: Image.Image


def predict(proxy: Proxy, outcome: Outcome, number: int, job: Path, figures: bool) -> Predicted:
    """Draws a shot of the values found.

    Args:
        proxy: Of the shot, at full size.
        job: Its folder, for the pictures.
        figures: Whether also to draw what would have been predicted without the last anchor, where there is one, and without any.
    """
    anchoring = outcome.shots[number].anchoring
    last = anchoring.proxy.correction
    corrections = {"shown": last}
    if last is not None and figures:
        corrections |= {"before_last_anchor": anchoring.earlier, "unanchored": None}
    for name, correction in corrections.items():
        proxy.correction = correction
        picture = _drawn(proxy, outcome, number)
        save_picture(picture.display, job / PICTURES[name])
    return Predicted(list(corrections), image(picture.mask))


def variants(proxy: Proxy, outcome: Outcome, number: int, job: Path) -> list[Image.Image]:
    """Draws a shot of every variant, and leaves each as a file in the job folder, see `variant`.

    Args:
        proxy: As for `predict`.
        outcome: As for `predict`.
        number: As for `predict`.
        job: As for `predict`.

    Returns:
        The pictures, in the order of the variants.
    """
    pictures = []
    for place, look in enumerate(outcome.variants, start=1):
        proxy.correction, *_ = look.anchors[number]
        path = job / variant(place)
        save_picture(_drawn(proxy, look, number).display, path)
        with Image.open(path) as file:
            pictures.append(file.convert("RGB"))
    return pictures


def apart(predicted: np.ndarray, after: np.ndarray, subject: np.ndarray) -> dict[str, float]:
    """How far a prediction is from Cycles' picture, in CIEDE2000.

    Args:
        predicted: (H, W, 3) sRGB-encoded, in [0, 1].
        subject: (H, W) the share of each pixel that the subject covers.

    Returns:
        `mean` and `p95`, the 95th percentile, over the pixels; `subject`, the mean where the subject covers most of
        a pixel, if it does anywhere.
    """
    labs = (lab_from_srgb(torch.from_numpy(picture)) for picture in (predicted, after))
    errors = ciede2000(*labs).numpy()
    figures = {"mean": errors.mean(), "p95": np.percentile(errors, 95)}
    if (subject > 0.5).any():
        figures["subject"] = errors[subject > 0.5].mean()
    return {name: round(float(figure), 3) for name, figure in figures.items()}


def _drawn(proxy: Proxy, outcome: Outcome, number: int) -> Render:
    with torch.no_grad():
        return draw(proxy, outcome.shots[number].vector, outcome.u)
