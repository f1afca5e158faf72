# SPDX-License-Identifier: GPL-3.0-or-later
"""The parts of camera, lights, film and compositor that no vibe changes; lights and backdrops that words may add."""

from __future__ import annotations

import math
import os
import tempfile
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from bpy.types import Image, Node, NodeTree, Object, Scene
from mathutils import Vector

from ..core import compat, rendered
from ..core.schema_import import schema
from ..core.temporary import temporary
from ..render import bake
from ..scene import bindings, light_links, orbits, prepare, scene_context, snapshot
from ..scene.copies import copied_scene, viewer
from ..scene.light_types import exported, has_uneven_cone, type_of
from ..scene.nodes import backgrounds, layers, light_nodes
from .analysis import SceneAnalysis

TABLE_SIZE = 33  # colors along each axis of the table
TABLE_TOE, TABLE_STOPS = schema.radiometry.TABLE_TOE, schema.radiometry.TABLE_STOPS
_TABLE_SIDE = math.isqrt(TABLE_SIZE**3 - 1) + 1  # pixels, of a square image with all colors of the table
MOST_INSTANCES = 24  # instances of lights in the prediction, at most


def camera_row(analysis: SceneAnalysis) -> dict[str, Any]:
    """The camera's entry in scene.json."""
    thing = analysis.scene.camera
    data, dof = thing.data, thing.data.dof
    row = {
        "name": thing.name_full,
        "type": data.type,
        "residual": [*map(list, orbits.Pose.of(thing, Vector(analysis.pivot)).residual)],
        "ortho_scale": data.ortho_scale,
        "shift": [data.shift_x, data.shift_y],
        "sensor_fit": data.sensor_fit,
        "clip": [data.clip_start, data.clip_end],
    }
    if dof.use_dof:  # the aperture's radius, and the distance or the point (world space) of the focus, meters
        length = 1.0 if data.type == "ORTHO" else data.lens * 1e-3
        row |= {"aperture": length / (2 * max(dof.aperture_fstop, 1e-5)), "focus_distance": dof.focus_distance}
        if focus := dof.focus_object:
            bone = focus.pose.bones.get(dof.focus_subtarget) if focus.pose else None
            matrix = focus.matrix_world @ bone.matrix if bone else focus.matrix_world
            row["focus_point"] = list(matrix.translation)
    return row


def light_rows(analysis: SceneAnalysis) -> list[dict[str, Any]]:
    """The lights' entries in scene.json."""
    pivot = Vector(analysis.pivot)
    context = analysis.context()
    roles = scene_context.light_roles(context)
    rows = [_light_row(o, role, pivot) for o, role in roles.items() if analysis.scene in o.users_scene]
    # The instanced lights nearest to the pivot. An instance takes the values of an object with the same light data.
    owners, instanced = {o.data: o for o in reversed(list(roles))}, []
    for obj, matrix in context.instanced_lights:
        owner = owners[obj.data]
        row = _light_row(obj, roles[owner], pivot) | {"name": owner.name_full, "fixed": True}
        row["residual"], row["position"] = [*map(list, matrix.to_3x3().normalized())], list(matrix.translation)
        instanced.append(row)
    instanced.sort(key=lambda row: (Vector(row["position"]) - pivot).length)
    rows += instanced[:MOST_INSTANCES]
    named = [{name for name in names if name} for names in analysis.geometry.objects]
    for row in rows:
        lamp = bpy.data.objects.get(row["name"])
        receivers = lamp.light_linking.receiver_collection if lamp else None
        if receivers is None:
            continue
        # The numbers of the objects that light linking excludes from the light.
        included, excluded = ({o.name_full for o in linked} for linked in light_links.states(receivers).values())
        unlit = [n for n, names in enumerate(named) if names & excluded or (included and not names & included)]
        if unlit:
            row["unlit"] = unlit
    return rows


def _light_row(thing: Object, role: str, pivot: Vector) -> dict[str, Any]:
    """One light's entry in scene.json."""
    data = thing.data
    row: dict[str, Any] = {
        "name": thing.name_full,
        "type": type_of(thing).name,
        "residual": [*map(list, orbits.Pose.of(thing, pivot).residual)],
        "position": list(thing.matrix_world.translation),
        "shadow": data.use_shadow,
        "normalize": data.normalize,
        "exposure": data.exposure,
        "soft_falloff": getattr(data, "use_soft_falloff", True),
        "use_temperature": data.use_temperature,
        "hidden": rendered.unlit_rays(thing),
        "role": role,
        "tint": light_nodes.factor(data) or bake.mean_light_factor(thing, pivot),
    }
    return row | exported(thing)


