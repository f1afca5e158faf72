# SPDX-License-Identifier: Apache-2.0
"""Batches: groups of one view under four looks that differ in one attribute each, with exact captions.

Each group is the whole picture, or the subject alone on a random background, or its surroundings with
the subject cut out, because those are the pictures that guidance compares with region prompts.
"""

import random
from dataclasses import dataclass

import numpy as np
import torch
import torch.nn.functional as F
from torch import Tensor

from ..language.attributes import ATTRIBUTES
from . import captions, looks, shader
from .bank import SUBJECT
from .wording import NOUNS

LOOKS = 4
"""Looks per group: a base, two one-attribute flips, a swap of the two colors."""
WHOLE, ALONE, EMPTY = 0, 1, 2
_SEEN_ALONE = (
    "subject_color",
    "subject_finish",
    "subject_metal",
    "light_side",
    "light_softness",
    "light_temperature",
)
_SEEN_EMPTY = ("surroundings_color", "fog", "light_temperature")
_GROUPS_AT_ONCE = 4


@dataclass
class Batch:
    """Pictures and what is true of them.

    Attributes:
        pictures: (B, 3, H, W) display values in 0..1.
        labels: (B, A) visible class of each attribute or `looks.UNKNOWN`.
        captions: One sentence per picture.
        mentioned: (B, A) class that the caption says, -1 where it says nothing.
        flipped: (B,) attribute in which the picture differs from its group's first, -1 for none, -2 for a swap.
        variant: (B,) WHOLE, ALONE or EMPTY.
    """

    pictures: Tensor
    labels: Tensor
    captions: list[str]
    mentioned: Tensor
    flipped: Tensor
    variant: Tensor


def make_batch(
    bank: dict[str, np.ndarray],
    groups: int,
    seed: int,
    augment: bool = True,
    shade: shader.Shade = shader.shade,
    device: torch.device | str = "cpu",
) -> Batch:
    """A batch of ``groups`` × `LOOKS` pictures that depends on nothing but the bank and the seed.

    Args:
        bank: From `bank.load`.
        groups: How many groups.
        seed: Of everything random.
        augment: Whether pictures are cut, cropped, mirrored and blurred.
        shade: `shader.shade`, or its faster `shader.fused()`.
        device: Where pictures are made and stay; the rest of the batch is on the CPU.
    """
    generator = torch.Generator().manual_seed(seed)
    dice = random.Random(seed)
    rows = torch.randint(len(bank["kind"]), (groups,), generator=generator)
    classes, flipped = _group_classes(groups, generator)
    noise = torch.rand(groups, 1, looks.NOISE, generator=generator).expand(-1, LOOKS, -1)
    look = looks.parameters(classes, noise)
    pictures, masks = _shade_all(bank, rows.tolist(), classes, look, dice, shade, device)
    flat = {name: value.flatten(0, 1) for name, value in look.items()}
    labels = looks.visible(
        classes.flatten(0, 1), flat, pictures.flatten(0, 1), masks.repeat_interleave(LOOKS, 0)
    )
    labels = labels.view(groups, LOOKS, -1)
    variant = torch.multinomial(
        torch.tensor([0.56, 0.26, 0.18]) if augment else torch.tensor([1.0, 0, 0]),
        groups,
        True,
        generator=generator,
    )
    for g in range(groups):
        pictures[g], labels[g] = _cut(pictures[g], labels[g], masks[g], int(variant[g]), generator)
        if augment:
            pictures[g], labels[g] = _frame(pictures[g], labels[g], masks[g], int(variant[g]), dice)
    if augment:
        pictures = _wear(pictures, generator)
    texts, mentioned = _describe(labels, flipped, variant, dice)
    return Batch(
        pictures.flatten(0, 1),
        labels.flatten(0, 1),
        texts,
        mentioned,
        flipped.flatten(),
        variant.repeat_interleave(LOOKS),
    )


