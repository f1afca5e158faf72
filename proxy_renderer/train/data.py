# SPDX-License-Identifier: Apache-2.0
"""Batches: groups of one view under four looks that differ in one attribute each, with exact captions.

Each group is the whole picture, or the subject alone on a random background, or its surroundings with
the subject cut out, because those are the pictures that guidance compares with region prompts.
"""

import random
from dataclasses import dataclass, fields

import numpy as np
import torch
from torch import Tensor

from ..language.attributes import ATTRIBUTES
from . import captions, dense, looks, shader
from .augment import ALONE, EMPTY, WHOLE, cut, frame, wear
from .bank import SUBJECT
from .wording import NOUNS, TRAINED, Split

LOOKS = 4
"""Looks per group: a base, two one-attribute flips, a swap of the two colors."""
_NOTICED = 0.012
"""Mean difference of display values from which a change of one attribute can be seen."""
_GLEAMS = 0.12
"""Standard deviation over the subject of the gleam's share from which a finish can be seen."""
_EDGES = 0.02
"""Mean difference between hard and soft shadows from which the light's softness can be seen."""
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
    made = _looks_of_views(bank, groups, generator, dice, shade, device, coarse)
    if real is not None:
        made = made.after(_real_group(real, generator, coarse, made))
    odds = torch.tensor([0.66, 0.26, 0.08] if augment else [1.0, 0, 0])
    variant = torch.multinomial(odds, len(made.pictures), True, generator=generator)
    truth = []
    for g, kind in enumerate(variant.tolist()):
        pairs = (slice(0, 2), slice(2, 4)) if real is not None and not g else (slice(0, LOOKS),)
        truth += [made.cut_and_frame(g, part, kind, augment, generator, dice) for part in pairs]
    maps = torch.cat(truth)
    if augment:
        made.pictures = wear(made.pictures, generator)
    texts, mentioned = _describe(made.labels, made.flipped, variant, dice, split)
    each = variant.repeat_interleave(LOOKS)
    seen = each.to(maps.device)[:, None, None, None]
    told = torch.where(seen == WHOLE, 1.0, torch.where(seen == ALONE, maps[:, :1], 1 - maps[:, :1]))
    if real is not None:
        told[:LOOKS] = 0.0  # nobody traced these
    pictures, labels = made.pictures.flatten(0, 1), made.labels.flatten(0, 1)
    return Batch(pictures, labels, texts, mentioned, made.flipped.flatten(), each, maps, told)


@dataclass
class _Groups:
    """Pictures in groups, before they are cut and told.

    Attributes:
        pictures: (G, LOOKS, 3, H, W).
        labels: (G, LOOKS, A).
        flipped: (G, LOOKS).
        masks: (G, LOOKS, H, W) where the subject is.
        maps: (G, LOOKS, CHANNELS, 40, 40).
    """

    pictures: Tensor
    labels: Tensor
    flipped: Tensor
    masks: Tensor
    maps: Tensor

    def after(self, first: "_Groups") -> "_Groups":
        """Another's groups, then these."""
        return _Groups(
            *(torch.cat([getattr(g, field.name) for g in (first, self)]) for field in fields(self))
        )

    def cut_and_frame(
        self, g: int, part: slice, kind: int, augment: bool, generator: torch.Generator, dice: random.Random
    ) -> Tensor:
        """Cuts and frames pictures of one view alike, in place; returns their maps, framed the same way."""
        mask, box, mirrored = self.masks[g, part.start], (0.0, 0.0, 1.0), False
        pictures, labels = cut(self.pictures[g, part], self.labels[g, part], mask, kind, generator)
        if augment:
            pictures, labels, box, mirrored = frame(pictures, labels, mask, kind, dice)
        self.pictures[g, part], self.labels[g, part] = pictures, labels
        return dense.framed(self.maps[g, part], box, mirrored)


