# SPDX-License-Identifier: Apache-2.0
"""The paper's figures, from the pictures of the first seed."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from PIL import Image

from lab.bench.paper.pairs import Pair
from proxy_renderer.engine.pictures import save_image
from proxy_renderer.vlm import judge


def columns(rows: Sequence[tuple[Pair, Path, Path]]) -> list[judge.Column]:
    """The judge's columns, one for each pair.

    Args:
        rows: The pair, and the folders of its two runs.
    """
    return [judge.Column(_name(pair), pair.prompt, picture(a), picture(b)) for pair, a, b in rows]


def save_benchmark(rows: Sequence[tuple[Pair, Path, Path]], path: Path) -> None:
    """Figure 2: two rows, ours and CLIP-only, a column for each object with its prompt.

    Args:
        rows: Pair, folder of our run and folder of the CLIP-only run.
    """
    save_image(judge.figure(columns(rows)), path)


def save_ablation(rows: Sequence[tuple[Pair, Path]], path: Path) -> None:
    """Figures 3 and 4: what each prompt made of the artist's picture, above it.

    Args:
        rows: Pair and folder of its run.
    """
    columns = [
        judge.Column(pair.name, pair.prompt, picture(folder), picture(folder, "before")) for pair, folder in rows
    ]
    save_image(judge.figure(columns, ("Ours", "Before")), path)


def picture(folder: Path, which: str = "after") -> Image.Image:
    """A run's picture.

    Args:
        which: "before" for the artist's, "after" for the result.
    """
    with Image.open(folder / f"{which}.png") as image:
        return image.convert("RGB")


def _name(pair: Pair) -> str:
    return pair.name.replace("_", " ").capitalize()
