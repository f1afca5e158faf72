# SPDX-License-Identifier: Apache-2.0
"""The judge encoder: another network than the one that guides, which no picture has been optimized for."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import torch

from ...guidance import augment
from ...guidance import encoder as guidance
from .finished import FloatArray

FOLDER = Path(guidance.__file__).with_name("judge")
"""Where it lies, an open_clip folder like the embedded encoder's."""


class Judge:
    """Similarity of pictures to words.

    Args:
        folder: Of the encoder.
    """

    def __init__(self, folder: Path) -> None:
        self._encoder = guidance.load_encoder(str(folder), "cpu")

    def gain(self, prompt: str, before: FloatArray, after: FloatArray) -> float:
        """How much nearer to the prompt the picture has come.

        Args:
            prompt: The words.
            before: (H, W, 3), sRGB-encoded, 0 to 1.
            after: Of the same shape.

        Returns:
            A difference of two cosines; above 0 if `after` is nearer.
        """
        with torch.no_grad():
            batch = torch.from_numpy(np.stack([before, after])).float().permute(0, 3, 1, 2)
            features = self._encoder.encode_images(augment.whole(batch, self._encoder.size))
            earlier, later = (features @ self._encoder.encode_texts([prompt]).T)[:, 0].tolist()
        return round(later - earlier, 4)


def find() -> Judge | None:
    """The judge that is shipped; None where there is none."""
    return Judge(FOLDER) if (FOLDER / "open_clip_config.json").is_file() else None
