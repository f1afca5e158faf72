# SPDX-License-Identifier: GPL-3.0-or-later
"""More subjects, of things that people name: for the benchmark of the words. Sizes and places as in `shapes`."""

from __future__ import annotations

import math
import random

import bpy
from bpy.types import Object

from lab.blender.scenes import making
from lab.blender.scenes.shapes import ShapeBuilder


def _tube(
    name: str,
    radius: float,
    length: float,
    place: tuple[float, float, float],
    turn: tuple[float, float, float] = (0.0, 0.0, 0.0),
    tip: float | None = None,
) -> Object:
    """A round bar, or a cone that ends in another radius; rounded where it has an edge."""
    bpy.ops.mesh.primitive_cone_add(
        vertices=48, radius1=radius, radius2=radius if tip is None else tip, depth=length, location=place, rotation=turn
    )
    return making.finish_active(name, 40.0, bevel={"width": 0.15 * min(radius, length), "segments": 3})


def _ring(name: str, radius: float, thickness: float, place: tuple[float, float, float], turn: float) -> Object:
    bpy.ops.mesh.primitive_torus_add(
        major_radius=radius,
        minor_radius=thickness,
        major_segments=64,
        minor_segments=24,
        location=place,
        rotation=(turn, 0.0, 0.0),
    )
    return making.finish_active(name)


def _soft_box(name: str, size: tuple[float, float, float], place: tuple[float, float, float]) -> Object:
    """A padded block."""
    return making.box(name, size, place, bevel=0.3 * min(size))


_CUP = [(0.0, 0.0), (0.36, 0.0), (0.44, 0.04), (0.46, 0.5), (0.48, 1.0)]


def _cup(name: str, scale: float, place: tuple[float, float, float]) -> list[Object]:
    """A cup of a thin wall and its handle."""
    body = making.lathe(name, _CUP, 0.05)
    handle = _ring(f"{name} Handle", 0.3, 0.06, (0.62, 0.0, 0.52), math.pi / 2)
    for part in (body, handle):
        part.location = tuple(p + scale * v for p, v in zip(place, part.location, strict=True))
        part.scale = (scale,) * 3
    return [body, handle]


def mug(_: random.Random) -> list[Object]:
    """A mug and its handle."""
    return _cup("Mug", 1.6, (0.0, 0.0, 0.0))


def duck(_: random.Random) -> list[Object]:
    """A bath duck: in turn, parts of its body, of its bill, and eyes."""
    body = making.ball("Body", 0.8, (0.0, 0.0, 0.6))
    body.scale = (1.15, 0.85, 0.72)
    head = making.ball("Head", 0.46, (0.62, 0.0, 1.38))
    tail = _tube("Tail", 0.34, 0.6, (-0.85, 0.0, 0.95), (0.0, -0.9, 0.0), 0.05)
    bills, eyes = [], []
    for i, side in enumerate((-1, 1)):
        bills.append(making.ball(f"Bill {i}", 0.2, (1.12, 0.0, 1.32 + 0.05 * side)))
        bills[i].scale = (1.1, 0.8, 0.25)
        eyes.append(making.ball(f"Eye {i}", 0.07, (0.95, 0.27 * side, 1.52)))
    return [body, bills[0], eyes[0], head, bills[1], eyes[1], tail]


def mushroom(_: random.Random) -> list[Object]:
    """A mushroom: cap and stem."""
    cap = making.lathe(
        "Cap", [(0.0, 1.95), (0.45, 1.85), (0.85, 1.5), (1.0, 1.15), (0.9, 1.05), (0.3, 1.2), (0.0, 1.2)]
    )
    stem = making.lathe("Stem", [(0.0, 0.0), (0.34, 0.0), (0.3, 0.3), (0.22, 0.8), (0.24, 1.25)])
    return [cap, stem]


def donut(_: random.Random) -> list[Object]:
    """It leans on nothing, as they do in pictures."""
    dough = _ring("Dough", 0.62, 0.34, (0.0, 0.0, 0.95), 1.15)
    icing = _ring("Icing", 0.62, 0.345, (0.0, -0.03, 0.99), 1.15)
    icing.scale = (1.0, 1.0, 0.95)
    return [dough, icing]


def rocket(_: random.Random) -> list[Object]:
    """A toy rocket with three fins."""
    hull = making.lathe("Hull", [(0.0, 0.3), (0.3, 0.3), (0.46, 0.8), (0.42, 1.4), (0.22, 1.9), (0.0, 2.15)])
    fins = []
    for i in range(3):
        angle = 2 * math.pi * i / 3 - 0.6
        fin = making.box(f"Fin {i}", (0.5, 0.06, 0.55), (0.55 * math.cos(angle), 0.55 * math.sin(angle), 0.3), angle)
        fins.append(fin)
    return [hull, *fins]


