# SPDX-License-Identifier: GPL-3.0-or-later
"""The bust of a stylized young woman: glasses, a bob, a turtleneck and a coat.

blender -b --python examples/bust.py -- bust.blend
"""

import math
import sys
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import bpy  # noqa: F401  (mathutils is part of it)
from mathutils import Vector

sys.path.append(str(Path(__file__).resolve().parent))
import building as b

CENTER = Vector((0.0, 0.0, 1.62))
"""The middle of the head, which looks to -Y; one unit is about 2.3 decimeters."""
EYE = (0.205, -0.395, 1.60)


def build() -> None:
    """Builds the figure and a plain backdrop."""
    head()
    eyes()
    hair()
    glasses()
    clothes()
    backdrop()
    b.world("#aeb3ba", 0.45)
    b.light("Key Light", "AREA", (-2.6, -3.0, 3.4), (0, 0, 1.5), 210.0, (1.5, 1.5))
    b.light("Fill Light", "AREA", (3.0, -2.6, 1.8), (0, 0, 1.4), 55.0, (2.0, 2.0))
    b.light("Rim Light", "AREA", (2.0, 1.5, 2.7), (0, 0, 1.6), 110.0, (0.7, 1.6), spread=math.radians(110))
    b.camera((0.85, -6.0, 1.72), (-0.26, 0, 1.45), 63.0)


def blend(first: float, second: float, soft: float) -> float:
    """The smaller of two distances, rounded where they meet."""
    share = max(0.0, min(1.0, 0.5 + 0.5 * (second - first) / soft))
    return second + (first - second) * share - soft * share * (1 - share)


def oval(place: Vector, middle: tuple, radii: tuple) -> float:
    """About the distance to an ellipsoid."""
    ratio = math.sqrt(sum(((p - m) / r) ** 2 for p, m, r in zip(place, middle, radii, strict=True)))
    return (ratio - 1) * min(radii)


def face(place: Vector) -> float:
    """The distance to the head: skull, jaw, cheeks, nose, lips, with hollows for the eyes."""
    side = Vector((abs(place.x), place.y, place.z))
    skull = oval(side, (0, 0.05, 1.72), (0.46, 0.52, 0.48))
    jaw = oval(side, (0, -0.13, 1.37), (0.31, 0.33, 0.27))
    chin = oval(side, (0, -0.36, 1.20), (0.105, 0.09, 0.085))
    cheek = oval(side, (0.2, -0.31, 1.44), (0.16, 0.13, 0.13))
    made = blend(blend(skull, jaw, 0.16), blend(cheek, chin, 0.08), 0.12)
    hollow = oval(side, (0.2, -0.54, 1.6), (0.15, 0.11, 0.105))
    made = -blend(-made, hollow, 0.09)
    brow = oval(side, (0.19, -0.415, 1.735), (0.16, 0.05, 0.04))
    made = blend(made, brow, 0.07)
    bridge = oval(side, (0, -0.455, 1.56), (0.042, 0.08, 0.15))
    tip = oval(side, (0, -0.535, 1.455), (0.056, 0.062, 0.05))
    wing = oval(side, (0.058, -0.475, 1.44), (0.04, 0.05, 0.035))
    made = blend(made, blend(blend(bridge, tip, 0.05), wing, 0.03), 0.035)
    upper = oval(side, (0.04, -0.452, 1.327), (0.078, 0.05, 0.022))
    lower = oval(side, (0, -0.452, 1.287), (0.082, 0.05, 0.028))
    return blend(made, min(upper, lower), 0.014)


def surface(distance: Callable[[Vector], float], way: Vector) -> Vector:
    """The outermost point of a shape in a direction from the head's middle."""
    out = 1.0
    for _ in range(40):
        step = distance(CENTER + way * out)
        out -= 0.8 * step
        if abs(step) < 5e-4:
            break
    return CENTER + way * out


