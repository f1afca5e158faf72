# SPDX-License-Identifier: GPL-3.0-or-later
"""Places put together from subjects: rooms, streets, tables of products, landscapes. Sizes in meters, floor at 0."""

from __future__ import annotations

import math
import random

import bpy
import numpy as np
from bpy.types import Object

from lab.blender.scenes import fields, gatherings, making, props, shapes
from lab.blender.scenes.shapes import ShapeBuilder


def _placed(things: list[Object], x: float, y: float, scale: float = 1.0, turn: float = 0.0) -> list[Object]:
    """Things made at the origin, moved together: turned around the z axis by radians, scaled, shifted."""
    empty = bpy.data.objects.new("Place", None)
    bpy.context.scene.collection.objects.link(empty)
    for thing in things:
        thing.parent = empty
    empty.location, empty.scale, empty.rotation_euler = (x, y, 0.0), (scale,) * 3, (0.0, 0.0, turn)
    bpy.context.view_layer.update()
    for thing in things:
        pose = thing.matrix_world.copy()
        thing.parent, thing.matrix_world = None, pose
    bpy.data.objects.remove(empty)
    return things


def _pane(name: str, size: tuple[float, float], place: tuple[float, float, float]) -> Object:
    """A flat box that faces the camera: a picture, a window."""
    return making.box(name, (size[0], 0.04, size[1]), place, bevel=0.005)


def lounge(chance: random.Random) -> list[Object]:
    """A sofa, a rug, a low table, a picture and a window that glows."""
    sofa = _placed(props.sofa(chance), 0.0, 1.2, 0.8)
    rug = making.box("Rug", (3.2, 2.0, 0.03), (0.0, -0.6, 0.015))
    table = making.box("Table", (1.2, 0.7, 0.35), (0.0, -0.7, 0.2), bevel=0.04)
    window, picture = (_pane("Window", (1.1, 1.3), (-1.6, 2.3, 2.2)), _pane("Picture", (1.2, 0.8), (0.9, 2.3, 2.4)))
    return [window, rug, table, picture, *sofa]


def bedroom(_: random.Random) -> list[Object]:
    """A bed, pillows, a night table with a glowing shade."""
    bed = making.box("Bed", (2.0, 2.6, 0.5), (-0.6, 0.9, 0.25), bevel=0.08)
    pillows = [
        making.box(f"Pillow {i}", (0.8, 0.5, 0.22), (x, 1.8, 0.6), bevel=0.1) for i, x in enumerate((-1.1, -0.1))
    ]
    board = making.box("Board", (2.2, 0.12, 1.3), (-0.6, 2.25, 0.65))
    table = making.box("Night Table", (0.6, 0.6, 0.6), (1.0, 1.9, 0.3))
    shade = making.ball("Shade", 0.22, (1.0, 1.9, 0.85))
    return [shade, bed, *pillows, board, table]


def kitchen(chance: random.Random) -> list[Object]:
    """A counter with cups and a bowl, and a shelf over it."""
    counter = making.box("Counter", (4.2, 0.9, 0.95), (0.0, 1.7, 0.475))
    shelf = making.box("Shelf", (3.0, 0.35, 0.08), (0.0, 2.15, 1.9))
    things = [counter, shelf]
    for number, x in enumerate((-1.2, -0.7, 0.9)):
        cup = _placed(props.mug(chance), x, 1.6, 0.16, number)
        for part in cup:
            part.location.z += 0.95
        things += cup
    bowl = _placed(shapes.bowl(chance), 0.2, 1.6, 0.35)
    for part in bowl:
        part.location.z += 0.95
    return [*things, *bowl]


def street(chance: random.Random) -> list[Object]:
    """Two rows of houses along a road, and a car."""
    walls = []
    for side in (-1, 1):
        for number in range(4):
            height = chance.uniform(2.5, 4.5)
            place = side * 3.4, 2.4 * number - 1.0, height / 2
            walls.append(making.box(f"House {side} {number}", (2.2, 2.2, height), place, bevel=0.03))
    road = making.box("Road", (3.0, 12.0, 0.02), (0.0, 2.5, 0.01))
    return [*walls, road, *_placed(gatherings.car(chance), 0.7, 0.2, 0.6, math.pi / 2)]


