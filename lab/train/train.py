# SPDX-License-Identifier: Apache-2.0
"""The training loop: resumable bit for bit, logged, and worth exporting at any time.

An average of the weights is kept, and towards the end of each sitting the learning rate falls, so that every sitting
ends with weights worth having.
"""

import copy
import json
import math
import time
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import asdict, dataclass
from pathlib import Path

import torch

from lab.train.data import Batch, make_batch
from lab.train.model import CONFIG, Student, export
from lab.train.pictures import bank as banks
from lab.train.pictures import cycles, shader
from lab.train.text import captions
from lab.train.text.wording import GUIDES, WordingSplit
from proxy_renderer.schema import VibeError, atomic

_LOGGED = 50
_FALLS = 0.15
"""From this share of a sitting on the learning rate falls."""


@dataclass
class TrainingRecipe:
    """Settings of the training.

    Attributes:
        groups: Groups of `LOOKS` pictures per batch.
        rate: Peak learning rate.
        warmup: Steps until it is reached.
        average: Steps over which weights are averaged.
        heads: Weight of the attributes read off pictures.
        words: Weight of the attributes read off captions.
        dense: Weight of the maps read off the grid of features.
        split: Which wordings and shapes are kept back; another number for an encoder that judges this one.
        seed: Of the weights and of every batch.
        save: Steps between checkpoints.
    """

    groups: int = 12
    rate: float = 1.5e-3
    warmup: int = 200
    average: int = 400
    heads: float = 8.0
    words: float = 1.0
    dense: float = 5.0
    split: int = GUIDES
    seed: int = 0
    save: int = 100


class Trainer:
    """Everything that a sitting needs and a checkpoint keeps."""

    def __init__(
        self,
        recipe: TrainingRecipe,
        bank: dict,
        device: torch.device,
        config: dict = CONFIG,
        shade: shader.Shade = shader.shade,
        real: dict | None = None,
    ) -> None:
        self.recipe, self.bank, self.device = recipe, bank, device
        self.step = self.pictures = 0
        self._shade, self._real = shade, real
        torch.manual_seed(recipe.seed)
        self.split = WordingSplit(recipe.split)
        self.student = Student(config, captions.samples(8000, recipe.split, self.split)).to(device)
        self.average = copy.deepcopy(self.student.state_dict())
        decayed = [p for n, p in self.student.named_parameters() if p.ndim > 1 and "embedding" not in n]
        other = [p for n, p in self.student.named_parameters() if p.ndim <= 1 or "embedding" in n]
        self._maker, self._ahead = ThreadPoolExecutor(1), dict[int, Future[Batch]]()
        groups = [{"params": decayed, "weight_decay": 0.05}, {"params": other, "weight_decay": 0.0}]
        self.optimizer = torch.optim.AdamW(groups, lr=recipe.rate, betas=(0.9, 0.98), fused=True)

    def advance(self, share: float = 1.0) -> dict[str, float]:
        """One step on the batch that belongs to it, at a share of the rate; returns its losses."""
        recipe = self.recipe
        batch = self._batch()
        for group in self.optimizer.param_groups:
            group["lr"] = share * recipe.rate * min(1.0, (self.step + 1) / recipe.warmup)
        self.student.train()
        losses = self.student.losses(batch, self.device)
        weights = {"heads": recipe.heads, "words": recipe.words, "dense": recipe.dense}
        total = torch.stack([weights.get(name, 1.0) * value for name, value in losses.items()]).sum()
        self.optimizer.zero_grad()
        total.backward()
        torch.nn.utils.clip_grad_norm_(self.student.parameters(), 1.0)
        self.optimizer.step()
        self.step += 1
        self.pictures += len(batch.pictures)
        self._average()
        return {name: round(value.item(), 4) for name, value in losses.items()}

    def _batch(self) -> Batch:
        """The batch of this step; the next one is made meanwhile."""
        ahead = {
            step: self._ahead.get(step) or self._maker.submit(self._make, step) for step in (self.step, self.step + 1)
        }
        self._ahead = ahead
        return ahead[self.step].result()

    def _make(self, step: int) -> Batch:
        seed = self.recipe.seed * 1_000_003 + step
        return make_batch(
            self.bank,
            self.recipe.groups,
            seed,
            shade=self._shade,
            device=self.device,
            split=self.split,
            size=self.student.config["vision_cfg"]["image_size"],
            real=self._real,
        )

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
        state = {"step": self.step, "pictures": self.pictures, "student": self.student.state_dict(), "average": self.average,
                 "optimizer": self.optimizer.state_dict(), "config": self.student.config, "recipe": asdict(self.recipe)}  # fmt: skip
        with atomic.replacing(path) as part:
            torch.save(state, part)

    def load(self, path: Path) -> None:
        """Goes on from a checkpoint of the same architecture and vocabulary.

        Raises:
            VibeError: It is of another one.
        """
        state = torch.load(path, map_location=self.device, weights_only=True)
        try:
            self.student.load_state_dict(state["student"])
        except RuntimeError as error:
            raise VibeError(
                f"{str(path)!r} was made with another architecture or vocabulary.",
                "Train in a new --out, with --from its model folder to keep what it has learned.",
            ) from error
        self.average = state["average"]
        self.optimizer.load_state_dict(state["optimizer"])
        self.step, self.pictures = state["step"], state["pictures"]

    def start_from(self, folder: Path) -> None:
        """Takes over the weights of an exported model of the same architecture; its words may differ.

        Raises:
            VibeError: If the architecture is another one.
        """
        self.student.load_export(folder)
        self.average = copy.deepcopy(self.student.state_dict())

    def export(self, folder: Path) -> None:
        """Writes the averaged weights as an open_clip folder."""
        export(self.student, {name: w.cpu() for name, w in self.average.items()}, folder)


