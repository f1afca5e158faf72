# SPDX-License-Identifier: GPL-3.0-or-later
"""Subjects: shapes made of Blender's primitives and of formulas, about two meters tall, standing at height 0."""

from __future__ import annotations

import math
import random
from collections.abc import Callable

import bpy
import numpy as np
from bpy.types import Object

from lab.blender.scenes import fields, gatherings, making

ShapeBuilder = Callable[[random.Random], list[Object]]


def head(_: random.Random) -> list[Object]:
    """Suzanne."""
    bpy.ops.mesh.primitive_monkey_add(size=2.0, location=(0, 0, 0.98), rotation=(-0.24, 0, 0.1))
    return [making.finish_active("Head", 40.0, subsurf={"levels": 2, "render_levels": 2})]


def ball(_: random.Random) -> list[Object]:
    """A ball of radius 0.9."""
    return [making.ball("Ball", 0.9, (0, 0, 0.9), 48)]


def trio(_: random.Random) -> list[Object]:
    """Three balls in a row."""
    places = [(-1.25, 0.1, 0.6), (0.0, -0.2, 0.6), (1.25, 0.1, 0.6)]
    return [making.ball(f"Ball {i}", 0.6, place) for i, place in enumerate(places)]


def rings(_: random.Random) -> list[Object]:
    """Three tori that lean on each other."""
    parts = []
    for i, (place, turn) in enumerate(
        [((-0.55, 0, 0.62), (1.35, 0, 0.5)), ((0.55, 0.25, 0.62), (1.4, 0.1, -0.4)), ((0.1, -0.75, 0.17), (0, 0, 0))]
    ):
        bpy.ops.mesh.primitive_torus_add(
            major_radius=0.5, minor_radius=0.15, major_segments=96, minor_segments=32, location=place, rotation=turn
        )
        parts.append(making.finish_active(f"Ring {i}"))
    return parts


def vase(_: random.Random) -> list[Object]:
    """A vase."""
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
    return [making.lathe("Vase", profile)]


def bowl(_: random.Random) -> list[Object]:
    """An open bowl with fruit in it."""
    angles = np.linspace(0.0, 0.45 * math.pi, 20)
    wall = [(float(1.05 * math.sin(a)), float(0.9 - 0.9 * math.cos(a))) for a in angles]
    fruit = [
        making.ball(f"Fruit {i}", 0.3, (0.36 * math.cos(2.1 * i), 0.36 * math.sin(2.1 * i), 0.5)) for i in range(3)
    ]
    return [making.lathe("Bowl", wall), *fruit]


def bottle(_: random.Random) -> list[Object]:
    """A bottle."""
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
    return [making.lathe("Bottle", profile)]


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
    return [making.lathe("Goblet", profile, 0.03), making.ball("Ball", 0.3, (0.85, -0.2, 0.3))]


def cloth(_: random.Random) -> list[Object]:
    """A cloth draped over a ball."""
    return [making.mesh("Cloth", *fields.drape(140))]


def curtain(_: random.Random) -> list[Object]:
    """A curtain."""
    return [making.mesh("Curtain", *fields.curtain(160))]


def cage(_: random.Random) -> list[Object]:
    """A ball in a cage of thin wires."""
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=3, radius=1.0, location=(0, 0, 1.0))
    wires = making.finish_active("Cage", None, wireframe={"thickness": 0.035})
    return [wires, making.ball("Core", 0.45, (0, 0, 1.0))]


def plant(chance: random.Random) -> list[Object]:
    """Leaves on stems in a pot."""
    pot = making.lathe("Pot", [(0.0, 0.0), (0.3, 0.0), (0.42, 0.55), (0.46, 0.55), (0.46, 0.62), (0.38, 0.62)], 0.03)
    return [pot, making.mesh("Leaves", *fields.leaves(chance, 46))]


def tree(chance: random.Random) -> list[Object]:
    """A bare tree: a few hundred tapering branches."""
    return [making.mesh("Tree", *fields.branches(chance))]


def cushion(_: random.Random) -> list[Object]:
    """A cushion."""
    bpy.ops.mesh.primitive_cube_add(size=1.6, location=(0, 0, 0.55), rotation=(0, 0, 0.35))
    bpy.context.object.scale = (1.0, 1.0, 0.62)
    return [making.finish_active("Cushion", 180.0, subsurf={"levels": 4, "render_levels": 4})]


def crystal(_: random.Random) -> list[Object]:
    """A crystal."""
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=1, radius=1.0, location=(0, 0, 0.95), rotation=(0.3, 0.2, 0))
    return [making.finish_active("Crystal", None)]


def tubes(_: random.Random) -> list[Object]:
    """Glowing rings around a dark ball."""
    parts = []
    for i, radius in enumerate((0.95, 0.75)):
        bpy.ops.mesh.primitive_torus_add(
            major_radius=radius,
            minor_radius=0.04,
            major_segments=128,
            minor_segments=16,
            location=(0, 0, 1.05),
            rotation=(1.2 - 0.9 * i, 0.3, 0),
        )
        parts.append(making.finish_active(f"Tube {i}"))
    return [*parts, making.ball("Core", 0.45, (0, 0, 1.05))]


def knot(_: random.Random) -> list[Object]:
    """A knot of 200,000 triangles."""
    return [making.mesh("Knot", *fields.knot(1000, 100))]


def rock(chance: random.Random) -> list[Object]:
    """A stone of 204,000 triangles."""
    return [making.mesh("Rock", *fields.rock(chance, 400, 256))]


SHAPES: dict[str, tuple[ShapeBuilder, tuple[str, ...]]] = {
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
    "pebbles": (gatherings.pebbles, ("many objects", "closed")),
    "bolts": (gatherings.bolts, ("many objects", "closed")),
    "columns": (gatherings.columns, ("many objects", "closed")),
    "chair": (gatherings.chair, ("many objects", "thin")),
    "house": (gatherings.house, ("closed",)),
    "city": (gatherings.city, ("many objects", "closed")),
    "letters": (gatherings.letters, ("closed",)),
    "car": (gatherings.car, ("closed",)),
    "cushion": (cushion, ("closed",)),
    "crystal": (crystal, ("closed",)),
    "lantern": (gatherings.lantern, ("thin", "closed")),
    "tubes": (tubes, ("thin", "closed")),
    "knot": (knot, ("200k triangles", "closed")),
    "rock": (rock, ("200k triangles", "closed")),
    "blind": (gatherings.blind, ("thin", "closed")),
}
"""By name: how it is built, and the features of its mesh."""
