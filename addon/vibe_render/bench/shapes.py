# SPDX-License-Identifier: GPL-3.0-or-later
"""Subjects: shapes made of Blender's primitives and of formulas, about two meters tall, standing at height 0."""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Iterable

import bpy
import numpy as np
from bpy.types import Object

from . import fields

Build = Callable[[random.Random], list[Object]]


def _made(name: str, smooth: float | None = 40.0, **modifiers: dict) -> Object:
    """Names the active object, gives it modifiers ("Bevel": {...}) and smooth shading up to an angle."""
    thing = bpy.context.object
    thing.name = name
    for kind, settings in modifiers.items():
        made = thing.modifiers.new(kind.title(), kind.upper())
        for key, value in settings.items():
            setattr(made, key, value)
    if smooth is not None:
        thing.data.shade_smooth()
        thing.data.set_sharp_from_angle(angle=math.radians(smooth))
    thing.select_set(False)
    return thing


def _mesh(name: str, vertices: np.ndarray, faces: Iterable, uvs: np.ndarray | None = None) -> Object:
    """A smooth object of a mesh; vertices (V, 3), uvs one per corner of each face."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices.tolist(), [], np.asarray(faces).tolist())
    if uvs is not None:
        mesh.uv_layers.new(name="UVMap").data.foreach_set("uv", uvs.astype(np.float32).ravel())
    mesh.shade_smooth()
    thing = bpy.data.objects.new(name, mesh)
    bpy.context.collection.objects.link(thing)
    return thing


def _ball(name: str, radius: float, place: tuple[float, float, float], rings: int = 32) -> Object:
    """A ball with UVs. (Blender's own has its faces in another order every time.)"""
    thing = _mesh(name, *fields.sphere(2 * rings, rings + 1, radius))
    thing.location = place
    return thing


def _box(
    name: str,
    size: tuple[float, float, float],
    place: tuple[float, float, float],
    turn: float = 0.0,
    bevel: float = 0.02,
) -> Object:
    bpy.ops.mesh.primitive_cube_add(size=1.0, location=place, rotation=(0.0, 0.0, turn))
    thing = bpy.context.object
    thing.scale = size
    bpy.ops.object.transform_apply(location=False, rotation=False, scale=True)
    return _made(name, 40.0, **({"bevel": {"width": bevel, "segments": 3}} if bevel else {}))


def _lathe(name: str, profile: list[tuple[float, float]], thickness: float = 0.0) -> Object:
    """A profile (radius, height) turned around the z axis; without a thickness it is an open surface."""
    thing = _mesh(name, *fields.lathe(np.array(profile, float)))
    if thickness:
        solid = thing.modifiers.new("Solid", "SOLIDIFY")
        solid.thickness, solid.offset = thickness, 0.0
    return thing


def head(_: random.Random) -> list[Object]:
    """Suzanne."""
    bpy.ops.mesh.primitive_monkey_add(size=2.0, location=(0, 0, 0.98), rotation=(-0.24, 0, 0.1))
    return [_made("Head", 40.0, subsurf={"levels": 2, "render_levels": 2})]


def ball(_: random.Random) -> list[Object]:
    return [_ball("Ball", 0.9, (0, 0, 0.9), 48)]


def trio(_: random.Random) -> list[Object]:
    places = [(-1.25, 0.1, 0.6), (0.0, -0.2, 0.6), (1.25, 0.1, 0.6)]
    return [_ball(f"Ball {i}", 0.6, place) for i, place in enumerate(places)]


def rings(_: random.Random) -> list[Object]:
    """Three tori that lean on each other."""
    made = []
    for i, (place, turn) in enumerate(
        [
            ((-0.55, 0, 0.62), (1.35, 0, 0.5)),
            ((0.55, 0.25, 0.62), (1.4, 0.1, -0.4)),
            ((0.1, -0.75, 0.17), (0, 0, 0)),
        ]
    ):
        bpy.ops.mesh.primitive_torus_add(
            major_radius=0.5,
            minor_radius=0.15,
            major_segments=96,
            minor_segments=32,
            location=place,
            rotation=turn,
        )
        made.append(_made(f"Ring {i}"))
    return made


def vase(_: random.Random) -> list[Object]:
    profile = [
        (0.0, 0.0),
        (0.3, 0.0),
        (0.34, 0.05),
        (0.52, 0.5),
        (0.55, 0.8),
        (0.42, 1.2),
        (0.2, 1.5),
        (0.19, 1.7),
        (0.3, 1.9),
    ]
    return [_lathe("Vase", profile)]


def bowl(_: random.Random) -> list[Object]:
    """An open bowl with fruit in it."""
    angles = np.linspace(0.0, 0.45 * math.pi, 20)
    wall = [(float(1.05 * math.sin(a)), float(0.9 - 0.9 * math.cos(a))) for a in angles]
    fruit = [
        _ball(f"Fruit {i}", 0.3, (0.36 * math.cos(2.1 * i), 0.36 * math.sin(2.1 * i), 0.5)) for i in range(3)
    ]
    return [_lathe("Bowl", wall), *fruit]


def bottle(_: random.Random) -> list[Object]:
    profile = [
        (0.0, 0.0),
        (0.36, 0.0),
        (0.4, 0.05),
        (0.4, 1.1),
        (0.34, 1.3),
        (0.13, 1.5),
        (0.12, 1.85),
        (0.15, 1.88),
        (0.15, 1.95),
        (0.0, 1.95),
    ]
    return [_lathe("Bottle", profile)]


def goblet(_: random.Random) -> list[Object]:
    """A glass of thin wall on a stem, and a ball beside it."""
    profile = [
        (0.0, 0.0),
        (0.42, 0.02),
        (0.08, 0.1),
        (0.05, 0.5),
        (0.06, 0.75),
        (0.35, 0.9),
        (0.5, 1.2),
        (0.48, 1.6),
        (0.4, 1.9),
    ]
    return [_lathe("Goblet", profile, 0.03), _ball("Ball", 0.3, (0.85, -0.2, 0.3))]


def cloth(_: random.Random) -> list[Object]:
    """A cloth draped over a ball."""
    return [_mesh("Cloth", *fields.drape(140))]


def curtain(_: random.Random) -> list[Object]:
    return [_mesh("Curtain", *fields.curtain(160))]


def cage(_: random.Random) -> list[Object]:
    """A ball in a cage of thin wires."""
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=3, radius=1.0, location=(0, 0, 1.0))
    wires = _made("Cage", None, wireframe={"thickness": 0.035})
    return [wires, _ball("Core", 0.45, (0, 0, 1.0))]


