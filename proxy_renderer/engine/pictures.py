# SPDX-License-Identifier: Apache-2.0
"""Images of a vibe: predictions, image files, and sheets of labeled panels."""

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import torch
from PIL import Image, ImageDraw, ImageFont
from torch import Tensor

from ..color.tensors import ciede2000, lab_from_srgb
from ..optimize.pipeline import Outcome
from ..optimize.shots import draw, picture_size
from ..render.proxy import Proxy
from ..schema import atomic

PICTURES = {
    "shown": "prediction.png",
    "before_last_anchor": "prediction-earlier.png",
    "unanchored": "prediction-unanchored.png",
}
"""Kind of prediction -> its file. The last anchor was rendered at the final values, so that "shown" says little about the
proxy. "before_last_anchor" does: its correction comes from other values."""
VARIANT = "variant-{}.png"  # the file name of a variant's image; numbers start at 1

Font = ImageFont.FreeTypeFont | ImageFont.ImageFont

_PANEL, _MARGIN = 512, 24  # pixels
_PAPER, _INK, _FAINT = (250, 250, 248), (32, 32, 36), (120, 120, 126)
_LATIN, _CJK = "Inter.woff2", "Noto Sans CJK Regular.woff2"
_EAST_ASIAN = re.compile(r"[\u1100-\u11ff\u2e80-\u9fff\uac00-\ud7af\uf900-\ufaff\uff00-\uffef]")
_UNIT = re.compile(rf"{_EAST_ASIAN.pattern}|\s*(?:(?!{_EAST_ASIAN.pattern})\S)+")
"""A unit of text, after which a line may end: an East Asian character, or a word with the space before it."""


@torch.no_grad()
def predict(proxy: Proxy, outcome: Outcome, number: int, job: Path, figures: bool) -> tuple[list[str], Image.Image]:
    """Draws shot `number` (from 0) at the values found, by its full-size proxy, into the shot's job folder `job`.

    With `figures`, and if there is an anchor, also draws the predictions without the last and without any anchor.
    Returns the keys of `PICTURES` that were drawn, and a gray image: the share of each pixel that the subject covers.
    """
    anchor = outcome.shots[number].anchor
    corrections = {"shown": anchor.correction}
    if anchor.correction is not None and figures:
        corrections |= {"before_last_anchor": anchor.earlier, "unanchored": None}
    for name, correction in corrections.items():
        proxy.correction = correction
        picture = draw(proxy, outcome.shots[number].vector, outcome.u)
        save_picture(picture.display, job / PICTURES[name])
    return list(corrections), as_image(picture.mask)


@torch.no_grad()
def predict_variants(proxy: Proxy, outcome: Outcome, number: int, job: Path) -> list[Image.Image]:
    """Images of a shot at the values of each variant, also saved as `VARIANT`. Arguments as for `predict`."""
    pictures = []
    for place, look in enumerate(outcome.variants, start=1):
        proxy.correction = look.shots[number].anchor.correction
        pictures.append(as_image(draw(proxy, look.shots[number].vector, look.u).display))
        save_image(pictures[-1], job / VARIANT.format(place))
    return pictures


def difference(predicted: np.ndarray, after: np.ndarray, subject: np.ndarray) -> dict[str, float]:
    """CIEDE2000 of two sRGB images (H, W, 3): "mean", "p95", and "subject" where coverage `subject` (H, W) is > 0.5."""
    labs = (lab_from_srgb(torch.from_numpy(picture)) for picture in (predicted, after))
    errors = ciede2000(*labs).numpy()
    figures = {"mean": errors.mean(), "p95": np.percentile(errors, 95)}
    if (subject > 0.5).any():
        figures["subject"] = errors[subject > 0.5].mean()
    return {name: round(float(figure), 3) for name, figure in figures.items()}


