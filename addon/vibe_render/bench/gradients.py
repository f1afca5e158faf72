# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's side of `vibe bench gradients`: scenes, and what Cycles makes of a step of each of their parameters.

    python -m vibe_render.bench.gradients --work DIR --cache DIR --size 96 --samples 128 [--only GLOB] ...

It prints lines `VIBE {json}`: "names", then "begin" before each scene, and "scene" or "failed" after it.
"""

from __future__ import annotations

import argparse
import hashlib
import os
import sys
import traceback
from fnmatch import fnmatchcase
from typing import Any

import bpy

from .. import bindings, rendering, scene_io
from ..contract import schema
from ..export import Job
from ..subject import Choice
from .build import build
from .fidelity import arguments, say
from .fingerprint import fingerprint
from .steps import CASES, Case, ends

VERSION = 1
"""Raised when the way pictures are rendered changes."""


def main() -> int:
    """Makes the scenes one after another; what goes wrong with one is told and the next one comes."""
    a = arguments()
    chosen = {case.recipe.name: case for case in CASES if fnmatchcase(case.recipe.name, a.only)}
    if not chosen:
        names = ", ".join(case.recipe.name for case in CASES)
        say("error", message=f"No scene has a name like {a.only!r}.", remedy=f"There are: {names}.")
        return 2
    say("names", names=list(chosen))
    for name in (n for n in chosen if n not in a.skip.split(",")):
        say("begin", name=name)
        try:
            say("scene", name=name, **make(chosen[name], a))
        except Exception as error:
            traceback.print_exc()
            say("failed", name=name, message=f"{type(error).__name__}: {error}")
    return 0


def make(case: Case, a: argparse.Namespace) -> dict[str, Any]:
    """A scene's job folder, and per parameter the pictures to both sides of its value."""
    scene, subject = build(case.recipe, a.seed)
    folder = a.work / case.recipe.name / "job"
    job = scene_io.open_job(scene, folder, Choice(tuple(o.name for o in subject)))
    base = f"{fingerprint(scene)} {a.size} {a.samples} {bpy.app.version_string} {VERSION}"
    steps = []
    for key, instance in job.instances.items():
        if any(fnmatchcase(key, pattern) for pattern in case.keys) and not instance.locked:
            steps.append(_step(scene, job, key, instance, base, a))
    return {"job": str(folder), "caption": case.caption, "steps": steps, "warnings": job.warnings}


def _step(
    scene: bpy.types.Scene, job: Job, key: str, instance: schema.Instance, base: str, a: argparse.Namespace
) -> dict[str, Any]:
    """Pictures of the scene with one value lower and higher than it is, which it is again afterwards."""
    low, middle, high, du = ends(instance)
    found: dict[str, Any] = {"key": key, "family": instance.parameter.family, "middle": middle, "du": du}
    for name, value in (("low", low), ("high", high)):
        text = f"{base} {key} {[f'{v:.6g}' for v in value]}"
        path = a.cache / f"{hashlib.sha256(text.encode()).hexdigest()[:32]}.png"
        if not path.is_file():
            a.cache.mkdir(parents=True, exist_ok=True)
            _write(scene, job, key, value)
            rendering.render(scene, path, a.size, a.samples, exact=True)
            _write(scene, job, key, instance.value)
        found |= {name: value, f"{name}_picture": str(path)}
    return found


def _write(scene: bpy.types.Scene, job: Job, key: str, value: schema.Values) -> None:
    left = bindings.write(scene, {key: value}, job.survey.objects, job.survey.pivot)
    if left:
        raise schema.VibeError(f"{key} was not written: {left[key]}.", "Mend the scene.")


if __name__ == "__main__":
    status = main()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(status)  # Blender 4.5's own exit handlers may wait for ever
