# SPDX-License-Identifier: Apache-2.0
"""A vibe for each measured material, "the ball is NAME", and for each light source, "lit by NAME", in one gray studio.

What is compared is the ball's mean color with that of a Cycles picture of the same studio whose ball has the measured color,
metalness, roughness, IOR and transmission: a mirror or a glass has no color of its own to compare with. Light that passes
below a surface, and thin films, are left out. All other figures are differences of values.
"""

from __future__ import annotations

import hashlib
import json
import random
from collections.abc import Mapping, Sequence
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

from PIL import Image

from lab.bench import blender
from lab.bench.materials import compare, table
from lab.bench.paper import finished
from lab.bench.sealed.prompts import measured
from lab.bench.sheet import Strip, save_sheets
from lab.bench.wild import product
from proxy_renderer.schema import VibeError, atomic

Rows = list[dict[str, Any]]


def run(out: Path, only: str = "*", draw: int = 0, size: int = 160, samples: int = 32) -> dict[str, Any]:
    """Carries out what is missing, compares, and writes OUT/results.json and contact sheets.

    Args:
        out: The folder. OUT/runs keeps each vibe; one that is there is not done again.
        only: A pattern of what the prompts call them.
        draw: How many of those, drawn at random with seed 0, fewer being the first of more; 0 for all.
        size: Side of the pictures, pixels.

    Returns:
        The content of results.json; see `table.summary`.

    Raises:
        VibeError: Nothing has such a name.
    """
    chosen = _chosen(only, draw)
    if not chosen:
        raise VibeError(f"Nothing has a name like {only!r}.", "Use *, or a part of a name: *glass*.")
    vibes = _Vibes(
        out, _studio(out / "studio"), [f"--size={size}", f"--samples={samples}", "--vlm-model=off", "--figures"]
    )
    materials = [row for kind, row in chosen if kind == "material"]
    references = _references(out, vibes.scene, materials, size, samples)
    rows: Rows = []
    for kind, row in chosen:
        prompt = f"the ball is {row['say']}" if kind == "material" else f"lit by {row['say']}"
        done = {"name": row["name"], "kind": kind, "prompt": prompt, **vibes.vibe(prompt)}
        if done["code"] == 0:
            done |= _compared(row, kind, vibes.folder(prompt), references)
        rows.append(done)
        print(f"[{len(rows)}/{len(chosen)}] {prompt}: {table.line(done)}", flush=True)
    results = table.summary(rows) | {"draw": draw, "size": size, "samples": samples}
    save_sheets([_strip(row, vibes.folder(row["prompt"]), references) for row in rows], out)
    atomic.write_text(out / "results.json", json.dumps(results, indent=1, ensure_ascii=False))
    table.show(results)
    return results


class _Vibes:
    """Vibes of one scene, each in a folder that is named by its prompt and its options."""

    def __init__(self, out: Path, scene: Path, options: Sequence[str]) -> None:
        self.scene = scene
        self._out, self._options = out, [*options, "--subject=Ball"]

    def folder(self, prompt: str) -> Path:
        """Folder of a prompt's vibe."""
        text = "\n".join([prompt, *self._options])
        return self._out / "runs" / hashlib.sha256(text.encode()).hexdigest()[:16]

    def vibe(self, prompt: str) -> dict[str, Any]:
        """End of a prompt's vibe; see `product.vibe_once`."""
        return product.vibe_once(self.scene, prompt, self.folder(prompt), self._options)


def _studio(folder: Path) -> Path:
    """The studio as a .blend, built if it is not there."""
    path = folder / "scene.blend"
    if not (folder / "sight.npz").is_file():
        folder.mkdir(parents=True, exist_ok=True)
        blender.command("materials", "studio", folder)
    return path


def _chosen(only: str, draw: int) -> list[tuple[str, dict[str, Any]]]:
    """Kind and row of what has such a name."""
    kinds = {"material": "materials", "light": "lights"}
    rows = [(k, row) for k, name in kinds.items() for row in measured()[name] if fnmatchcase(row["say"], only)]
    return random.Random(0).sample(rows, len(rows))[:draw] if draw else rows


def _references(out: Path, scene: Path, materials: Rows, size: int, samples: int) -> Path:
    """The folder with the studio's pictures of all measured materials."""
    folder = out / f"references-{size}-{samples}"
    folder.mkdir(exist_ok=True)
    rows = [{**row, "file": f"{row['say']}.png"} for row in materials]
    atomic.write_text(folder / "materials.json", json.dumps(rows))
    blender.command("materials", "measured", scene, folder / "materials.json", folder, size, samples)
    return folder


def _compared(row: Mapping[str, Any], kind: str, folder: Path, references: Path) -> dict[str, Any]:
    report = json.loads((folder / "out" / "report.json").read_text("utf-8"))
    ignored, values = report["understood"]["ignored"], report["parameters"]
    if kind == "light":
        return {"ignored": ignored, **compare.lamp(row, values)}
    mask, sight = folder / "out" / "mask.png", references.parent / "studio" / "sight.npz"
    after, reference = (
        finished.read(picture, mask, sight)
        for picture in (folder / "out" / "after.png", references / f"{row['say']}.png")
    )
    return {"ignored": ignored, **compare.material(row, values, after, reference)}


def _strip(row: Mapping[str, Any], folder: Path, references: Path) -> Strip:
    """The vibe's picture, and for a material what was measured."""
    measured_picture = references / f"{row['prompt'].removeprefix('the ball is ')}.png"
    panels = []
    for name, path in (("vibe", folder / "out" / "after.png"), ("measured", measured_picture)):
        if path.is_file():
            with Image.open(path) as picture:
                panels.append((name, picture.convert("RGB")))
    return Strip(row["prompt"], table.line(row)[:80], panels or [("no picture", Image.new("RGB", (256, 256)))])
