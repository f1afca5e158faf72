# SPDX-License-Identifier: Apache-2.0
"""Which attributes a finished picture shows: only what can be seen is said, learned and asked for."""

import torch
import torch.nn.functional as F
from torch import Tensor

from ...color.tensors import lab_from_srgb
from ...prompt.lexicon.attributes import ATTRIBUTES, COLORS
from .bank import SUBJECT
from .looks import INDEX, NAMES, UNKNOWN

_NOTICED = 0.02
"""Mean difference of display values from which a change of one attribute can be seen."""
_GLEAMS = 0.1
"""Standard deviation over the subject of the gleam's brightness from which a finish can be seen."""
_STEP, _BENDS = 3, (0.015, 0.45)
"""Pixels between two normals, and angles between them (radians) at which a surface bends."""
MIN_CURVED = 0.3
"""Share of a subject that bends, below which its finish cannot be told: a flat face mirrors one direction, whatever it is."""
_EDGES = 0.02
"""Mean difference between hard and soft shadows from which the light's softness can be seen."""
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
_WINDOWS = {
    "brightness": ((0, 29), (36, 60), (66, 101)),
    "contrast": ((0, 9), (11, 19), (21, 101)),
    "saturation": ((0, 10), (14, 40), (44, 200)),
}
"""Mean L*, standard deviation of L*, and mean chroma of the pictures that are called by each class."""


def visible_classes(classes: Tensor, look: dict[str, Tensor], picture: Tensor, mask: Tensor) -> Tensor:
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
        F.interpolate(field, (32, 32), mode="area").cpu() for field in (picture, mask[:, None].float())
    )
    lab = lab_from_srgb(small.clamp(0, 1).movedim(1, -1)).movedim(-1, 1)
    subject = (lab * share).sum((2, 3)) / share.sum((2, 3)).clamp_min(1e-3)
    surroundings = (lab * (1 - share)).sum((2, 3)) / (1 - share).sum((2, 3)).clamp_min(1e-3)
    lightness, chroma = lab[:, 0].mean((1, 2)), lab[:, 1:].norm(dim=1)
    spread, colorful = lab[:, 0].flatten(1).std(1), chroma.flatten(1).mean(1)

    def asked(name: str) -> Tensor:
        return classes[:, INDEX[name]]

    clear = look["fog"] < 0.9
    tinted = asked("light_temperature") != ATTRIBUTES["light_temperature"].index("neutral")
    back = asked("light_side") == ATTRIBUTES["light_side"].index("back")
    dull = asked("subject_finish") == ATTRIBUTES["subject_finish"].index("matte")
    # Warm light on a green thing looks like neutral light on a yellowish green one: something has to be gray or white.
    neutral = torch.stack(
        [
            asked(f"{region}_color") == COLORS.index(name)
            for region in ("subject", "surroundings")
            for name in ("grey", "white")
        ]
    ).any(0)
    shown = clear & (subject[:, 0] > 9) & _modeled(lab[:, :1], share)
    strong = shown & (look["ambient"].mean(-1) < 0.3 * look["key"].mean(-1)) & (look["contrast"] > 0.3)

    def measured(name: str, value: Tensor) -> Tensor:
        low, high = torch.tensor(_WINDOWS[name], dtype=torch.float32)[asked(name)].unbind(-1)
        return (value >= low) & (value <= high)

    holds = {
        "subject_finish": shown & ~back,
        "subject_metal": shown & ~back & ~dull,
        "light_side": strong | (clear & back),
        "light_softness": strong & ~back,
        "light_temperature": neutral & (lightness > 12) & (lightness < 93) & (look["saturation"] > 0.5),
        "fog": lightness > 10,
        "brightness": measured("brightness", lightness),
        "contrast": measured("contrast", spread),
        "saturation": measured("saturation", colorful),
        "vignette": surroundings[:, 0] > 22,
    }
    shown_colors = {"subject_color": subject, "surroundings_color": surroundings}
    columns = [
        color_class(asked(name), shown_colors[name], tinted)
        if name in shown_colors
        else torch.where(holds[name], asked(name), UNKNOWN)
        for name in NAMES
    ]
    return torch.stack(columns, -1)


