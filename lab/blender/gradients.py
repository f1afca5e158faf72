# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's side of `python -m lab gradients`: scenes, and what Cycles makes of a step of each of their parameters.

python -m lab.blender.gradients --work DIR --cache DIR --size 96 --samples 128 [--only GLOB] ...
"""

from __future__ import annotations

import argparse
from fnmatch import fnmatchcase
from typing import Any

import bpy
from vibe_render.core.schema_import import schema
from vibe_render.export import reading
from vibe_render.export.job_folder import SceneJob
from vibe_render.render import final_render
from vibe_render.scene import bindings
from vibe_render.scene.subject import SubjectChoice

from lab.blender import side
from lab.blender.scenes.build import build
from lab.blender.scenes.fingerprint import fingerprint
from lab.blender.scenes.steps import CASES, StepCase, ends

VERSION = 1
"""Raised when the way pictures are rendered changes."""


def make(case: StepCase, a: argparse.Namespace) -> dict[str, Any]:
    """Makes a scene's job folder, and for each parameter the pictures to both sides of its value.

    Args:
        case: The scene, and which parameters.
        a: The options of `side.main`.

    Returns:
        A row of the measurement: the folder, the caption, the prompt, a step for each parameter, warnings.
    """
    scene, subject = build(case.recipe, a.seed)
    folder = a.work / case.recipe.name / "job"
    job = reading.export_scene(scene, folder, SubjectChoice(tuple(o.name for o in subject)))
    base = f"{fingerprint(scene)} {a.size} {a.samples} {bpy.app.version_string} {VERSION}"
    steps = []
    for key, instance in job.instances.items():
        if any(fnmatchcase(key, pattern) for pattern in case.keys) and not instance.locked:
            steps.append(_step(scene, job, key, instance, base, a))
    return {
        "job": str(folder),
        "caption": case.caption,
        "prompt": case.prompt,
        "steps": steps,
        "warnings": job.warnings,
    }


def _step(
    scene: bpy.types.Scene, job: SceneJob, key: str, instance: schema.Instance, base: str, a: argparse.Namespace
) -> dict[str, Any]:
    """Pictures of the scene with one value lower and higher than it is, which it is again afterwards."""
    low, middle, high, du = ends(instance)
    step: dict[str, Any] = {"key": key, "family": instance.parameter.family, "middle": middle, "du": du}
    for name, value in (("low", low), ("high", high)):
        path = side.cached(a, ".png", base, key, [f"{v:.6g}" for v in value])
        if not path.is_file():
            _write(scene, job, key, value)
            final_render.render_picture(scene, path, a.size, a.samples, exact=True)
            _write(scene, job, key, instance.value)
        step |= {name: value, f"{name}_picture": str(path)}
    return step


def _write(scene: bpy.types.Scene, job: SceneJob, key: str, value: schema.Values) -> None:
    left = bindings.write(scene, {key: value}, job.analysis.objects, job.analysis.pivot)
    if left:
        raise schema.VibeError(f"{key} was not written: {left[key]}.", "Mend the scene.")


if __name__ == "__main__":
    side.main({case.recipe.name: case for case in CASES}, make)
