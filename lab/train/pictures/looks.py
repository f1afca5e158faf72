# SPDX-License-Identifier: Apache-2.0
"""From attribute classes to the numbers of a look.

Classes are (…, A) integers in the order of `ATTRIBUTES`. The same noise with another class gives the
same picture with that one attribute changed, which is what makes hard negatives exact.
"""

import torch
from torch import Tensor

from lab.heads.attributes import ATTRIBUTES
from proxy_renderer.color.floats import linear_from_srgb, srgb_from_hex
from proxy_renderer.words.lexicon.quantities import COLORS

NAMES = tuple(ATTRIBUTES)
INDEX = {name: i for i, name in enumerate(NAMES)}
UNKNOWN = -100
NOISE = 40
"""Uniform numbers that a look takes besides its classes."""

_ANCHORS = {
    "black": "050505 0b0b0d 141414 1c1c1e 101418",
    "grey": "606060 6e6e70 808080 8c8c8c 9a9a98",
    "white": "ececec f4f4f2 ffffff f8f6f0 f0f4f8",
    "brown": "4a2c17 653c1e 7b4a26 5c4033 8a5a33",
    "red": "b00c12 d01818 e3241c 9c1020 c8102e",
    "orange": "e8650a f57c14 ff8c1a e2702a f08c30",
    "yellow": "f0c808 f8dc28 ffe135 e8c52a f4d03f",
    "green": "1f7a2c 2ea043 3cb84a 4c9a2a 0f6b38",
    "teal": "008080 0f9a94 20b2aa 0e7c86 14a3a8",
    "blue": "123fae 1f5fd0 2e6fe0 1a2f8a 3f7fe8",
    "purple": "5a1f9a 7030b0 8040c0 4b1a80 9050d0",
    "pink": "f06aa0 ff7fb0 f48fb8 e85a98 ff9ac8",
}


def _linear(codes: str) -> list[list[float]]:
    return [list(linear_from_srgb(srgb_from_hex(f"#{code}"))) for code in codes.split()]


ANCHORS = torch.tensor([_linear(_ANCHORS[name]) for name in COLORS])
"""(12, 5, 3) linear Rec.709 examples of every color class."""
_TINTS = torch.tensor([[1.3, 0.95, 0.55], [1.0, 1.0, 1.0], [0.68, 0.94, 1.35]])

_ODDS = {
    "subject_color": [1.5, 1.5, 1.8, 1, 1, 1, 1, 1, 1.2, 1, 1, 1],
    "surroundings_color": [1.8, 1.6, 2.6, 0.8, 1, 1, 1, 1, 1, 1.2, 1, 1],
    "subject_finish": [1.2, 0.8, 1.3],
    "subject_metal": [1.0, 1.2],
    "light_side": [1, 1, 1, 1.1, 0.9],
    "fog": [2.4, 1.0, 0.9],
    "brightness": [0.9, 2.0, 1.1],
    "contrast": [0.7, 2.0, 1.3],
    "saturation": [0.7, 2.4, 1],
    "vignette": [1.7, 1],
}
_PLAIN = {"fog": "none", "brightness": "medium", "contrast": "medium"}
_PLAIN_SHARE = 0.5
"""So many looks hide nothing of a thing's surface and of its light, which are the hardest to learn."""
_HARD = {
    "subject_finish": 6.0,
    "light_softness": 4.0,
    "subject_metal": 2.0,
    "light_side": 2.0,
    "light_temperature": 2.0,
}
STRESS = torch.tensor([_HARD.get(name, 1.0) for name in NAMES])
"""Rate of each attribute's flips, and weight of its head: what is hard to see is taught more."""


def sample_flips(shape: tuple[int, int], generator: torch.Generator) -> Tensor:
    """Random attributes to flip, the hard ones more often than the others.

    Returns:
        Indices into `NAMES`.
    """
    return torch.multinomial(STRESS, shape[0] * shape[1], replacement=True, generator=generator).view(shape)


def sample_classes(count: int, generator: torch.Generator) -> Tensor:
    """Classes of random looks; black, gray and white, and clear days, come up more often than by chance.

    Returns:
        (count, A).
    """
    columns = []
    for name, values in ATTRIBUTES.items():
        odds = torch.tensor(_ODDS.get(name, [1.0] * len(values)), dtype=torch.float32)
        columns.append(torch.multinomial(odds, count, replacement=True, generator=generator))
    classes = torch.stack(columns, -1)
    plain = torch.rand(count, generator=generator) < _PLAIN_SHARE
    for name, value in _PLAIN.items():
        classes[plain, INDEX[name]] = ATTRIBUTES[name].index(value)
    return classes


