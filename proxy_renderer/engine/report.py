# SPDX-License-Identifier: Apache-2.0
"""What is left behind of a vibe: the report's fields, and the picture that compares."""

from __future__ import annotations

import platform
from collections.abc import Sequence
from importlib import metadata
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from PIL import Image, ImageDraw

from .. import __version__
from ..schema import Values, atomic
from . import lettering

if TYPE_CHECKING:
    from torch import Tensor

    from ..optimize.anchoring import BlenderPictures
    from ..optimize.pipeline import Outcome
    from ..optimize.shots import ShotState

_PANEL = 512
_MARGIN = 24
_PAPER, _INK, _FAINT = (250, 250, 248), (32, 32, 36), (120, 120, 126)
_PACKAGES = ("torch", "open_clip_torch", "numpy", "opencolorio", "trimesh")


def parameter_records(outcome: Outcome) -> dict[str, dict[str, Any]]:
    """What `report.json` says of every parameter of the scene.

    Returns:
        Key -> before, after, lower, upper, moved (on the perceptual scale), priority (the confiner's π, 0 comes first;
        None is irrelevant), optimized, reason.
    """
    after = outcome.vector.values(outcome.u)
    lower, upper = (outcome.vector.plain(b) for b in outcome.vector.bounds(outcome.ranges))
    return {
        key: {
            "before": plain(instance.value),
            "after": plain(after[key]),
            "lower": plain(lower[key]),
            "upper": plain(upper[key]),
            "moved": round(instance.distance(after[key]), 4),
            "priority": outcome.plan[key].priority,
            "optimized": key in outcome.optimized,
            "reason": instance.locked or outcome.plan[key].reason,
        }
        for key, instance in outcome.vector.instances.items()
    }


def changed_values(outcome: Outcome, shot: ShotState | None = None) -> dict[str, list[float]]:
    """Key -> components, of what differs from the artist's scene; in one of several shots, under its names.

    Args:
        shot: One of several; None for the shared names.
    """
    vector = (shot or outcome).vector
    return {k: list(v) for k, v in vector.changes(outcome.u).items()}


def anchored(outcome: Outcome, blenders: Sequence[BlenderPictures]) -> dict[str, Any]:
    """How the proxies were corrected, one for each shot.

    `predicted` is the mean CIEDE2000 between what was predicted and what the next picture of Cycles showed, the
    last time; of several shots, their mean.

    Args:
        blenders: The picture source of each shot.

    Returns:
        {"anchored": {"pictures", "predicted", "notes"}}.
    """
    pictures, predicted, notes = [], [], []
    for shot, blender in zip(outcome.shots, blenders, strict=True):
        pairs = zip(shot.anchoring.records, blender.seconds, strict=True)
        records = [{**record, "seconds": seconds} for record, seconds in pairs]
        pictures += records
        predicted += [records[-1]["delta_e"]] if records else []
        notes += blender.notes
    mean = {"predicted": round(sum(predicted) / len(predicted), 3)} if predicted else {}
    return {"anchored": {"pictures": pictures, **mean, "notes": list(dict.fromkeys(notes))}}


def plain(values: Values) -> float | list[float]:
    """A number for one component, a list for several."""
    return values[0] if len(values) == 1 else list(values)


def versions() -> dict[str, str]:
    """What the engine runs on."""
    installed = {"vibe-render": __version__, "python": platform.python_version()}
    for package in _PACKAGES:
        try:
            installed[package] = metadata.version(package)
        except metadata.PackageNotFoundError:
            continue
    return installed


def save_picture(picture: Tensor, path: Path) -> None:
    """Writes (H, W, 3) or (H, W) in [0, 1] as an 8-bit PNG, all at once or not at all.

    Args:
        picture: As for `image`.

    Raises:
        OSError: It cannot be written.
    """
    save_image(image(picture), path)


def image(picture: Tensor) -> Image.Image:
    """An 8-bit image of a picture (H, W, 3) or (H, W) in [0, 1]; what is outside is clipped."""
    data = (picture.detach().cpu().numpy().clip(0.0, 1.0) * 255.0 + 0.5).astype(np.uint8)
    return Image.fromarray(data)


def save_image(image: Image.Image, path: Path) -> None:
    """Writes a PNG, all at once or not at all.

    Args:
        image: 8-bit, of any mode.

    Raises:
        OSError: It cannot be written.
    """
    with atomic.replacing(path) as part:
        image.save(part, format="PNG")


def load_picture(path: Path) -> np.ndarray:
    """Reads a picture as (H, W, 3) float32 in [0, 1]; what is transparent shows black."""
    with Image.open(path) as image:
        flat = Image.alpha_composite(Image.new("RGBA", image.size, (0, 0, 0, 255)), image.convert("RGBA"))
    return np.asarray(flat.convert("RGB"), np.float32) / 255.0


def compare(rows: Sequence[Sequence[tuple[str, Image.Image]]], prompt: str, fonts: Path) -> Image.Image:
    """Labeled panels side by side, rows of them one below the other, the prompt at the foot.

    Args:
        rows: (label, picture), from left to right; all in a row are as high as the first.
        prompt: Long ones are wrapped, and cut after four lines; "" for none.
    """
    title = lettering.font(26, prompt, fonts)
    label = lettering.font(18, "".join(name for row in rows for name, _ in row), fonts)
    sizes = [[_fitted(picture, _fitted(row[0][1])[1]) for _, picture in row] for row in rows]
    total = max(sum(width + _MARGIN for width, _ in row) for row in sizes) + _MARGIN
    lines = lettering.wrapped(f"“{prompt}”", title, total - 2 * _MARGIN, 4) if prompt.strip() else []
    head = 2 * _MARGIN + 8
    height = sum(head + row[0][1] for row in sizes)
    sheet = Image.new("RGB", (total, height + _MARGIN + 36 * len(lines) + _MARGIN), _PAPER)
    draw, top = ImageDraw.Draw(sheet), 0
    for row, row_sizes in zip(rows, sizes, strict=True):
        x = _MARGIN
        for (name, picture), size in zip(row, row_sizes, strict=True):
            draw.text((x + size[0] / 2, top + head / 2 + 2), name, _FAINT, label, anchor="mm")
            sheet.paste(picture.convert("RGB").resize(size, Image.Resampling.LANCZOS), (x, top + head))
            x += size[0] + _MARGIN
        top += head + row_sizes[0][1]
    for i, line in enumerate(lines):
        draw.text((total / 2, top + _MARGIN + 18 + 36 * i), line, _INK, title, anchor="mm")
    return sheet


def _fitted(picture: Image.Image, high: int = 0) -> tuple[int, int]:
    """Width and height of a panel that shows a picture; of a given height, if that is not 0."""
    width, height = picture.size
    scale = high / height if high else _PANEL / max(width, height)
    return max(round(width * scale), 1), max(round(height * scale), 1)