def plant(chance: random.Random) -> list[Object]:
    """Leaves on stems in a pot."""
    pot = _lathe(
        "Pot", [(0.0, 0.0), (0.3, 0.0), (0.42, 0.55), (0.46, 0.55), (0.46, 0.62), (0.38, 0.62)], 0.03
    )
    return [pot, _mesh("Leaves", *fields.leaves(chance, 46))]


def tree(chance: random.Random) -> list[Object]:
    """A bare tree: a few hundred tapering branches."""
    return [_mesh("Tree", *fields.branches(chance))]


def pebbles(chance: random.Random) -> list[Object]:
    """Ninety stones in a heap."""
    stones = [_ball("Pebble 0", 0.24, (0, 0, 0.12), 12)]
    for i in range(1, 90):
        stones.append(
            bpy.data.objects.new(f"Pebble {i}", stones[i % 3].data if i >= 3 else stones[0].data.copy())
        )
        bpy.context.collection.objects.link(stones[-1])
    for i, stone in enumerate(stones):
        radius, angle = 0.13 * math.sqrt(i), 2.39996 * i
        stone.location = (
            radius * math.cos(angle),
            radius * math.sin(angle),
            0.1 + 0.5 * max(0.0, 1.0 - radius) * chance.random(),
        )
        stone.scale = (chance.uniform(0.5, 1.1), chance.uniform(0.5, 1.1), chance.uniform(0.35, 0.7))
        stone.rotation_euler = (0.0, 0.0, chance.uniform(0, 6.3))
    return stones