def film_row(scene: Scene) -> dict[str, Any]:
    """The film's entry in scene.json: view transform, exposure and white balance."""
    view = scene.view_settings
    return {
        "ocio": ocio_config(),
        "display": scene.display_settings.display_device,
        "view": view.view_transform,
        "look": "" if view.look == "None" else view.look,
        "transparent": scene.render.film_transparent,
        "working_space": getattr(getattr(bpy.data, "colorspace", None), "working_space", ""),
        "gain": scene.cycles.film_exposure,
        "white_balance": white_balance(scene),
        "fonts": bpy.utils.system_resource("DATAFILES", path="fonts"),
    }


def white_balance(scene: Scene) -> list[list[float]]:
    """Rows of the 3x3 matrix by which white balance multiplies scene-linear colors; [] if it is off or not known."""
    if not scene.view_settings.use_white_balance:
        return []
    # It is fitted to a few colors that Blender saves through this white balance and the view "Raw".
    colors = 0.05 * (1.0 + np.eye(4, 3, dtype=np.float32))  # dark enough to stay below 1 at any balance
    twin = scene.copy()
    image = bpy.data.images.new("Vibe Colors", len(colors), 1, float_buffer=True)
    with temporary(image, twin):
        plain = {"look": "None", "view_transform": "Raw", "exposure": 0.0, "gamma": 1.0}
        try:
            compat.assign(twin.view_settings, **plain, use_curve_mapping=False)
        except TypeError:  # the OCIO configuration has no such view
            return []
        compat.assign(twin.render.image_settings, **bake.png("RGB", "16"))
        image.pixels.foreach_set(np.insert(colors, 3, 1.0, axis=1).ravel())
        with tempfile.TemporaryDirectory(prefix="vibe-") as folder:
            path = Path(folder) / "colors.png"
            image.save_render(str(path), scene=twin)
            shown = bake.read_file(path)[0, :, :3]
    return np.linalg.lstsq(colors, shown, rcond=None)[0].T.tolist()


def ocio_config() -> str:
    """The color management configuration that this Blender uses: a path, or a name that OpenColorIO knows."""
    chosen = os.environ.get("BLENDER_OCIO") or os.environ.get("OCIO") or ""
    if chosen.startswith("ocio://"):
        return chosen
    if os.path.isfile(chosen):
        return os.path.abspath(chosen)  # absolute, because the engine has another working directory
    return os.path.join(bpy.utils.system_resource("DATAFILES", path="colormanagement"), "config.ocio")


def color_table(scene: Scene) -> np.ndarray | None:
    """Scene-linear colors after the compositor, (TABLE_SIZE, TABLE_SIZE, TABLE_SIZE, 3), on the scale of `_in_stops`.

    The axes are the input's blue, green and red, evenly spaced on the same scale from 0 to TABLE_STOPS. None if the
    compositor leaves colors alone, or if no table can describe it: the result depends on a pixel's position or on its
    neighbors, or the compositor reads more than the image of the first rendered view layer.
    """
    if rendered.changing_compositor(scene) is None:
        return None
    axis = TABLE_TOE * (2 ** np.linspace(0.0, TABLE_STOPS, TABLE_SIZE) - 1)
    blue, green, red = np.meshgrid(axis, axis, axis, indexing="ij")
    colors = np.zeros((_TABLE_SIDE**2, 3), np.float32)
    colors[: TABLE_SIZE**3] = np.stack((red, green, blue), -1).reshape(-1, 3)
    # The same colors at other pixels show whether the position matters.
    order = np.random.default_rng(0).permutation(len(colors))
    image = bpy.data.images.new("Vibe Colors", _TABLE_SIDE, _TABLE_SIDE, float_buffer=True, is_data=True)
    with temporary(image), copied_scene(scene, graded=True, size=(_TABLE_SIDE, _TABLE_SIDE)) as twin:
        for node in list(_layers(compat.compositor(twin))):
            names = {socket.name for socket in node.outputs if socket.is_linked}
            first = node.scene in (None, twin) and node.layer == rendered.layer(twin).name
            if names != {"Image"} or not first:
                return None
            source = node.id_data.nodes.new("CompositorNodeImage")
            source.image = image
            for link in list(node.outputs["Image"].links):
                node.id_data.links.new(source.outputs["Image"], link.to_socket)
        straight, mixed = (_in_stops(_composited(twin, image, each)) for each in (colors, colors[order]))
    if np.abs(straight[order] - mixed).max() > 0.02:
        return None
    return straight[: TABLE_SIZE**3].reshape(TABLE_SIZE, TABLE_SIZE, TABLE_SIZE, 3)


