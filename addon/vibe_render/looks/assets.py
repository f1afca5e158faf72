# SPDX-License-Identifier: GPL-3.0-or-later
"""A look as assets for Blender's Asset Browser: materials, world, light rig, grade and fog, in their own .blend."""

from __future__ import annotations

import tempfile
import uuid
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import bmesh
import bpy
import numpy as np
from bpy.types import ID, Material
from mathutils import Matrix, Vector

from ..core import compat, rendered
from ..core.files import whole
from ..core.schema_import import schema
from ..export.analysis import SceneAnalysis
from ..render import bake, final_render
from ..scene.nodes import grade, owned
from ..scene.stage import area_light, framing_camera, plain_world
from . import thumbnail

CATALOG_FILE = "blender_assets.cats.txt"
_VERSION = "VERSION 1"
_SPACE = uuid.UUID("5b1f2a86-6f0c-4f6e-9a43-2f5d8b0c7e11")  # gives a path the same UUID in every library
_BALL_SAMPLES = 48
_TOP = "Vibe Render"


def catalog_identifier(path: str) -> str:
    """The UUID of a Vibe Render catalog, by its path, such as "Vibe Render/Materials"."""
    return str(uuid.uuid5(_SPACE, path))


def catalog_root(folder: Path, libraries: Iterable[str]) -> Path:
    """The folder whose catalog file Blender reads for a .blend in `folder`; `libraries`: paths of asset libraries."""
    folder = folder.resolve()
    for library in filter(None, libraries):
        place = Path(library).resolve()
        if place == folder or place in folder.parents:
            return place
    # Outside of every library: the nearest folder, from this one upward, that has a catalog file.
    return next((place for place in (folder, *folder.parents) if (place / CATALOG_FILE).is_file()), folder)


