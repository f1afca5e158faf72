# SPDX-License-Identifier: Apache-2.0
"""Attribute heads: they read exact attributes (colors, finish, light, fog, grade) off an encoder's picture features.

Training learns through them, and measurements ask them; here lie those of the embedded encoder, others in their encoder's folder.
"""

import json
from pathlib import Path

import torch
import torch.nn.functional as F
from safetensors.torch import load_file
from torch import Tensor, nn

from proxy_renderer.guidance.encoder import EMBEDDED, Encoder

OF_SURFACES = ("subject_finish", "subject_metal")
"""Attributes that are read off the subject alone."""


class AttributeHeads(nn.Module):
    """Reads every attribute's class off picture features, by one small network for all of them.

    Attributes:
        names: Attribute name → its classes, in the order of the logits.
        skill: Attribute name → how far above a blind guess its head has been measured to be, in [0, 1];
            1 where nobody has measured.
    """

    def __init__(self, dim: int, names: dict[str, list[str]], hidden: int = 192) -> None:
        super().__init__()
        self.names = names
        self.skill = dict.fromkeys(names, 1.0)
        self.scale = dim**0.5
        self.layers = nn.Sequential(nn.Linear(dim, hidden), nn.GELU(), nn.Linear(hidden, sum(map(len, names.values()))))

    def logits(self, features: Tensor) -> dict[str, Tensor]:
        """Attribute name → logits (B, classes), from unit features (B, D)."""
        parts = self.layers(features * self.scale).split([len(classes) for classes in self.names.values()], -1)
        return dict(zip(self.names, parts, strict=True))

    def read(self, whole: Tensor, subject: Tensor) -> dict[str, Tensor]:
        """As `logits`, of features of whole pictures (B, D) and of the subject, framed closely (C, D), which shows its surface better.

        Args:
            whole: (B, D) unit features of whole pictures.
            subject: (C, D) unit features of their subjects, framed closely.

        Returns:
            Attribute name -> logits (B, classes), or (C, classes) for `OF_SURFACES`.
        """
        of_surfaces = self.logits(subject)
        return self.logits(whole) | {name: of_surfaces[name] for name in OF_SURFACES if name in self.names}

    def loss(self, features: Tensor, labels: Tensor, stress: Tensor) -> Tensor:
        """Mean cross-entropy of the heads.

        Args:
            features: (B, D) unit features of pictures.
            labels: (B, A) indices of classes; -100 where an attribute cannot be seen.
            stress: (A,) how much each attribute weighs.

        Returns:
            A scalar.
        """
        terms = [
            F.cross_entropy(logits, labels[:, i], reduction="sum") / (labels[:, i] >= 0).sum().clamp_min(1)
            for i, logits in enumerate(self.logits(features).values())
        ]
        return (torch.stack(terms) * stress).sum() / stress.sum()


def folder_of(encoder: str | Path) -> Path:
    """The folder of an encoder's heads.

    Args:
        encoder: Its name, or its folder.
    """
    here = encoder == "embedded" or Path(encoder).resolve() == EMBEDDED
    return Path(__file__).parent if here else Path(encoder)


def heads_of(encoder: Encoder) -> AttributeHeads | None:
    """The heads of an encoder, on its device; None if it has none."""
    folder = folder_of(encoder.name)
    if not (folder / "heads.json").is_file():
        return None
    names = json.loads((folder / "heads.json").read_text())
    weights = {key: w.float() for key, w in load_file(folder / "heads.safetensors").items()}
    heads = AttributeHeads(weights["layers.0.weight"].shape[1], names, weights["layers.0.weight"].shape[0])
    heads.load_state_dict(weights)
    if (folder / "skill.json").is_file():
        heads.skill |= json.loads((folder / "skill.json").read_text())
    return heads.to(encoder.device).eval().requires_grad_(False)
