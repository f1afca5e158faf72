# SPDX-License-Identifier: Apache-2.0
"""Batches: groups of one view under four looks that differ in one attribute each, with exact captions.

Each group is the whole picture, or the subject alone on a random background, or its surroundings with
the subject cut out, because those are the pictures that guidance compares with region prompts.
"""

import random
from dataclasses import dataclass, fields

import numpy as np
import torch
import torch.nn.functional as F
from torch import Tensor

from lab.heads.attributes import ATTRIBUTES
from lab.train.pictures import dense, looks, shader, visible
from lab.train.pictures.augment import ALONE, EMPTY, WHOLE, cut, frame, wear
from lab.train.pictures.bank import SUBJECT
from lab.train.text import captions, wording
from lab.train.text.wording import NOUNS, TRAINED, WordingSplit

LOOKS = 4
"""Looks per group: a base, two one-attribute flips, a swap of the two colors."""
_GROUPS_AT_ONCE = 4
_LESSONS = 32


@dataclass
class Batch:
    """Pictures with their labels and captions.

    Attributes:
        pictures: (B, 3, H, W) display values in 0..1.
        labels: (B, A) visible class of each attribute or `looks.UNKNOWN`.
        captions: One sentence per picture.
        mentioned: (B, A) class that the caption says, -1 where it says nothing.
        flipped: (B,) attribute in which the picture differs from its group's first, -1 for none, -2 for a swap.
        variant: (B,) WHOLE, ALONE or EMPTY.
        maps: (B, CHANNELS, GRID, GRID) what every part shows, see `dense`.
        map_weights: (B, 1, GRID, GRID) weight of each part of the maps.
        lessons: Phrases of the language without a picture: few pictures show all that a phrase says.
        taught: (L, A) class that each of them says, -1 where it says nothing.
        masks: (B, H, W) where the subject is; empty where pictures were cropped.
    """

    pictures: Tensor
    labels: Tensor
    captions: list[str]
    mentioned: Tensor
    flipped: Tensor
    variant: Tensor
    maps: Tensor
    map_weights: Tensor
    lessons: list[str]
    taught: Tensor
    masks: Tensor


def make_batch(
    bank: dict[str, np.ndarray],
    groups: int,
    seed: int,
    augment: bool = True,
    shade: shader.Shade = shader.shade,
    device: torch.device | str = "cpu",
    split: WordingSplit = TRAINED,
    size: int | None = None,
    real: dict[str, np.ndarray] | None = None,
) -> Batch:
    """A batch of ``groups`` × `LOOKS` pictures that depends on nothing but the bank and the seed.

    Args:
        bank: From `bank.load`.
        augment: Whether pictures are cut, cropped, mirrored and blurred.
        shade: `shader.shade`, or its faster `shader.fused()`.
        device: Where pictures are made and stay; the rest of the batch is on the CPU.
        size: Side of the pictures in pixels; the bank's own by default.
        real: From `cycles.load`: a group of Cycles pictures then comes first, on top of the others.
    """
    generator, dice = torch.Generator().manual_seed(seed), random.Random(seed)
    size = size or bank["kind"].shape[-1]
    drawn = _looks_of_views(bank, groups, generator, dice, shade, device)
    if real is not None:
        drawn = drawn.after(_real_group(real, generator, drawn))
    odds = torch.tensor([0.66, 0.26, 0.08] if augment else [1.0, 0, 0])
    variant = torch.multinomial(odds, len(drawn.pictures), True, generator=generator)
    truth, framed = [], []
    for g, kind in enumerate(variant.tolist()):
        pairs = (slice(0, 2), slice(2, 4)) if real is not None and not g else (slice(0, LOOKS),)
        for part in pairs:
            pictures, maps = drawn.cut_and_frame(g, part, kind, augment, generator, dice)
            framed.append(_resized(pictures, size))
            truth.append(maps)
    maps, pictures = torch.cat(truth), torch.cat(framed)
    if augment:
        pictures = wear(pictures.unflatten(0, (-1, LOOKS)), generator).flatten(0, 1)
    texts, mentioned = _describe(drawn.labels, drawn.flipped, variant, dice, split)
    each = variant.repeat_interleave(LOOKS)
    kind = each.to(maps.device)[:, None, None, None]
    map_weights = torch.where(kind == WHOLE, 1.0, torch.where(kind == ALONE, maps[:, :1], 1 - maps[:, :1]))
    if real is not None:
        map_weights[:LOOKS] = 0.0  # nobody traced these
    labels, flipped = drawn.labels.flatten(0, 1), drawn.flipped.flatten()
    masks = torch.empty(0) if augment else drawn.masks.flatten(0, 1)
    return Batch(pictures, labels, texts, mentioned, flipped, each, maps, map_weights, *_lessons(dice), masks)


