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
from . import captions, dense, looks, shader
from .bank import SUBJECT
from .wording import NOUNS, TRAINED, Split

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
_SEEN_EMPTY = ("surroundings_color",)
_NOTICED = 0.012
"""Mean difference of display values from which a change of one attribute can be seen."""
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
        maps: (B, CHANNELS, GRID, GRID) what every part shows, see `dense`.
        told: (B, 1, GRID, GRID) weight of each part of the maps.
    """

    pictures: Tensor
    labels: Tensor
    captions: list[str]
    mentioned: Tensor
    flipped: Tensor
    variant: Tensor
    maps: Tensor
    told: Tensor


def make_batch(
    bank: dict[str, np.ndarray],
    groups: int,
    seed: int,
    augment: bool = True,
    shade: shader.Shade = shader.shade,
    device: torch.device | str = "cpu",
    split: Split = TRAINED,
    coarse: int = 1,
    real: dict[str, np.ndarray] | None = None,
) -> Batch:
    """A batch of ``groups`` × `LOOKS` pictures that depends on nothing but the bank and the seed.

    Args:
        bank: From `bank.load`.
        groups: How many groups.
        seed: Of everything random.
        augment: Whether pictures are cut, cropped, mirrored and blurred.
        shade: `shader.shade`, or its faster `shader.fused()`.
        device: Where pictures are made and stay; the rest of the batch is on the CPU.
        split: Which wordings captions use.
        coarse: Every how many of the bank's pixels are shaded, across and down.
        real: From `cycles.load`: a group of Cycles pictures then comes first, on top of the others.
    """
    generator = torch.Generator().manual_seed(seed)
    dice = random.Random(seed)
    rows = torch.randint(len(bank["kind"]), (groups,), generator=generator)
    classes, flipped = _group_classes(groups, generator)
    noise = torch.rand(groups, 1, looks.NOISE, generator=generator).expand(-1, LOOKS, -1)
    look = looks.parameters(classes, noise)
    pictures, masks, maps = _shade_all(bank, rows.tolist(), classes, look, dice, shade, device, coarse)
    flat = {name: value.flatten(0, 1) for name, value in look.items()}
    labels = looks.visible(
        classes.flatten(0, 1), flat, pictures.flatten(0, 1), masks.repeat_interleave(LOOKS, 0)
    )
    labels = _noticed(pictures, masks, labels.view(groups, LOOKS, -1), flipped)
    masks = masks[:, None].expand(-1, LOOKS, -1, -1)
    if real is not None:
        more = _real_group(real, generator, coarse, pictures)
        pictures, labels, flipped, masks = (
            torch.cat([one[None].to(all_), all_])
            for one, all_ in zip(more, (pictures, labels, flipped, masks), strict=True)
        )
        maps = torch.cat([torch.zeros_like(maps[:1]), maps])
    variant = torch.multinomial(
        torch.tensor([0.66, 0.26, 0.08]) if augment else torch.tensor([1.0, 0, 0]),
        len(pictures),
        True,
        generator=generator,
    )
    told = []
    for g in range(len(pictures)):
        pairs = (slice(0, 2), slice(2, 4)) if real is not None and not g else (slice(0, LOOKS),)
        for part in pairs:  # pictures of one view are cut alike
            mask, kind = masks[g, part.start], int(variant[g])
            pictures[g, part], labels[g, part] = _cut(
                pictures[g, part], labels[g, part], mask, kind, generator
            )
            box, mirrored = (0.0, 0.0, 1.0), False
            if augment:
                pictures[g, part], labels[g, part], box, mirrored = _frame(
                    pictures[g, part], labels[g, part], mask, kind, dice
                )
            told.append(dense.framed(maps[g, part], box, mirrored))
    if augment:
        pictures = _wear(pictures, generator)
    texts, mentioned = _describe(labels, flipped, variant, dice, split)
    truth = torch.cat(told)
    each = variant.repeat_interleave(LOOKS).to(truth.device)[:, None, None, None]
    inside = truth[:, :1]
    weight = torch.where(each == WHOLE, 1.0, torch.where(each == ALONE, inside, 1 - inside))
    if real is not None:
        weight[:LOOKS] = 0.0  # nobody traced these
    return Batch(
        pictures.flatten(0, 1),
        labels.flatten(0, 1),
        texts,
        mentioned,
        flipped.flatten(),
        variant.repeat_interleave(LOOKS),
        truth,
        weight,
    )


def _group_classes(groups: int, generator: torch.Generator) -> tuple[Tensor, Tensor]:
    """Classes (G, LOOKS, A) and the flipped attribute (G, LOOKS)."""
    base = looks.sample_classes(groups, generator)
    flipped = looks.sample_flips((groups, LOOKS), generator)
    columns = [base] + [looks.flip(base, flipped[:, k], generator) for k in range(1, LOOKS)]
    swapping = torch.rand(groups, generator=generator) < 0.4
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
    coarse: int,
) -> tuple[Tensor, Tensor, Tensor]:
    """Pictures (G, LOOKS, 3, H, W), subject masks (G, H, W) and `dense.maps`, a few groups at a time to stay in the cache."""
    pictures, masks, maps = [], [], []
    for start in range(0, len(rows), _GROUPS_AT_ONCE):
        part = slice(start, start + _GROUPS_AT_ONCE)
        view = {
            name: torch.from_numpy(np.stack([_thinned(values[r], coarse) for r in rows[part]])).to(device)
            for name, values in bank.items()
        }
        chosen = {name: value[part].to(device) for name, value in look.items()}
        fields = gather(view, classes[part])
        pictures.append(shade(fields, chosen, dice.random() < 0.6))
        masks.append(view["kind"] == SUBJECT)
        maps.append(dense.maps(fields, chosen))
    return torch.cat(pictures), torch.cat(masks), torch.cat(maps)


def _real_group(
    real: dict[str, np.ndarray], generator: torch.Generator, coarse: int, like: Tensor
) -> tuple[Tensor, Tensor, Tensor, Tensor]:
    """Two pairs of Cycles pictures: pictures, labels, flipped and masks of `LOOKS`; a pair is a look and its flip."""
    pairs = torch.randint(len(real["labels"]) // 2, (LOOKS // 2,), generator=generator).tolist()
    rows = [row for pair in pairs for row in (2 * pair, 2 * pair + 1)]
    pictures, masks = (
        torch.from_numpy(real[name][rows][..., ::coarse, ::coarse].copy()) for name in ("pictures", "masks")
    )
    labels, flipped = (torch.from_numpy(real[name][rows]) for name in ("labels", "flipped"))
    return pictures.to(like) / 255, labels, flipped, masks > 127


def _thinned(field: np.ndarray, coarse: int) -> np.ndarray:
    """Every so many pixels of a picture (..., H, W); what is no picture as it is."""
    return field[..., ::coarse, ::coarse] if field.ndim > 1 and field.shape[-1] > 3 else field


def _noticed(pictures: Tensor, masks: Tensor, labels: Tensor, flipped: Tensor) -> Tensor:
    """The labels (G, LOOKS, A) without flipped attributes whose change hardly shows, in the flip and in its base."""
    labels, unlike = labels.clone(), (pictures - pictures[:, :1]).abs().mean(2)
    inside = masks[:, None].float()
    of_subject = (unlike * inside).sum((2, 3)) / inside.sum((2, 3)).clamp_min(1)
    of_rest = (unlike * (1 - inside)).sum((2, 3)) / (1 - inside).sum((2, 3)).clamp_min(1)
    hidden = (torch.maximum(of_subject, of_rest).cpu() < _NOTICED) & (flipped >= 0)
    for g, k in hidden.nonzero().tolist():
        labels[g, [0, k], flipped[g, k]] = looks.UNKNOWN
    return labels


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
) -> tuple[Tensor, Tensor, tuple[float, float, float], bool]:
    """A random crop around the subject, and a mirror image with the light's sides exchanged.

    Returns:
        Pictures, labels, the crop's top, left and side as shares of the picture, and whether it was mirrored.
    """
    labels, box = labels.clone(), (0.0, 0.0, 1.0)
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
        box = (top / size, left / size, side / size)
        if side < 0.85 * size:
            labels[:, looks.INDEX["vignette"]] = looks.UNKNOWN
    mirrored = dice.random() < 0.5
    if mirrored:
        pictures = pictures.flip(-1)
        sides = labels[:, looks.INDEX["light_side"]]
        left, right = (ATTRIBUTES["light_side"].index(name) for name in ("left", "right"))
        labels[:, looks.INDEX["light_side"]] = torch.where(
            sides == left, right, torch.where(sides == right, left, sides)
        )
    return pictures, labels, box, mirrored


def _wear(pictures: Tensor, generator: torch.Generator) -> Tensor:
    """A little blur for some groups: renders differ in sharpness."""
    share, worn = torch.rand(2, len(pictures), generator=generator).unbind()
    for g in torch.nonzero(worn < 0.6)[:, 0].tolist():
        soft = F.pad(pictures[g], (1, 1, 1, 1), mode="replicate")  # slices are ten times faster than a pool
        soft = soft[..., :-2, :] + soft[..., 1:-1, :] + soft[..., 2:, :]
        soft = (soft[..., :-2] + soft[..., 1:-1] + soft[..., 2:]) / 9
        pictures[g] = torch.lerp(pictures[g], soft, share[g].item())
    return pictures


def _describe(
    labels: Tensor, flipped: Tensor, variant: Tensor, dice: random.Random, split: Split
) -> tuple[list[str], Tensor]:
    """A caption for each picture, and the classes (B, A) that it says."""
    texts, mentioned = [], torch.full_like(labels.flatten(0, 1), -1)
    for g, group in enumerate(labels.tolist()):
        focus = [looks.NAMES[a] if a >= 0 else None for a in flipped[g].tolist()]
        for k, row in enumerate(group):
            known = {name: ATTRIBUTES[name][c] for name, c in zip(looks.NAMES, row, strict=True) if c >= 0}
            said = captions.mention(known, focus[k] or dice.choice(focus), dice)
            texts.append(
                captions.caption(said, dice, bool(variant[g] == EMPTY), split) if said else dice.choice(NOUNS)
            )
            for name, value in said.items():
                mentioned[g * LOOKS + k, looks.INDEX[name]] = ATTRIBUTES[name].index(value)
    return texts, mentioned


def contradicts(labels: Tensor, mentioned: Tensor) -> Tensor:
    """(B, T): whether caption t says something that is known to be false of picture b."""
    wrong = (labels[:, None] >= 0) & (mentioned[None] >= 0) & (labels[:, None] != mentioned[None])
    return wrong.any(-1)
