# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's side of `python -m lab rendered`: scenes with properties at random that hide, replace or multiply.

python -m lab.blender.rendered --work DIR --count 500 --seed 0 --size 128 --samples 64 [--only GLOB] ...
"""

from __future__ import annotations

import argparse
import random
from collections import Counter
from typing import Any

import bpy
import numpy as np
from vibe_render.core import compat, rendered
from vibe_render.export import reading
from vibe_render.export.analysis import SceneAnalysis
from vibe_render.render import anchors, bake, final_render
from vibe_render.scene import bindings, copies, snapshot
from vibe_render.scene.subject import SubjectChoice

from lab.blender import contents, side
from lab.blender.move import move
from lab.blender.scenes import properties
from lab.blender.scenes.properties import hiding, imaging, lighting
from lab.blender.scenes.properties.plain import AddProperty

_WORLDS = {
    lighting.world_in_a_group, lighting.computed_turn, lighting.world_override, lighting.world_hidden_from_rays,
    lighting.no_world, lighting.no_sky, lighting.sky_texture, lighting.mixed_environments, lighting.backdrop_apart,
    lighting.mirror_ball, lighting.glowing_instances,
}  # fmt: skip
_COMPOSITORS = {
    imaging.compositor, imaging.two_layers, imaging.other_scene, imaging.group_mix, imaging.grouped_compositor, imaging.glare,
    imaging.unused_compositor, imaging.muted_compositor, hiding.unused_first_layer,
}  # fmt: skip
_BODIES = {
    hiding.linear_image, hiding.object_slots, hiding.material_override, hiding.empty_slot, hiding.set_by_nodes,
    hiding.missing_image,
}  # fmt: skip
_APART = (
    _WORLDS,
    _COMPOSITORS,
    _BODIES,
    {hiding.background_set, hiding.nested_sets},
    {lighting.light_groups, imaging.group_mix, lighting.glowing_instances},
    {lighting.light_groups, lighting.no_world},
    {imaging.orthographic, imaging.depth_of_field},
    {hiding.material_override, lighting.linked_glow},
    {imaging.view_settings, imaging.standard_view},
    {imaging.camera_clip, hiding.holdout_collection, hiding.holdout_material},
)
"""Properties that cancel one another: a scene has at most one of each set."""
_SHARE = 0.01  # of the image: what an object covers in one of two images and not in the other is a difference


def recipes(a: argparse.Namespace) -> dict[str, tuple[AddProperty, ...]]:
    """The properties of each scene, by its name: each alone, then two or three at random."""
    known = [*dict.fromkeys((*properties.HONORED, *properties.REPORTED))]
    found: dict[str, tuple[AddProperty, ...]] = {}
    for number in range(a.count):
        chance = random.Random(f"{a.seed}/{number}")
        chosen: list[AddProperty] = []
        for builder in chance.sample(known, len(known)):
            if not any(builder in group and group & set(chosen) for group in _APART):
                chosen.append(builder)
        added = [known[number]] if number < len(known) else chosen[: chance.choice((2, 3))]
        found[f"{number:03d}-{'+'.join(each.__name__ for each in added)}"] = tuple(added)
    return found


def make(added: tuple[AddProperty, ...], a: argparse.Namespace) -> dict[str, Any]:
    """Makes one scene: its job, its render, an anchor at other values, what is visible, and what Revert leaves."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    properties.build(scene, *added)
    before = contents.dump()
    folder = a.work / "+".join(each.__name__ for each in added)
    job = reading.export_scene(scene, folder / "job", SubjectChoice())
    analysis = job.analysis
    final_render.render_picture(scene, folder / "render.png", a.size, a.samples)
    unlike = _visible_differences(scene, analysis)
    values = move(job.instances, random.Random(a.seed))
    subject, pivot = analysis.objects, analysis.pivot
    groups = anchors.render_anchor(scene, folder / "anchor.exr", values, subject, pivot, a.size, 16)
    left = bindings.write(scene, values, subject, pivot)
    snapshot.revert(scene)
    changed = contents.difference(before, contents.dump())
    left_out = ["[Render Result]"]
    if compat.compositor(scene) is None:
        left_out.append("[Scene].node_tree")  # Blender 4 cannot delete one; it is switched off
    missing = [text for each, text in properties.REPORTED.items() if each in added and not _named(text, job.warnings)]
    return {
        "job": str(folder / "job"),
        "render": str(folder / "render.png"),
        "anchor": {"picture": str(folder / "anchor.exr"), "groups": groups, "values": values},
        "named": [each.__name__ for each in added if each not in properties.HONORED],
        "warnings": job.warnings,
        "unnamed": missing,
        "unlike": unlike,
        "left_alone": left,
        "not_reverted": [path for path in changed if not any(part in path for part in left_out)],
    }


def _named(text: str, warnings: list[str]) -> bool:
    return any(text in warning for warning in warnings)


def _visible_differences(scene: bpy.types.Scene, analysis: SceneAnalysis) -> dict[str, list[float]]:
    """Objects that cover another share of the image in Cycles than in the export: both shares."""
    exported = Counter(analysis.geometry.objects[n][0] for n in analysis.visible.object.ravel() if n >= 0)
    total = analysis.visible.object.size
    with copies.copied_scene(scene, resolution_x=96, resolution_y=64, resolution_percentage=100) as twin:
        twin.render.engine, twin.cycles.samples, twin.cycles.max_bounces = "CYCLES", 1, 0
        rendered.layer(twin).use_pass_object_index = True
        things = dict(enumerate(bpy.data.objects, start=1))
        for number, thing in things.items():
            thing.pass_index = number
        passes = bake.render_passes(twin)
    for thing in things.values():
        thing.pass_index = 0
    index = next(values for name, values in passes.items() if name in ("IndexOB", "Object Index"))
    numbers, counts = np.unique(np.rint(index), return_counts=True)
    shown = {things[int(n)].name_full: c / index.size for n, c in zip(numbers, counts, strict=True) if int(n)}
    pairs = {name: [exported[name] / total, shown.get(name, 0.0)] for name in {*exported, *shown}}
    return {name: pair for name, pair in pairs.items() if abs(pair[0] - pair[1]) > 3 * _SHARE and min(pair) < _SHARE}


if __name__ == "__main__":
    side.main(recipes, make)
