# SPDX-License-Identifier: Apache-2.0
"""Labels for training pictures: an attribute that the picture does not visibly show is marked `UNKNOWN`.

A look is drawn at random, so darkness, fog or a tinted light may hide what it asked for. Captions and labels that name
a hidden attribute would teach the encoder noise.
"""

import torch
import torch.nn.functional as F
from torch import Tensor

from lab.heads.attributes import ATTRIBUTES
from lab.train.pictures.bank import SUBJECT
from lab.train.pictures.looks import INDEX, NAMES, UNKNOWN
from proxy_renderer.color.tensors import lab_from_srgb
from proxy_renderer.words.lexicon.quantities import COLORS

_NOTICED = 0.02
"""Least mean difference of display values between two pictures that differ in one attribute."""
_GLEAMS = 0.1
"""Least standard deviation of the gleam's brightness over the subject that shows its finish."""
_STEP, _BENDS = 3, (0.015, 0.45)
"""Pixels between two normals, and angles between them (radians) at which a surface bends."""
MIN_CURVED = 0.3
"""Least share of a subject's surface that is curved. A flat face mirrors one direction, whatever its finish."""
_EDGES = 0.02
"""Least mean difference between hard and soft shadows that shows the light's softness."""
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
"""Range of mean L*, of the standard deviation of L*, and of mean chroma for each class."""


def visible_classes(classes: Tensor, look: dict[str, Tensor], picture: Tensor, mask: Tensor) -> Tensor:
    """Labels of pictures: the classes that were drawn, or `UNKNOWN` where the picture hides them.

    A color is relabeled where the picture clearly shows another one.

    Args:
        classes: (n, A) classes that the looks were drawn from.
        look: Parameters of the looks, each (n, ...).
        picture: (n, 3, H, W) display pictures in [0, 1], on any device.
        mask: (n, H, W) subject coverage in [0, 1], on the same device.

    Returns:
        (n, A) classes or `UNKNOWN`, on the CPU.
    """
    small, share = (F.interpolate(field, (32, 32), mode="area").cpu() for field in (picture, mask[:, None].float()))
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
    """True if subjects show shading (n,): not mostly black or blown out, and not one flat tone.

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
    """Color labels of mean Lab colors.

    Args:
        color: (n,) classes that were drawn.
        lab: (n, 3) mean colors.
        tinted: (n,) whether the light is warm or cool.

    Returns:
        (n,) the class that was drawn where the color still fits it; else the only class of which the color is a
        typical example; else `UNKNOWN`.
    """
    every = torch.arange(len(COLORS))
    evident = is_typical(every[None, :], lab[:, None, :])
    named = torch.where(evident.sum(1) == 1, evident.float().argmax(1), UNKNOWN)
    return torch.where(can_be_called(color, lab, tinted), color, named)


def is_typical(color: Tensor, lab: Tensor) -> Tensor:
    """True if Lab colors (..., 3) are typical examples of color classes (...): narrow bounds; the two broadcast.

    Args:
        color: (...) classes.
        lab: (..., 3) CIE Lab.
    """
    bounds = torch.tensor([_EVIDENT.get(name, _LIGHTNESS[name]) for name in COLORS])[color]
    hue = torch.tensor([_HUES.get(name, -1) for name in COLORS])[color]
    chroma, lightness = lab[..., 1:].norm(dim=-1), lab[..., 0]
    away = (torch.rad2deg(torch.atan2(lab[..., 2], lab[..., 1])) - hue + 180).remainder(360) - 180
    right = torch.where(hue < 0, chroma < 8, (chroma > 28) & (away.abs() < 15))
    return right & (lightness >= bounds[..., 0]) & (lightness <= bounds[..., 1])


def can_be_called(color: Tensor, lab: Tensor, tinted: Tensor) -> Tensor:
    """True if mean Lab colors (n, 3) fit color classes (n,): wide bounds, wider in tinted light (n,).

    Args:
        color: (n,) classes.
        lab: (n, 3) CIE Lab.
        tinted: (n,) whether the light is warm or cool.
    """
    bounds = torch.tensor([_LIGHTNESS[name] for name in COLORS])[color]
    hue = torch.tensor([_HUES.get(name, -1) for name in COLORS])[color]
    chroma = lab[:, 1:].norm(dim=1)
    away = (torch.rad2deg(torch.atan2(lab[:, 2], lab[:, 1])) - hue + 180).remainder(360) - 180
    right = torch.where(
        hue < 0, chroma < torch.where(tinted, 18.0, 12.0), (chroma > 8) & (away.abs() < torch.where(tinted, 38.0, 30.0))
    )
    return right & (lab[:, 0] >= bounds[:, 0]) & (lab[:, 0] <= bounds[:, 1])


def visible_by_light(view: dict[str, Tensor], classes: Tensor, gleam: Tensor) -> dict[str, Tensor]:
    """True if pictures show the attributes that only light on a surface shows.

    Args:
        view: Traced views, see `bank`: kind (G, H, W), normal (G, 3, H, W), shadow (G, sides, 2, H, W) hard and soft.
        classes: (G, LOOKS, A) classes of the looks.
        gleam: (G, LOOKS, H, W) how bright the reflections are.

    Returns:
        Attribute -> (G, LOOKS) bool. "subject_finish": the subject is curved, and matte or unevenly bright;
        "light_softness": a shadow's edge is in the picture.
    """
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
    """Share of each subject's surface that is curved, (G,)."""
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
    """Labels without the flips that make no visible difference, in the flipped picture and in the one it is compared with.

    Args:
        pictures: (G, K, 3, H, W) groups; the first of each is the base.
        masks: (G, H, W) subject coverage.
        labels: (G, K, A) classes.
        flipped: (G, K) index of the attribute that was flipped; negative for none.

    Returns:
        (G, K, A) classes or `UNKNOWN`.
    """
    labels, unlike = labels.clone(), (pictures - pictures[:, :1]).abs().mean(2)
    inside = masks[:, None].float()
    of_subject = (unlike * inside).sum((2, 3)) / inside.sum((2, 3)).clamp_min(1)
    of_rest = (unlike * (1 - inside)).sum((2, 3)) / (1 - inside).sum((2, 3)).clamp_min(1)
    hidden = (torch.maximum(of_subject, of_rest).cpu() < _NOTICED) & (flipped >= 0)
    for g, k in hidden.nonzero().tolist():
        labels[g, [0, k], flipped[g, k]] = UNKNOWN
    return labels
