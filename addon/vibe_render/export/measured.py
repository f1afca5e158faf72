# SPDX-License-Identifier: GPL-3.0-or-later
"""Computed inputs of a scene's materials: as textures over UVs where possible, else measured on small renders."""

from __future__ import annotations

import bpy
import numpy as np

from ..render import baked_passes
from ..scene.nodes.trails import ValueOrigin
from . import textures
from .analysis import SceneAnalysis
from .materials import ExportedMaterial, MeasuredChannel, computed_inputs, export_material, uv_of

_SEEN_ELSEWHERE = ("base_color", "emission_color", "emission", "alpha")
"""Inputs that count of materials that the camera does not see: the light that they send to others."""


def measured_materials(analysis: SceneAnalysis) -> dict[str, ExportedMaterial]:
    """All materials of a scene by name, with what their nodes compute."""
    geometry = analysis.geometry
    by_name = {m.name_full: m for m in bpy.data.materials}
    chosen = {name: by_name.get(name) for name in geometry.materials}
    channels: dict[str, dict[str, MeasuredChannel]] = {name: {} for name in chosen}
    requests = []
    # Textures over UVs are read or baked one by one; the rest is baked in one render.
    for name, material in chosen.items():
        if material is None:
            continue
        uvs = geometry.uvs[geometry.material == geometry.materials.index(name)]
        for channel, origin in computed_inputs(material).items():
            picture = _over_uvs(material, channel, origin, uvs)
            if picture:
                channels[name][channel] = MeasuredChannel(picture.image.mean((0, 1)), picture)
            else:
                requests.append(baked_passes.PassRequest(material, channel, origin))
    baked = baked_passes.bake_passes(analysis.scene, requests)
    for request in requests:
        name = request.material.name_full
        view = baked.get((name, request.channel))
        if view:
            picture = textures.ExportedTexture(view.image, "EXTEND", "", view.window)
            channels[name][request.channel] = MeasuredChannel(view.mean, picture)
            far = _straight_on(analysis, request) if request.channel == "base_color" else None
            if far:
                channels[name]["far"] = MeasuredChannel(view.mean, far)
        # The camera does not see it: measure its mean.
        elif request.origin is not None and request.channel != "normal":
            mask = analysis.visible.material == geometry.materials.index(name)
            mean = np.full(3, 0.5, np.float32)
            if mask.any() or request.channel in _SEEN_ELSEWHERE:
                mean = textures.mean_color(analysis.scene, request.material, request.origin, mask)
            channels[name][request.channel] = MeasuredChannel(mean)
    return {name: export_material(material, channels[name]) for name, material in chosen.items()}


def _over_uvs(
    material: bpy.types.Material, channel: str, origin: ValueOrigin | None, uvs: np.ndarray
) -> textures.ExportedTexture | None:
    """A texture where one is enough, and as sharp as the original: of base colors and cut-outs."""
    if origin is None or channel not in ("base_color", "alpha"):
        return None
    chosen, matrix = uv_of(material)
    name, own = textures.uv_mapping(origin.source)
    if name != chosen or not np.allclose(matrix, own):
        return None
    outputs = ("Color", "Alpha") if channel == "alpha" else ("Color",)
    tiles = textures.plain_image(origin.source, outputs) is not None
    inside = uvs.size and -1e-3 <= uvs.min() <= uvs.max() <= 1 + 1e-3
    return textures.uv_texture(material, channel, origin) if tiles or inside else None


def _straight_on(
    analysis: SceneAnalysis, request: baked_passes.PassRequest
) -> textures.ExportedTexture | None:
    """The pattern of a flat surface as mirrors may show it, also where the camera does not look."""
    geometry, eye = analysis.geometry, analysis.scene.camera.matrix_world.translation
    chosen = geometry.material == geometry.materials.index(request.material.name_full)
    pivot = np.array(analysis.pivot)
    corners = geometry.vertices[geometry.faces[chosen]].astype(float)
    plane = baked_passes.capture_plane(corners, pivot, float(np.linalg.norm(pivot - np.array(eye))))
    if plane is None:
        return None
    view = baked_passes.bake_passes(analysis.scene, [request], plane).get(
        (request.material.name_full, request.channel)
    )
    if view is None:
        return None
    left, bottom, right, top = view.window
    scale, shift = np.array([1 / (right - left), 1 / (top - bottom)]), np.array([left, bottom])
    mapping = np.array(plane.mapping)
    mapping[:, 3] -= shift
    return textures.ExportedTexture(view.image, "CLIP", "", None, (mapping * scale[:, None]).tolist())
