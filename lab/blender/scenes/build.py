# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds a measured scene into an empty file, from its recipe and a seed."""

from __future__ import annotations

import math
import random
from pathlib import Path

import bpy
import numpy as np
from bpy.types import Node, Object, Scene
from mathutils import Euler, Vector
from vibe_render.core import compat, rendered
from vibe_render.core.color import Color
from vibe_render.core.schema_import import schema
from vibe_render.scene import bindings, snapshot
from vibe_render.scene.light_types import LIGHT_TYPES, SIZE
from vibe_render.scene.orbits import orbit_matrix
from vibe_render.scene.stage import cyclorama, floor, framing_camera, mesh_object, plain_material, plain_world

from lab.blender.scenes.places import PLACES
from lab.blender.scenes.props import PROPS
from lab.blender.scenes.recipe import CameraRecipe, FogRecipe, LightRecipe, SceneRecipe, WorldRecipe, chance
from lab.blender.scenes.shapes import SHAPES
from lab.blender.scenes.surfaces import material, shifted

_SIDE = 256
WORLDS = ("city", "courtyard", "forest", "interior", "night", "studio", "sunrise", "sunset")
"""The environment pictures that come with Blender."""


def build(recipe: SceneRecipe, seed: int) -> tuple[Scene, list[Object]]:
    """Starts an empty file and builds the scene in it.

    Args:
        seed: 0 for the set that is quoted. Others vary colors, directions, brightnesses and worlds.

    Returns:
        The scene and the subject's objects.
    """
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True, load_ui=False)
    scene, luck = bpy.context.scene, chance(recipe, seed)
    scene.render.resolution_x = scene.render.resolution_y = _SIDE
    subject = (SHAPES | PROPS | PLACES)[recipe.shape][0](luck)
    stuffs = [material(f"Stuff {i}", finish, luck) for i, finish in enumerate(recipe.finishes)]
    for i, thing in enumerate(subject):
        thing.data.materials.clear()
        thing.data.materials.append(stuffs[i % len(stuffs)])
    points = np.concatenate([_points(scene, thing) for thing in subject])
    sunk = float(points[:, 2].min())
    for thing in subject:
        thing.location.z -= sunk
    points[:, 2] -= sunk
    pivot = Vector((points.min(0) + points.max(0)) / 2)
    _camera(scene, recipe.view, points, luck)
    _stage(scene, recipe, luck)
    for i, lamp in enumerate(recipe.lamps):
        _lamp(scene, f"Lamp {i + 1}", lamp, pivot, luck)
    _world(scene, recipe.world, seed, luck)
    _film(scene, recipe)
    _values(scene, recipe, subject, pivot, luck)
    return scene, subject


def _camera(scene: Scene, view: CameraRecipe, points: np.ndarray, luck: random.Random) -> None:
    angles = (view.azimuth + luck.uniform(-12, 12), view.elevation + luck.uniform(-3, 3))
    camera = framing_camera(scene, points, angles, view.fov, view.fill)
    if view.orthographic:
        away = (camera.location - Vector((points.min(0) + points.max(0)) / 2)).length
        camera.data.type, camera.data.ortho_scale = "ORTHO", 2 * away * math.tan(math.radians(view.fov) / 2)


def _points(scene: Scene, thing: Object) -> np.ndarray:
    """(N, 3) vertices of an object as it is rendered, world space."""
    evaluated = thing.evaluated_get(rendered.depsgraph(scene))
    mesh = evaluated.to_mesh()
    flat = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", flat)
    evaluated.to_mesh_clear()
    pose = np.array(thing.matrix_world)
    return flat.reshape(-1, 3) @ pose[:3, :3].T + pose[:3, 3]


def _stage(scene: Scene, recipe: SceneRecipe, luck: random.Random) -> None:
    if recipe.stage == "none":
        return
    ground = material("Ground", recipe.ground, luck)
    if recipe.stage == "cove":
        cyclorama(scene, 7.0, 6.0, recipe.view.azimuth, ground)
    elif recipe.stage == "room":
        _room(scene, recipe, ground, luck)
    else:
        floor(scene, 30.0, ground)


def _room(scene: Scene, recipe: SceneRecipe, ground: bpy.types.Material, luck: random.Random) -> None:
    """Floor, ceiling and back wall, and walls of other colors on the left and on the right."""
    colors = dict(zip(("Left", "Right"), recipe.walls, strict=True))
    walls = {name: plain_material(name, shifted(color, luck), 0.9) for name, color in colors.items()}
    w, d, h = 2.6, 2.4, 3.6
    corners = np.array([[x, y, z] for x in (-w, w) for y in (-4.5, d) for z in (0, h)], float)
    sides = {
        "Floor": ((0, 4, 6, 2), ground),
        "Ceiling": ((1, 3, 7, 5), ground),
        "Back": ((2, 6, 7, 3), ground),
        "Left Wall": ((0, 2, 3, 1), walls["Left"]),
        "Right Wall": ((4, 5, 7, 6), walls["Right"]),
    }
    for name, (quad, stuff) in sides.items():
        mesh_object(scene, name, corners[list(quad)], [(0, 1, 2, 3)], stuff)