def direction(u: float, v: float) -> Vector:
    """A direction; rows run from below to above, and are closer together at the face's features."""
    lon, lat = 2 * math.pi * u - math.pi / 2, math.pi * (v - 0.5)
    lon += 0.35 * math.sin(2 * math.pi * u) * -1.0  # more columns in the front
    lat -= 0.18 * math.sin(2 * lat) * (lat < 0)
    return Vector((math.cos(lat) * math.cos(lon), math.cos(lat) * math.sin(lon), math.sin(lat)))


def head() -> None:
    """Skin, ears, lips, brows, neck."""
    skin = b.material("Skin", "#c79a80", 0.5, subsurface=0.15)
    b.principled(skin).inputs["Subsurface Radius"].default_value = (0.08, 0.03, 0.015)
    b.sheet("Head", lambda u, v: surface(face, direction(u, v)), 88, 66, skin, closed=True)
    neck = [(0.30, 0.75), (0.235, 0.95), (0.225, 1.1), (0.24, 1.3), (0.26, 1.42)]
    b.turned("Neck", neck, (0, 0.07, 0), skin, 40)
    lips = b.material("Lips", "#9c5a50", 0.35, subsurface=0.1)

    def lip(u: float, v: float) -> b.Point:
        x = 0.094 * (2 * u - 1)
        share = 1 - (2 * u - 1) ** 2
        bow = 0.011 * math.exp(-((x / 0.02) ** 2))
        z = 1.309 + share * (0.034 * max(0.0, 2 * v - 1) ** 0.9 - 0.038 * max(0.0, 1 - 2 * v) ** 0.9) - bow * (v > 0.9)
        z += 0.012 * (1 - share)
        target = Vector((x, -0.5, z)) - CENTER
        spot = surface(face, target.normalized())
        return spot + (spot - CENTER).normalized() * (0.004 + 0.012 * share * math.sin(math.pi * v))

    b.sheet("Lips", lip, 28, 14, lips)
    brow = b.material("Brows", "#3b2418", 0.8)
    for side in (-1, 1):
        name = "Right" if side < 0 else "Left"
        line = [
            surface(face, (Vector((side * x, -0.5, z)) - CENTER).normalized())
            for x, z in ((0.09, 1.765), (0.19, 1.80), (0.29, 1.80), (0.36, 1.755))
        ]
        b.tube(f"Brow {name}", [line], 0.021, brow, (0.7, 1.0, 0.8, 0.2))
        ear = b.ball(f"Ear {name}", (0.05, 0.11, 0.15), (side * 0.45, 0.04, 1.53), skin, 20, 14)
        ear.rotation_euler = (math.radians(-12), 0, side * math.radians(-18))
        b.ball(
            f"Earring {name}",
            (0.032, 0.032, 0.032),
            (side * 0.475, 0.0, 1.355),
            b.bpy.data.materials.get("Earring Gold") or b.material("Earring Gold", "#c49a4e", 0.2, metallic=1.0),
            20,
            12,
        )


