# SPDX-License-Identifier: Apache-2.0
"""Comparison of the prediction with Cycles' renders, where things hide, replace or multiply: scenes at random."""

from __future__ import annotations

import json
import statistics
from pathlib import Path
from typing import Any

import torch
from PIL import Image

from lab.bench import blender
from lab.bench.metrics import difference
from proxy_renderer.engine.pictures import load_picture, save_picture
from proxy_renderer.render.cycles import CyclesPicture
from proxy_renderer.render.proxy import Proxy
from proxy_renderer.scene import load_scene
from proxy_renderer.schema import atomic


def run(
    out: Path, count: int = 500, seed: int = 0, size: int = 160, samples: int = 32, only: str = "*"
) -> dict[str, Any]:
    """Makes the scenes, prints a line for each, and writes OUT/results.json.

    Returns:
        The content of results.json. `failed` holds scenes that could not be made, and those in which something differs.
    """
    torch.set_num_threads(1)  # small pictures: threads would only wait for one another
    options = [f"--work={out / 'scenes'}", f"--count={count}", f"--seed={seed}", f"--size={size}"]
    rows: dict[str, dict[str, Any]] = {}
    failed: dict[str, str] = {}
    for event in blender.scenes(only, [*options, f"--samples={samples}"], bench="rendered"):
        if event["type"] == "names":
            continue
        name = event["name"]
        if event["type"] == "failed":
            failed[name] = event["message"]
        else:
            rows[name] = {**event, **_errors(event)}
            if wrong := _wrong(rows[name]):
                failed[name] = wrong
        print(
            f"{name}: {[rows[name][k] for k in ('error', 'anchored')] if name in rows else ''} {failed.get(name, '')}",
            flush=True,
        )
    results = summary(rows, failed) | {"rows": rows}
    atomic.write_text(out / "results.json", json.dumps(results, indent=1))
    print(json.dumps({name: value for name, value in results.items() if name not in ("rows", "failed")}))
    return results


def summary(rows: dict[str, dict[str, Any]], failed: dict[str, str]) -> dict[str, Any]:
    """The figures of all scenes; errors of those in which the prediction leaves nothing out, and of the others."""
    return {
        "scenes": len({*rows, *failed}),
        "made": len(rows),
        "exact_reverts": sum(not row["not_reverted"] for row in rows.values()),
        "visible_alike": sum(not row["unlike"] for row in rows.values()),
        "noted": sum(not row["unnamed"] for row in rows.values()),
        "honored": _spread([row for row in rows.values() if not row["named"]]),
        "reported": _spread([row for row in rows.values() if row["named"]]),
        "failed": failed,
    }


def _spread(rows: list[dict[str, Any]]) -> dict[str, float]:
    """Median and 95th percentile of the errors of at least two scenes."""
    figures = {"scenes": float(len(rows))}
    for kind in ("error", "anchored") if len(rows) > 1 else ():
        errors = [row[kind] for row in rows]
        figures[f"{kind}_median"] = round(statistics.median(errors), 3)
        figures[f"{kind}_p95"] = round(statistics.quantiles(errors, n=20)[-1], 3)
    return figures


def _wrong(row: dict[str, Any]) -> str:
    """Differences in a scene, in words; "" if nothing does."""
    parts = [
        f"no note: {', '.join(row['unnamed'])}" if row["unnamed"] else "",
        f"visible: {row['unlike']}" if row["unlike"] else "",
        f"not reverted: {row['not_reverted'][:3]}" if row["not_reverted"] else "",
        "far from the render" if row["error"] > _FAR and not row["named"] else "",
    ]
    return "; ".join(filter(None, parts))


_FAR = 2.0  # CIEDE2000


def _errors(event: dict[str, Any]) -> dict[str, float]:
    """Mean CIEDE2000 between proxy and Cycles, plain and corrected by an anchor, on black where the film is transparent."""
    with Image.open(event["render"]) as image:
        flat = Image.new("RGBA", image.size, "black")
        flat.alpha_composite(image.convert("RGBA"))
    folder = Path(event["render"]).parent
    flat.convert("RGB").save(folder / "flat.png")
    reference = torch.from_numpy(load_picture(folder / "flat.png").copy())
    height, width, _ = reference.shape
    anchor = event["anchor"]
    values = {key: torch.tensor(value) for key, value in anchor["values"].items()}
    with torch.no_grad():
        proxy = Proxy(load_scene(event["job"]), (width, height))
        plain = proxy.render({}).display
        proxy.anchor(values, CyclesPicture.load(anchor["picture"], anchor["groups"]))
        anchored = proxy.render({}).display
    save_picture(plain, folder / "predicted.png")
    pictures = {"error": plain, "anchored": anchored}
    return {name: round(difference(each, reference).delta_e, 3) for name, each in pictures.items()}
