# SPDX-License-Identifier: Apache-2.0
"""Agreement of the proxy's gradients with the changes of Cycles' pictures, for every parameter of the schema.

Blender's side (`lab.blender.gradients`) moves each parameter a step to both sides on its perceptual scale and
renders with Cycles, every time with the same noise. The difference of these pictures is compared with autograd's
derivative of the proxy's, both of the same functionals: mean luminance and Lab of the subject and of the surroundings
(which stay where they were, whatever the camera does), the encoder's loss, and luminance over a coarse grid.

The gradient of the whole objective of a vibe, over all parameters of a scene, is compared too: see `objective`. It is
crooked (an encoder's similarity, hinges), so a derivative is not what a step brings, even of one renderer. Beside it
are the differences of the proxy's own pictures of the same steps: they say how much of it is due to the pictures.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import torch
from rich.console import Console
from rich.table import Table
from torch import Tensor
from torch.nn.functional import adaptive_avg_pool2d

from lab.bench import blender, cache
from lab.bench.objective import TERMS, agreement, objective
from proxy_renderer.color.tensors import lab_from_srgb, linear_from_srgb, luminance
from proxy_renderer.engine.pictures import load_picture
from proxy_renderer.guidance import regions
from proxy_renderer.guidance.encoder import Encoder, load_encoder
from proxy_renderer.guidance.regions import mean
from proxy_renderer.render.proxy import Proxy
from proxy_renderer.scene import load_scene
from proxy_renderer.schema import atomic

_CELLS = 6
_REGIONS = 8
_POOR = 0.5
_WAYS = ("gradient", "differences")
"""Derivatives of the proxy that are compared with the differences of Cycles' pictures: autograd's, and its own differences."""
_FAINT = 0.3
"""Change of a region's Lab over the whole of a parameter's scale that nobody sees."""


def run(out: Path, size: int = 96, samples: int = 128, only: str = "*", cache_folder: str = "") -> dict[str, Any]:
    """Measures, prints a table, and writes OUT/results.json.

    Args:
        out: The folder. OUT/scenes/NAME keeps each scene's job folder.
        size: Side of the pictures, pixels.
        cache_folder: Where pictures are kept; "" for the user's cache.

    Returns:
        The content of results.json: `mean_cosine`, `parameters` by family, `objective` by scene and way, `keys` with
        every single one, and `failed`: the scenes that could not be rendered, and why.
    """
    folder = cache.folder(cache_folder)
    options = [f"--work={out / 'scenes'}", f"--cache={folder}", f"--size={size}", f"--samples={samples}"]
    encoder = load_encoder(None, "cpu")
    keys: dict[str, dict[str, Any]] = {}
    failed: dict[str, str] = {}
    for event in blender.scenes(only, options, "gradients"):
        if event["type"] == "failed":
            failed[event["name"]] = event["message"]
        elif event["type"] == "scene":
            keys |= measure(event, encoder)
        if event["type"] != "names":
            print(f"{event['name']}: {event.get('message', 'measured')}", flush=True)
    results = summary(keys) | {"failed": failed, "size": size, "samples": samples}
    _show(results)
    atomic.write_text(out / "results.json", json.dumps(results, indent=1))
    return results


def measure(event: Mapping[str, Any], encoder: Encoder) -> dict[str, dict[str, Any]]:
    """Compares the gradients of one scene, parameter by parameter.

    Args:
        event: What Blender's side told of the scene.
        encoder: Whose loss to the scene's caption, and whose part of the objective, is differentiated.

    Returns:
        By "scene: key" what `compare` says, and for the `objective`, by way and term, the proxy's derivative and Cycles'.
    """
    steps = event["steps"]
    first = load_picture(Path(steps[0]["low_picture"]))
    proxy = Proxy(load_scene(event["job"]), (first.shape[1], first.shape[0]))
    values = {step["key"]: torch.tensor(step["middle"], requires_grad=True) for step in steps}
    picture = proxy.render(values)
    with torch.no_grad():
        caption = encoder.encode_texts([event["caption"]])
    mask = picture.mask.detach()
    judge = objective(proxy, event["prompt"], encoder)

    def outputs_of(display: Tensor) -> Tensor:
        return torch.cat((functionals(display, mask, encoder, caption), judge(display)))

    slopes = [
        torch.autograd.grad(output, list(values.values()), retain_graph=True, allow_unused=True)
        for output in outputs_of(picture.display)
    ]
    rows = {}
    for i, step in enumerate(steps):
        rate = (torch.tensor(step["high"]) - torch.tensor(step["low"])) / step["du"]
        ours = torch.stack([torch.zeros(()) if s[i] is None else (s[i] * rate).sum() for s in slopes])
        with torch.no_grad():
            low, high = (outputs_of(_picture(step[f"{end}_picture"])) for end in ("low", "high"))
            drawn = [proxy.render({step["key"]: torch.tensor(step[end])}) for end in ("low", "high")]
            own_low, own_high = (judge(picture.display) for picture in drawn)
        theirs = (high - low) / step["du"]
        split = len(ours) - len(TERMS)
        slopes_by_way = (ours[split:], (own_high - own_low) / step["du"])
        rows[f"{event['name']}: {step['key']}"] = {
            "family": step["family"],
            **compare(ours[:split], theirs[:split]),
            "objective": {
                way: dict(zip(TERMS, zip(slope.tolist(), theirs[split:].tolist(), strict=True), strict=True))
                for way, slope in zip(_WAYS, slopes_by_way, strict=True)
            },
        }
    return rows


def functionals(display: Tensor, mask: Tensor, encoder: Encoder, caption: Tensor) -> Tensor:
    """The values that are differentiated: luminance in percent and Lab of both regions, the encoder's loss, and cells (8 + 1 + 36).

    Args:
        display: (H, W, 3).
        mask: (H, W) the subject's, constant.
        encoder: See `measure`.
        caption: (1, D) features.
    """
    light = 100 * luminance(linear_from_srgb(display))
    colors = torch.cat((light, lab_from_srgb(display)), -1)
    features = encoder.encode_images(regions.whole(display.permute(2, 0, 1)[None], encoder.size))
    cells = adaptive_avg_pool2d(light.permute(2, 0, 1), _CELLS).flatten()
    return torch.cat((mean(colors, mask), mean(colors, 1 - mask), 1 - (features @ caption.T).flatten(), cells))


def compare(ours: Tensor, cycles: Tensor) -> dict[str, Any]:
    """Similarity of two derivatives of `functionals`.

    Args:
        ours: (45,), the proxy's derivative by one parameter: regions' means, the encoder's loss, then cells.
        cycles: (45,), that of Cycles' pictures.

    Returns:
        `cosine` of the regions' means, `image_cosine` of the cells, `sign`: whether the encoder's loss goes the same
        way, `length` of ours over Cycles', `change`: length of Cycles' derivative, all of the regions.
    """
    a, b = ours[:_REGIONS], cycles[:_REGIONS]
    return {
        "cosine": _cosine(a, b),
        "image_cosine": _cosine(ours[_REGIONS + 1 :], cycles[_REGIONS + 1 :]),
        "sign": bool(ours[_REGIONS] * cycles[_REGIONS] > 0),
        "length": round(float(a.norm() / b.norm().clamp_min(1e-9)), 3),
        "change": round(float(b.norm()), 3),
    }


def summary(keys: Mapping[str, Mapping[str, Any]]) -> dict[str, Any]:
    """The content of results.json: means by family, and over the families; the objective's cosines by scene."""
    families: dict[str, list[Mapping[str, Any]]] = {}
    for row in keys.values():
        families.setdefault(row["family"], []).append(row)
    parameters = {}
    for family, rows in families.items():
        average = {
            name: round(float(np.mean([row[name] for row in rows])), 3)
            for name in ("cosine", "image_cosine", "sign", "length", "change")
        }
        parameters[family] = {**average, "note": _note(average)}
    mean_cosine = float(np.mean([row["cosine"] for row in parameters.values()])) if parameters else 0.0
    return {
        "mean_cosine": round(mean_cosine, 3),
        "parameters": parameters,
        "objective": _objectives(keys),
        "keys": dict(keys),
    }