def _modeled(lightness: Tensor, share: Tensor) -> Tensor:
    """Whether subjects tell of their surface and light (n,): not mostly black or blown out, and with some shading.

    Args:
        lightness: L* (n, 1, H, W).
        share: Coverage (n, 1, H, W).
    """
    inside = (share > 0.9).float()
    among = inside.sum((2, 3)).clamp_min(1)[:, 0]
    middle = ((lightness > 7) & (lightness < 96)).float()
    readable = (middle * inside).sum((1, 2, 3)) / among > 0.6
    off = lightness - ((lightness * inside).sum((2, 3)) / among[:, None])[..., None, None]
    return readable & (((off**2 * inside).sum((1, 2, 3)) / among).sqrt() > 6.0)


def color_class(color: Tensor, lab: Tensor, tinted: Tensor) -> Tensor:
    """The color class that a mean Lab color (n, 3) is called: the one asked for (n,), or what anybody would say."""
    every = torch.arange(len(COLORS))
    evident = is_typical(every[None, :], lab[:, None, :])
    named = torch.where(evident.sum(1) == 1, evident.float().argmax(1), UNKNOWN)
    return torch.where(can_be_called(color, lab, tinted), color, named)


def is_typical(color: Tensor, lab: Tensor) -> Tensor:
    """Whether Lab colors are textbook examples of color classes, by narrow bounds; broadcasts."""
    bounds = torch.tensor([_EVIDENT.get(name, _LIGHTNESS[name]) for name in COLORS])[color]
    hue = torch.tensor([_HUES.get(name, -1) for name in COLORS])[color]
    chroma, lightness = lab[..., 1:].norm(dim=-1), lab[..., 0]
    away = (torch.rad2deg(torch.atan2(lab[..., 2], lab[..., 1])) - hue + 180).remainder(360) - 180
    right = torch.where(hue < 0, chroma < 8, (chroma > 28) & (away.abs() < 15))
    return right & (lightness >= bounds[..., 0]) & (lightness <= bounds[..., 1])


def can_be_called(color: Tensor, lab: Tensor, tinted: Tensor) -> Tensor:
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


def visible_by_light(view: dict[str, Tensor], classes: Tensor, gleam: Tensor) -> dict[str, Tensor]:
    """Attribute → (G, LOOKS) whether a finish gleams anywhere on bent surfaces, and whether the edge of a shadow is in the picture."""
    finish, side = classes[..., INDEX["subject_finish"]], classes[..., INDEX["light_side"]]
    mask = (view["kind"] == SUBJECT)[:, None].float()
    count = mask.sum((2, 3)).clamp_min(1)
    mean = (gleam * mask).sum((2, 3)) / count
    uneven = (((gleam - mean[..., None, None]) ** 2 * mask).sum((2, 3)) / count).sqrt()
    edges = (view["shadow"][:, :, 0].float() - view["shadow"][:, :, 1].float()).abs().mean((2, 3)) / 255
    matte = finish == ATTRIBUTES["subject_finish"].index("matte")
    return {
        "subject_finish": (matte | (uneven.cpu() > _GLEAMS)) & (_curved(view).cpu() > MIN_CURVED)[:, None],
        "light_softness": edges.cpu().gather(1, side) > _EDGES,
    }


def _curved(view: dict[str, Tensor]) -> Tensor:
    """Share of the subjects (G,) whose surface bends."""
    normal, inside = view["normal"].float(), view["kind"] == SUBJECT
    shares = []
    for axis in (-1, -2):
        size = inside.shape[axis] - _STEP
        here, there = normal.narrow(axis, 0, size), normal.narrow(axis, _STEP, size)
        both = inside.narrow(axis, 0, size) & inside.narrow(axis, _STEP, size)
        turn = (there - here).norm(dim=1)
        bends = both & (turn > _BENDS[0]) & (turn < _BENDS[1])
        shares.append(bends.sum((1, 2)) / both.sum((1, 2)).clamp_min(1))
    return torch.maximum(*shares)


def drop_unnoticed(pictures: Tensor, masks: Tensor, labels: Tensor, flipped: Tensor) -> Tensor:
    """The labels (G, K, A) of groups without flipped attributes whose change hardly shows, in the flip and in its base."""
    labels, unlike = labels.clone(), (pictures - pictures[:, :1]).abs().mean(2)
    inside = masks[:, None].float()
    of_subject = (unlike * inside).sum((2, 3)) / inside.sum((2, 3)).clamp_min(1)
    of_rest = (unlike * (1 - inside)).sum((2, 3)) / (1 - inside).sum((2, 3)).clamp_min(1)
    hidden = (torch.maximum(of_subject, of_rest).cpu() < _NOTICED) & (flipped >= 0)
    for g, k in hidden.nonzero().tolist():
        labels[g, [0, k], flipped[g, k]] = UNKNOWN
    return labels
