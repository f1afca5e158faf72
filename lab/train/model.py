# SPDX-License-Identifier: Apache-2.0
"""The dual encoder in training, and its export to a folder that open_clip loads like any other model."""

import gzip
import json
import tempfile
from itertools import pairwise
from pathlib import Path
from typing import Any

import torch
import torch.nn.functional as F
from open_clip import SimpleTokenizer
from open_clip.model import CLIP
from safetensors.torch import load_file, save_file
from torch import Tensor, nn

from lab.heads import AttributeHeads, folder_of
from lab.heads.attributes import ATTRIBUTES
from lab.judge import network as judge_network  # noqa: F401 - makes timm know the judge's picture tower
from lab.train.data import LOOKS, Batch, choices, contradicts
from lab.train.pictures.dense import MapReader
from lab.train.pictures.looks import STRESS
from proxy_renderer.guidance import encoder
from proxy_renderer.guidance.encoder import MERGES
from proxy_renderer.schema import VibeError, atomic

CONFIG = {
    "embed_dim": 128,
    "vision_cfg": {"image_size": 128, "timm_model_name": "vibe_resnet", "timm_pool": "", "timm_proj": ""},
    "text_cfg": {"context_length": 40, "width": 64, "heads": 4, "layers": 2},
}
JUDGE = {
    "embed_dim": 192,
    "vision_cfg": {"image_size": 80, "timm_model_name": "vibe_resnet_judge", "timm_pool": "", "timm_proj": ""},
    "text_cfg": {"context_length": 40, "width": 96, "heads": 4, "layers": 3},
}
"""An encoder that only ever judges results: another architecture, to be trained on other shapes, views and wordings."""
PREPROCESS = {"mean": [0.5, 0.5, 0.5], "std": [0.25, 0.25, 0.25], "interpolation": "bicubic", "resize_mode": "squash"}


class Student(nn.Module):
    """open_clip's CLIP, the attribute heads that share its features, and the reader of dense maps.

    Args:
        config: open_clip's model configuration, without the size of the vocabulary.
        captions: Sentences that hold every word of training; the vocabulary is made of their parts.
    """

    def __init__(self, config: dict, captions: list[str]) -> None:
        super().__init__()
        length = config["text_cfg"]["context_length"]
        self.merges = merges(captions, length)
        with tempfile.TemporaryDirectory() as folder:
            self.tokenizer = SimpleTokenizer(_write_merges(self.merges, Path(folder)), context_length=length)
        self.config = config | {"text_cfg": config["text_cfg"] | {"vocab_size": self.tokenizer.vocab_size}}
        self.clip = CLIP(config["embed_dim"], config["vision_cfg"], self.config["text_cfg"])
        self.heads = AttributeHeads(config["embed_dim"], {name: list(c) for name, c in ATTRIBUTES.items()})
        last, channels = _last_grid(self.clip.visual)
        self.dense = MapReader(last, channels)
        self._forget_unseen(captions)
        self.clip.visual.to(memory_format=torch.channels_last)
        self.tally = {name: [0, 0] for name in ATTRIBUTES}
        """Attribute name → how often its head was right, and asked, since somebody last cleared it."""

    def _forget_unseen(self, captions: list[str]) -> None:
        """Zeroes the embeddings of tokens that these captions lack: an unknown word then says nothing."""
        used = torch.unique(self.tokenizer(captions))
        keep = torch.zeros(self.tokenizer.vocab_size, 1)
        keep[used] = 1
        with torch.no_grad():
            self.clip.token_embedding.weight.mul_(keep)

    def load_export(self, folder: Path) -> None:
        """Takes over an exported model's weights, word by word, whatever size its pictures had.

        Raises:
            VibeError: If its architecture is another one.
        """
        if not (folder / "open_clip_config.json").is_file():
            raise VibeError(
                f"There is no exported model in {str(folder)!r}.", "Leave --from out to start from nothing."
            )
        config = json.loads((folder / "open_clip_config.json").read_text())["model_cfg"]
        own, theirs = (
            c | {"text_cfg": c["text_cfg"] | {"vocab_size": 0}, "vision_cfg": c["vision_cfg"] | {"image_size": 0}}
            for c in (self.config, config)
        )
        if own != theirs or not (folder / MERGES).is_file():
            raise VibeError(
                f"The model in {str(folder)!r} has another architecture than the one to be trained.",
                "Leave --from out to start from nothing.",
            )
        weights = {
            prefix + key: value.float()
            for prefix, path in (
                ("clip.", folder / "open_clip_model.safetensors"),
                ("heads.", folder_of(folder) / "heads.safetensors"),
            )
            for key, value in load_file(path).items()
        }
        token_ids = SimpleTokenizer(str(folder / MERGES)).encoder
        rows = self.clip.token_embedding.weight.detach().clone()
        for token, row in self.tokenizer.encoder.items():
            if token in token_ids:
                rows[row] = weights["clip.token_embedding.weight"][token_ids[token]]
        weights["clip.token_embedding.weight"] = rows
        left = self.load_state_dict(weights, strict=False)
        assert not left.unexpected_keys, left

    def losses(self, batch: Batch, device: torch.device) -> dict[str, Tensor]:
        """Contrast between pictures and captions, choices of phrases, and attributes read off pictures and off captions.

        The captions of two thirds of the groups are left unread: words are costly and are learned sooner.

        Args:
            batch: From `data.make_batch`.

        Returns:
            Each term by name, a scalar that is not weighted yet.
        """
        mean, std = (torch.tensor(PREPROCESS[key], device=device)[:, None, None] for key in ("mean", "std"))
        pictures = ((batch.pictures.to(device) - mean) / std).to(memory_format=torch.channels_last)
        read = len(batch.captions) // (3 * LOOKS) * LOOKS or len(batch.captions)
        tokens = self.tokenizer([*batch.captions[:read], *batch.lessons]).to(device)
        with torch.autocast(device.type, torch.bfloat16):
            image = self.clip.encode_image(pictures)
            sentences = self.clip.encode_text(tokens)
        image, sentences = F.normalize(image.float(), dim=-1), F.normalize(sentences.float(), dim=-1)
        text = sentences[:read]
        labels, mentioned = batch.labels.to(device), batch.mentioned[:read].to(device)
        scale = self.clip.logit_scale.exp().clamp(max=60)
        logits = scale * image[:read] @ text.T
        own = torch.arange(read, device=device)
        rival = contradicts(labels[:read], mentioned) | (own[:, None] == own)
        logits = logits.masked_fill(~rival, float("-inf"))
        taught = batch.taught.to(device)
        claims = torch.cat([mentioned, taught])
        speaks = (mentioned >= 0).any(1)
        self._count(image.detach(), batch.labels)
        truth, weight, stress = batch.maps.to(device), batch.map_weights.to(device), STRESS.to(device)
        return {
            "dense": self.dense.loss(truth, weight),
            "contrast": (F.cross_entropy(logits[speaks], own[speaks]) + F.cross_entropy(logits.T[speaks], own[speaks]))
            / 2,
            "choice": _choice(scale * image @ sentences[read:].T, labels, taught),
            "heads": self.heads.loss(image, labels, stress),
            "words": self.heads.loss(sentences, claims.masked_fill(claims < 0, -100), stress),
        }

    @torch.no_grad()
    def _count(self, image: Tensor, labels: Tensor) -> None:
        for i, (name, logits) in enumerate(self.heads.logits(image).items()):
            labeled = labels[:, i] >= 0
            self.tally[name][0] += int((logits.argmax(1).cpu() == labels[:, i])[labeled].sum())
            self.tally[name][1] += int(labeled.sum())


