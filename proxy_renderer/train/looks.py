# SPDX-License-Identifier: Apache-2.0
"""From attribute classes to the numbers of a look, and back: which attributes a finished picture shows.

Classes are (…, A) integers in the order of `ATTRIBUTES`. The same noise with another class gives the
same picture with that one attribute changed, which is what makes hard negatives exact.
"""

import torch
from torch import Tensor

from ..language.attributes import ATTRIBUTES, COLORS

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
_HUES = {
    "brown": 60,
    "red": 36,
    "orange": 62,
    "yellow": 92,
    "green": 145,
    "teal": 197,
    "blue": 282,
    "purple": 308,
    "pink": 358,
}
_LIGHTNESS = {
    "black": (0, 27), "grey": (30, 72), "white": (70, 101), "brown": (8, 52), "red": (10, 62), "orange": (36, 88),
    "yellow": (48, 101), "green": (8, 85), "teal": (12, 88), "blue": (6, 75), "purple": (6, 72), "pink": (42, 95),
}  # fmt: skip
_EVIDENT = {"black": (0, 18), "grey": (36, 64), "white": (80, 101), "brown": (16, 42), "orange": (54, 88)}


def _linear(codes: str) -> list[list[float]]:
    rgb = [[int(code[i : i + 2], 16) / 255 for i in (0, 2, 4)] for code in codes.split()]
    return [[c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in color] for color in rgb]


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
    "subject_finish": 4.0,
    "light_softness": 4.0,
    "subject_metal": 2.0,
    "light_side": 2.0,
    "light_temperature": 2.0,
}
STRESS = torch.tensor([_HARD.get(name, 1.0) for name in NAMES])
"""How often each attribute is flipped, and how much its head counts: what is hard to see is taught more."""


def sample_flips(shape: tuple[int, int], generator: torch.Generator) -> Tensor:
    """Attributes to flip, the hard ones more often than the others."""
    return torch.multinomial(STRESS, shape[0] * shape[1], replacement=True, generator=generator).view(shape)


def sample_classes(count: int, generator: torch.Generator) -> Tensor:
    """Classes (count, A) of random looks; black, grey and white, and clear days, come up more often than by chance."""
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
    """The same looks (n, A) with another class of one attribute each (n,)."""
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
    """What `shader.shade` takes, from classes (..., A) and noise (..., NOISE) in 0..1."""
    numbers = iter(range(NOISE))

    def uniform(low: float, high: float) -> Tensor:
        return low + (high - low) * noise[..., next(numbers)]

    def by_class(name: str, *ranges: tuple[float, float]) -> Tensor:
        bounds = torch.tensor(ranges)[classes[..., INDEX[name]]]
        return bounds[..., 0] + (bounds[..., 1] - bounds[..., 0]) * noise[..., next(numbers)]

    def color(name: str) -> Tensor:
        anchors = ANCHORS[classes[..., INDEX[name]]]
        first, second = (
            uniform(0, 4.999).long()[..., None, None].expand(*anchors.shape[:-2], 1, 3) for _ in range(2)
        )
        return torch.lerp(
            anchors.gather(-2, first), anchors.gather(-2, second), uniform(0, 1)[..., None, None]
        )[..., 0, :]

    back = (classes[..., INDEX["light_side"]] == ATTRIBUTES["light_side"].index("back")).float()
    silhouette = back * (uniform(0, 1) < 0.6)
    tint = _TINTS[classes[..., INDEX["light_temperature"]]] ** uniform(0.7, 1.25)[..., None]
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