def night_street(chance: random.Random) -> list[Object]:
    """The same with windows, every third thing: two finishes of walls and one that glows."""
    things = []
    for side in (-1, 1):
        for number in range(4):
            height, y = chance.uniform(2.5, 4.5), 2.4 * number - 1.0
            things.append(making.box(f"House {side} {number}", (2.2, 2.2, height), (side * 3.4, y, height / 2)))
            things.append(making.box(f"Step {side} {number}", (0.5, 0.8, 0.2), (side * 2.1, y, 0.1)))
            things.append(making.box(f"Window {side} {number}", (0.06, 0.7, 0.8), (side * 2.28, y, 1.6), bevel=0.005))
    return things


def products(chance: random.Random) -> list[Object]:
    """Three bottles of different heights on a plinth."""
    plinth = making.box("Plinth", (2.6, 1.4, 0.3), (0.0, 0.0, 0.15), bevel=0.03)
    bottles = []
    for x, y, scale in ((-0.7, 0.1, 0.9), (0.1, -0.2, 0.7), (0.8, 0.15, 1.0)):
        for part in _placed(shapes.bottle(chance), x, y, scale):
            part.location.z += 0.3
            bottles.append(part)
    return [plinth, *bottles]


def boxes(_: random.Random) -> list[Object]:
    """Cartons and a jar, as for a catalog."""
    cartons = [
        making.box("Carton", (1.0, 0.6, 1.5), (-0.5, 0.2, 0.75), 0.3),
        making.box("Tin", (0.7, 0.7, 0.5), (0.6, -0.3, 0.25), -0.2),
    ]
    jar = making.lathe("Jar", [(0.0, 0.0), (0.35, 0.0), (0.38, 0.05), (0.38, 0.7), (0.3, 0.8), (0.0, 0.82)])
    jar.location = (0.5, 0.5, 0.0)
    return [*cartons, jar]


def _hills(chance: random.Random, height: float) -> Object:
    """A hilly ground of 24 m, flat in front."""
    count = 96
    x, y = np.meshgrid(np.linspace(-12, 12, count), np.linspace(-6, 18, count))
    z = np.zeros_like(x)
    for _ in range(6):
        cx, cy, width = chance.uniform(-11, 11), chance.uniform(6, 17), chance.uniform(2, 4)
        z += height * chance.uniform(0.5, 1.0) * np.exp(-((x - cx) ** 2 + (y - cy) ** 2) / (2 * width**2))
    index = np.arange(count * count).reshape(count, count)
    faces = np.stack((index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]), -1).reshape(-1, 4)
    return making.mesh("Hills", np.stack((x, y, z), -1).reshape(-1, 3), faces)


def valley(chance: random.Random) -> list[Object]:
    """A cottage before hills."""
    return [_hills(chance, 3.0), *_placed(gatherings.house(chance), 0.0, 0.5, 0.9, 0.4)]


def lake(chance: random.Random) -> list[Object]:
    """Hills behind still water, a rock in it."""
    water = making.box("Water", (24.0, 12.0, 0.02), (0.0, 0.0, 0.02), bevel=0.0)
    stone = making.mesh("Stone", *fields.sphere(32, 17, 0.6))
    stone.scale, stone.location = (1.4, 1.0, 0.6), (1.2, 0.0, 0.1)
    return [water, _hills(chance, 2.5), stone]


def park(chance: random.Random) -> list[Object]:
    """A chair under a tree."""
    return [*_placed(shapes.tree(chance), -0.9, 0.8, 1.4), *_placed(gatherings.chair(chance), 0.9, 0.0, 0.6, 0.4)]


PLACES: dict[str, tuple[ShapeBuilder, tuple[str, ...]]] = {
    each.__name__: (each, ("set",))
    for each in (lounge, bedroom, kitchen, street, night_street, products, boxes, valley, lake, park)
}
"""By name: how it is built, and the features of its mesh."""
