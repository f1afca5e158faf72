# SPDX-License-Identifier: GPL-3.0-or-later
"""Subjects of many parts, about two meters tall, standing at height 0."""

from __future__ import annotations

import math
import random

import bpy
import numpy as np
from bpy.types import Object

from lab.blender.scenes import making


def pebbles(chance: random.Random) -> list[Object]:
    """Ninety stones in a heap."""
    stones = [making.ball("Pebble 0", 0.24, (0, 0, 0.12), 12)]
    for i in range(1, 90):
        stones.append(bpy.data.objects.new(f"Pebble {i}", stones[i % 3].data if i >= 3 else stones[0].data.copy()))
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
    parts = []
    for i in range(12):
        x, y = (0.72 * (i % 4 - 1.5) + chance.uniform(-0.1, 0.1), 0.75 * (i // 4 - 1) + chance.uniform(-0.1, 0.1))
        bpy.ops.mesh.primitive_cylinder_add(
            vertices=6, radius=0.27, depth=0.2, location=(x, y, 0.1), rotation=(0, 0, chance.uniform(0, 1))
        )
        parts.append(making.finish_active(f"Nut {i}", 30.0, bevel={"width": 0.03, "segments": 2}))
        bpy.ops.mesh.primitive_cylinder_add(vertices=32, radius=0.14, depth=0.7, location=(x, y, 0.5))
        parts.append(making.finish_active(f"Bolt {i}", 40.0, bevel={"width": 0.02, "segments": 2}))
    return parts


def columns(_: random.Random) -> list[Object]:
    """Two rows of columns, a pedestal with a head between them."""
    parts = []
    for i in range(8):
        bpy.ops.mesh.primitive_cylinder_add(
            vertices=48, radius=0.22, depth=2.6, location=(-1.3 if i % 2 else 1.3, -0.6 + 1.5 * (i // 2), 1.3)
        )
        parts.append(making.finish_active(f"Column {i}"))
    parts.append(making.box("Pedestal", (0.7, 0.7, 0.7), (0, 0.5, 0.35)))
    bpy.ops.mesh.primitive_monkey_add(size=0.9, location=(0, 0.5, 1.12), rotation=(-0.2, 0, 0.2))
    return [*parts, making.finish_active("Bust", 40.0, subsurf={"levels": 2, "render_levels": 2})]


def chair(_: random.Random) -> list[Object]:
    """A chair with a back of slats."""
    legs = [
        making.box(f"Leg {i}", (0.09, 0.09, 0.9), (0.45 * (1 if i % 2 else -1), 0.4 * (1 if i // 2 else -1), 0.45))
        for i in range(4)
    ]
    slats = [making.box(f"Slat {i}", (0.1, 0.06, 0.85), (0.2 * (i - 2), 0.42, 1.4)) for i in range(5)]
    return [
        making.box("Seat", (1.05, 0.95, 0.1), (0, 0, 0.92)),
        making.box("Top", (1.05, 0.09, 0.16), (0, 0.42, 1.85)),
        *legs,
        *slats,
    ]


def house(_: random.Random) -> list[Object]:
    """A cottage, its roof, a chimney and two fir trees."""
    roof = making.mesh(
        "Roof",
        np.array([(-1, -0.8, 0.9), (1, -0.8, 0.9), (1, 0.8, 0.9), (-1, 0.8, 0.9), (-1, 0, 1.7), (1, 0, 1.7)], float),
        [(0, 1, 5), (0, 5, 4), (2, 3, 4), (2, 4, 5), (1, 2, 5), (3, 0, 4), (0, 3, 2), (0, 2, 1)],
    )
    roof.data.shade_flat()
    parts = [
        making.box("Walls", (1.7, 1.3, 0.9), (0, 0, 0.45), bevel=0.0),
        roof,
        making.box("Chimney", (0.22, 0.22, 0.7), (0.55, 0.2, 1.6), bevel=0.0),
    ]
    for i, (x, y, height) in enumerate([(-1.45, 0.5, 1.8), (1.5, -0.25, 1.3)]):
        bpy.ops.mesh.primitive_cone_add(vertices=32, radius1=0.45, depth=height, location=(x, y, 0.2 + height / 2))
        parts.append(making.finish_active(f"Fir {i}"))
    return parts


def city(chance: random.Random) -> list[Object]:
    """Sixty-four blocks."""
    parts = []
    for i in range(64):
        x, y = 0.36 * (i % 8 - 3.5), 0.36 * (i // 8 - 3.5)
        height = 0.25 + 1.5 * chance.random() ** 2 * math.exp(-0.5 * (x * x + y * y))
        parts.append(making.box(f"Block {i}", (0.26, 0.26, height), (x, y, height / 2), bevel=0.0))
    return parts


def letters(_: random.Random) -> list[Object]:
    """The word VIBE, as extruded letters."""
    bpy.ops.object.text_add(location=(-1.45, 0, 0.05), rotation=(math.pi / 2, 0, 0))
    text = bpy.context.object
    text.name, text.data.body, text.data.size = "Letters", "VIBE", 1.5
    text.data.extrude, text.data.bevel_depth, text.data.bevel_resolution = 0.16, 0.02, 2
    return [text]


def car(_: random.Random) -> list[Object]:
    """A toy car."""
    soft = {"bevel": {"width": 0.16, "segments": 6}}
    parts = []
    for name, size, place in (("Body", (2.4, 1.0, 0.5), (0.0, 0.0, 0.5)), ("Cabin", (1.2, 0.85, 0.5), (0.1, 0, 0.92))):
        bpy.ops.mesh.primitive_cube_add(size=1.0, location=place)
        bpy.context.object.scale = size
        bpy.ops.object.transform_apply(location=False, rotation=False, scale=True)
        parts.append(making.finish_active(name, 40.0, **soft))
    for i in range(4):
        at = (0.75 if i % 2 else -0.75, 0.5 if i // 2 else -0.5, 0.28)
        bpy.ops.mesh.primitive_cylinder_add(
            vertices=48, radius=0.28, depth=0.2, location=at, rotation=(math.pi / 2, 0, 0)
        )
        parts.append(making.finish_active(f"Wheel {i}", 40.0, bevel={"width": 0.04, "segments": 3}))
    return parts


def lantern(_: random.Random) -> list[Object]:
    """A glowing bulb between four posts under a roof."""
    posts = [
        making.box(f"Post {i}", (0.08, 0.08, 1.3), (0.45 * (1 if i % 2 else -1), 0.45 * (1 if i // 2 else -1), 0.75))
        for i in range(4)
    ]
    bpy.ops.mesh.primitive_cone_add(
        vertices=4, radius1=0.95, depth=0.5, location=(0, 0, 1.65), rotation=(0, 0, math.pi / 4)
    )
    return [
        making.ball("Bulb", 0.3, (0, 0, 0.75)),
        making.box("Base", (1.1, 1.1, 0.1), (0, 0, 0.05)),
        *posts,
        making.finish_active("Roof", None),
    ]


def blind(_: random.Random) -> list[Object]:
    """A ball behind a blind, whose slats cut the light."""
    slats = [making.box(f"Slat {i}", (2.6, 0.02, 0.16), (-0.2, -0.9, 0.3 + 0.3 * i), bevel=0.0) for i in range(7)]
    for slat in slats:
        slat.visible_camera, slat.rotation_euler = True, (0.5, 0.0, -0.75)
        slat.location.x -= 0.75
    return [making.ball("Ball", 0.75, (0.35, 0.2, 0.75)), *slats]
