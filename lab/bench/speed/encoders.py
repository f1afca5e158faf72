# SPDX-License-Identifier: Apache-2.0
"""Cost of an encoder's guidance in a step of the loop: all views of one picture, forward and backward."""

from __future__ import annotations

import logging
import statistics
import time
from collections.abc import Callable

import torch
from torch import Tensor

from proxy_renderer.guidance.encoder import load_encoder
from proxy_renderer.guidance.regions import Views

_PAPER = "ViT-B-32"
_STEPS = 6


def milliseconds() -> dict[str, float]:
    """Medians, of the embedded encoder and of the architecture that the paper's loop asks, with random weights."""
    import open_clip

    embedded = load_encoder(None, "cpu")
    logging.disable(logging.WARNING)  # that the weights are random
    try:
        paper = open_clip.create_model(_PAPER, pretrained=None).eval().requires_grad_(False)
    finally:
        logging.disable(logging.NOTSET)
    side = paper.visual.image_size
    return {
        "embedded": _step(embedded.encode_images, embedded.size),
        f"{_PAPER}, random weights": _step(paper.encode_image, side if isinstance(side, int) else side[0]),
    }


def _step(encode: Callable[[Tensor], Tensor], side: int) -> float:
    views = Views()
    batch = torch.rand(views.subject + views.surroundings + views.whole, 3, side, side, requires_grad=True)
    times = []
    for _ in range(_STEPS):
        start = time.perf_counter()
        encode(batch).square().sum().backward()
        times.append(1000.0 * (time.perf_counter() - start))
    return round(statistics.median(times[1:]), 1)  # the first one warms up