def eyes() -> None:
    """Eyeballs, irises, pupils, lids, lashes."""
    white, iris = (b.material("Eye White", "#d9d5d0", 0.15, coat=0.8), b.material("Iris", "#5b7a6a", 0.2, coat=1.0))
    pupil, lash = b.material("Pupil", "#0b0b0b", 0.05, coat=1.0), b.material("Lashes", "#1e1411", 0.7)
    skin = b.existing("Skin")
    for side in (-1, 1):
        name = "Right" if side < 0 else "Left"
        parts = [b.ball(f"Eyeball {name}", (0.112,) * 3, (0, 0, 0), white, 24, 16)]
        for part, size, out, stuff in (("Iris", 0.055, 0.004, iris), ("Pupil", 0.027, 0.007, pupil)):

            def cap(u: float, v: float, size: float = size, out: float = out) -> b.Point:
                radius = size * v
                return (
                    radius * math.cos(2 * math.pi * u),
                    -math.sqrt((0.112 + out) ** 2 - radius**2),
                    radius * math.sin(2 * math.pi * u),
                )

            parts.append(b.sheet(f"{part} {name}", cap, 28, 5, stuff, closed=True))

        def lid(u: float, v: float, upper: bool) -> b.Point:
            lon = math.radians(-92 + 184 * u)
            edge = math.radians(30 if upper else -27) * math.cos(lon * 0.92) - math.radians(3)
            lat = edge + (math.radians(100 if upper else -95) - edge) * v
            r = 0.121 - 0.004 * (v < 0.05)
            return r * math.sin(lon) * math.cos(lat), -r * math.cos(lon) * math.cos(lat), r * math.sin(lat)

        parts.append(b.sheet(f"Upper Lid {name}", lambda u, v: lid(u, v, True), 24, 8, skin, thickness=0.006))
        parts.append(b.sheet(f"Lower Lid {name}", lambda u, v: lid(u, v, False), 24, 8, skin, thickness=0.006))
        rim = [[Vector(lid(0.05 + 0.9 * i / 6, 0.0, True)) * 1.03 for i in range(7)]]
        parts.append(b.tube(f"Lashes {name}", rim, 0.009, lash, [0.5, *[1.0] * 5, 0.5]))
        carrier = b.group(f"Eye {name}", parts, (side * EYE[0], EYE[1], EYE[2]))
        carrier.rotation_euler.z = math.radians(side * 5)


def hair() -> None:
    """A bob: a cap of hair with locks that fall to the chin, parted on the side."""
    stuff = b.material("Hair", "#4a2a1c", 0.38, sheen=0.2)
    b.pattern(stuff, "Noise", ("#3a2015", "#5c3623"), (7, 7, 0.6), bump=0.5, Scale=5.0, Detail=4.0)

    def cap(place: Vector) -> float:
        return oval(place, (0, 0.09, 1.74), (0.525, 0.555, 0.53))

    def hairline(u: float) -> float:
        front = max(0.0, math.cos(2 * math.pi * u)) ** 0.6
        return -0.9 + 1.47 * front

    def shell(u: float, v: float) -> b.Point:
        lon = 2 * math.pi * u - math.pi / 2
        low = hairline(u)
        lat = low + (math.pi / 2 - low) * v
        way = Vector((math.cos(lat) * math.cos(lon), math.cos(lat) * math.sin(lon), math.sin(lat)))
        spot = surface(cap, way)
        groove = 0.012 * math.sin(26 * 2 * math.pi * u) * (1 - v) + 0.006 * math.sin(41 * 2 * math.pi * u) * (1 - v)
        part = 0.03 * math.exp(-(((spot.x - 0.17) / 0.03) ** 2)) * (spot.y < 0.25) * v
        return spot + way * (groove - part)

    b.sheet("Hair Cap", shell, 96, 24, stuff, closed=True)
    count = 0
    for ring, radius in ((0, 1.0), (1, 1.07)):
        for step in range(19):
            angle = math.radians(-38 + 256 * (step + 0.5 * ring) / 18.5)
            count += 1
            lock(f"Lock {count}", angle, radius, 1.13 + 0.03 * math.sin(5 * step), stuff)
    fringe(stuff)


def lock(name: str, angle: float, share: float, end: float, stuff: b.Stuff) -> None:
    """A broad lock from the crown down to the chin's height, curled in at its end."""
    out = Vector((math.cos(angle), math.sin(angle), 0))
    along = Vector((-out.y, out.x, 0))
    rows = (
        (0.24, 2.22, 0.5),
        (0.43, 2.06, 1.0),
        (0.53, 1.78, 1.1),
        (0.55, 1.5, 1.1),
        (0.53, 1.3, 0.9),
        (0.44, end, 0.25),
    )

    def point(u: float, v: float) -> b.Point:
        at = v * (len(rows) - 1)
        first, part = min(int(at), len(rows) - 2), at - min(int(at), len(rows) - 2)
        radius, z, wide = (p + (q - p) * part for p, q in zip(rows[first], rows[first + 1], strict=True))
        turn = 2 * math.pi * u
        middle = Vector((0, 0.09, z)) + Vector((out.x * radius * 0.98, out.y * radius * 1.03, 0)) * share
        return middle + along * (0.105 * wide * math.cos(turn)) + out * (0.04 * wide * math.sin(turn))

    made = b.sheet(name, point, 8, 11, stuff, closed=True)
    made.modifiers.new("Smooth", "SMOOTH").iterations = 3


