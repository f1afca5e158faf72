# SPDX-License-Identifier: Apache-2.0
"""A bank of real Cycles pictures with labels: a share of training, and what the encoder is tested on.

Every second picture is the one before it with one attribute changed, so that flips can be told apart here too.
"""

from __future__ import annotations

import json
import os
import random
import shutil
import subprocess
import sys
from collections import deque
from pathlib import Path
from typing import Any

import numpy as np
import torch
from PIL import Image
from torch import Tensor

from lab.heads.attributes import ATTRIBUTES
from lab.train.pictures import looks, visible
from lab.train.pictures.bank import SIDES
from lab.train.pictures.shapes import shape
from lab.train.pictures.surfaces import bent
from proxy_renderer.blender.launch import environment, events
from proxy_renderer.schema import VibeError
from proxy_renderer.schema.orbit import frame

SAMPLES = 24
_TWINNED = ("subject_finish", "subject_metal", "light_softness")
"""Attributes that a picture may hide: without a traced view, only a twin that differs shows that it does not."""
_SOFT, _HARD = 4.0, 0.12
"""Edges of a softbox and of a lamp, at five meters."""


def build(folder: Path, pairs: int, first_seed: int, size: int, samples: int = SAMPLES) -> None:
    """Renders pairs of pictures, of a procedural shape each, and moves the bank into place when it is whole.

    Args:
        folder: Where ``pictures.npy`` (N, 3, H, W), ``masks.npy`` (N, H, W), both of bytes, ``labels.npy`` (N, A) and
            ``flipped.npy`` (N,) come to lie.
        first_seed: Of the first shape and look.
        size: Side of a picture in pixels.
        samples: Of Cycles, in a pixel.

    Raises:
        VibeError: Blender rendered nothing.
    """
    part = folder.with_name(folder.name + ".part")
    shutil.rmtree(part, ignore_errors=True)
    part.mkdir(parents=True)
    rows: list[dict[str, Any]] = []
    for seed in range(first_seed, first_seed + pairs):
        rows += _pair(part, seed, size, samples)
    plain = [{k: v for k, v in row.items() if not isinstance(v, Tensor)} for row in rows]
    (part / "looks.json").write_text(json.dumps(plain), encoding="utf-8")
    rendered = _render(part)
    whole = [
        row
        for a in range(0, len(rows), 2)
        for row in rows[a : a + 2]
        if {rows[a]["name"], rows[a + 1]["name"]} <= rendered
    ]
    if not whole:
        raise VibeError("Blender rendered no training pictures.", "Run `vibe doctor`.")
    _collect(part, whole)
    shutil.rmtree(folder, ignore_errors=True)
    os.replace(part, folder)


def load(folder: Path) -> dict[str, np.ndarray]:
    """The bank's arrays by name."""
    return {path.stem: np.load(path) for path in sorted(folder.glob("*.npy"))}


def _render(folder: Path) -> set[str]:
    """Runs Blender's side; the names of what it made."""
    with subprocess.Popen(
        [sys.executable, "-m", "lab.blender.pictures", str(folder)],
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL,
        encoding="utf-8", errors="replace", env=environment(),
    ) as process:  # fmt: skip
        try:
            return {event["name"] for event in events(process, deque(maxlen=40)) if event["type"] == "scene"}
        except BaseException:
            process.kill()
            raise


def _pair(folder: Path, seed: int, size: int, samples: int) -> list[dict[str, Any]]:
    """A look and the same with one attribute flipped, as rows for Blender; the mesh is written beside them."""
    generator, dice = torch.Generator().manual_seed(seed), random.Random(seed)
    base = looks.sample_classes(1, generator)
    attribute = looks.sample_flips((1, 1), generator)[0]
    flipped = looks.swap(base) if dice.random() < 0.15 else looks.flip(base, attribute, generator)
    noise = torch.rand(1, looks.NOISE, generator=generator)
    subject, turn = shape(seed), np.array(frame(dice.uniform(0, 360), 90.0))
    mesh = f"{seed}.npz"
    np.savez(folder / mesh, triangles=subject.triangles @ turn.T, normals=subject.normals @ turn.T)
    view = {
        "size": size, "samples": samples, "mesh": mesh, "elevation": dice.uniform(2, 35), "fov": dice.uniform(22, 50),
        "fill": dice.uniform(0.55, 0.95), "stage": dice.choice(("none", "floor", "cove", "cove")), "radius": dice.uniform(5, 9),
        "transform": "AgX" if dice.random() < 0.6 else "Standard", "spread": [dice.uniform(-1, 1), dice.uniform(-1, 1)],
        "bent": bent(subject),
    }  # fmt: skip
    kinds = (-1, -2 if torch.equal(flipped, looks.swap(base)) else int(attribute))
    return [
        {"name": f"{seed}-{k}", "classes": classes[0], "flipped": kind, "noise": noise[0], **view, **_numbers(classes, noise, view)}
        for k, (classes, kind) in enumerate(zip((base, flipped), kinds, strict=True))
    ]  # fmt: skip