def visible(classes: Tensor, look: dict[str, Tensor], picture: Tensor, mask: Tensor) -> Tensor:
    """The classes that the picture shows; `UNKNOWN` where it does not bear out what was asked for.

    A red thing in the dark is not red to anybody who looks: only what can be seen is said and learned.

    Args:
        classes: (n, A) classes asked for.
        look: Their parameters (n, ...).
        picture: (n, 3, H, W) display picture, on any device.
        mask: (n, H, W) subject coverage, on the same.

    Returns:
        (n, A) classes or `UNKNOWN`.
    """
    small, share = (
        torch.nn.functional.interpolate(field, (32, 32), mode="area").cpu()
        for field in (picture, mask[:, None].float())
    )
    lab = display_to_lab(small)
    subject = (lab * share).sum((2, 3)) / share.sum((2, 3)).clamp_min(1e-3)
    surroundings = (lab * (1 - share)).sum((2, 3)) / (1 - share).sum((2, 3)).clamp_min(1e-3)
    lightness, chroma = lab[:, 0].mean((1, 2)), lab[:, 1:].norm(dim=1)
    spread, colorful = lab[:, 0].flatten(1).std(1), chroma.flatten(1).mean(1)

    def asked(name: str) -> Tensor:
        return classes[:, INDEX[name]]

    # A thing that is mostly black or blown out, or hardly modelled, tells nothing about its surface or its light.
    inside = (share > 0.9).float()
    among = inside.sum((2, 3)).clamp_min(1)[:, 0]
    middle = ((lab[:, :1] > 7) & (lab[:, :1] < 96)).float()
    readable = (middle * inside).sum((1, 2, 3)) / among > 0.6
    off = lab[:, :1] - ((lab[:, :1] * inside).sum((2, 3)) / among[:, None])[..., None, None]
    modelled = ((off**2 * inside).sum((1, 2, 3)) / among).sqrt() > 6.0
    clear = look["fog"] < 0.9
    tinted = asked("light_temperature") != ATTRIBUTES["light_temperature"].index("neutral")
    back = asked("light_side") == ATTRIBUTES["light_side"].index("back")
    dull = asked("subject_finish") == ATTRIBUTES["subject_finish"].index("matte")
    shown = clear & (subject[:, 0] > 9) & readable & modelled
    strong = shown & (look["ambient"].mean(-1) < 0.3 * look["key"].mean(-1)) & (look["contrast"] > 0.3)
    window = {
        "brightness": ((0, 30), (37, 63), (63, 101)),
        "contrast": ((0, 13), (8, 28), (14, 101)),
        "saturation": ((0, 12), (9, 42), (30, 200)),
    }

    def measured(name: str, value: Tensor) -> Tensor:
        low, high = torch.tensor(window[name], dtype=torch.float32)[asked(name)].unbind(-1)
        return (value >= low) & (value <= high)

    holds = {
        "subject_finish": shown & ~back,
        "subject_metal": shown & ~back & ~dull,
        "light_side": strong | (clear & back),
        "light_softness": strong & ~back,
        "light_temperature": (lightness > 12) & (lightness < 93) & (look["saturation"] > 0.5),
        "fog": lightness > 10,
        "brightness": measured("brightness", lightness),
        "contrast": measured("contrast", spread),
        "saturation": measured("saturation", colorful),
        "vignette": surroundings[:, 0] > 22,
    }
    shown_colors = {"subject_color": subject, "surroundings_color": surroundings}
    columns = [
        seen_color(asked(name), shown_colors[name], tinted)
        if name in shown_colors
        else torch.where(holds[name], asked(name), UNKNOWN)
        for name in NAMES
    ]
    return torch.stack(columns, -1)


def seen_color(color: Tensor, lab: Tensor, tinted: Tensor) -> Tensor:
    """The color class that a mean Lab color (n, 3) is called: the one asked for (n,), or what anybody would say."""
    every = torch.arange(len(COLORS))
    evident = evidently(every[None, :], lab[:, None, :])
    named = torch.where(evident.sum(1) == 1, evident.float().argmax(1), UNKNOWN)
    return torch.where(shows_color(color, lab, tinted), color, named)


def evidently(color: Tensor, lab: Tensor) -> Tensor:
    """Whether Lab colors are textbook examples of color classes, by narrow bounds; broadcasts."""
    bounds = torch.tensor([_EVIDENT.get(name, _LIGHTNESS[name]) for name in COLORS])[color]
    hue = torch.tensor([_HUES.get(name, -1) for name in COLORS])[color]
    chroma, lightness = lab[..., 1:].norm(dim=-1), lab[..., 0]
    away = (torch.rad2deg(torch.atan2(lab[..., 2], lab[..., 1])) - hue + 180).remainder(360) - 180
    right = torch.where(hue < 0, chroma < 8, (chroma > 28) & (away.abs() < 15))
    return right & (lightness >= bounds[..., 0]) & (lightness <= bounds[..., 1])


def shows_color(color: Tensor, lab: Tensor, tinted: Tensor) -> Tensor:
    """Whether a mean Lab color (n, 3) can be called by the color classes (n,); white stays white in tinted light."""
    bounds = torch.tensor([_LIGHTNESS[name] for name in COLORS])[color]
    hue = torch.tensor([_HUES.get(name, -1) for name in COLORS])[color]
    chroma = lab[:, 1:].norm(dim=1)
    away = (torch.rad2deg(torch.atan2(lab[:, 2], lab[:, 1])) - hue + 180).remainder(360) - 180
    right = torch.where(
        hue < 0,
        chroma < torch.where(tinted, 18.0, 12.0),
        (chroma > 8) & (away.abs() < torch.where(tinted, 38.0, 30.0)),
    )
    return right & (lab[:, 0] >= bounds[:, 0]) & (lab[:, 0] <= bounds[:, 1])


def display_to_lab(picture: Tensor) -> Tensor:
    """CIE Lab (D65) of sRGB-encoded pictures (n, 3, H, W) in 0..1."""
    c = picture.clamp(0, 1)
    c = torch.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)
    to_xyz = torch.tensor([[0.4339, 0.3762, 0.1899], [0.2126, 0.7152, 0.0722], [0.0177, 0.1095, 0.8729]])
    xyz = torch.einsum("ij,njhw->nihw", to_xyz, c)  # rows divided by the white point
    f = torch.where(xyz > 0.008856, xyz.clamp_min(1e-6) ** (1 / 3), 7.787 * xyz + 16 / 116)
    return torch.stack([116 * f[:, 1] - 16, 500 * (f[:, 0] - f[:, 1]), 200 * (f[:, 1] - f[:, 2])], 1)