def _group_classes(groups: int, generator: torch.Generator) -> tuple[Tensor, Tensor]:
    """Classes (G, LOOKS, A) and the flipped attribute (G, LOOKS)."""
    base = looks.sample_classes(groups, generator)
    flipped = torch.randint(len(looks.NAMES), (groups, LOOKS), generator=generator)
    columns = [base] + [looks.flip(base, flipped[:, k], generator) for k in range(1, LOOKS)]
    swapping = torch.rand(groups, generator=generator) < 0.5
    columns[-1] = torch.where(swapping[:, None], looks.swap(base), columns[-1])
    flipped[:, 0] = -1
    flipped[:, -1] = torch.where(swapping, torch.tensor(-2), flipped[:, -1])
    return torch.stack(columns, 1), flipped


def _shade_all(
    bank: dict[str, np.ndarray],
    rows: list[int],
    classes: Tensor,
    look: dict[str, Tensor],
    dice: random.Random,
    shade: shader.Shade,
    device: torch.device | str,
) -> tuple[Tensor, Tensor]:
    """Pictures (G, LOOKS, 3, H, W) and subject masks (G, H, W), a few groups at a time to stay in the cache."""
    pictures, masks = [], []
    for start in range(0, len(rows), _GROUPS_AT_ONCE):
        part = slice(start, start + _GROUPS_AT_ONCE)
        view = {
            name: torch.from_numpy(np.stack([values[r] for r in rows[part]])).to(device)
            for name, values in bank.items()
        }
        chosen = {name: value[part].to(device) for name, value in look.items()}
        pictures.append(shade(gather(view, classes[part]), chosen, dice.random() < 0.6))
        masks.append(view["kind"] == SUBJECT)
    return torch.cat(pictures), torch.cat(masks)


def gather(view: dict[str, Tensor], classes: Tensor) -> dict[str, Tensor]:
    """The bank's fields (G, ...) as `shader.shade` takes them, with each look's light and shadow."""
    side, soft = classes[..., looks.INDEX["light_side"]], classes[..., looks.INDEX["light_softness"]]
    each = torch.arange(len(classes))[:, None]
    device = view["kind"].device
    each, side, soft = each.to(device), side.to(device), soft.to(device)
    return {
        "kind": view["kind"][:, None],
        "normal": view["normal"][:, None].float(),
        "depth": view["depth"][:, None].float(),
        "occlusion": view["occlusion"][:, None].float() / 255,
        "mirror": view["mirror"][:, None].float(),
        "camera": view["camera"][:, None],
        "tangent": view["tangent"][:, None],
        "light": view["lights"][each, side],
        "shadow": view["shadow"][each, side, soft].float() / 255,
    }


def _cut(
    pictures: Tensor, labels: Tensor, mask: Tensor, variant: int, generator: torch.Generator
) -> tuple[Tensor, Tensor]:
    """Leaves one region of the pictures (LOOKS, 3, H, W), and only the labels that it can show."""
    if variant == WHOLE:
        return pictures, labels
    seen = _SEEN_ALONE if variant == ALONE else _SEEN_EMPTY
    hidden = torch.tensor([name not in seen for name in looks.NAMES])
    labels = labels.masked_fill(hidden, looks.UNKNOWN)
    rest = (~mask).float()
    mean = (pictures * rest).sum((2, 3), keepdim=True) / rest.sum().clamp_min(1)
    chance = torch.rand((), generator=generator)
    if variant == EMPTY:
        fill = mean if chance < 0.8 else 0 * mean
        if chance < 0.3:
            fill = torch.rand(3, 1, 1, generator=generator).to(pictures)
        return torch.where(mask, fill, pictures), labels
    if chance < 0.35:
        return torch.where(mask, pictures, mean), labels
    cells = (1, 1, 2, 5, 12)[int(torch.randint(5, (), generator=generator))]
    coarse = torch.rand(len(pictures), 3, cells, cells, generator=generator)
    if cells == 1 and torch.rand((), generator=generator) < 0.4:
        coarse = coarse[:, :1].expand(-1, 3, -1, -1)
    background = F.interpolate(coarse.to(pictures), pictures.shape[-2:], mode="bilinear", align_corners=False)
    return torch.where(mask, pictures, background), labels


