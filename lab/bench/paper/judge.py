# SPDX-License-Identifier: Apache-2.0
"""The judge encoder: another network than the one that guides, which no picture has been optimized for."""

from __future__ import annotations

import numpy as np
import torch

from lab import judge
from lab.bench.paper.finished import FloatArray
from proxy_renderer.guidance import regions


class Judge:
    """Similarity of pictures to words."""

    def __init__(self) -> None:
        self._encoder = judge.load()

    def gain(self, prompt: str, before: FloatArray, after: FloatArray) -> float:
        """Approach of the picture to the prompt.

        Args:
            before: (H, W, 3), sRGB-encoded, 0 to 1.
            after: Of the same shape.

        Returns:
            A difference of two cosines; above 0 if `after` is nearer.
        """
        with torch.no_grad():
            batch = torch.from_numpy(np.stack([before, after])).float().permute(0, 3, 1, 2)
            features = self._encoder.encode_images(regions.whole(batch, self._encoder.size))
            earlier, later = (features @ self._encoder.encode_texts([prompt]).T)[:, 0].tolist()
        return round(later - earlier, 4)


def find() -> Judge | None:
    """The judge; None where its weights are missing."""
    return Judge() if (judge.FOLDER / "open_clip_model.safetensors").is_file() else None
