# SPDX-License-Identifier: Apache-2.0
"""Distance of the proxy from Cycles, over a fixed set of scenes that a script builds.

Blender's side (`lab.blender`) builds each scene, exports it as a vibe does, and renders the
reference with Cycles; this side renders the job folder with the proxy and compares.
"""

from __future__ import annotations

import json
import time
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import torch
from PIL import Image
from torch import Tensor

from lab.bench import blender, cache, eevee, table
from lab.bench.metrics import Difference, difference
from lab.bench.sheet import Strip, error_picture, save_sheets
from proxy_renderer.engine.pictures import load_picture, save_picture
from proxy_renderer.render.cycles import CyclesPicture
from proxy_renderer.render.proxy import Proxy
from proxy_renderer.scene import load_scene
from proxy_renderer.schema import atomic

_QUICK = (128, 128)
_PANELS = ("cycles", "proxy", "error", "anchored", "eevee")
_DIGITS = 3


def run(
    out: Path,
    size: int = 256,
    samples: int = 512,
    quick: bool = False,
    only: str = "*",
    seed: int = 0,
    cache_folder: str = "",
    eevee_blender: str = "",
) -> dict[str, Any]:
    """Measures, prints tables, and writes OUT/results.json and contact sheets.

    Args:
        out: The folder. OUT/scenes/NAME keeps each scene's pictures and its job folder.
        size: Side of the pictures, pixels.
        quick: 128 pixels and 128 samples instead.
        seed: 0 for the set that is quoted; others vary it.
        cache_folder: Where references are kept; "" for the user's cache.
        eevee_blender: A Blender with a window, whose EEVEE is measured too; "" for none.

    Returns:
        The content of results.json. `failed` holds the scenes that could not be rendered, and why.
    """
    size, samples = _QUICK if quick else (size, samples)
    work = out / "scenes"
    options = [f"--work={work}", f"--cache={cache.folder(cache_folder)}", f"--seed={seed}"]
    options += [f"--size={size}", f"--samples={samples}", *(["--blend"] if eevee_blender else [])]
    measured: dict[str, dict[str, Any]] = {}
    failed: dict[str, str] = {}
    count = 0
    for event in blender.scenes(only, options):
        if event["type"] == "names":
            count = len(event["names"])
            continue
        name = event["name"]
        if event["type"] == "scene":
            try:
                measured[name] = measure(event, work / name)
            except Exception as error:  # one scene's; the others are wanted all the same
                event = {"type": "failed", "message": f"{type(error).__name__}: {error}"}
        if event["type"] == "failed":
            failed[name] = event["message"]
        print(
            f"[{len(measured) + len(failed)}/{count}] {name}: {_line(measured.get(name), failed.get(name))}", flush=True
        )
    if eevee_blender:
        eevee.measure(eevee_blender, measured, work, size, failed)
    results = table.summary(measured, failed) | {"size": size, "samples": samples, "seed": seed}
    save_sheets([_strip(name, row, work / name) for name, row in measured.items()], out)
    atomic.write_text(out / "results.json", json.dumps(results, indent=1))
    table.show(results)
    return results


def measure(event: dict[str, Any], folder: Path) -> dict[str, Any]:
    """Renders a job folder with the proxy and compares it with its reference.

    Args:
        event: What Blender's side told of the scene.
        folder: Gets cycles.png, proxy.png, error.png and anchored.png.
    """
    reference = torch.from_numpy(load_picture(Path(event["reference"])).copy())
    height, width, _ = reference.shape
    scene = load_scene(event["job"])
    start = time.monotonic()
    proxy = Proxy(scene, (width, height), fine=True)
    with torch.no_grad():
        picture = proxy.render({}).display
    seconds = time.monotonic() - start
    save_picture(reference, folder / "cycles.png")
    save_picture(picture, folder / "proxy.png")
    error_picture(picture, reference).save(folder / "error.png")
    return {
        "features": event["features"],
        **rounded(difference(picture, reference)),
        **_anchored(proxy, event["anchors"], reference, folder),
        "seconds": round(seconds, 2),
        "cycles_seconds": event["reference_seconds"],
        "cached": event["cached"],
        "reference": Path(event["reference"]).name,
        "warnings": event["warnings"],
    }


def _anchored(proxy: Proxy, anchors: Mapping[str, Any], reference: Tensor, folder: Path) -> dict[str, float]:
    """Distance of the proxy from Cycles after its correction by a small picture of Cycles, as in a round of a vibe.

    Args:
        anchors: "still", rendered at the scene's own values, and "moved", at others: the values that differ, the
            EXR, and its light groups.
        reference: Of the scene's own values, which the corrected proxies are asked for.
        folder: Gets anchored.png, corrected by what has moved.
    """
    measured = {}
    small: Proxy | None = None
    for name, figure in (("still", "anchored_still_delta_e"), ("moved", "anchored_delta_e")):
        anchor = anchors[name]
        cycles = CyclesPicture.load(anchor["picture"], anchor["groups"])
        small = small or Proxy(proxy.scene, cycles.size)
        values = {key: torch.tensor(value) for key, value in anchor["values"].items()}
        with torch.no_grad():
            proxy.correction = small.anchor(values, cycles)
            picture = proxy.render({}).display
        measured[figure] = round(difference(picture, reference).delta_e, _DIGITS)
        if name == "moved":
            save_picture(picture, folder / "anchored.png")
    return measured


def rounded(measured: Difference) -> dict[str, float]:
    """Figures for the report."""
    return {name: round(value, _DIGITS) for name, value in asdict(measured).items()}


def _line(row: dict[str, Any] | None, failure: str | None) -> str:
    if row is None:
        return f"FAILED: {failure}"
    spent = "cached" if row["cached"] else f"{row['cycles_seconds']:.0f} s of Cycles"
    return f"delta E {row['delta_e']:.2f}, anchored {row['anchored_delta_e']:.2f} ({spent})"


def _strip(name: str, row: dict[str, Any], folder: Path) -> Strip:
    panels = []
    for kind in (k for k in _PANELS if (folder / f"{k}.png").is_file()):
        with Image.open(folder / f"{kind}.png") as picture:
            panels.append((kind, picture.convert("RGB")))
    title = f"{name}   {row['delta_e']:.2f}, anchored {row['anchored_delta_e']:.2f}"
    note = f"p95 {row['p95']:.1f}, {row['lighter']:+.1f} L*, PSNR {row['psnr']:.1f}; {', '.join(row['features'])}"
    return Strip(title, note[:130], panels)
