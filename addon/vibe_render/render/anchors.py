# SPDX-License-Identifier: GPL-3.0-or-later
"""Anchors: small Cycles renders of the search's current values, by which the engine corrects its prediction.

After each render the scene has the artist's values again. A render is linear in the power of every light, so each light,
and the world, is also rendered into a light group of its own.
"""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from pathlib import Path

import bpy
from bpy.types import ID, Object, Scene

from ..core import rendered
from ..core.schema_import import messages, schema
from ..scene import bindings
from ..scene.copies import copied_scene
from . import bake, final_render, light_groups


def answer_anchor(
    scene: Scene, folder: Path, request: messages.Anchor, subject: Sequence[Object], pivot: Sequence[float]
) -> messages.Anchored:
    """Renders the anchor (small Cycles render) that the engine requests, into `folder`; the answer reports errors."""
    start = time.monotonic()
    name = f"anchor-{request.number}.exr"
    if bpy.app.is_job_running("RENDER"):
        return messages.Anchored(request.number, error="Blender is busy with another render")
    try:
        groups = render_anchor(
            scene, folder / name, request.values, subject, pivot, request.size, request.samples, request.seed
        )
    except Exception as error:  # of any kind: the vibe goes on without this render
        text = error.message if isinstance(error, schema.VibeError) else f"{type(error).__name__}: {error}"
        return messages.Anchored(request.number, error=" ".join(text.split()) or "it failed")
    return messages.Anchored(request.number, name, groups, round(time.monotonic() - start, 3))


def render_anchor(
    scene: Scene,
    path: Path,
    values: Mapping[str, Sequence[float]],
    subject: Sequence[Object] = (),
    pivot: Sequence[float] = (0.0, 0.0, 0.0),
    size: int = 192,
    samples: int = 32,
    seed: int = 0,
) -> dict[str, str]:
    """Renders the scene with other values (by key; film values are ignored) to a multilayer EXR.

    The file has the scene-linear layers "Combined" (denoised), "Noisy Image" and one "Combined_…" for each light group.
    Compositor and view transform are left out. The file appears whole or not at all; the scene is left as it was.

    Returns:
        Name of each light group -> its owner, "light/NAME" or "world". Light of other sources is only in "Combined".
    """
    linear_values = {key: value for key, value in values.items() if not key.startswith("film/")}
    with bindings.trial(scene, linear_values, subject, pivot), copied_scene(scene) as twin:
        layer = rendered.layer(twin)
        layer.cycles.denoising_store_passes = True
        # Owner to the data-blocks of its light group; lights with the same data share a group.
        sharing = light_groups.sharing_data(light_groups.all_lights(scene))
        found: dict[str, list[ID]] = {f"light/{name}": [*members] for name, members in sharing.items()}
        if world := rendered.world(scene):
            found["world"] = [world]
        emitters = {owner: members for owner, members in found.items() if all(m.is_editable for m in members)}
        numbered = ((f"Vibe {n}", members) for n, members in enumerate(emitters.values()))
        with light_groups.grouped(layer, numbered) as names:
            final_render.set_up(twin, size, samples, seed)
            bake.render_file(twin, path, {**bake.LAYERS, "exr_codec": "ZIP"}, layer=layer.name)
    return dict(zip(names, emitters, strict=True))
