# SPDX-License-Identifier: Apache-2.0
"""Accuracy with which an encoder reads looks off shapes that it never saw.

Every comparison is between two sentences, so chance is one half; heads are compared with the truth.
"""

import json
import random
import time
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
import trimesh
from torch import Tensor

from lab.heads import OF_SURFACES, folder_of, heads_of
from lab.heads.attributes import ATTRIBUTES
from lab.train.data import Batch, make_batch
from lab.train.pictures import bank as banks
from lab.train.pictures.looks import INDEX, NAMES
from lab.train.pictures.surfaces import Shape
from lab.train.text.captions import caption
from lab.train.text.wording import NOUNS, TRAINED, WordingSplit
from proxy_renderer.guidance import regions
from proxy_renderer.guidance.encoder import Encoder, load_encoder
from proxy_renderer.schema import atomic

_GROUPS, _BATCHES, _SEED = 48, 10, 7_000_000
_UNIFORM = 0.8
FEW = 15
"""Comparisons below which a set says nothing of an attribute."""


def evaluate(model: Path, held_out: Path, meshes: list[Path], out: Path | None = None) -> dict:
    """Judges a model on a held-out bank, and on views of meshes.

    The model's folder gets ``skill.json``: how far each attribute's head is from a blind guess (0) to
    never being wrong (1). Guidance trusts the heads by it.

    Args:
        held_out: Folder of a bank of shapes that training did not have.
        meshes: Mesh files, their y axis up; may be empty.
        out: The JSON file for the results; None for no file.

    Returns:
        ``attribute_flip`` and ``swap`` (fractions), the same per attribute and for the heads, per set of
        pictures, and ``crops_seconds``, the cost of 8 crops forward and backward.
    """
    encoder = load_encoder(str(model))
    sets = {"procedural": banks.load(held_out)}
    if meshes:
        sets["meshes"] = bank_of(meshes, next(iter(sets.values()))["kind"].shape[-1])
    results: dict = {
        "sets": {name: judge(encoder, shaded(bank)) for name, bank in sets.items()},
        "crops_seconds": cost(encoder),
    }
    results |= {key: results["sets"]["procedural"][key] for key in ("attribute_flip", "swap", "heads_mean")}
    if skills := skill(results["sets"].values()):
        _write(folder_of(model) / "skill.json", skills)
    if out:
        _write(out, results)
    return results


def skill(sets: Iterable[dict]) -> dict[str, float]:
    """Attribute -> skill in [0, 1] of its head, the worst over all sets: (right - blind) / (1 - blind).

    A set says nothing of an attribute that few of its pictures show, or nearly all in the same class.
    """
    skills: dict[str, float] = {}
    for one in sets:
        for name, right in one["heads"].items():
            blind = one["commonest"][name]
            if blind > _UNIFORM or one["comparisons"][f"heads/{name}"] < FEW:
                continue
            skills[name] = min(skills.get(name, 1.0), round(max(right - blind, 0.0) / max(1.0 - blind, 1e-6), 3))
    return skills


def _write(path: Path, content: dict) -> None:
    atomic.write_text(path, json.dumps(content, indent=1) + "\n")


@dataclass(frozen=True)
class Mistake:
    """A picture (3, H, W) that was nearer to a false sentence than to the true one."""

    picture: Tensor
    asked: str
    true: str
    false: str


Sentence = Callable[[dict[str, str], str, float], str]
"""Makes a sentence about a thing: attributes that are stated, the thing's name, and a number that fixes the wording.

"" where it has no words for them: then nothing is asked."""


def shaded(bank: dict, batches: int = _BATCHES) -> Iterator[Batch]:
    """Batches of whole pictures of a bank, the same ones every time.

    Args:
        bank: From `bank.load`.
    """
    return (make_batch(bank, _GROUPS, _SEED + k, augment=False) for k in range(batches))


def judge(
    encoder: Encoder, batches: Iterable[Batch], sentence: Sentence | None = None, mistakes: list[Mistake] | None = None
) -> dict:
    """Flip, swap and head accuracy on whole pictures; ``commonest`` is what a blind guess would score.

    Args:
        batches: Pictures; each that is not the first of a group differs from it in one attribute.
        sentence: Says attributes; by default in training's wordings.
        mistakes: Gets the comparisons that went wrong.
    """
    right: dict[str, list[bool]] = defaultdict(list)
    shown: dict[str, list[int]] = defaultdict(list)
    dice, readers = random.Random(_SEED), heads_of(encoder)
    for batch in batches:
        with torch.no_grad():
            features, framed = looks_at(encoder, batch)
            logits = readers.read(features, framed) if readers else {}
        features, framed = features.cpu(), framed.cpu()
        logits = {name: value.cpu() for name, value in logits.items()}
        for name, value in logits.items():
            labeled = batch.labels[:, INDEX[name]] >= 0
            right[f"heads/{name}"] += (value.argmax(1) == batch.labels[:, INDEX[name]])[labeled].tolist()
            shown[name] += batch.labels[labeled, INDEX[name]].tolist()
        comparisons = _comparisons(batch, dice, sentence or describe)
        if not comparisons:
            continue
        true = encoder.encode_texts([stated for _, _, stated, _ in comparisons]).cpu()
        false = encoder.encode_texts([otherwise for _, _, _, otherwise in comparisons]).cpu()
        shown_by = [
            (framed if asked.removeprefix("flip/") in OF_SURFACES else features)[picture]
            for asked, picture, _, _ in comparisons
        ]
        closer = (torch.stack(shown_by) * (true - false)).sum(1) > 0
        for (asked, picture, stated, otherwise), correct in zip(comparisons, closer.tolist(), strict=True):
            right[asked].append(correct)
            if mistakes is not None and not correct:
                mistakes.append(Mistake(batch.pictures[picture], asked, stated, otherwise))
    share = {key: round(float(np.mean(values)), 4) for key, values in right.items() if values}
    flips = {name: share[f"flip/{name}"] for name in NAMES if f"flip/{name}" in share}
    heads = {name: share[f"heads/{name}"] for name in NAMES if f"heads/{name}" in share}
    return {
        "attribute_flip": round(float(np.mean(list(flips.values()))), 4), "swap": share.get("swap"),
        "heads_mean": round(float(np.mean(list(heads.values()))), 4) if heads else None, "flip_by_attribute": flips, "heads": heads,
        "commonest": {name: round(max(Counter(c).values()) / len(c), 4) for name, c in shown.items() if c},
        "comparisons": {key: len(values) for key, values in right.items()},
    }  # fmt: skip