def _objectives(keys: Mapping[str, Mapping[str, Any]]) -> dict[str, dict[str, dict[str, float]]]:
    """By scene and way, the cosines of the objective's gradients over all parameters."""
    scenes: dict[str, dict[str, Any]] = {}
    for key, row in keys.items():
        scenes.setdefault(key.split(":")[0], {})[key] = row["objective"]
    return {
        name: {way: agreement({key: slopes[way] for key, slopes in rows.items()}) for way in _WAYS}
        for name, rows in scenes.items()
    }


def _note(row: Mapping[str, float]) -> str:
    """Why a gradient is poor, as far as the figures say; "" for a good one."""
    if row["cosine"] >= _POOR:
        return ""
    if row["change"] < _FAINT:
        return "Cycles' picture hardly depends on it"
    if row["length"] < 0.2:
        return "the proxy's picture hardly depends on it"
    return "the proxy goes another way"


def _cosine(a: Tensor, b: Tensor) -> float:
    return round(float((a @ b) / (a.norm() * b.norm()).clamp_min(1e-9)), 3)


def _picture(path: str) -> Tensor:
    return torch.from_numpy(load_picture(Path(path)).copy())


def _show(results: Mapping[str, Any]) -> None:
    table = Table(title=f"mean cosine {results['mean_cosine']:.3f}")
    for title in ("parameter", "cosine", "image", "CLIP sign", "length", "change", "note"):
        table.add_column(title, justify="left" if title in ("parameter", "note") else "right")
    for family, row in sorted(results["parameters"].items(), key=lambda item: item[1]["cosine"]):
        figures = [f"{row[name]:.2f}" for name in ("cosine", "image_cosine", "sign", "length", "change")]
        table.add_row(family, *figures, row["note"])
    Console().print(table)
    for way in _WAYS:
        table = Table(title=f"the objective over all parameters of a scene, cosine by {way}")
        columns = ("whole", *TERMS)
        for title in ("scene", *columns):
            table.add_column(title, justify="left" if title == "scene" else "right")
        for scene, row in results["objective"].items():
            table.add_row(scene, *(f"{row[way][name]:.2f}" if name in row[way] else "" for name in columns))
        Console().print(table)