@dataclass
class _Groups:
    """Pictures in groups, before they are cropped and captioned.

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
        return _Groups(*(torch.cat([getattr(g, field.name) for g in (first, self)]) for field in fields(self)))

    def cut_and_frame(
        self, g: int, part: slice, kind: int, augment: bool, generator: torch.Generator, dice: random.Random
    ) -> tuple[Tensor, Tensor]:
        """Pictures of one view, cut and framed alike, and their maps, framed the same way; labels change in place."""
        mask, box, mirrored = self.masks[g, part.start], (0.0, 0.0, 1.0), False
        pictures, labels = cut(self.pictures[g, part], self.labels[g, part], mask, kind, generator)
        if augment:
            pictures, labels, box, mirrored = frame(pictures, labels, mask, kind, dice)
        self.labels[g, part] = labels
        return pictures, dense.framed(self.maps[g, part], box, mirrored)


def _looks_of_views(
    bank: dict[str, np.ndarray],
    groups: int,
    generator: torch.Generator,
    dice: random.Random,
    shade: shader.Shade,
    device: torch.device | str,
) -> _Groups:
    """Random views of the bank under random looks."""
    rows = torch.randint(len(bank["kind"]), (groups,), generator=generator)
    classes, flipped = _group_classes(groups, generator)
    noise = torch.rand(groups, 1, looks.NOISE, generator=generator).expand(-1, LOOKS, -1)
    look = looks.parameters(classes, noise)
    pictures, masks, maps, shown = _shade_all(bank, rows.tolist(), classes, look, dice, shade, device)
    flat = {name: value.flatten(0, 1) for name, value in look.items()}
    labels = visible.visible_classes(
        classes.flatten(0, 1), flat, pictures.flatten(0, 1), masks.repeat_interleave(LOOKS, 0)
    )
    labels = labels.view(groups, LOOKS, -1)
    for name, clear in shown.items():
        labels[..., looks.INDEX[name]].masked_fill_(~clear, looks.UNKNOWN)
    labels = visible.drop_unnoticed(pictures, masks, labels, flipped)
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
) -> tuple[Tensor, Tensor, Tensor, dict[str, Tensor]]:
    """Pictures (G, LOOKS, 3, H, W), subject masks (G, H, W), `dense.maps`, and `visible.visible_by_light`; a few groups at a time to stay in the cache."""
    pictures, masks, maps, clear = [], [], [], []
    for start in range(0, len(rows), _GROUPS_AT_ONCE):
        part = slice(start, start + _GROUPS_AT_ONCE)
        view = {
            name: torch.from_numpy(np.stack([values[r] for r in rows[part]])).to(device)
            for name, values in bank.items()
        }
        chosen = {name: value[part].to(device) for name, value in look.items()}
        fields = gather(view, classes[part])
        picture, gleam = shade(fields, chosen, dice.random() < 0.6).split([3, 1], 2)
        pictures.append(picture)
        masks.append(view["kind"] == SUBJECT)
        maps.append(dense.maps(fields, chosen, gleam))
        clear.append(visible.visible_by_light(view, classes[part], gleam[:, :, 0]))
    shown = {name: torch.cat([each[name] for each in clear]) for name in clear[0]}
    return torch.cat(pictures), torch.cat(masks), torch.cat(maps), shown


def _real_group(real: dict[str, np.ndarray], generator: torch.Generator, like: _Groups) -> _Groups:
    """One group of two pairs of Cycles pictures; a pair is a look and its flip."""
    pairs = torch.randint(len(real["labels"]) // 2, (LOOKS // 2,), generator=generator).tolist()
    rows = [row for pair in pairs for row in (2 * pair, 2 * pair + 1)]
    pictures, masks = (torch.from_numpy(real[name][rows])[None] for name in ("pictures", "masks"))
    labels, flipped = (torch.from_numpy(real[name][rows])[None] for name in ("labels", "flipped"))
    return _Groups(
        pictures.to(like.pictures) / 255,
        labels,
        flipped,
        (masks > 127).to(like.masks.device),
        torch.zeros_like(like.maps[:1]),
    )


def _resized(pictures: Tensor, size: int) -> Tensor:
    """Square pictures at another size, without aliasing: a highlight of a pixel stays a weak highlight."""
    if pictures.shape[-1] == size:
        return pictures
    return F.interpolate(pictures, (size, size), mode="bilinear", antialias=True, align_corners=False)


def gather(view: dict[str, Tensor], classes: Tensor) -> dict[str, Tensor]:
    """The bank's fields of some views as `shader.shade` takes them, with each look's light and shadow.

    Args:
        view: Fields of G views, (G, ...) each; see `bank.fields`.
        classes: (G, K, A), the K looks of each view.

    Returns:
        The fields, (G, 1, ...) each; "light" (G, K, 3) and "shadow" (G, K, H, W), 0 to 1, depend on the look.
    """
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
    labels: Tensor, flipped: Tensor, variant: Tensor, dice: random.Random, split: WordingSplit
) -> tuple[list[str], Tensor]:
    """A caption for each picture, and the classes (B, A) that it says."""
    texts, mentioned = [], torch.full_like(labels.flatten(0, 1), -1)
    for g, group in enumerate(labels.tolist()):
        focus = [looks.NAMES[a] if a >= 0 else None for a in flipped[g].tolist()]
        for k, row in enumerate(group):
            classes = {name: ATTRIBUTES[name][c] for name, c in zip(looks.NAMES, row, strict=True) if c >= 0}
            mentions = captions.mention(classes, focus[k] or dice.choice(focus), dice)
            texts.append(
                captions.caption(mentions, dice, bool(variant[g] == EMPTY), split) if mentions else dice.choice(NOUNS)
            )
            for name, value in mentions.items():
                mentioned[g * LOOKS + k, looks.INDEX[name]] = ATTRIBUTES[name].index(value)
    return texts, mentioned


def _lessons(dice: random.Random) -> tuple[list[str], Tensor]:
    """Phrases of the language, half of them about a thing, and the classes (L, A) that they say, each as often."""
    attributes = list(wording.lessons_by_class().values())
    chosen = [dice.choice(dice.choice(list(classes.values()))) for classes in dice.choices(attributes, k=_LESSONS)]
    taught = torch.full((len(chosen), len(looks.NAMES)), -1)
    for row, (_, asks) in zip(taught, chosen, strict=True):
        for name, value in asks.items():
            row[looks.INDEX[name]] = ATTRIBUTES[name].index(value)
    return [dice.choice(("", f"a {dice.choice(NOUNS)}, ")) + phrase for phrase, _ in chosen], taught


def contradicts(labels: Tensor, mentioned: Tensor) -> Tensor:
    """(B, T): whether caption t says something that is known to be false of picture b.

    Args:
        labels: (B, A) classes of pictures, negative where unknown.
        mentioned: (T, A) classes that captions mention, negative for none.
    """
    wrong = (labels[:, None] >= 0) & (mentioned[None] >= 0) & (labels[:, None] != mentioned[None])
    return wrong.any(-1)


def choices(labels: Tensor, taught: Tensor) -> tuple[Tensor, Tensor]:
    """Choices between two lessons that say nothing but the same attribute, with different classes.

    Args:
        labels: (B, A), classes that the pictures show.
        taught: (L, A), classes that the lessons say; -1 where a lesson says nothing.

    Returns:
        (A, B, P) bool, where the first lesson of a pair is true of the picture and about that attribute, and the
        pairs (2, P) of lessons.
    """
    single = (taught >= 0).sum(1) == 1
    name = taught.argmax(1)
    rival = single[:, None] & single & (name[:, None] == name) & (taught[:, None] != taught).any(-1)
    pairs = rival.nonzero().T
    attribute = name[pairs[0]]
    true = labels[:, attribute] == taught[pairs[0], attribute]
    return true & (attribute == torch.arange(labels.shape[1], device=attribute.device)[:, None, None]), pairs
