# SPDX-License-Identifier: Apache-2.0
"""The proxy beside Mitsuba 3: time per step, and how far both are from Cycles, on scenes of `vibe bench fidelity`.

Both render the same exported meshes, lights and materials at the same size on the same threads, and
differentiate the mean of the picture in the same values. Their pictures go through the same film.
"""

from __future__ import annotations

import importlib.util
import json
import subprocess
import sys
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import torch

from ...blender.launch import environment
from ...engine.report import load_picture, save_picture
from ...render.proxy import Proxy
from ...scene import SceneData, load_scene
from ...schema import VibeError
from .. import blender, cache
from ..fidelity import rounded
from ..metrics import difference
from ..mitsuba.steps import VARIANT
from ..mitsuba.twin import DEPTH, learned

SCENES = ("clay_head", "steel_bolts")
_SAMPLES = 192
_LLVM = "Install LLVM 16 or later (Debian, Ubuntu: `apt install libllvm19`) and set DRJIT_LIBLLVM_PATH to its library."

Step = Callable[[SceneData, Sequence[str], int], float]


def require() -> None:
    """Refuses to start without Mitsuba, and names the package to install.

    Raises:
        VibeError: Mitsuba is not there.
    """
    if importlib.util.find_spec("mitsuba") is None:
        raise VibeError(
            "Mitsuba 3 is not installed; --mitsuba needs it.", "`pip install mitsuba==3.9.1`. " + _LLVM
        )


def compare(out: Path, size: int, step: Step) -> dict[str, Any]:
    """Measures both on every scene; OUT/mitsuba holds the pictures.

    Args:
        out: The folder of the measurement.
        size: Side of the pictures, pixels.
        step: Milliseconds of a step of the proxy: (scene, learned keys, size).

    Returns:
        Per scene: `proxy` with `step_ms` and its difference from Cycles, and the same of Mitsuba for several
        counts of samples per pixel.

    Raises:
        VibeError: Mitsuba or its compiler is missing, or a scene could not be rendered.
    """
    options = [f"--work={out / 'mitsuba'}", f"--cache={cache.folder()}", "--seed=0"]
    options += [f"--size={size}", f"--samples={_SAMPLES}"]
    rows: dict[str, Any] = {}
    for name in SCENES:
        for event in blender.scenes(name, options):
            if event["type"] == "failed":
                raise VibeError(f"{name} could not be rendered: {event['message']}.", "Run `vibe doctor`.")
            if event["type"] == "scene":
                rows[name] = _row(event, out / "mitsuba" / name, size, step)
                print(_line(name, rows[name]), flush=True)
    return {"integrator": f"prb, depth {DEPTH}", "variant": VARIANT, "size": size, "scenes": rows}


def _row(event: dict[str, Any], folder: Path, size: int, step: Step) -> dict[str, Any]:
    scene = load_scene(event["job"])
    reference = torch.from_numpy(load_picture(Path(event["reference"])).copy())
    proxy = Proxy(scene, (size, size))
    with torch.no_grad():
        picture = proxy.render({}).display
    save_picture(reference, folder / "cycles.png")
    save_picture(picture, folder / "proxy.png")
    ours = {"step_ms": step(scene, learned(scene), size), **rounded(difference(picture, reference))}
    output, pictures = _mitsuba(Path(event["job"]), size)
    theirs = {}
    for samples, linear in pictures.items():
        with torch.no_grad():
            shown = proxy.film.develop(torch.from_numpy(linear), {})
        save_picture(shown, folder / f"mitsuba_{samples}.png")
        theirs[samples] = {"step_ms": output["step_ms"][samples], **rounded(difference(shown, reference))}
    return {"proxy": ours, "mitsuba": theirs, "version": output["version"], "learned": learned(scene)}


def _mitsuba(job: Path, size: int) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """Mitsuba's printed figures, and its linear pictures by samples per pixel."""
    with tempfile.TemporaryDirectory(prefix="vibe-mitsuba-") as folder:
        module = "proxy_renderer.bench.mitsuba.steps"
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
    rows = {"proxy": row["proxy"], **{f"Mitsuba, {n} spp": r for n, r in row["mitsuba"].items()}}
    parts = (
        f"{who} {r['step_ms']:.0f} ms, delta E {r['delta_e']:.2f}, {r['psnr']:.1f} dB"
        for who, r in rows.items()
    )
    return f"{name}: {'; '.join(parts)}"