def add_catalogs(place: Path, paths: Iterable[str]) -> None:
    """Adds catalogs, such as "Vibe Render/Fogs", to the catalog file of a folder; raises VibeError if it cannot."""
    file = place / CATALOG_FILE
    try:
        text = file.read_text(encoding="utf-8") if file.exists() else _VERSION
        lines = [line.strip() for line in text.splitlines()]
        if _VERSION not in lines:
            raise schema.VibeError(f"{file} is of another version.", "Choose another folder.")
        present = {line.partition(":")[0] for line in lines}
        rows = [f"{catalog_identifier(path)}:{path}:{path.replace('/', '-')}" for path in paths]
        missing = [row for row in rows if row.partition(":")[0] not in present]
        if missing:
            with whole(file) as part:
                part.write_text(text.rstrip("\n") + "\n" + "\n".join(missing) + "\n", encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise schema.VibeError(f"{file} cannot be changed: {error}.", "Choose another folder.") from error


def _material_balls(materials: Sequence[Material]) -> list[np.ndarray]:
    """For each material, a Cycles render of a ball: (SIZE, SIZE, 4) float32 (`thumbnail.SIZE`), row 0 at the bottom."""
    kinds = {"SCENE", "OBJECT", "MESH", "LIGHT", "CAMERA", "WORLD", "MATERIAL"}  # types of the data-blocks added below
    before = set(bpy.data.user_map(key_types=kinds))
    try:
        # A ball under two area lights and a gray world, on a transparent background.
        scene = bpy.data.scenes.new("Vibe Preview")
        scene.render.resolution_x = scene.render.resolution_y = thumbnail.SIZE
        scene.render.film_transparent = True
        scene.view_settings.view_transform = "Standard"
        mesh = bpy.data.meshes.new("Vibe Preview")
        shape = bmesh.new()
        shape.loops.layers.uv.new()
        bmesh.ops.create_uvsphere(shape, u_segments=64, v_segments=32, radius=1.0, calc_uvs=True)
        shape.to_mesh(mesh)
        shape.free()
        mesh.shade_smooth()
        mesh.materials.append(None)
        scene.collection.objects.link(bpy.data.objects.new("Vibe Preview", mesh))
        corners, middle = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * 0.62, np.zeros(3)
        framing_camera(scene, corners, (0.0, 12.0), fov=30.0, fill=0.92)
        area_light(scene, "Vibe Preview", (-45.0, 40.0), 4.0, 2.0, 0.9, middle)
        area_light(scene, "Vibe Preview", (140.0, 30.0), 4.0, 1.5, 0.8, middle)
        plain_world(scene, (0.5, 0.5, 0.5), strength=0.35)
        with tempfile.TemporaryDirectory(prefix="vibe-") as folder:
            pictures, path = [], Path(folder) / "ball.png"
            for material in materials:
                mesh.materials[0] = material
                final_render.render_picture(scene, path, thumbnail.SIZE, _BALL_SAMPLES)
                pictures.append(bake.read_file(path))
            return pictures
    finally:
        bpy.data.batch_remove(set(bpy.data.user_map(key_types=kinds)) - before)


@dataclass
class _Crate:
    """Copies of the look's data-blocks, which `export_assets` writes to a .blend and then removes again."""

    name: str  # of the look
    assets: list[tuple[ID, str]] = field(default_factory=list)  # each copy that is an asset, and its catalog: "Worlds"
    copies: list[ID] = field(default_factory=list)  # all copies

    def keep(self, block: Any, name: str) -> Any:
        """Renames the copy `block` to the look's name and `name`, lists it in `copies`, and returns it."""
        self.copies.append(block)
        block.name = f"{self.name} {name}"
        block.pop(owned.MARK, None)  # an asset in another file is the artist's, not Vibe Render's
        return block

    def mark(self, block: ID, catalog: str, words: str) -> None:
        """Marks a copy as an asset in a catalog, such as "Worlds", with `words` as its description."""
        block.asset_mark()
        block.asset_data.catalog_id = catalog_identifier(f"{_TOP}/{catalog}")
        block.asset_data.description = words
        block.asset_data.author = _TOP
        self.assets.append((block, catalog))


def export_assets(
    analysis: SceneAnalysis, name: str, words: str, materials: Iterable[Material], path: Path, picture: Path
) -> list[str]:
    """Writes the look of a scene as assets to the .blend `path`; returns the assets' names, which begin with `name`.

    The assets are `materials`, and the scene's world, lights, grade and fog, each with `words` as its description. The
    preview of a material is a ball; that of the others is `picture`, an image of the look. Raises VibeError if there is
    nothing to export, or if a file cannot be written.
    """
    crate = _Crate(name)  # its copies are written and then removed: the open file stays as it is
    try:
        surfaces = [crate.keep(material.copy(), material.name) for material in materials]
        for surface in surfaces:
            crate.mark(surface, "Materials", words)
        if world := rendered.world(analysis.scene):
            crate.mark(crate.keep(world.copy(), "World"), "Worlds", words)
        _pack_rig(crate, analysis, words)
        for node in owned.group_nodes(compat.compositor(analysis.scene), grade.NAME)[:1]:
            twin = crate.keep(node.node_tree.copy(), "Grade")
            for item in twin.interface.items_tree:  # the scene's values become the default values
                if item.item_type == "SOCKET" and item.in_out == "INPUT" and item.name != "Image":
                    item.default_value = node.inputs[item.name].default_value
            crate.mark(twin, "Grades", words)
        fog = owned.find_owned(analysis.scene.objects, owned.FOG)
        if fog is not None and not fog.hide_render:
            crate.mark(crate.keep(fog.data.materials[0].copy(), "Fog"), "Fogs", words)
        if not crate.assets:
            raise schema.VibeError("There is nothing to export.", "Vibe the scene first, or apply a preset.")
        # Previews: a material has a render of its ball, every other asset the image of the look.
        look = bake.read_file(picture)
        pictures = dict(zip(surfaces, _material_balls(surfaces), strict=True))
        for block, _ in crate.assets:
            pixels, preview = pictures.get(block, look), block.preview_ensure()
            preview.image_size = pixels.shape[1::-1]
            preview.image_pixels_float.foreach_set(np.ascontiguousarray(pixels, np.float32).ravel())
        # Write the copies to the .blend, and their catalogs to the asset library that contains it.
        blocks = {block for block, _ in crate.assets}
        with whole(path) as part:
            bpy.data.libraries.write(str(part), blocks, path_remap="RELATIVE_ALL", fake_user=True, compress=True)
        libraries = [library.path for library in bpy.context.preferences.filepaths.asset_libraries]
        catalogs = dict.fromkeys(f"{_TOP}/{catalog}" for _, catalog in crate.assets)
        add_catalogs(catalog_root(path.parent, libraries), catalogs)
        return [block.name for block, _ in crate.assets]
    finally:
        bpy.data.batch_remove(crate.copies)


def _pack_rig(crate: _Crate, analysis: SceneAnalysis, words: str) -> None:
    """Adds the lights, if any, to the crate as one collection; its origin is the bottom center of the subject's box."""
    lights = rendered.lights(analysis.scene)
    if not lights:
        return
    rig = crate.keep(bpy.data.collections.new("Rig"), "Light Rig")
    low, high = Vector(analysis.low), Vector(analysis.high)
    foot = Matrix.Translation(-Vector(((low.x + high.x) / 2.0, (low.y + high.y) / 2.0, low.z)))
    for light in lights:
        data = crate.keep(light.data.copy(), light.name)
        twin = crate.keep(bpy.data.objects.new(light.name, data), light.name)
        data.animation_data_clear()
        twin.matrix_world = foot @ light.matrix_world
        rig.objects.link(twin)
    crate.mark(rig, "Light Rigs", words)