def _frame(
    pictures: Tensor, labels: Tensor, mask: Tensor, variant: int, dice: random.Random
) -> tuple[Tensor, Tensor]:
    """A random crop around the subject, and a mirror image with the light's sides exchanged."""
    labels = labels.clone()
    size = pictures.shape[-1]
    if dice.random() < (0.4 if variant == WHOLE else 0.7):
        rows, columns = (torch.nonzero(mask.any(axis))[:, 0].float() for axis in (1, 0))
        center = [(axis[0] + axis[-1]).item() / 2 for axis in (rows, columns)]
        side = int(size * dice.uniform(0.55, 0.97))
        if variant == ALONE:  # guidance frames a lone subject closely
            extent = max((axis[-1] - axis[0]).item() for axis in (rows, columns))
            side = int(min(max(extent * dice.uniform(0.85, 1.35), 0.45 * size), size))
        if variant == EMPTY:
            center = [dice.uniform(0, size), dice.uniform(0, size)]
        top, left = (
            int(min(max(c - side / 2 + dice.uniform(-0.12, 0.12) * side, 0), size - side)) for c in center
        )
        crop = pictures[:, :, top : top + side, left : left + side]
        pictures = F.interpolate(crop, (size, size), mode="bilinear", align_corners=False)
        if side < 0.85 * size:
            labels[:, looks.INDEX["vignette"]] = looks.UNKNOWN
    if dice.random() < 0.5:
        pictures = pictures.flip(-1)
        sides = labels[:, looks.INDEX["light_side"]]
        left, right = (ATTRIBUTES["light_side"].index(name) for name in ("left", "right"))
        labels[:, looks.INDEX["light_side"]] = torch.where(
            sides == left, right, torch.where(sides == right, left, sides)
        )
    return pictures, labels


def _wear(pictures: Tensor, generator: torch.Generator) -> Tensor:
    """A little blur for some groups: renders differ in sharpness."""
    share, worn = torch.rand(2, len(pictures), generator=generator).unbind()
    for g in torch.nonzero(worn < 0.6)[:, 0].tolist():
        soft = F.avg_pool2d(F.pad(pictures[g], (1, 1, 1, 1), mode="replicate"), 3, 1)
        pictures[g] = torch.lerp(pictures[g], soft, share[g].item())
    return pictures


def _describe(
    labels: Tensor, flipped: Tensor, variant: Tensor, dice: random.Random
) -> tuple[list[str], Tensor]:
    """A caption for each picture, and the classes (B, A) that it says."""
    texts, mentioned = [], torch.full_like(labels.flatten(0, 1), -1)
    for g, group in enumerate(labels.tolist()):
        focus = [looks.NAMES[a] if a >= 0 else None for a in flipped[g].tolist()]
        for k, row in enumerate(group):
            known = {name: ATTRIBUTES[name][c] for name, c in zip(looks.NAMES, row, strict=True) if c >= 0}
            said = captions.mention(known, focus[k] or dice.choice(focus), dice)
            texts.append(
                captions.caption(said, dice, empty=bool(variant[g] == EMPTY)) if said else dice.choice(NOUNS)
            )
            for name, value in said.items():
                mentioned[g * LOOKS + k, looks.INDEX[name]] = ATTRIBUTES[name].index(value)
    return texts, mentioned


def contradicts(labels: Tensor, mentioned: Tensor) -> Tensor:
    """(B, T): whether caption t says something that is known to be false of picture b."""
    wrong = (labels[:, None] >= 0) & (mentioned[None] >= 0) & (labels[:, None] != mentioned[None])
    return wrong.any(-1)
