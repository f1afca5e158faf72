# SPDX-License-Identifier: Apache-2.0
"""One task: its scene and its picture are made, the scene is vibed, and the result is compared with the truth."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import astuple, dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch
from PIL import Image

from lab.bench import blender
from lab.bench.like import flat, values
from lab.bench.like.tasks import HiddenLook, LikeTask
from lab.bench.metrics import difference
from lab.bench.wild import product
from proxy_renderer.schema import atomic

WORDS = "warm light, thin fog"
"""Prompt for the comparison of times."""
TOLD = "Reinhard, told the truth"
"""The truth itself after transfer between flat pictures: no picture of another scene tells its tones better."""


@dataclass(frozen=True)
class LikeTrial:
    """A task to be carried out.

    Attributes:
        task: What.
        out: The measurement's folder; what has been made in it is not made again.
        size: Longer side of the pictures, pixels.
        samples: Of Cycles.
        effort: As for `vibe run`.
        words: Whether a scene of *recovery* is vibed in words as well, to compare the time.
    """

    task: LikeTask
    out: Path
    size: int
    samples: int
    effort: str = "standard"
    words: bool = False

    @property
    def folder(self) -> Path:
        """Folder of this task; named by all that it depends on."""
        return self.out / "runs" / _name(self.task.name, *astuple(self.task), self.size, self.samples, self.effort)

    def row(self) -> dict[str, Any]:
        """Its result."""
        made, scene = self._made(self.task.truth)
        picture = self._picture()
        options = ["--vlm-model=off", f"--effort={self.effort}", *(f"--subject={name}" for name in made["subject"])]
        options += [f"--size={self.size}", f"--samples={self.samples}"]
        like = [f"--like={picture.resolve()}", *self.task.options]
        ended = product.vibe_once(scene / "scene.blend", "", self.folder, [*options, *like])
        row = {"task": self.task.name, "part": self.task.part, "run": self.folder.name, **ended}
        if ended["code"] != 0:
            return row
        row |= self._figures(made, scene, picture)
        if self.words and self.task.part == "recovery":  # the same scene and as many pixels
            timed = product.vibe_once(scene / "scene.blend", WORDS, self._timed(scene), options)
            row["words_seconds"] = timed["seconds"]
        return row

    def pictures(self) -> dict[str, Path]:
        """The pictures to look at, by what they are called; those that there are."""
        shown, truth = self._picture(), self._truth(self._scene(self.task.truth))
        named = {"given": shown, "before": self.folder / "out" / "before.png"}
        named["after"] = self.folder / "out" / "after.png"
        if truth != shown:
            named["truth"] = truth
        flattened = sorted(self.folder.glob("flat_*.png"))
        named |= {path.stem.removeprefix("flat_"): path for path in flattened}
        return {name: path for name, path in named.items() if path.is_file()}

    def _figures(self, made: Mapping[str, Any], scene: Path, picture: Path) -> dict[str, Any]:
        before, after = (_read(self.folder / "out" / f"{name}.png") for name in ("before", "after"))
        truth, shown = _read(self._truth(scene)), _read(picture)
        rivals = flat.matched(before, shown)
        for name, rival in rivals.items():
            Image.fromarray((255 * rival).round().astype(np.uint8)).save(self.folder / f"flat_{name}.png")
        report = json.loads((self.folder / "out" / "report.json").read_text("utf-8"))
        entries = {"before": before, "after": after, **rivals}
        if self.task.part == "transfer":
            entries[TOLD] = flat.reinhard(before, truth).clip(0.0, 1.0)
        return {
            "differences": {name: _apart(each, truth) for name, each in entries.items()},
            "errors": values.key_light_errors(made, values.found_in(report)),
            "errors_before": values.key_light_errors(made, {}),
            "loop_seconds": report["timings"]["engine: loop"],
        }

    def _scene(self, look: HiddenLook) -> Path:
        return self.out / "scenes" / _name(look.set, *astuple(look), self.size, self.samples)

    def _made(self, look: HiddenLook) -> tuple[dict[str, Any], Path]:
        """Blender's report of a scene and a look, and their folder."""
        folder = self._scene(look)
        told = folder / "made.json"
        if not told.is_file():
            folder.mkdir(parents=True, exist_ok=True)
            groups = ",".join(look.groups) or "none"
            made = blender.command("like", look.set, folder, look.seed, groups, self.size, self.samples)
            atomic.write_text(told, json.dumps(made))
        content: dict[str, Any] = json.loads(told.read_text("utf-8"))
        return content, folder

    def _picture(self) -> Path:
        """The picture that is given."""
        _, folder = self._made(self.task.shown)
        if not self.task.photo_filter:
            return folder / "goal.png"
        path = self.folder / "given.png"
        if not path.is_file():
            self.folder.mkdir(parents=True, exist_ok=True)
            with Image.open(folder / "goal.png") as plain:
                flat.filtered(plain.convert("RGB"), self.task.photo_filter).save(path)
        return path

    def _truth(self, scene: Path) -> Path:
        return self._picture() if self.task.photo_filter else scene / "goal.png"

    def _timed(self, scene: Path) -> Path:
        """Folder of the vibe in words of the same scene, which tasks share."""
        return self.out / "words" / f"{scene.name}-{self.effort}"


def _name(readable: str, *depends: Any) -> str:
    """A folder's name from what its content depends on."""
    mark = hashlib.sha256(json.dumps(depends, default=list).encode()).hexdigest()[:12]
    return f"{readable.replace(' ', '_')}-{mark}"


def _read(path: Path) -> np.ndarray:
    """(H, W, 3) in [0, 1]."""
    with Image.open(path) as picture:
        return np.asarray(picture.convert("RGB"), np.float32) / 255


def _apart(picture: np.ndarray, truth: np.ndarray) -> dict[str, float]:
    """Mean CIEDE2000, and a hundred times the mean squared error of sRGB in [0, 1]."""
    apart = difference(torch.from_numpy(picture), torch.from_numpy(truth))
    mse = 100 * float(np.square(picture - truth).mean())
    return {"delta_e": round(apart.delta_e, 3), "mse": round(mse, 4), "ssim": round(apart.ssim, 4)}
