# SPDX-License-Identifier: Apache-2.0
"""How long one step of the renderer takes: forward and backward, at 512 x 512 unless said otherwise."""

from __future__ import annotations

import json
import os
import statistics
import time
from pathlib import Path
from typing import Any

import torch

from ..render.proxy import Proxy
from ..scene import SceneData
from .scenes import balls

_SIZE = 512
_STEPS = 8
_TRIANGLES = (3, 7)  # subdivisions: a ball of 1,280 and one of 327,680 triangles


def main(out: Path) -> dict[str, Any]:
    """Measures steps and writes OUT/results.json.

    Returns:
        Milliseconds: `step_ms_512` for one material and one light with all of their looks (and the
        film's) learned, `step_ms_512_eight_materials` for eight and four lights, the step while
        a light or the camera moves, and the step for few and for many triangles.
    """
    one, many = balls(1, 1), balls(8, 4)
    results: dict[str, Any] = {
        "threads": torch.get_num_threads(),
        "step_ms_512": _step(one, ("material", "light", "world", "film")),
        "step_ms_512_eight_materials": _step(many, ("material", "light", "world", "film")),
        "step_ms_512_moving_light": _step(one, ("azimuth", "elevation"), moving="light"),
        "step_ms_512_moving_camera": _step(one, ("azimuth", "elevation"), moving="camera"),
        "step_ms_by_triangles": {
            len(scene.mesh.faces): _step(scene, ("material", "light"))
            for scene in (balls(2, 1, subdivisions) for subdivisions in _TRIANGLES)
        },
    }
    out.mkdir(parents=True, exist_ok=True)
    part = out / "results.json.part"
    part.write_text(json.dumps(results, indent=1), encoding="utf-8")
    os.replace(part, out / "results.json")
    return results


def _step(scene: SceneData, learned: tuple[str, ...], moving: str = "") -> float:
    """Median milliseconds of rendering and differentiating; what moves is moved before every step."""
    proxy = Proxy(scene, (_SIZE, _SIZE))
    values = {
        key: torch.tensor(i.value, requires_grad=True)
        for key, i in scene.instances.items()
        if _learned(key, learned, moving)
    }
    times = []
    for step in range(_STEPS):
        if moving:
            with torch.no_grad():
                for value in values.values():
                    value += 0.3
        start = time.perf_counter()
        picture = proxy.render(values).display
        picture.backward(torch.full_like(picture, 1e-6))
        if step > 1:
            times.append(1000 * (time.perf_counter() - start))
    return round(statistics.median(times), 1)


def _learned(key: str, learned: tuple[str, ...], moving: str) -> bool:
    group, name = key.split("/")[0], key.rpartition("/")[2]
    if moving:
        return group == moving and name in learned
    placed = group == "light" and name in ("azimuth", "elevation", "distance", "size", "angle")
    return group in learned and not placed