def as_image(picture: Tensor) -> Image.Image:
    """An 8-bit image of (H, W, 3) or (H, W) in [0, 1]; values outside are clipped."""
    return Image.fromarray((picture.detach().cpu().numpy().clip(0.0, 1.0) * 255.0 + 0.5).astype(np.uint8))


def save_picture(picture: Tensor, path: Path) -> None:
    """Writes (H, W, 3) or (H, W) in [0, 1] as an 8-bit PNG, all at once or not at all; raises OSError if it cannot."""
    save_image(as_image(picture), path)


def save_image(image: Image.Image, path: Path) -> None:
    """Writes a PNG, all at once or not at all; raises OSError if it cannot."""
    with atomic.replacing(path) as part:
        image.save(part, format="PNG")


def load_picture(path: Path | str, shape: tuple[int, int] | None = None) -> np.ndarray:
    """Reads an image, on black, as (H, W, 3) float32 in [0, 1]; `shape`: (width, height) to resize to, or None."""
    with Image.open(path) as image:
        flat = Image.alpha_composite(Image.new("RGBA", image.size, (0, 0, 0, 255)), image.convert("RGBA"))
    shown = flat.convert("RGB").resize(shape or flat.size, Image.Resampling.LANCZOS)
    return np.asarray(shown, np.float32) / 255.0


def compare(rows: Sequence[Sequence[tuple[str, Image.Image]]], prompt: str, fonts: Path) -> Image.Image:
    """A sheet of `rows` of (label, image) panels, above the prompt in at most four lines ("" for none).

    Each row has the height of its first panel; `fonts` is the folder of Blender's fonts.
    """
    title = font(26, prompt, fonts)
    label = font(18, "".join(name for row in rows for name, _ in row), fonts)
    sizes = []
    for row in rows:
        high = picture_size(row[0][1].size, _PANEL)[1]
        sizes.append([(max(round(picture.width * (high / picture.height)), 1), high) for _, picture in row])
    total = max(sum(width + _MARGIN for width, _ in row) for row in sizes) + _MARGIN
    lines = wrapped(f"“{prompt}”", title, total - 2 * _MARGIN, 4) if prompt.strip() else []
    head = 2 * _MARGIN + 8
    height = sum(head + row[0][1] for row in sizes)
    sheet = Image.new("RGB", (total, height + _MARGIN + 36 * len(lines) + _MARGIN), _PAPER)
    pen, top = ImageDraw.Draw(sheet), 0
    for row, row_sizes in zip(rows, sizes, strict=True):
        x = _MARGIN
        for (name, picture), size in zip(row, row_sizes, strict=True):
            pen.text((x + size[0] / 2, top + head / 2 + 2), name, _FAINT, label, anchor="mm")
            sheet.paste(picture.convert("RGB").resize(size, Image.Resampling.LANCZOS), (x, top + head))
            x += size[0] + _MARGIN
        top += head + row_sizes[0][1]
    for i, line in enumerate(lines):
        pen.text((total / 2, top + _MARGIN + 18 + 36 * i), line, _INK, title, anchor="mm")
    return sheet


def font(size: int, text: str, fonts: Path) -> Font:
    """A font of a size in pixels with the characters of `text`; Pillow's own if the folder `fonts` has no such font."""
    try:
        return ImageFont.truetype(str(fonts / (_CJK if _EAST_ASIAN.search(text) else _LATIN)), size)
    except OSError:
        return ImageFont.load_default(size)


def wrapped(text: str, face: Font, width: float, most: int) -> list[str]:
    """At most `most` lines of a text, each at most `width` pixels wide; "…" marks that text is left out."""
    lines = [""]
    for unit in _UNIT.findall(text):
        if lines[-1] and face.getlength(lines[-1] + unit) > width:
            lines.append("")
        lines[-1] = (lines[-1] + unit).lstrip()
    if len(lines) <= most:
        return lines
    last = lines[most - 1]
    while last and face.getlength(f"{last} …") > width:
        last = last[:-1]
    return [*lines[: most - 1], f"{last} …"]