def fringe(stuff: b.Stuff) -> None:
    """Swept locks over the forehead, from the parting to both sides."""
    count = 0
    for side, reaches in ((-1, (0.0, 0.12, 0.24, 0.36)), (1, (0.0, 0.14))):
        for reach in reaches:
            count += 1
            x = 0.17 - 0.02 * count
            path = [
                Vector((x, -0.18, 2.235)),
                Vector((x + side * (0.08 + 0.4 * reach), -0.42, 2.11 - 0.1 * reach)),
                Vector((x + side * (0.28 + 0.5 * reach), -0.50 + 0.28 * reach, 1.93)),
                Vector((side * 0.50, -0.30 + 0.28 * reach, 1.70)),
                Vector((side * 0.545, -0.16 + 0.3 * reach, 1.42)),
                Vector((side * 0.48, -0.13 + 0.3 * reach, 1.2)),
            ]
            made = b.tube(f"Fringe {count}", [path], 0.085, stuff, (0.5, 1.0, 1.0, 1.0, 0.8, 0.1))
            made.data.bevel_resolution = 2


def glasses() -> None:
    """Round glasses with thin frames."""
    frame = b.material("Glasses Frame", "#20201f", 0.25, coat=0.6)
    y = -0.575
    rings = [
        [
            (
                side * 0.212 + 0.17 * math.cos(a),
                y + 0.03 * abs(math.cos(a)) * (math.cos(a) * side > 0),
                1.585 + 0.155 * math.sin(a),
            )
            for a in (2 * math.pi * i / 16 for i in range(16))
        ]
        for side in (-1, 1)
    ]
    b.tube("Glasses Rims", rings, 0.0125, frame, closed=True).data.resolution_u = 3
    b.tube(
        "Glasses Bridge",
        [[(-0.055, y + 0.002, 1.6), (-0.02, y - 0.012, 1.628), (0.02, y - 0.012, 1.628), (0.055, y + 0.002, 1.6)]],
        0.0125,
        frame,
    )
    b.tube(
        "Glasses Temples",
        [
            [(s * 0.378, y + 0.03, 1.62), (s * 0.45, -0.42, 1.625), (s * 0.485, -0.1, 1.62), (s * 0.47, 0.08, 1.56)]
            for s in (-1, 1)
        ],
        0.011,
        frame,
    )


def torso(u: float, z: float, out: float) -> b.Point:
    """A point of the chest and shoulders at a height, `out` of the skin."""
    rows = (
        (0.0, 0.80, 0.44),
        (0.35, 0.86, 0.45),
        (0.55, 0.84, 0.42),
        (0.70, 0.74, 0.37),
        (0.80, 0.58, 0.33),
        (0.87, 0.40, 0.29),
        (0.95, 0.30, 0.27),
    )
    first, second = next(pair for pair in pairwise(rows) if z <= pair[1][0])
    part = max(0.0, min(1.0, (z - first[0]) / (second[0] - first[0])))
    part = part * part * (3 - 2 * part) * 0.4 + part * 0.6
    wide, deep = (p + (q - p) * part for p, q in zip(first[1:], second[1:], strict=True))
    angle = 2 * math.pi * u - math.pi / 2
    x = (wide + out) * math.copysign(abs(math.cos(angle)) ** 0.8, math.cos(angle))
    y = (deep + out) * math.copysign(abs(math.sin(angle)) ** 0.9, math.sin(angle))
    return x, y + 0.08 - 0.05 * (y < 0) * (1 - z), z