def _layers(tree: NodeTree | None) -> Iterator[Node]:
    """The linked Render Layers nodes of a tree and its groups; also mutes Vibe Render's own grades."""
    for node in tree.nodes if tree else ():
        if node.bl_idname == "CompositorNodeRLayers" and any(s.is_linked for s in node.outputs):
            yield node
        elif node.type == "GROUP" and node.node_tree:
            node.mute = node.mute or rendered.MARK in node.node_tree
            yield from _layers(node.node_tree)


def _composited(twin: Scene, image: Image, colors: np.ndarray) -> np.ndarray:
    """The compositor's output (N, 3) for these `colors` (N, 3), which it reads from the N pixels of `image`."""
    image.pixels.foreach_set(np.insert(colors, 3, 1.0, axis=1).ravel())
    image.update()
    with viewer(twin, lambda _: None):
        return bake.render_pixels(twin, bake.LINEAR)[..., :3].reshape(-1, 3)


def _in_stops(colors: np.ndarray) -> np.ndarray:
    """Linear colors c of any shape as sign(c) · log2(|c| / TABLE_TOE + 1): stops, but 0 at black."""
    return np.sign(colors) * np.log2(np.abs(np.nan_to_num(colors)) / TABLE_TOE + 1)


def light_notes(scene: Scene) -> list[str]:
    """Notes for the artist on properties of lights, and of light linking, that the prediction leaves out."""
    notes = []
    for obj in sorted(rendered.shown(scene), key=lambda o: o.name_full):
        linking = obj.light_linking
        if linking.blocker_collection:
            notes.append(f"Shadow linking of {obj.name} is left out: in the prediction all objects cast its shadows.")
        surfaces = rendered.worn(obj, rendered.layer(scene)) if obj.type in rendered.GEOMETRY else []
        glows = any(layers.emitted_radiance(material) > 0.0 for material in surfaces if material)
        if linking.receiver_collection and glows:
            notes.append(f"{obj.name} is linked to some objects; in the prediction its glow lights all.")
    instances = rendered.instanced_lights(scene)
    lights = [o for o in rendered.shown(scene) if o.type == "LIGHT" and not rendered.is_portal(o)]
    for light in dict.fromkeys([*sorted(lights, key=lambda o: o.name_full), *(o for o, _ in instances)]):
        if not rendered.is_finite(light.matrix_world):
            notes.append(f"{light.name} has no usable place: it is left out.")
        elif light_nodes.factor(light.data) is None:
            notes.append(f"The nodes of {light.name} are shown as their average: without a pattern.")
        if has_uneven_cone(light):
            notes.append(f"{light.name} is scaled unevenly; the prediction shows a round cone.")
    if len(instances) > MOST_INSTANCES:
        left = len(instances) - MOST_INSTANCES
        notes.append(f"{left} instances of lights, the farthest, are left out of the prediction.")
    return notes


def standby_lights(analysis: SceneAnalysis) -> tuple[list[dict[str, Any]], dict[str, schema.Instance]]:
    """scene.json entries, and parameters by key, of lights that words may add; the scene has them during the call."""
    scene, pivot = analysis.scene, Vector(analysis.pivot)
    known = schema.added_lights.ADDED_LIGHTS
    names = [name for name in known if name not in bpy.data.objects]
    with snapshot.undone(scene) as journal:
        added = bindings.add_lights(journal, scene, names, analysis.objects)
        rendered.layer(scene).update()
        size = prepare.card_size(*scene_context.bounds(scene, analysis.objects or scene_context.meshes(scene)))
        cards = {name: {"card": size} for name, light in known.items() if light.pattern}
        rows = [_light_row(light, known[light.name].role, pivot) | cards.get(light.name, {}) for light in added]
        bound = bindings.instances(scene, analysis.objects, analysis.pivot, ("light",))
        ours = {k: replace(i, role=known[i.owner].role) for k, i in bound.items() if i.owner in names}
    return rows, ours


def standby_backdrop(analysis: SceneAnalysis, instances: Mapping[str, schema.Instance]) -> dict[str, schema.Instance]:
    """The parameters (by key) of a backdrop that the world may get; none if the render does not show the world."""
    scene, shown = analysis.scene, analysis.visible.object
    mine = np.append(analysis.is_subject, False)[shown]
    # A world counts as visible if it fills a twentieth of the image around the subject.
    if scene.render.film_transparent or (shown < 0).sum() < 0.05 * max((~mine).sum(), 1):
        return {}
    return backgrounds.offered_backdrop(rendered.world(scene), instances)