def bolts(chance: random.Random) -> list[Object]:
    """Screws that stand and lie about."""
    made = []
    for i in range(12):
        x, y = (
            0.72 * (i % 4 - 1.5) + chance.uniform(-0.1, 0.1),
            0.75 * (i // 4 - 1) + chance.uniform(-0.1, 0.1),
        )
        bpy.ops.mesh.primitive_cylinder_add(
            vertices=6, radius=0.27, depth=0.2, location=(x, y, 0.1), rotation=(0, 0, chance.uniform(0, 1))
        )
        made.append(_made(f"Nut {i}", 30.0, bevel={"width": 0.03, "segments": 2}))
        bpy.ops.mesh.primitive_cylinder_add(vertices=32, radius=0.14, depth=0.7, location=(x, y, 0.5))
        made.append(_made(f"Bolt {i}", 40.0, bevel={"width": 0.02, "segments": 2}))
    return made


def columns(_: random.Random) -> list[Object]:
    """Two rows of columns, a pedestal with a head between them."""
    made = []
    for i in range(8):
        bpy.ops.mesh.primitive_cylinder_add(
            vertices=48, radius=0.22, depth=2.6, location=(-1.3 if i % 2 else 1.3, -0.6 + 1.5 * (i // 2), 1.3)
        )
        made.append(_made(f"Column {i}"))
    made.append(_box("Pedestal", (0.7, 0.7, 0.7), (0, 0.5, 0.35)))
    bpy.ops.mesh.primitive_monkey_add(size=0.9, location=(0, 0.5, 1.12), rotation=(-0.2, 0, 0.2))
    return [*made, _made("Bust", 40.0, subsurf={"levels": 2, "render_levels": 2})]


def chair(_: random.Random) -> list[Object]:
    legs = [
        _box(f"Leg {i}", (0.09, 0.09, 0.9), (0.45 * (1 if i % 2 else -1), 0.4 * (1 if i // 2 else -1), 0.45))
        for i in range(4)
    ]
    slats = [_box(f"Slat {i}", (0.1, 0.06, 0.85), (0.2 * (i - 2), 0.42, 1.4)) for i in range(5)]
    return [
        _box("Seat", (1.05, 0.95, 0.1), (0, 0, 0.92)),
        _box("Top", (1.05, 0.09, 0.16), (0, 0.42, 1.85)),
        *legs,
        *slats,
    ]


def house(_: random.Random) -> list[Object]:
    """A cottage, its roof, a chimney and two firs."""
    roof = _mesh(
        "Roof",
        np.array(
            [(-1, -0.8, 0.9), (1, -0.8, 0.9), (1, 0.8, 0.9), (-1, 0.8, 0.9), (-1, 0, 1.7), (1, 0, 1.7)], float
        ),
        [(0, 1, 5), (0, 5, 4), (2, 3, 4), (2, 4, 5), (1, 2, 5), (3, 0, 4), (0, 3, 2), (0, 2, 1)],
    )
    roof.data.shade_flat()
    made = [
        _box("Walls", (1.7, 1.3, 0.9), (0, 0, 0.45), bevel=0.0),
        roof,
        _box("Chimney", (0.22, 0.22, 0.7), (0.55, 0.2, 1.6), bevel=0.0),
    ]
    for i, (x, y, height) in enumerate([(-1.45, 0.5, 1.8), (1.5, -0.25, 1.3)]):
        bpy.ops.mesh.primitive_cone_add(
            vertices=32, radius1=0.45, depth=height, location=(x, y, 0.2 + height / 2)
        )
        made.append(_made(f"Fir {i}"))
    return made


def city(chance: random.Random) -> list[Object]:
    """Sixty-four blocks."""
    made = []
    for i in range(64):
        x, y = 0.36 * (i % 8 - 3.5), 0.36 * (i // 8 - 3.5)
        height = 0.25 + 1.5 * chance.random() ** 2 * math.exp(-0.5 * (x * x + y * y))
        made.append(_box(f"Block {i}", (0.26, 0.26, height), (x, y, height / 2), bevel=0.0))
    return made


def letters(_: random.Random) -> list[Object]:
    bpy.ops.object.text_add(location=(-1.45, 0, 0.05), rotation=(math.pi / 2, 0, 0))
    text = bpy.context.object
    text.name, text.data.body, text.data.size = "Letters", "VIBE", 1.5
    text.data.extrude, text.data.bevel_depth, text.data.bevel_resolution = 0.16, 0.02, 2
    return [text]


def car(_: random.Random) -> list[Object]:
    """A toy car."""
    soft = {"bevel": {"width": 0.16, "segments": 6}}
    made = []
    for name, size, place in (
        ("Body", (2.4, 1.0, 0.5), (0.0, 0.0, 0.5)),
        ("Cabin", (1.2, 0.85, 0.5), (0.1, 0, 0.92)),
    ):
        bpy.ops.mesh.primitive_cube_add(size=1.0, location=place)
        bpy.context.object.scale = size
        bpy.ops.object.transform_apply(location=False, rotation=False, scale=True)
        made.append(_made(name, 40.0, **soft))
    for i in range(4):
        at = (0.75 if i % 2 else -0.75, 0.5 if i // 2 else -0.5, 0.28)
        bpy.ops.mesh.primitive_cylinder_add(
            vertices=48, radius=0.28, depth=0.2, location=at, rotation=(math.pi / 2, 0, 0)
        )
        made.append(_made(f"Wheel {i}", 40.0, bevel={"width": 0.04, "segments": 3}))
    return made


def cushion(_: random.Random) -> list[Object]:
    bpy.ops.mesh.primitive_cube_add(size=1.6, location=(0, 0, 0.55), rotation=(0, 0, 0.35))
    bpy.context.object.scale = (1.0, 1.0, 0.62)
    return [_made("Cushion", 180.0, subsurf={"levels": 4, "render_levels": 4})]


def crystal(_: random.Random) -> list[Object]:
    bpy.ops.mesh.primitive_ico_sphere_add(
        subdivisions=1, radius=1.0, location=(0, 0, 0.95), rotation=(0.3, 0.2, 0)
    )
    return [_made("Crystal", None)]


def lantern(_: random.Random) -> list[Object]:
    """A glowing bulb between four posts under a roof."""
    posts = [
        _box(
            f"Post {i}", (0.08, 0.08, 1.3), (0.45 * (1 if i % 2 else -1), 0.45 * (1 if i // 2 else -1), 0.75)
        )
        for i in range(4)
    ]
    bpy.ops.mesh.primitive_cone_add(
        vertices=4, radius1=0.95, depth=0.5, location=(0, 0, 1.65), rotation=(0, 0, math.pi / 4)
    )
    return [
        _ball("Bulb", 0.3, (0, 0, 0.75)),
        _box("Base", (1.1, 1.1, 0.1), (0, 0, 0.05)),
        *posts,
        _made("Roof", None),
    ]


def tubes(_: random.Random) -> list[Object]:
    """Glowing rings around a dark ball."""
    made = []
    for i, radius in enumerate((0.95, 0.75)):
        bpy.ops.mesh.primitive_torus_add(
            major_radius=radius,
            minor_radius=0.04,
            major_segments=128,
            minor_segments=16,
            location=(0, 0, 1.05),
            rotation=(1.2 - 0.9 * i, 0.3, 0),
        )
        made.append(_made(f"Tube {i}"))
    return [*made, _ball("Core", 0.45, (0, 0, 1.05))]


def knot(_: random.Random) -> list[Object]:
    """A knot of 200,000 triangles."""
    return [_mesh("Knot", *fields.knot(1000, 100))]


def rock(chance: random.Random) -> list[Object]:
    """A stone of 204,000 triangles."""
    return [_mesh("Rock", *fields.rock(chance, 400, 256))]


def blind(_: random.Random) -> list[Object]:
    """A ball behind a blind, whose slats cut the light."""
    slats = [_box(f"Slat {i}", (2.6, 0.02, 0.16), (-0.2, -0.9, 0.3 + 0.3 * i), bevel=0.0) for i in range(7)]
    for slat in slats:
        slat.visible_camera, slat.rotation_euler = True, (0.5, 0.0, -0.75)
        slat.location.x -= 0.75
    return [_ball("Ball", 0.75, (0.35, 0.2, 0.75)), *slats]


SHAPES: dict[str, tuple[Build, tuple[str, ...]]] = {
    "head": (head, ("open",)),
    "ball": (ball, ("closed",)),
    "trio": (trio, ("closed",)),
    "rings": (rings, ("closed",)),
    "vase": (vase, ("open", "thin")),
    "bowl": (bowl, ("open", "thin")),
    "bottle": (bottle, ("closed",)),
    "goblet": (goblet, ("closed", "thin")),
    "cloth": (cloth, ("open", "thin")),
    "curtain": (curtain, ("open", "thin")),
    "cage": (cage, ("thin",)),
    "plant": (plant, ("thin", "open")),
    "tree": (tree, ("thin", "closed")),
    "pebbles": (pebbles, ("many objects", "closed")),
    "bolts": (bolts, ("many objects", "closed")),
    "columns": (columns, ("many objects", "closed")),
    "chair": (chair, ("many objects", "thin")),
    "house": (house, ("closed",)),
    "city": (city, ("many objects", "closed")),
    "letters": (letters, ("closed",)),
    "car": (car, ("closed",)),
    "cushion": (cushion, ("closed",)),
    "crystal": (crystal, ("closed",)),
    "lantern": (lantern, ("thin", "closed")),
    "tubes": (tubes, ("thin", "closed")),
    "knot": (knot, ("200k triangles", "closed")),
    "rock": (rock, ("200k triangles", "closed")),
    "blind": (blind, ("thin", "closed")),
}
"""By name: how it is built, and the features of its mesh."""