def train(
    recipe: TrainingRecipe,
    bank_folder: Path,
    out: Path,
    minutes: float,
    device: torch.device,
    config: dict = CONFIG,
    start: Path | None = None,
) -> Trainer:
    """Trains for some minutes into ``out``: ``checkpoint.pt`` and ``log.jsonl``; goes on where it stopped.

    Args:
        bank_folder: Traced views; ``out/cycles``, where it is, adds Cycles pictures.
        start: A model's folder, to go on from where there is no checkpoint.
    """
    out.mkdir(parents=True, exist_ok=True)
    real = cycles.load(out / "cycles") if (out / "cycles").exists() else None
    trainer = Trainer(recipe, banks.load(bank_folder), device, config, shader.fused(), real)
    if (out / "checkpoint.pt").exists():
        trainer.load(out / "checkpoint.pt")
        print(f"goes on at step {trainer.step}", flush=True)
    elif start:
        trainer.start_from(start)
        print(f"goes on from {start}", flush=True)
    started, seconds, counted = time.monotonic(), 60 * minutes, trainer.pictures
    last = started
    while (done := (time.monotonic() - started) / seconds) < 1:
        losses = trainer.advance(_share(done))
        if trainer.step % _LOGGED == 0:
            now = time.monotonic()
            speed = (trainer.pictures - counted) / (now - last)
            last, counted = now, trainer.pictures
            row = {
                "step": trainer.step,
                "pictures": trainer.pictures,
                "per_second": round(speed, 1),
                **losses,
                "right": {name: round(r / max(n, 1), 3) for name, (r, n) in trainer.student.tally.items()},
            }
            trainer.student.tally = {name: [0, 0] for name in trainer.student.tally}
            with (out / "log.jsonl").open("a") as log:
                log.write(json.dumps(row) + "\n")
        if trainer.step % recipe.save == 0:
            trainer.save(out / "checkpoint.pt")
    trainer.save(out / "checkpoint.pt")
    return trainer


def _share(done: float) -> float:
    """The share of the learning rate after a share of the sitting: whole, then half a cosine down to a fiftieth."""
    late = max(0.0, (done - _FALLS) / (1 - _FALLS))
    return 0.02 + 0.98 * 0.5 * (1 + math.cos(math.pi * late))
