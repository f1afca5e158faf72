# SPDX-License-Identifier: Apache-2.0
"""The sentence encoder all-MiniLM-L6-v2, from its files alone: vectors of words and glosses."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import torch
import torch.nn.functional as F


class MiniLM:
    """The sentence encoder: BERT with six layers, mean pooling, unit vectors of 384."""

    def __init__(self, folder: Path) -> None:
        from safetensors.torch import load_file
        from tokenizers import Tokenizer

        self._w = {k.removeprefix("bert."): v.float() for k, v in load_file(folder / "model.safetensors").items()}
        self._tokens = Tokenizer.from_file(str(folder / "tokenizer.json"))
        self._tokens.enable_truncation(48)
        self._tokens.no_padding()

    @torch.no_grad()
    def encode(self, texts: list[str]) -> np.ndarray:
        """(N, 384) unit vectors."""
        vectors = np.zeros((len(texts), 384), np.float32)
        ids = [e.ids for e in self._tokens.encode_batch(texts)]
        order = sorted(range(len(ids)), key=lambda i: len(ids[i]))
        for start in range(0, len(order), 256):
            batch = order[start : start + 256]
            longest = max(len(ids[i]) for i in batch)
            tokens = torch.tensor([ids[i] + [0] * (longest - len(ids[i])) for i in batch])
            lengths = torch.tensor([len(ids[i]) for i in batch])
            vectors[batch] = self._forward(tokens, lengths).numpy()
        return vectors

    def _forward(self, tokens: torch.Tensor, lengths: torch.Tensor) -> torch.Tensor:
        w, count = self._w, tokens.shape[1]
        used = torch.arange(count)[None] < lengths[:, None]
        x = w["embeddings.word_embeddings.weight"][tokens] + w["embeddings.position_embeddings.weight"][:count]
        x = self._norm(x + w["embeddings.token_type_embeddings.weight"][0], "embeddings.LayerNorm")
        for layer in range(6):
            at = f"encoder.layer.{layer}."
            q, k, v = (
                self._dense(x, at + f"attention.self.{n}").unflatten(-1, (12, 32)).transpose(1, 2)
                for n in ("query", "key", "value")
            )
            attended = F.scaled_dot_product_attention(q, k, v, attn_mask=used[:, None, None])
            mixed = self._dense(attended.transpose(1, 2).flatten(2), at + "attention.output.dense")
            x = self._norm(x + mixed, at + "attention.output.LayerNorm")
            more = self._dense(F.gelu(self._dense(x, at + "intermediate.dense")), at + "output.dense")
            x = self._norm(x + more, at + "output.LayerNorm")
        mean = (x * used[..., None]).sum(1) / lengths[:, None]
        return F.normalize(mean, dim=-1)

    def _dense(self, x: torch.Tensor, name: str) -> torch.Tensor:
        return F.linear(x, self._w[name + ".weight"], self._w[name + ".bias"])

    def _norm(self, x: torch.Tensor, name: str) -> torch.Tensor:
        return F.layer_norm(x, (384,), self._w[name + ".weight"], self._w[name + ".bias"], 1e-12)