def robot(_: random.Random) -> list[Object]:
    """Boxes and tubes."""
    limbs = [
        _tube(f"Arm {i}", 0.12, 0.8, (0.62 * side, 0.0, 0.95), (0.0, 0.25 * side, 0.0))
        for i, side in enumerate((-1, 1))
    ]
    limbs += [_tube(f"Leg {i}", 0.15, 0.5, (0.25 * side, 0.0, 0.25)) for i, side in enumerate((-1, 1))]
    eyes = [making.ball(f"Eye {i}", 0.09, (0.17 * side, -0.36, 1.72), 16) for i, side in enumerate((-1, 1))]
    return [
        making.box("Chest", (0.95, 0.6, 0.85), (0.0, 0.0, 0.92), bevel=0.06),
        making.box("Head", (0.7, 0.55, 0.5), (0.0, -0.05, 1.68), bevel=0.08),
        *limbs,
        *eyes,
    ]


def boat(_: random.Random) -> list[Object]:
    """A toy sailing boat on its keel."""
    hull = making.ball("Hull", 0.9, (0.0, 0.0, 0.3))
    hull.scale = (1.2, 0.42, 0.36)
    mast = _tube("Mast", 0.04, 1.7, (0.05, 0.0, 1.3))
    sail = _tube("Sail", 0.62, 1.3, (0.42, 0.0, 1.35), (0.0, 0.0, 0.0), 0.02)
    sail.scale = (0.62, 0.04, 1.0)
    return [hull, mast, sail]


def lamp(_: random.Random) -> list[Object]:
    """A table lamp beside a stack of three books."""
    shade = making.lathe("Shade", [(0.55, 1.2), (0.5, 1.4), (0.32, 1.9)], 0.02)
    foot = making.lathe("Foot", [(0.0, 0.0), (0.34, 0.0), (0.3, 0.1), (0.06, 0.2), (0.05, 0.8), (0.04, 1.5)])
    books = [
        making.box(f"Book {i}", (0.85 - 0.08 * i, 0.6, 0.16), (0.95, -0.1, 0.08 + 0.17 * i), 0.2 * i, 0.015)
        for i in range(3)
    ]
    return [shade, foot, *books]


def sofa(_: random.Random) -> list[Object]:
    """A sofa of padded blocks."""
    seats = [_soft_box(f"Seat {i}", (1.0, 0.9, 0.3), (0.52 * side, -0.05, 0.5)) for i, side in enumerate((-1, 1))]
    arms = [_soft_box(f"Arm {i}", (0.3, 1.05, 0.75), (1.22 * side, 0.0, 0.45)) for i, side in enumerate((-1, 1))]
    return [_soft_box("Base", (2.4, 1.0, 0.32), (0.0, 0.0, 0.25)), _soft_box("Back", (2.4, 0.32, 0.75), (0.0, 0.45, 0.8)), *seats, *arms]  # fmt: skip


def table(_: random.Random) -> list[Object]:
    """A cup on a round table."""
    top = _tube("Table", 1.15, 0.12, (0.0, 0.0, 0.94))
    leg = _tube("Table Leg", 0.12, 0.9, (0.0, 0.0, 0.45))
    cup = _cup("Cup", 0.75, (0.0, 0.0, 1.0))
    return [cup[0], top, cup[1], leg]


def supper(_: random.Random) -> list[Object]:
    """A bowl, a bottle and a plate."""
    bowl = making.lathe("Bowl", [(0.0, 0.0), (0.25, 0.0), (0.5, 0.2), (0.68, 0.6)], 0.04)
    bottle = making.lathe(
        "Bottle", [(0.0, 0.0), (0.25, 0.0), (0.26, 0.9), (0.2, 1.1), (0.08, 1.3), (0.08, 1.75), (0.0, 1.76)]
    )
    bottle.location = (-0.85, 0.35, 0.0)
    plate = making.lathe("Plate", [(0.0, 0.02), (0.4, 0.02), (0.62, 0.09)], 0.03)
    plate.location = (1.15, -0.1, 0.0)
    return [bowl, bottle, plate]


PROPS: dict[str, tuple[ShapeBuilder, tuple[str, ...]]] = {
    "mug": (mug, ("thin",)),
    "duck": (duck, ("closed",)),
    "mushroom": (mushroom, ("open",)),
    "donut": (donut, ("closed",)),
    "rocket": (rocket, ("open",)),
    "robot": (robot, ("many objects",)),
    "boat": (boat, ("thin",)),
    "lamp": (lamp, ("thin",)),
    "sofa": (sofa, ("closed",)),
    "table": (table, ("thin",)),
    "supper": (supper, ("thin",)),
}
"""By name: how it is built, and the features of its mesh."""
