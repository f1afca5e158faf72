# SPDX-License-Identifier: Apache-2.0
"""The judge: another encoder than the one that guides. It only judges results; nothing may be optimized against it."""

from pathlib import Path

from lab.judge import network as network  # makes timm know its picture tower
from proxy_renderer.guidance.encoder import Encoder, load_encoder

FOLDER = Path(__file__).parent
"""An open_clip folder, like the embedded encoder's."""


def load() -> Encoder:
    """The judge, on the CPU."""
    return load_encoder(str(FOLDER), "cpu")
