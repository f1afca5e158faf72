# SPDX-License-Identifier: GPL-3.0-or-later
"""A look as assets for Blender's Asset Browser: materials, world, light rig, grade and fog, in a .blend of their own.

Copies of the data-blocks are written and then removed: the open file stays as it is.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import bpy
from bpy.types import ID, Material
from mathutils import Matrix, Vector

from ..core import compat
from ..core.files import whole
from ..core.schema_import import schema
from ..export.analysis import SceneAnalysis
from ..scene import scene_context
from ..scene.nodes import grade, owned
from . import asset_catalog, asset_preview, thumbnail

_TOP = "Vibe Render"


@dataclass
class _Crate:
    """Copies of data-blocks to write; some of them are assets, each with its catalog."""

    name: str
    assets: list[tuple[ID, str]] = field(default_factory=list)
    copies: list[tuple[str, ID]] = field(default_factory=list)

    def keep(self, collection: str, block: Any, name: str) -> Any:
        """Names a copy after the look, and notes it for its removal."""
        self.copies.append((collection, block))
        block.name = f"{self.name} {name}"
        if owned.MARK in block:  # an asset that is dragged into another file is the artist's own
            del block[owned.MARK]
        return block

    def mark(self, block: ID, catalog: str, words: str) -> None:
        """Makes a copy an asset."""
        block.asset_mark()
        block.asset_data.catalog_id = asset_catalog.catalog_identifier(f"{_TOP}/{catalog}")
        block.asset_data.description = words
        block.asset_data.author = _TOP
        self.assets.append((block, catalog))

    def empty(self) -> None:
        """Removes the copies from the open file."""
        for collection, block in reversed(self.copies):
            getattr(bpy.data, collection).remove(block)


def export_assets(
    analysis: SceneAnalysis, name: str, words: str, materials: Iterable[Material], path: Path, picture: Path
) -> list[str]:
    """Writes the look that a scene has now.

    Args:
        materials: The materials that belong to the look.
        path: The .blend to write, or to replace.
        picture: A thumbnail of the look: the preview of assets that are no materials.

    Returns:
        The names of the assets.

    Raises:
        VibeError: There is nothing to export, or the files cannot be written.
    """
    crate = _Crate(name)
    try:
        surfaces = [_material(crate, material, words) for material in materials]
        for pack in (_world, _rig, _grade, _fog):
            pack(crate, analysis, words)
        if not crate.assets:
            raise schema.VibeError("There is nothing to export.", "Vibe the scene first, or apply a preset.")
        _show(crate, surfaces, picture)
        _write(path, {block for block, _ in crate.assets})
        libraries = [library.path for library in bpy.context.preferences.filepaths.asset_libraries]
        catalogs = dict.fromkeys(f"{_TOP}/{catalog}" for _, catalog in crate.assets)
        asset_catalog.add_catalogs(asset_catalog.catalog_root(path.parent, libraries), catalogs)
        return [block.name for block, _ in crate.assets]
    finally:
        crate.empty()


def _material(crate: _Crate, material: Material, words: str) -> Material:
    twin = crate.keep("materials", material.copy(), material.name)
    crate.mark(twin, "Materials", words)
    return twin


def _world(crate: _Crate, analysis: SceneAnalysis, words: str) -> None:
    if analysis.scene.world:
        crate.mark(crate.keep("worlds", analysis.scene.world.copy(), "World"), "Worlds", words)


def _rig(crate: _Crate, analysis: SceneAnalysis, words: str) -> None:
    """A collection of the scene's lights; its origin is what the subject stands on."""
    lights = scene_context.lights(analysis.scene)
    if not lights:
        return
    rig = crate.keep("collections", bpy.data.collections.new("Rig"), "Light Rig")
    low, high = Vector(analysis.low), Vector(analysis.high)
    foot = Matrix.Translation(-Vector(((low.x + high.x) / 2.0, (low.y + high.y) / 2.0, low.z)))
    for light in lights:
        data = crate.keep("lights", light.data.copy(), light.name)
        twin = crate.keep("objects", bpy.data.objects.new(light.name, data), light.name)
        data.animation_data_clear()
        twin.matrix_world = foot @ light.matrix_world
        rig.objects.link(twin)
    crate.mark(rig, "Light Rigs", words)


def _grade(crate: _Crate, analysis: SceneAnalysis, words: str) -> None:
    """The compositor group with the scene's values as its defaults."""
    for node in owned.group_nodes(compat.compositor(analysis.scene), grade.NAME)[:1]:
        twin = crate.keep("node_groups", node.node_tree.copy(), "Grade")
        for item in twin.interface.items_tree:
            if item.item_type == "SOCKET" and item.in_out == "INPUT" and item.name != "Image":
                item.default_value = node.inputs[item.name].default_value
        crate.mark(twin, "Grades", words)


def _fog(crate: _Crate, analysis: SceneAnalysis, words: str) -> None:
    """The material of the fog box, for any box."""
    box = owned.find(analysis.scene.objects, owned.FOG)
    if box is not None and not box.hide_render:
        crate.mark(crate.keep("materials", box.data.materials[0].copy(), "Fog"), "Fogs", words)


def _show(crate: _Crate, surfaces: list[Material], picture: Path) -> None:
    look = thumbnail.read_picture(picture)
    pictures = dict(zip(surfaces, asset_preview.material_balls(surfaces), strict=True))
    for block, _ in crate.assets:
        asset_preview.set_preview(block, pictures.get(block, look))


def _write(path: Path, blocks: set[ID]) -> None:
    with whole(path) as part:
        bpy.data.libraries.write(str(part), blocks, path_remap="RELATIVE_ALL", fake_user=True, compress=True)