def _numbers(classes: Tensor, noise: Tensor, view: dict[str, Any]) -> dict[str, Any]:
    """The look of `looks.parameters` as Blender's numbers."""
    look = {name: value[0] for name, value in looks.parameters(classes, noise).items()}

    def one(name: str) -> float:
        return float(look[name])

    side = ATTRIBUTES["light_side"][int(classes[0, looks.INDEX["light_side"]])]
    azimuth, turn, elevation, tilt = SIDES[side]
    key, ambient = look["key"], look["ambient"]
    bare = view["stage"] == "none"
    return {
        "color": look["subject"].tolist(), "roughness": one("roughness"), "metallic": one("metal"), "specular": one("specular") / 0.08,
        "ground": look["surroundings"].tolist(), "world": (look["world"] if bare else ambient).tolist(),
        "light_azimuth": azimuth + turn * view["spread"][0], "light_elevation": elevation + tilt * view["spread"][1],
        "light": 1.3 * float(key.max()), "light_color": (key / key.max()).tolist(), "light_size": _SOFT if one("soft") > 0.5 else _HARD,
        "fog": one("fog") if one("fog") > 1e-3 else 0.0, "fog_color": look["fog_color"].clamp(0, 1).tolist(),
        "film": {
            "exposure": float(np.log2(one("exposure"))), "contrast": min(max(one("contrast"), 0.5), 2.0),
            "saturation": min(one("saturation"), 2.0), "vignette": one("vignette"),
        },
    }  # fmt: skip


def _collect(folder: Path, rows: list[dict[str, Any]]) -> None:
    """Turns the rendered files into the bank's arrays, with the labels that the pictures bear out."""

    def read(name: str, mode: str) -> np.ndarray:
        with Image.open(folder / name) as picture:
            return np.asarray(picture.convert(mode))

    pictures = np.stack([read(f"{row['name']}.png", "RGB").transpose(2, 0, 1) for row in rows])
    masks = np.stack([read(f"{row['name']}.mask.png", "L") for row in rows])
    classes = torch.stack([row["classes"] for row in rows])
    look = looks.parameters(classes, torch.stack([row["noise"] for row in rows]))
    bare = torch.tensor([row["stage"] == "none" for row in rows])
    look["ambient"] = torch.where(bare[:, None], look["world"], look["ambient"])
    flipped = torch.tensor([row["flipped"] for row in rows])
    labels = _borne_out(classes, look, torch.from_numpy(pictures), torch.from_numpy(masks > 127), flipped)
    faceted = torch.tensor([row["bent"] <= visible.MIN_CURVED for row in rows])
    labels[faceted, looks.INDEX["subject_finish"]] = looks.UNKNOWN
    for name, values in (
        ("pictures", pictures),
        ("masks", masks),
        ("labels", labels.numpy()),
        ("flipped", flipped.numpy()),
    ):
        np.save(folder / f"{name}.npy", values)
    for file in (*folder.glob("*.png"), *folder.glob("*.npz")):
        file.unlink()


def _borne_out(classes: Tensor, look: dict[str, Tensor], pictures: Tensor, masks: Tensor, flipped: Tensor) -> Tensor:
    """The classes (N, A) that pairs of pictures (N, 3, H, W) of bytes show."""
    display = pictures.float() / 255
    labels = visible.visible_classes(classes, look, display, masks).unflatten(0, (-1, 2))
    kinds = flipped.view(-1, 2)
    labels = visible.drop_unnoticed(display.unflatten(0, (-1, 2)), masks[::2], labels, kinds)
    for name in _TWINNED:
        labels[kinds[:, 1] != looks.INDEX[name], :, looks.INDEX[name]] = looks.UNKNOWN
    return labels.flatten(0, 1)