def _choice(logits: Tensor, labels: Tensor, taught: Tensor) -> Tensor:
    """Pictures (B, A) choose between two lessons (L, A) about one attribute: the mean over attributes, by logits (B, L)."""
    offered, (true, false) = choices(labels, taught)
    doubt = F.softplus(logits[:, false] - logits[:, true])
    asked = offered.flatten(1).sum(1)
    each = torch.einsum("abp,bp->a", offered.float(), doubt) / asked.clamp_min(1)
    return each.sum() / (asked > 0).sum().clamp_min(1)


def _last_grid(visual: Any) -> tuple[nn.Module, int]:
    """The last module of a picture tower that puts out a grid of features, and its channels."""
    trunk = getattr(visual, "trunk", None)
    if isinstance(trunk, encoder.Tower):
        last: Any = trunk[-1]
        return trunk[-4], last.in_features // encoder.GRID**2
    return visual.layer4, visual.attnpool.positional_embedding.shape[1]


def merges(captions: list[str], length: int) -> list[str]:
    """The pair merges of open_clip's tokenizer that some captions need: a tenth of its vocabulary.

    Args:
        captions: All that the model is to read.
        length: Tokens that the model reads at most.

    Returns:
        Lines "a b" of two tokens that are merged, in the tokenizer's order.
    """
    whole = SimpleTokenizer(context_length=length)
    words = {word for caption in captions for word in whole.pat.findall(caption.lower())}
    used: set[tuple[str, str]] = set()
    for word in words:
        used |= _applied([whole.byte_encoder[byte] for byte in word.encode()], whole.bpe_ranks)
    return [" ".join(pair) for pair in sorted(used, key=whole.bpe_ranks.__getitem__)]


def _applied(letters: list[str], ranks: dict[tuple[str, str], int]) -> set[tuple[str, str]]:
    """The merges that turn the letters of one word into its tokens."""
    parts, used = [*letters[:-1], letters[-1] + "</w>"], set()
    while possible := {*pairwise(parts)} & ranks.keys():
        best = min(possible, key=ranks.__getitem__)
        used.add(best)
        merged: list[str] = []
        for part in parts:
            whole = merged and (merged[-1], part) == best
            merged[-1:] = [merged[-1] + part] if whole else [*merged[-1:], part]
        parts = merged
    return used


def _write_merges(lines: list[str], folder: Path) -> str:
    """Writes the merges as open_clip's tokenizer reads them; returns the file's path."""
    with gzip.GzipFile(folder / MERGES, "wb", mtime=0) as file:
        file.write("\n".join(["merges", *lines]).encode())
    return str(folder / MERGES)


def export(student: Student, weights: dict[str, Tensor], folder: Path) -> None:
    """Writes a folder that open_clip loads: configuration, both towers (fp16), the tokenizer's merges, and the heads.

    Args:
        student: Its configuration, merges and the heads' names.
        weights: Of the student, by name: those that are written, averaged ones as a rule.
        folder: Made if it does not exist.
    """
    folder.mkdir(parents=True, exist_ok=True)
    half = {name: (w.half() if w.is_floating_point() else w).contiguous() for name, w in weights.items()}
    for prefix, name in (("clip.", "open_clip_model.safetensors"), ("heads.", "heads.safetensors")):
        part = {key.removeprefix(prefix): w.clone() for key, w in half.items() if key.startswith(prefix)}
        with atomic.replacing(folder / name) as file:
            save_file(part, file, metadata={"format": "pt"})
            file.chmod(0o644)
    _write_merges(student.merges, folder)
    for name, content in (
        ("open_clip_config.json", {"model_cfg": student.config, "preprocess_cfg": PREPROCESS}),
        ("heads.json", student.heads.names),
    ):
        atomic.write_text(folder / name, json.dumps(content, indent=1) + "\n")