def looks_at(encoder: Encoder, batch: Batch) -> tuple[Tensor, Tensor]:
    """Features of whole pictures and of their subjects framed closely, as guidance looks at them.

    Returns:
        Two unit features per picture, (B, D) each: of the whole, and of the subject.
    """
    pictures, masks = batch.pictures.to(encoder.device), batch.masks.to(encoder.device).float()
    dice = torch.Generator().manual_seed(_SEED)
    subjects = [
        regions.subject_views(picture.permute(1, 2, 0), mask, 1, dice, encoder.size)
        for picture, mask in zip(pictures, masks, strict=True)
    ]
    return encoder.encode_images(pictures), encoder.encode_images(torch.cat(subjects))


def _comparisons(batch: Batch, dice: random.Random, sentence: Sentence) -> list[tuple[str, int, str, str]]:
    """(what is tested, picture, true sentence, false sentence)."""
    comparisons, base = [], 0
    for i, labels in enumerate(batch.labels.tolist()):
        noun = dice.choice(NOUNS)
        flip = int(batch.flipped[i])
        base = i if flip == -1 else base
        first = batch.labels[base].tolist()
        if flip >= 0 and labels[flip] >= 0 and first[flip] >= 0 and labels[flip] != first[flip]:
            name, wording = NAMES[flip], dice.random()
            stated, otherwise = (sentence(_named({name: c[flip]}), noun, wording) for c in (labels, first))
            if stated and otherwise and stated != otherwise:
                comparisons += [(f"flip/{name}", i, stated, otherwise), (f"flip/{name}", base, otherwise, stated)]
        a, b = labels[INDEX["subject_color"]], labels[INDEX["surroundings_color"]]
        if a >= 0 and b >= 0 and a != b:
            wording = dice.random()
            pairs = ({"subject_color": x, "surroundings_color": y} for x, y in ((a, b), (b, a)))
            stated, otherwise = (sentence(_named(pair), noun, wording) for pair in pairs)
            if stated and otherwise:
                comparisons.append(("swap", i, stated, otherwise))
    return comparisons


def _named(classes: dict[str, int]) -> dict[str, str]:
    return {name: ATTRIBUTES[name][value] for name, value in classes.items()}


def describe(classes: dict[str, str], noun: str, wording: float, split: WordingSplit = TRAINED) -> str:
    """A caption of some attributes.

    Args:
        noun: The thing, which is named where its color is not said.
        wording: Seeds the choice of words: the same number gives the same words as far as the attributes agree.
    """
    stated = caption(classes, random.Random(wording), split=split)
    return stated if "subject_color" in classes else f"{noun}, {stated}"


def bank_of(meshes: list[Path], size: int, views: int = 24) -> dict[str, np.ndarray]:
    """A bank of views of mesh files, in memory.

    Args:
        size: Side of a view, pixels.

    Returns:
        The fields of `bank.fields`, (meshes * views, ...) each.
    """
    traced = []
    for number, path in enumerate(meshes):
        mesh = trimesh.load(path, force="mesh")
        turn = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0.0]])
        points = mesh.triangles @ turn.T
        low, high = points.reshape(-1, 3).min(0), points.reshape(-1, 3).max(0)
        center = np.array([*(low + high)[:2] / 2, low[2]])
        normals = mesh.vertex_normals[mesh.faces] @ turn.T
        subject = Shape(
            ((points - center) * 2 / np.linalg.norm(high - low)).astype(np.float32), normals.astype(np.float32)
        )
        traced += [banks.trace(subject, np.random.default_rng([number, k]), size) for k in range(views)]
    layout = banks.fields(size)
    return {name: np.stack([view[name] for view in traced]).astype(layout[name][1]) for name in layout}


def cost(encoder: Encoder, crops: int = 8, repeats: int = 5) -> float:
    """Seconds for a forward and backward pass of random crops of 256² pixels.

    Args:
        encoder: The encoder, on the device where it is measured.
        repeats: Passes, of which the median counts.
    """
    text = encoder.encode_texts(["a red thing"])
    taken = []
    for _ in range(repeats):
        pictures = torch.rand(crops, 3, 256, 256, device=encoder.device, requires_grad=True)
        start = time.perf_counter()
        loss: Tensor = (encoder.encode_images(pictures) @ text.T).sum()
        loss.backward()
        taken.append(time.perf_counter() - start)
    return round(sorted(taken)[repeats // 2], 4)
