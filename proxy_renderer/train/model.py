# SPDX-License-Identifier: Apache-2.0
"""The dual encoder in training, and its export to a folder that open_clip loads like any other model."""

import json
import os
from pathlib import Path
from typing import Any

import torch
import torch.nn.functional as F
from open_clip import SimpleTokenizer
from open_clip.model import CLIP
from safetensors.torch import save_file
from torch import Tensor, nn

from ..guidance.encoder import AttributeHeads
from ..language.attributes import ATTRIBUTES
from .data import Batch, contradicts

CONFIG = {
    "embed_dim": 192,
    "vision_cfg": {"image_size": 128, "layers": [1, 2, 3, 2], "width": 16, "head_width": 64},
    "text_cfg": {"context_length": 40, "vocab_size": 49408, "width": 96, "heads": 4, "layers": 3},
}
PREPROCESS = {
    "mean": [0.5, 0.5, 0.5],
    "std": [0.25, 0.25, 0.25],
    "interpolation": "bicubic",
    "resize_mode": "squash",
}


class Student(nn.Module):
    """open_clip's CLIP and the attribute heads that share its features."""

    def __init__(self, config: dict = CONFIG) -> None:
        super().__init__()
        self.config = config
        self.clip = CLIP(config["embed_dim"], config["vision_cfg"], config["text_cfg"])
        self.heads = AttributeHeads(config["embed_dim"], {name: list(c) for name, c in ATTRIBUTES.items()})
        self.tokenizer = SimpleTokenizer(context_length=config["text_cfg"]["context_length"])
        spread_attention(self.clip.visual.attnpool)
        self.clip.visual.to(memory_format=torch.channels_last)

    def forget_unseen(self, captions: list[str]) -> None:
        """Zeroes the embeddings of tokens that these captions lack: they stay zero, and compress well."""
        seen = torch.unique(self.tokenizer(captions))
        keep = torch.zeros(self.config["text_cfg"]["vocab_size"], 1)
        keep[seen] = 1
        with torch.no_grad():
            self.clip.token_embedding.weight.mul_(keep.to(self.clip.token_embedding.weight))

    def losses(self, batch: Batch, device: torch.device) -> dict[str, Tensor]:
        """Contrast between pictures and captions, and attributes read off pictures and off captions."""
        mean, std = (torch.tensor(PREPROCESS[key])[:, None, None] for key in ("mean", "std"))
        pictures = ((batch.pictures - mean) / std).to(device, memory_format=torch.channels_last)
        tokens = self.tokenizer(batch.captions).to(device)
        with torch.autocast(device.type, torch.bfloat16):
            image = self.clip.encode_image(pictures)
            text = self.clip.encode_text(tokens)
        image, text = F.normalize(image.float(), dim=-1), F.normalize(text.float(), dim=-1)
        labels, mentioned = batch.labels.to(device), batch.mentioned.to(device)
        logits = self.clip.logit_scale.exp().clamp(max=60) * image @ text.T
        rival = contradicts(labels, mentioned) | torch.eye(len(labels), dtype=torch.bool, device=device)
        logits = logits.masked_fill(~rival, float("-inf"))
        speaks = (mentioned >= 0).any(1)
        own = torch.arange(len(labels), device=device)
        return {
            "contrast": (
                F.cross_entropy(logits[speaks], own[speaks]) + F.cross_entropy(logits.T[speaks], own[speaks])
            )
            / 2,
            "heads": self.heads.loss(image, labels),
            "words": self.heads.loss(text, mentioned.masked_fill(mentioned < 0, -100)),
        }


@torch.no_grad()
def spread_attention(pool: Any, code: float = 6.0, pull: float = 8.0) -> None:
    """Sets the pooling's heads on different parts of the picture for good: halves, center, corners, all of it.

    Left to themselves they soon pick one cell each, and stop learning on which side the light falls and
    whether the corners are dark.

    Args:
        pool: open_clip's AttentionPool2d.
        code: Strength of a part's mark in the position embedding.
        pull: How strongly a head asks for its mark.
    """
    generator = torch.Generator().manual_seed(0)
    marks, dim = pool.positional_embedding, pool.k_proj.in_features
    side, width = round((len(marks) - 1) ** 0.5), dim // pool.num_heads
    y, x = (axis.flatten() for axis in torch.meshgrid(*[torch.linspace(-1, 1, side)] * 2, indexing="ij"))
    inner, outer = torch.maximum(x.abs(), y.abs()) < 0.5, torch.minimum(x.abs(), y.abs()) > 0.5
    parts = (x < 0, x > 0, y < 0, y > 0, inner, outer, inner | (y > 0))
    directions = torch.randn(len(parts), dim, generator=generator)
    directions = F.normalize(
        directions - directions.mean(1, keepdim=True), dim=1
    )  # features are all positive
    for projection in (pool.q_proj, pool.k_proj):
        projection.weight.normal_(0, 0.004, generator=generator)
        projection.bias.zero_()
    for head, (part, direction) in enumerate(zip(parts[: pool.num_heads], directions, strict=False)):
        marks[1:] += code * part[:, None] * direction
        pool.k_proj.weight[head * width] += direction
        pool.q_proj.bias[head * width] += pull
    for fixed in (marks, *pool.q_proj.parameters(), *pool.k_proj.parameters()):
        fixed.requires_grad_(False)


def export(student: Student, weights: dict[str, Tensor], folder: Path) -> None:
    """Writes ``open_clip_config.json``, ``open_clip_model.safetensors`` (fp16), ``heads.json`` and ``heads.safetensors``."""
    folder.mkdir(parents=True, exist_ok=True)
    half = {name: (w.half() if w.is_floating_point() else w).contiguous() for name, w in weights.items()}
    for prefix, name in (("clip.", "open_clip_model.safetensors"), ("heads.", "heads.safetensors")):
        part = {key.removeprefix(prefix): w.clone() for key, w in half.items() if key.startswith(prefix)}
        save_file(part, folder / f".{name}", metadata={"format": "pt"})
        (folder / f".{name}").chmod(0o644)
        os.replace(folder / f".{name}", folder / name)
    for name, content in (
        ("open_clip_config.json", {"model_cfg": student.config, "preprocess_cfg": PREPROCESS}),
        ("heads.json", student.heads.names),
    ):
        temporary = folder / f".{name}"
        temporary.write_text(json.dumps(content, indent=1) + "\n")
        os.replace(temporary, folder / name)
