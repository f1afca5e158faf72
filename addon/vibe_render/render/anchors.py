# SPDX-License-Identifier: GPL-3.0-or-later
"""Anchors: small Cycles pictures of the values of a round, by which the engine corrects its prediction.

The scene is the artist's again as soon as the picture is done. A render is linear in the power of every light, so
each of them, and the world, is rendered into a light group of its own as well.
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path

import bpy
from bpy.types import Object, Scene

from ..core import rendered
from ..core.compat import changed
from ..core.schema_import import messages, schema
from ..scene import bindings
from ..scene.copies import copied_scene
from . import final_render


def answer_anchor(
    scene: Scene, folder: Path, request: messages.Anchor, subject: Sequence[Object], pivot: Sequence[float]
) -> messages.Anchored:
    """Renders the anchor that the engine requests; a failure becomes its answer and does not end the vibe."""
    start = time.monotonic()
    name = f"anchor-{request.number}.exr"
    if bpy.app.is_job_running("RENDER"):
        return messages.Anchored(request.number, error="Blender is busy with another render")
    try:
        groups = render_anchor(
            scene, folder / name, request.values, subject, pivot, request.size, request.samples, request.seed
        )
    except Exception as error:  # whatever it is, the vibe can do without this picture
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
    """Renders the scene at other values, denoised, before compositor and view transform, to a multilayer EXR.

    The file has the layers "Combined", "Noisy Image" and one "Combined_…" of every light group, in scene-linear light.
    It appears whole or not at all, and the scene is left exactly as it was.

    Returns:
        Light group to the owner of its light: "light/NAME" or "world". Other light is only in the whole.
    """
    linear_values = {key: value for key, value in values.items() if not key.startswith("film/")}
    with bindings.trial(scene, linear_values, subject, pivot), copied_scene(scene) as twin:
        layer = rendered.layer(twin)
        layer.cycles.denoising_store_passes = True
        with _light_groups(scene, layer) as groups:
            final_render.render_layers(twin, layer, path, size, samples, seed)
    return groups


@contextmanager
def _light_groups(scene: Scene, layer: bpy.types.ViewLayer) -> Iterator[dict[str, str]]:
    """A light group for every light that can be edited, and for the world; the artist's are put back afterwards."""
    # Lights that share their data are one group.
    sharing: dict[bpy.types.ID, list[bpy.types.ID]] = {}
    instanced = dict.fromkeys(light for light, _ in rendered.instanced_lights(scene))
    for light in dict.fromkeys([*rendered.lights(scene), *instanced]):
        sharing.setdefault(light.data, []).append(light)
    emitters = [(f"light/{members[0].name_full}", members) for members in sharing.values()]
    if world := rendered.world(scene):
        emitters.append(("world", [world]))
    groups: dict[str, str] = {}
    with ExitStack() as stack:
        for owner, members in emitters:
            if not all(member.is_editable for member in members):
                continue
            group = layer.lightgroups.add(name=f"Vibe {len(groups)}").name
            groups[group] = owner
            for member in members:
                stack.enter_context(changed(member, lightgroup=group))
        yield groups
