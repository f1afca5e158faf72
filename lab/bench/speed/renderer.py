# SPDX-License-Identifier: Apache-2.0
"""Time of one step of the renderer: forward and backward, at 512 x 512 unless said otherwise."""

from __future__ import annotations

import json
import statistics
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import torch

from lab.bench.scenes import balls, outdoors
from lab.bench.speed import comparison, encoders
from proxy_renderer.render.proxy import Proxy
from proxy_renderer.scene import SceneData
from proxy_renderer.schema import atomic

try:
    import resource
except ImportError:  # Windows
    resource = None  # type: ignore[assignment]

_SIZE = 512
_STEPS = 8
_SIDES = (256, 512, 1024)
_TRIANGLES = (3, 7)  # subdivisions: a ball of 1,280 and one of 327,680 triangles
_COMMON = ("light/Lamp 0/power", "light/Lamp 0/color", "film/exposure", "film/contrast")
_ONE = [*(f"material/Ball 0/{name}" for name in ("base_color", "roughness", "metallic")), *_COMMON, "world/color"]
_COLORS = [f"material/Ball {i}/base_color" for i in range(3)]
_MANY, _FOGGY = [*_COLORS, *_COMMON, "world/color"], [*_COLORS, *_COMMON, "world/tint"]


def run(out: Path, mitsuba: bool = False, eevee_blender: str = "") -> dict[str, Any]:
    """Measures steps and writes OUT/results.json.

    Args:
        mitsuba: Whether to measure Mitsuba 3, see `comparison`.
        eevee_blender: A Blender with a window, whose EEVEE is measured, see `comparison`; "" for none.

    Returns:
        Milliseconds, and `memory_mb` by the side of the picture. `step_ms_512` is a step with eight parameters learned, as many as a round of a vibe
        chooses, of one material, one light, the world and the film; `..._eight_materials` the same of eight
        materials and four lights; `..._fog` these under a picture of the sky with a sun, in fog, and
        `..._fog_density` with the fog learned too; `..._everything` learns all that does not move, at once; then steps
        with a light or the camera moving before each, and steps for few and for many triangles; `encoder_ms` is what guidance by
        an encoder adds to a step.
    """
    if mitsuba:
        comparison.require()
    one, many, foggy = balls(1, 1), balls(8, 4), outdoors(8, 4)
    still = [key for key in one.instances if _still(key)]
    results: dict[str, Any] = {
        "threads": torch.get_num_threads(),
        "memory_mb": _memory(one),  # first: what later steps take would hide it
        "step_ms_512": _step(one, _ONE),
        "step_ms_512_eight_materials": _step(many, _MANY),
        "step_ms_512_eight_materials_fog": _step(foggy, _FOGGY),
        "step_ms_512_eight_materials_fog_density": _step(foggy, [*_FOGGY, "volume/density"]),
        "step_ms_512_everything": _step(one, still),
        "step_ms_512_eight_materials_everything": _step(many, [key for key in many.instances if _still(key)]),
        "step_ms_512_moving_light": _step(one, ["light/Lamp 0/azimuth", "light/Lamp 0/elevation"], 0.3),
        "step_ms_512_moving_camera": _step(one, ["camera/azimuth", "camera/elevation"], 0.3),
        "step_ms_by_triangles": {
            len(scene.mesh.faces): _step(scene, _ONE) for scene in (balls(2, 1, n) for n in _TRIANGLES)
        },
        "encoder_ms": encoders.milliseconds(),
    }
    for name, value in results.items():
        print(f"{name}: {value}")
    if mitsuba or eevee_blender:
        results["comparison"] = comparison.compare(
            out, _SIZE, lambda scene, keys, size: _step(scene, keys, size=size), mitsuba, eevee_blender
        )
    out.mkdir(parents=True, exist_ok=True)
    atomic.write_text(out / "results.json", json.dumps(results, indent=1))
    return results


def _memory(scene: SceneData) -> dict[int, int]:
    """Megabytes that a step needs at most, by the side of the picture; nothing where the system does not tell."""
    if resource is None:
        return {}
    peaks, start = {}, _peak()
    for side in _SIDES:  # the largest comes last: a peak never falls
        _step(scene, _ONE, size=side, steps=2)
        peaks[side] = round(_peak() - start)
    return peaks


def _peak() -> float:
    """The most memory that this process has had so far, megabytes."""
    assert resource is not None
    most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return most / 2**20 if sys.platform == "darwin" else most / 2**10


def _step(scene: SceneData, learned: Sequence[str], move: float = 0.0, size: int = _SIZE, steps: int = _STEPS) -> float:
    """Median milliseconds of rendering and differentiating; `move` is added before every step."""
    proxy = Proxy(scene, (size, size))
    values = {key: torch.tensor(scene.instances[key].value, requires_grad=True) for key in learned}
    times = []
    for step in range(steps):
        with torch.no_grad():
            for value in values.values():
                value += move
        start = time.perf_counter()
        picture = proxy.render(values).display
        picture.backward(torch.full_like(picture, 1e-6))
        if step > 1 or step == steps - 1:  # the first ones trace rays and warm up
            times.append(1000 * (time.perf_counter() - start))
    return round(statistics.median(times), 1)


def _still(key: str) -> bool:
    """True if a parameter changes looks only: no rays are traced again for it."""
    group, name = key.split("/")[0], key.rpartition("/")[2]
    placed = group == "light" and name in ("azimuth", "elevation", "distance", "size", "angle")
    return group in ("material", "light", "world", "film") and not placed