def _looks_of_views(
    bank: dict[str, np.ndarray],
    groups: int,
    generator: torch.Generator,
    dice: random.Random,
    shade: shader.Shade,
    device: torch.device | str,
    coarse: int,
) -> _Groups:
    """Random views of the bank under random looks."""
    rows = torch.randint(len(bank["kind"]), (groups,), generator=generator)
    classes, flipped = _group_classes(groups, generator)
    noise = torch.rand(groups, 1, looks.NOISE, generator=generator).expand(-1, LOOKS, -1)
    look = looks.parameters(classes, noise)
    pictures, masks, maps, shown = _shade_all(bank, rows.tolist(), classes, look, dice, shade, device, coarse)
    flat = {name: value.flatten(0, 1) for name, value in look.items()}
    labels = looks.visible(
        classes.flatten(0, 1), flat, pictures.flatten(0, 1), masks.repeat_interleave(LOOKS, 0)
    )
    labels = labels.view(groups, LOOKS, -1)
    for name, clear in shown.items():
        labels[..., looks.INDEX[name]].masked_fill_(~clear, looks.UNKNOWN)
    labels = _noticed(pictures, masks, labels, flipped)
    return _Groups(pictures, labels, flipped, masks[:, None].expand(-1, LOOKS, -1, -1), maps)


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
) -> tuple[Tensor, Tensor, Tensor, dict[str, Tensor]]:
    """Pictures (G, LOOKS, 3, H, W), subject masks (G, H, W), `dense.maps`, and `shown`; a few groups at a time to stay in the cache."""
    pictures, masks, maps, clear = [], [], [], []
    for start in range(0, len(rows), _GROUPS_AT_ONCE):
        part = slice(start, start + _GROUPS_AT_ONCE)
        view = {
            name: torch.from_numpy(np.stack([_thinned(values[r], coarse) for r in rows[part]])).to(device)
            for name, values in bank.items()
        }
        chosen = {name: value[part].to(device) for name, value in look.items()}
        fields = gather(view, classes[part])
        picture, gleam = shade(fields, chosen, dice.random() < 0.6).split([3, 1], 2)
        pictures.append(picture)
        masks.append(view["kind"] == SUBJECT)
        maps.append(dense.maps(fields, chosen, gleam))
        clear.append(_shown(view, classes[part], gleam[:, :, 0]))
    shown = {name: torch.cat([each[name] for each in clear]) for name in clear[0]}
    return torch.cat(pictures), torch.cat(masks), torch.cat(maps), shown


def _shown(view: dict[str, Tensor], classes: Tensor, gleam: Tensor) -> dict[str, Tensor]:
    """Attribute → (G, LOOKS) whether a finish gleams anywhere, and whether the edge of a shadow is in the picture."""
    finish, side = classes[..., looks.INDEX["subject_finish"]], classes[..., looks.INDEX["light_side"]]
    mask = (view["kind"] == SUBJECT)[:, None].float()
    count = mask.sum((2, 3)).clamp_min(1)
    mean = (gleam * mask).sum((2, 3)) / count
    uneven = (((gleam - mean[..., None, None]) ** 2 * mask).sum((2, 3)) / count).sqrt()
    edges = (view["shadow"][:, :, 0].float() - view["shadow"][:, :, 1].float()).abs().mean((2, 3)) / 255
    matte = finish == ATTRIBUTES["subject_finish"].index("matte")
    return {
        "subject_finish": matte | (uneven.cpu() > _GLEAMS),
        "light_softness": edges.cpu().gather(1, side) > _EDGES,
    }


def _real_group(
    real: dict[str, np.ndarray], generator: torch.Generator, coarse: int, like: _Groups
) -> _Groups:
    """One group of two pairs of Cycles pictures; a pair is a look and its flip."""
    pairs = torch.randint(len(real["labels"]) // 2, (LOOKS // 2,), generator=generator).tolist()
    rows = [row for pair in pairs for row in (2 * pair, 2 * pair + 1)]
    pictures, masks = (
        torch.from_numpy(real[name][rows][..., ::coarse, ::coarse].copy())[None]
        for name in ("pictures", "masks")
    )
    labels, flipped = (torch.from_numpy(real[name][rows])[None] for name in ("labels", "flipped"))
    return _Groups(
        pictures.to(like.pictures) / 255,
        labels,
        flipped,
        (masks > 127).to(like.masks.device),
        torch.zeros_like(like.maps[:1]),
    )


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
