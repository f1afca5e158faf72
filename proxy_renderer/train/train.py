# SPDX-License-Identifier: Apache-2.0
"""The training loop: resumable bit for bit, logged, and worth exporting at any time.

The learning rate only warms up, and an average of the weights is kept, so that a sitting can end at any
step; the last one is best run with a lower rate.
"""

import copy
import json
import os
import time
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import asdict, dataclass
from pathlib import Path

import torch

from . import bank as banks
from . import captions, shader
from .data import LOOKS, Batch, make_batch
from .model import CONFIG, Student, export


@dataclass
class Recipe:
    """How to train.

    Attributes:
        groups: Groups of `LOOKS` pictures per batch.
        rate: Peak learning rate.
        warmup: Steps until it is reached.
        average: Steps over which weights are averaged.
        heads: Weight of the attributes read off pictures.
        words: Weight of the attributes read off captions.
        seed: Of the weights and of every batch.
        save: Steps between checkpoints.
    """

    groups: int = 20
    rate: float = 1.5e-3
    warmup: int = 150
    average: int = 250
    heads: float = 3.0
    words: float = 0.3
    seed: int = 0
    save: int = 50


class Trainer:
    """Everything that a sitting needs and a checkpoint keeps."""

    def __init__(
        self,
        recipe: Recipe,
        bank: dict,
        device: torch.device,
        config: dict = CONFIG,
        shade: shader.Shade = shader.shade,
    ) -> None:
        self.recipe, self.bank, self.device, self.step = recipe, bank, device, 0
        self._shade = shade
        torch.manual_seed(recipe.seed)
        self.student = Student(config)
        self.student.forget_unseen(captions.samples(8000, recipe.seed))
        self.student.to(device)
        self.average = copy.deepcopy(self.student.state_dict())
        decayed = [p for n, p in self.student.named_parameters() if p.ndim > 1 and "embedding" not in n]
        other = [p for n, p in self.student.named_parameters() if p.ndim <= 1 or "embedding" in n]
        self._maker, self._ahead = ThreadPoolExecutor(1), dict[int, Future[Batch]]()
        groups = [{"params": decayed, "weight_decay": 0.05}, {"params": other, "weight_decay": 0.0}]
        self.optimizer = torch.optim.AdamW(groups, lr=recipe.rate, betas=(0.9, 0.98), fused=True)

    def advance(self) -> dict[str, float]:
        """One step on the batch that belongs to it; returns its losses."""
        recipe = self.recipe
        batch = self._batch()
        for group in self.optimizer.param_groups:
            group["lr"] = recipe.rate * min(1.0, (self.step + 1) / recipe.warmup)
        self.student.train()
        losses = self.student.losses(batch, self.device)
        total = losses["contrast"] + recipe.heads * losses["heads"] + recipe.words * losses["words"]
        self.optimizer.zero_grad()
        total.backward()
        torch.nn.utils.clip_grad_norm_(self.student.parameters(), 1.0)
        self.optimizer.step()
        self.step += 1
        self._average()
        return {name: round(value.item(), 4) for name, value in losses.items()}

    def _batch(self) -> Batch:
        """The batch of this step; the next one is made meanwhile."""
        ahead = {
            step: self._ahead.get(step) or self._maker.submit(self._make, step)
            for step in (self.step, self.step + 1)
        }
        self._ahead = ahead
        return ahead[self.step].result()

    def _make(self, step: int) -> Batch:
        seed = self.recipe.seed * 1_000_003 + step
        return make_batch(self.bank, self.recipe.groups, seed, shade=self._shade, device=self.device)

    @torch.no_grad()
    def _average(self) -> None:
        share = max(1 / self.recipe.average, 1 / (1 + self.step))
        for name, value in self.student.state_dict().items():
            if value.is_floating_point():
                self.average[name].lerp_(value, share)
            else:
                self.average[name].copy_(value)

    def save(self, path: Path) -> None:
        """Writes a checkpoint; a crash leaves the old one."""
        state = {"step": self.step, "student": self.student.state_dict(), "average": self.average,
                 "optimizer": self.optimizer.state_dict(), "config": self.student.config, "recipe": asdict(self.recipe)}  # fmt: skip
        temporary = path.with_suffix(".part")
        torch.save(state, temporary)
        os.replace(temporary, path)

    def load(self, path: Path) -> None:
        """Goes on from a checkpoint of the same architecture."""
        state = torch.load(path, map_location=self.device, weights_only=True)
        self.student.load_state_dict(state["student"])
        self.average = state["average"]
        self.optimizer.load_state_dict(state["optimizer"])
        self.step = state["step"]

    def export(self, folder: Path) -> None:
        """Writes the averaged weights as an open_clip folder."""
        export(self.student, {name: w.cpu() for name, w in self.average.items()}, folder)


def train(recipe: Recipe, bank_folder: Path, out: Path, minutes: float, device: torch.device) -> Trainer:
    """Trains for some minutes into ``out``: ``checkpoint.pt`` and ``log.jsonl``; goes on where it stopped."""
    out.mkdir(parents=True, exist_ok=True)
    trainer = Trainer(recipe, banks.load(bank_folder), device, shade=shader.fused())
    if (out / "checkpoint.pt").exists():
        trainer.load(out / "checkpoint.pt")
        print(f"goes on at step {trainer.step}", flush=True)
    started, last = time.monotonic(), time.monotonic()
    while time.monotonic() - started < 60 * minutes:
        losses = trainer.advance()
        if trainer.step % 10 == 0:
            now = time.monotonic()
            speed = 10 * recipe.groups * LOOKS / (now - last)
            last = now
            row = {
                "step": trainer.step,
                "pictures": trainer.step * recipe.groups * LOOKS,
                "per_second": round(speed, 1),
                **losses,
            }
            with (out / "log.jsonl").open("a") as log:
                log.write(json.dumps(row) + "\n")
        if trainer.step % recipe.save == 0:
            trainer.save(out / "checkpoint.pt")
    trainer.save(out / "checkpoint.pt")
    return trainer