def clothes() -> None:
    """A ribbed turtleneck, a coat with lapels and buttons."""
    knit = b.material("Turtleneck Knit", "#b9a78d", 0.85, sheen=0.4)
    b.pattern(
        knit, "Wave", ("#a8967d", "#c4b399"), turn=(0, 0, 0), bump=0.5, Scale=9.0, bands_direction="X", Distortion=0.3
    )
    b.sheet("Sweater", lambda u, v: torso(u, 0.95 * v, 0.0), 48, 20, knit, closed=True)
    collar = [
        (0.33, 0.86),
        (0.31, 0.95),
        (0.30, 1.04),
        (0.315, 1.115),
        (0.345, 1.13),
        (0.365, 1.09),
        (0.365, 1.0),
        (0.375, 0.94),
        (0.355, 0.91),
    ]

    def fold(u: float, v: float) -> b.Point:
        at = v * (len(collar) - 1)
        first = min(int(at), len(collar) - 2)
        radius, z = (p + (q - p) * (at - first) for p, q in zip(collar[first], collar[first + 1], strict=True))
        rib = 0.006 * math.sin(33 * 2 * math.pi * u)
        angle = 2 * math.pi * u
        return (
            (radius + rib) * math.cos(angle),
            0.06 + (radius + rib) * math.sin(angle) * 0.98,
            z + 0.05 * math.sin(angle),
        )

    b.sheet("Turtleneck Collar", fold, 132, 14, knit, closed=True)
    wool = b.material("Coat Wool", "#5d6670", 0.85, sheen=0.4)
    b.pattern(wool, "Noise", bump=0.3, Scale=90.0)

    def coat(u: float, v: float) -> b.Point:
        z = 0.90 * v
        opening = 0.006 + 0.105 * max(0.0, (z - 0.12) / 0.78) ** 0.8
        return torso(opening + (1 - 2 * opening) * u, z, 0.05 - 0.02 * v)

    b.sheet("Coat", coat, 56, 18, wool, thickness=0.035)
    for side in (-1, 1):
        name = "Right" if side < 0 else "Left"

        def lapel(u: float, v: float, side: int = side) -> b.Point:
            z = 0.10 + 0.84 * v
            opening = 0.006 + 0.105 * max(0.0, (z - 0.12) / 0.78) ** 0.8
            broad = (
                0.075 * math.sin(math.pi * min(1.0, v * 1.12)) ** 0.7 if v < 0.62 else 0.03 + 0.055 * (v - 0.62) / 0.38
            )
            turn = opening + broad * u
            return torso(turn if side > 0 else 1 - turn, z, 0.095 + 0.02 * math.sin(math.pi * u))

        b.sheet(f"Lapel {name}", lapel, 8, 30, wool, thickness=0.02)
    horn = b.material("Coat Buttons", "#2e211a", 0.3, coat=0.4)
    for number, z in enumerate((0.04, 0.0), 1):
        place = torso(0.965, z, 0.1)
        button = b.turned(
            f"Button {number}", [(0, 0.012), (0.035, 0.012), (0.045, 0.018), (0.045, 0), (0, 0)], place, horn, 24
        )
        button.rotation_euler.x = math.radians(90)


def backdrop() -> None:
    """A painted canvas behind the figure."""
    canvas = b.pattern(
        b.material("Canvas Backdrop", "#8b8983", 0.9), "Noise", ("#77756f", "#9a9892"), Scale=0.9, Detail=7.0
    )
    b.sheet("Backdrop", lambda u, v: (-6 + 12 * u, 2.6 + 0.05 * math.sin(9 * u), -2 + 7 * v), 24, 1, canvas)


if __name__ == "__main__":
    b.run(build)
