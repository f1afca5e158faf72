# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's side of `python -m lab like`: a scene, and the picture of a look that is hidden from it.

    python -m lab.blender.like SET FOLDER SEED GROUPS SIZE SAMPLES

FOLDER gets scene.blend, as it is without the look, and goal.png, the look. GROUPS is a list of the schema's groups that the look
changes, separated by commas; "none" for the scene as it is. One event "scene" tells the `subject`, and the values `before`
and `hidden` of what the look has changed.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import bpy
from vibe_render.export.analysis import analyze
from vibe_render.headless.scenes import save_blend
from vibe_render.render import final_render
from vibe_render.scene import bindings
from vibe_render.scene.subject import SubjectChoice

from lab.blender import side
from lab.blender.like.hidden import hidden_values
from lab.blender.paper import build_set


def hide(name: str, folder: Path, seed: str, groups: list[str], size: int, samples: int) -> dict[str, Any]:
    """Builds a set, saves it, and renders it with a look that is drawn at random.

    Args:
        size: Longer side of the picture, pixels.
    """
    subject = build_set(name)
    save_blend(folder / "scene.blend")
    analysis = analyze(bpy.context.scene, SubjectChoice(tuple(subject)))
    instances = bindings.instances(analysis.scene, analysis.objects, analysis.pivot)
    hidden = hidden_values(instances, seed, groups)
    with bindings.trial(analysis.scene, hidden, analysis.objects, analysis.pivot) as left:
        final_render.render_picture(analysis.scene, folder / "goal.png", size, samples)
    hidden = {key: value for key, value in hidden.items() if key not in left}
    roles = {key: instances[key].role for key in hidden}
    return {
        "subject": subject,
        "before": {key: instances[key].value for key in hidden},
        "hidden": hidden,
        "roles": roles,
    }


if __name__ == "__main__":
    name, folder, seed, groups, *numbers = sys.argv[1:]
    size, samples = map(int, numbers)
    side.end(side.once(lambda: hide(name, Path(folder), seed, groups.split(","), size, samples)))
