# SPDX-License-Identifier: Apache-2.0
"""The pictures of what was found, at full size, as the proxy draws them: each shot, and each variant of it."""

from __future__ import annotations

from pathlib import Path

import torch
from PIL import Image

from ..optimize.drawing import draw
from ..optimize.pipeline import Outcome
from ..render.proxy import Proxy, Render
from . import report

PREDICTION, MASK = "prediction.png", "mask.png"
OTHERS = {"before_last_anchor": "prediction-earlier.png", "unanchored": "prediction-unanchored.png"}
"""Predictions that only the figures are taken of: of the correction before the last, and without any."""


def variant(number: int) -> str:
    """The file name of a variant's picture; they count from 1."""
    return f"variant-{number}.png"


def predict(proxy: Proxy, outcome: Outcome, number: int, job: Path) -> list[str]:
    """Draws a shot of the values found, and what would have been predicted without the last anchor.

    Args:
        proxy: Of the shot, at full size.
        outcome: What was found.
        number: Of the shot.
        job: Its folder, for the pictures.

    Returns:
        Which of `OTHERS` there are.
    """
    anchoring = outcome.shots[number].anchoring
    last = anchoring.proxy.correction
    corrections = {PREDICTION: last}
    if last is not None:
        corrections |= {OTHERS["before_last_anchor"]: anchoring.earlier, OTHERS["unanchored"]: None}
    for name, correction in corrections.items():
        proxy.correction = correction
        picture = _drawn(proxy, outcome, number)
        report.save_picture(picture.display, job / name)
    report.save_picture(picture.mask, job / MASK)
    return [name for name in OTHERS if OTHERS[name] in corrections]


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
        report.save_picture(_drawn(proxy, look, number).display, path)
        with Image.open(path) as image:
            pictures.append(image.convert("RGB"))
    return pictures


def _drawn(proxy: Proxy, outcome: Outcome, number: int) -> Render:
    with torch.no_grad():
        return draw(proxy, outcome.shots[number].vector, outcome.u)