def flip(classes: Tensor, attribute: Tensor, generator: torch.Generator) -> Tensor:
    """The same looks with another class of one attribute each.

    Args:
        classes: (n, A).
        attribute: (n,), indices into `NAMES`.
    """
    sizes = torch.tensor([len(c) for c in ATTRIBUTES.values()])[attribute]
    step = 1 + (torch.rand(len(classes), generator=generator) * (sizes - 1)).long()
    old = classes.gather(1, attribute[:, None])[:, 0]
    return classes.scatter(1, attribute[:, None], ((old + step) % sizes)[:, None])


def swap(classes: Tensor) -> Tensor:
    """The same looks with the colors of subject and surroundings exchanged."""
    swapped = classes.clone()
    a, b = INDEX["subject_color"], INDEX["surroundings_color"]
    swapped[:, a], swapped[:, b] = classes[:, b], classes[:, a]
    return swapped


def parameters(classes: Tensor, noise: Tensor) -> dict[str, Tensor]:
    """The numbers of a look, as `shader.shade` takes them.

    Args:
        classes: (..., A).
        noise: (..., NOISE), uniform in 0..1: the look within its classes.

    Returns:
        Scalars (...) and linear colors (..., 3), by name.
    """
    numbers = iter(range(NOISE))

    def uniform(low: float, high: float) -> Tensor:
        return low + (high - low) * noise[..., next(numbers)]

    def by_class(name: str, *ranges: tuple[float, float]) -> Tensor:
        bounds = torch.tensor(ranges)[classes[..., INDEX[name]]]
        return bounds[..., 0] + (bounds[..., 1] - bounds[..., 0]) * noise[..., next(numbers)]

    def color(name: str) -> Tensor:
        anchors = ANCHORS[classes[..., INDEX[name]]]
        first, second = (uniform(0, 4.999).long()[..., None, None].expand(*anchors.shape[:-2], 1, 3) for _ in range(2))
        return torch.lerp(anchors.gather(-2, first), anchors.gather(-2, second), uniform(0, 1)[..., None, None])[
            ..., 0, :
        ]

    back = (classes[..., INDEX["light_side"]] == ATTRIBUTES["light_side"].index("back")).float()
    silhouette = back * (uniform(0, 1) < 0.6)
    tint = _TINTS[classes[..., INDEX["light_temperature"]]] ** uniform(1.0, 1.5)[..., None]
    surroundings = color("surroundings_color")
    share = uniform(0, 1)
    ambient = torch.where(share < 0.8, uniform(0.03, 0.2), uniform(0.2, 0.5)) * (1 - 0.85 * silhouette)
    subject = color("subject_color")
    metal = by_class("subject_metal", (0, 0), (1, 1))
    world = surroundings * uniform(0.6, 1.0)[..., None] * (1 + 0.3 * (tint - 1))
    fog = -torch.log(by_class("fog", (1, 1), (0.62, 0.84), (0.2, 0.48)))
    return {
        "subject": torch.lerp(subject, subject.sqrt(), 0.25 * metal[..., None]),
        "surroundings": surroundings,
        "world": world,
        "gradient": uniform(-0.5, 0.5),
        "roughness": by_class("subject_finish", (0.62, 1.0), (0.3, 0.45), (0.03, 0.16)),
        "specular": by_class("subject_finish", (0.0, 0.02), (0.03, 0.05), (0.05, 0.14)),
        "metal": metal,
        "key": tint * (uniform(1.3, 2.2) * (1 + 0.6 * back))[..., None],
        "ambient": ambient[..., None] * torch.lerp(torch.ones(3), surroundings, uniform(0.1, 0.6)[..., None]) * tint**0.5,
        "fill": uniform(0.0, 0.12) * (1 - silhouette),
        "soft": by_class("light_softness", (0, 0), (1, 1)),
        "backdrop": uniform(0.0, 0.2) + 0.5 * silhouette,
        "panels": torch.stack([uniform(3.0, 14.0), (uniform(-3.0, 4.0)).clamp_min(0)], -1) * (1 - 0.7 * silhouette)[..., None],
        "panel_turn": torch.stack([uniform(-0.5, 0.5), uniform(-2.6, 2.6)], -1),
        "panel_size": torch.stack([uniform(0.25, 0.8), uniform(0.2, 0.9)], -1),
        "fog": fog,
        "fog_color": torch.lerp(world, world.mean(-1, keepdim=True).expand_as(world), uniform(0, 0.4)[..., None]) * uniform(0.8, 1.2)[..., None],
        "exposure": by_class("brightness", (0.08, 0.26), (0.65, 1.1), (1.5, 2.8)),
        "contrast": by_class("contrast", (0.45, 0.68), (0.92, 1.15), (1.5, 2.1)),
        "saturation": by_class("saturation", (0.0, 0.35), (0.9, 1.15), (1.5, 2.2)),
        "vignette": by_class("vignette", (0, 0), (0.55, 1.0)),
        "falloff": uniform(-0.4, 0.9).clamp_min(0),
    }  # fmt: skip