def _lamp(scene: Scene, name: str, lamp: LightRecipe, pivot: Vector, luck: random.Random) -> None:
    data = bpy.data.lights.new(name, lamp.kind)
    angles = (lamp.azimuth + luck.uniform(-15, 15), lamp.elevation + luck.uniform(-5, 5))
    level = lamp.level * luck.uniform(0.8, 1.25)
    data.energy = level * schema.radiometry.unit_energy(lamp.kind, lamp.distance)
    kind = LIGHT_TYPES[lamp.kind]
    setattr(data, kind.extent_property, lamp.size if kind.extent == SIZE else math.radians(lamp.size))
    data.color = shifted(lamp.color, luck, 0.06)
    for key, value in lamp.settings.items():
        setattr(data, key, value)
    thing = bpy.data.objects.new(name, data)
    thing.matrix_world = orbit_matrix(pivot, *angles, lamp.distance)
    scene.collection.objects.link(thing)


def _world(scene: Scene, world: WorldRecipe, seed: int, luck: random.Random) -> None:
    plain_world(scene, shifted(world.color, luck), world.strength)
    tree = compat.enable_nodes(scene.world)
    background = next(n for n in tree.nodes if n.bl_idname == "ShaderNodeBackground")
    if world.picture:
        _environment(background, _world_file(world.picture, seed), luck)
    if world.backdrop is not None:
        _backdrop(background, world.backdrop, seed, luck)


def _backdrop(light: Node, behind: Color | str, seed: int, luck: random.Random) -> None:
    """Lets the camera see a Background of its own: a color, or a picture by name."""
    tree = light.id_data
    path, mix, seen = (tree.nodes.new(f"ShaderNode{n}") for n in ("LightPath", "MixShader", "Background"))
    if isinstance(behind, str):
        _environment(seen, _world_file(behind, seed), luck)
    else:
        seen.inputs["Color"].default_value = (*shifted(behind, luck), 1.0)
    tree.links.new(path.outputs["Is Camera Ray"], mix.inputs[0])
    for socket, background in zip(mix.inputs[1:], (light, seen), strict=True):
        tree.links.new(background.outputs[0], socket)
    tree.links.new(mix.outputs[0], tree.get_output_node("ALL").inputs["Surface"])


def _environment(background: Node, picture: Path, luck: random.Random) -> None:
    """Lights with a picture, turned at random."""
    tree = background.id_data
    texture, turn = tree.nodes.new("ShaderNodeTexEnvironment"), tree.nodes.new("ShaderNodeMapping")
    place = tree.nodes.new("ShaderNodeTexCoord")
    texture.image = bpy.data.images.load(str(picture))
    turn.inputs["Rotation"].default_value = Euler((0.0, 0.0, luck.uniform(-math.pi, math.pi)))
    tree.links.new(place.outputs["Generated"], turn.inputs["Vector"])
    tree.links.new(turn.outputs["Vector"], texture.inputs["Vector"])
    tree.links.new(texture.outputs["Color"], background.inputs["Color"])


def _world_file(name: str, seed: int) -> Path:
    """The picture of that name; with a seed the eight change places."""
    order = list(WORLDS)
    if seed:
        random.Random(seed).shuffle(order)
    folder = bpy.utils.system_resource("DATAFILES", path="studiolights/world")
    return Path(folder) / f"{order[WORLDS.index(name)]}.exr"


def _film(scene: Scene, recipe: SceneRecipe) -> None:
    scene.view_settings.view_transform = recipe.transform
    if recipe.look:
        scene.view_settings.look = next(
            item for item in (f"{recipe.transform} - {recipe.look}", recipe.look) if _takes(scene.view_settings, item)
        )
    scene.render.film_transparent = recipe.transparent


def _takes(settings: bpy.types.ColorManagedViewSettings, look: str) -> bool:
    try:
        settings.look = look
    except TypeError:
        return False
    return True


def _values(scene: Scene, recipe: SceneRecipe, subject: list[Object], pivot: Vector, luck: random.Random) -> None:
    """Fog and film, written as a vibe writes them and kept as the artist's."""
    view = (scene.camera.location - pivot).length
    values: dict[str, tuple[float, ...]] = {}
    for name, value in recipe.film.items():
        values[f"film/{name}"] = value if isinstance(value, tuple) else (value,)
    fog = recipe.fog
    if fog and fog.owner == "world":
        _world_fog(scene, fog, view)
    elif fog:
        values |= {
            "volume/density": (fog.depth / view,),
            "volume/color": shifted(fog.color, luck, 0.05),
            "volume/anisotropy": (fog.anisotropy,),
            "volume/falloff": (fog.falloff,),
            "volume/offset": (fog.offset,),
        }
    if values:
        left = bindings.write(scene, values, subject, tuple(pivot))
        assert not left, left
        snapshot.forget(scene)


def _world_fog(scene: Scene, fog: FogRecipe, view: float) -> None:
    tree = compat.enable_nodes(scene.world)
    volume = tree.nodes.new("ShaderNodeVolumePrincipled")
    volume.inputs["Density"].default_value = fog.depth / view
    volume.inputs["Color"].default_value = (*fog.color, 1.0)
    volume.inputs["Anisotropy"].default_value = fog.anisotropy
    output = next(n for n in tree.nodes if n.bl_idname == "ShaderNodeOutputWorld")
    tree.links.new(volume.outputs["Volume"], output.inputs["Volume"])
