# SPDX-License-Identifier: Apache-2.0
"""Steps of Mitsuba 3, in a process of its own, because a compiler that does not suit it ends the process.

    python -m lab.bench.mitsuba.steps JOB SIZE THREADS OUT

writes OUT/SPP.npy, linear pictures, and prints one line of JSON with milliseconds for each count of samples.
"""

from __future__ import annotations

import json
import statistics
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

from lab.bench.mitsuba.twin import same, twin
from proxy_renderer.scene import load_scene

VARIANT = "llvm_ad_rgb"
SAMPLES = (4, 16, 64)
_STEPS = {4: 6, 16: 4, 64: 3}


def main(job: str, size: str, threads: str, out: str) -> None:
    """Times Mitsuba's gradient steps, keeps its pictures, and prints the figures as JSON.

    Arguments come from the command line, as texts.

    Args:
        job: The job folder of an exported scene.
        size: Side of the picture, pixels.
        out: Folder for the pictures, an array for each number of samples.
    """
    import drjit as dr
    import mitsuba as mi

    mi.set_variant(VARIANT)
    dr.set_thread_count(int(threads))
    scene = load_scene(job)
    picture = twin(mi, scene, (int(size), int(size)))
    parameters = mi.traverse(picture)
    keys = same(scene, parameters)
    times = {}
    for samples in SAMPLES:
        laps = []
        for seed in range(_STEPS[samples]):
            start = time.perf_counter()
            image = _step(dr, mi, picture, parameters, keys, samples, seed)
            laps.append(1000 * (time.perf_counter() - start))
        times[samples] = round(statistics.median(laps[1:]), 1)  # the first one compiles
        np.save(Path(out) / f"{samples}.npy", np.array(image))
    print(json.dumps({"version": mi.__version__, "learned": keys, "step_ms": times}))


def _step(dr: Any, mi: Any, picture: Any, parameters: Any, keys: list[str], samples: int, seed: int) -> Any:
    """Renders, and differentiates the mean of the picture in all keys."""
    for key in keys:
        value = dr.detach(parameters[key])
        dr.enable_grad(value)
        parameters[key] = value
    parameters.update()
    image = mi.render(picture, parameters, spp=samples, seed=seed)
    dr.backward(dr.mean(image, axis=None))
    gradients = [dr.grad(parameters[key]) for key in keys]
    dr.eval(image, gradients)
    dr.sync_thread()
    return image


if __name__ == "__main__":
    main(*sys.argv[1:])
