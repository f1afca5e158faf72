# SPDX-License-Identifier: Apache-2.0
"""The dual encoder in training, and its export to a folder that open_clip loads like any other model."""

import json
import os
from pathlib import Path

import torch
import torch.nn.functional as F
from open_clip import SimpleTokenizer
from open_clip.model import CLIP
from safetensors.torch import save_file
from torch import Tensor, nn

from ..guidance import network  # noqa: F401 - makes timm know our picture tower
from ..guidance.encoder import AttributeHeads
from ..language.attributes import ATTRIBUTES
from .data import LOOKS, Batch, contradicts

CONFIG = {
    "embed_dim": 192,
    "vision_cfg": {"image_size": 160, "timm_model_name": "vibe_resnet", "timm_pool": "", "timm_proj": ""},
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
        self.clip.visual.to(memory_format=torch.channels_last)

    def forget_unseen(self, captions: list[str]) -> None:
        """Zeroes the embeddings of tokens that these captions lack: they stay zero, and compress well."""
        seen = torch.unique(self.tokenizer(captions))
        keep = torch.zeros(self.config["text_cfg"]["vocab_size"], 1)
        keep[seen] = 1
        with torch.no_grad():
            self.clip.token_embedding.weight.mul_(keep.to(self.clip.token_embedding.weight))

    def losses(self, batch: Batch, device: torch.device) -> dict[str, Tensor]:
        """Contrast between pictures and captions, and attributes read off pictures and off captions.

        The captions of half of the groups are left unread: words cost a third of a step and are learned sooner.
        """
        mean, std = (torch.tensor(PREPROCESS[key], device=device)[:, None, None] for key in ("mean", "std"))
        pictures = ((batch.pictures.to(device) - mean) / std).to(memory_format=torch.channels_last)
        read = len(batch.captions) // (2 * LOOKS) * LOOKS or len(batch.captions)
        tokens = self.tokenizer(batch.captions[:read]).to(device)
        with torch.autocast(device.type, torch.bfloat16):
            image = self.clip.encode_image(pictures)
            text = self.clip.encode_text(tokens)
        image, text = F.normalize(image.float(), dim=-1), F.normalize(text.float(), dim=-1)
        labels, mentioned = batch.labels.to(device), batch.mentioned[:read].to(device)
        logits = self.clip.logit_scale.exp().clamp(max=60) * image[:read] @ text.T
        own = torch.arange(read, device=device)
        rival = contradicts(labels[:read], mentioned) | (own[:, None] == own)
        logits = logits.masked_fill(~rival, float("-inf"))
        speaks = (mentioned >= 0).any(1)
        return {
            "contrast": (
                F.cross_entropy(logits[speaks], own[speaks]) + F.cross_entropy(logits.T[speaks], own[speaks])
            )
            / 2,
            "heads": self.heads.loss(image, labels),
            "words": self.heads.loss(text, mentioned.masked_fill(mentioned < 0, -100)),
        }


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
