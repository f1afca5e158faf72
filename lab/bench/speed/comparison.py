# SPDX-License-Identifier: Apache-2.0
"""The proxy beside Mitsuba 3 and EEVEE: time, and how far all are from Cycles, on scenes of `python -m lab fidelity`.

Mitsuba renders the same exported meshes, lights and materials at the same size on the same threads, and differentiates the
mean of the picture in the same values. Its pictures go through the same film. EEVEE differentiates nothing: a frame of its own
stands beside a picture of the proxy without gradients.
"""

from __future__ import annotations

import importlib.util
import json
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import torch

from lab.bench import blender, cache, eevee
from lab.bench.fidelity import rounded
from lab.bench.metrics import difference
from lab.bench.mitsuba.steps import VARIANT
from lab.bench.mitsuba.twin import DEPTH, learned
from proxy_renderer.blender.launch import environment
from proxy_renderer.engine.pictures import load_picture, save_picture
from proxy_renderer.render.proxy import Proxy
from proxy_renderer.scene import SceneData, load_scene
from proxy_renderer.schema import VibeError

SCENES = ("clay_head", "steel_bolts")
_SAMPLES = 192
_FRAMES = 5
_LLVM = "Install LLVM 16 or later (Debian, Ubuntu: `apt install libllvm19`) and set DRJIT_LIBLLVM_PATH to its library."

Step = Callable[[SceneData, Sequence[str], int], float]


def require() -> None:
    """Refuses to start without Mitsuba, and names the package to install.

    Raises:
        VibeError: Mitsuba is not there.
    """
    if importlib.util.find_spec("mitsuba") is None:
        raise VibeError("Mitsuba 3 is not installed; --mitsuba needs it.", "`pip install mitsuba==3.9.1`. " + _LLVM)


def compare(out: Path, size: int, step: Step, mitsuba: bool, eevee_blender: str) -> dict[str, Any]:
    """Measures all on every scene; OUT/comparison holds the pictures.

    Args:
        size: Side of the pictures, pixels.
        step: Milliseconds of a step of the proxy: (scene, learned keys, size).
        eevee_blender: A Blender with a window, whose EEVEE is measured; "" for none.

    Returns:
        Per scene: `proxy` with `step_ms`, `frame_ms` and its difference from Cycles; `mitsuba`, the same for several counts of
        samples per pixel; `eevee_ms`, `eevee_delta_e` and `eevee_psnr`. `failed`: what EEVEE did not render.

    Raises:
        VibeError: Mitsuba, its compiler or the other Blender is missing, or a scene could not be rendered.
    """
    work = out / "comparison"
    options = [f"--work={work}", f"--cache={cache.folder()}", "--seed=0", "--blend"]
    options += [f"--size={size}", f"--samples={_SAMPLES}"]
    rows: dict[str, Any] = {}
    for name in SCENES:
        for event in blender.scenes(name, options):
            if event["type"] == "failed":
                raise VibeError(f"{name} could not be rendered: {event['message']}.", "Run `vibe doctor`.")
            if event["type"] == "scene":
                rows[name] = _row(event, work / name, size, step, mitsuba)
    failed: dict[str, str] = {}
    if eevee_blender:
        eevee.measure(eevee_blender, rows, work, size, failed, frames=2)
    for name, row in rows.items():
        print(_line(name, row), flush=True)
    return {"integrator": f"prb, depth {DEPTH}", "variant": VARIANT, "size": size, "scenes": rows, "failed": failed}


def _row(event: dict[str, Any], folder: Path, size: int, step: Step, mitsuba: bool) -> dict[str, Any]:
    scene = load_scene(event["job"])
    reference = torch.from_numpy(load_picture(Path(event["reference"])).copy())
    proxy = Proxy(scene, (size, size))
    with torch.no_grad():
        picture = proxy.render({}).display
    save_picture(reference, folder / "cycles.png")
    save_picture(picture, folder / "proxy.png")
    times = {"step_ms": step(scene, learned(scene), size), "frame_ms": _frame(proxy)}
    row: dict[str, Any] = {"proxy": times | rounded(difference(picture, reference)), "learned": learned(scene)}
    if mitsuba:
        output, pictures = _mitsuba(Path(event["job"]), size)
        row |= {"mitsuba": {}, "version": output["version"]}
        for samples, linear in pictures.items():
            with torch.no_grad():
                shown = proxy.film.develop(torch.from_numpy(linear), {})
            save_picture(shown, folder / f"mitsuba_{samples}.png")
            step_ms = output["step_ms"][samples]
            row["mitsuba"][samples] = {"step_ms": step_ms, **rounded(difference(shown, reference))}
    return row


def _frame(proxy: Proxy) -> float:
    """Median milliseconds of a picture of other lights, without gradients."""
    times = []
    for strength in range(_FRAMES):
        start = time.perf_counter()
        with torch.no_grad():
            proxy.expose({"world/strength": torch.tensor([1.0 + strength])})
        times.append(1000 * (time.perf_counter() - start))
    return round(statistics.median(times), 1)


def _mitsuba(job: Path, size: int) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """Mitsuba's printed figures, and its linear pictures by samples per pixel."""
    with tempfile.TemporaryDirectory(prefix="vibe-mitsuba-") as folder:
        module = "lab.bench.mitsuba.steps"
        threads = str(torch.get_num_threads())
        done = subprocess.run(
            [sys.executable, "-m", module, str(job), str(size), threads, folder],
            capture_output=True,
            encoding="utf-8",
            errors="replace",
            env=environment(),
        )
        if done.returncode != 0:
            first_line = next((line for line in done.stderr.splitlines() if line.strip()), "nothing")
            raise VibeError(f"Mitsuba ended with code {done.returncode}: {first_line.strip()[:160]}.", _LLVM)
        output = json.loads(done.stdout.splitlines()[-1])
        return output, {path.stem: np.load(path) for path in sorted(Path(folder).glob("*.npy"), key=_number)}


def _number(path: Path) -> int:
    return int(path.stem)


def _line(name: str, row: dict[str, Any]) -> str:
    steps = {"proxy": row["proxy"], **{f"Mitsuba, {n} spp": r for n, r in row.get("mitsuba", {}).items()}}
    parts = [f"{who} {r['step_ms']:.0f} ms a step, delta E {r['delta_e']:.2f}" for who, r in steps.items()]
    parts.append(f"proxy {row['proxy']['frame_ms']:.0f} ms a frame")
    if "eevee_ms" in row:
        parts.append(f"EEVEE {row['eevee_ms']:.0f} ms a frame, delta E {row['eevee_delta_e']:.2f}")
    return f"{name}: {'; '.join(parts)}"
