# SPDX-License-Identifier: GPL-3.0-or-later
"""A small classic coupe on a forecourt in front of a garage.

blender -b --python examples/car.py -- car.blend
"""

import math
import sys
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parent))
import building as b

AXLES, WHEEL = (-1.22, 1.22), 0.33
"""Places of the axles along the car, whose nose points to -X, and the radius of the wheels; meters."""
STATIONS = (
    (-2.02, 0.50, 0.36, 0.55),
    (-1.98, 0.70, 0.28, 0.66),
    (-1.72, 0.83, 0.24, 0.76),
    (-1.22, 0.86, 0.24, 0.86),
    (-0.70, 0.84, 0.24, 0.89),
    (0.00, 0.83, 0.24, 0.91),
    (0.70, 0.84, 0.24, 0.92),
    (1.22, 0.86, 0.24, 0.90),
    (1.66, 0.82, 0.26, 0.84),
    (1.93, 0.68, 0.30, 0.74),
    (1.99, 0.52, 0.38, 0.62),
)
"""Sections of the body from nose to tail: place, half the width, height of the sill, height of the hood."""


def build() -> None:
    """Builds the car and where it stands."""
    forecourt()
    body()
    cabin()
    wheels()
    fittings()
    b.world("#aab4bf", 0.7, horizon="#c6c9cb")
    b.light("Sun", "SUN", (-3, -7, 7), (0, 0, 0), 3.0, angle=math.radians(4))
    b.light("Sky Panel", "AREA", (-1.5, -3.5, 5.5), (0, 0, 0.5), 220.0, (6, 3))
    b.camera((-4.9, -5.5, 1.35), (0.15, 0.1, 0.84), 48.0)


def between(x: float) -> tuple[float, float, float]:
    """Half the width, the sill and the hood at a place along the body, smoothly from station to station."""
    for first, second in pairwise(STATIONS):
        if x <= second[0]:
            share = max(0.0, (x - first[0]) / (second[0] - first[0]))
            width, low, high = (p + (q - p) * share for p, q in zip(first[1:], second[1:], strict=True))
            return width, low, high
    return STATIONS[-1][1:]


def body() -> None:
    """The painted hull with fenders, cut out over the wheels."""
    paint = b.material("Car Paint", "#8c8f8e", 0.25, coat=1.0, metallic=0.2)

    def point(u: float, v: float) -> b.Point:
        x = -2.02 + 4.01 * (0.5 - 0.5 * math.cos(math.pi * v)) if 0 < v < 1 else (-2.02, 1.99)[round(v)]
        wide, low, high = between(x)
        angle = 2 * math.pi * u
        across, up = math.sin(angle), -math.cos(angle)
        y = wide * math.copysign(abs(across) ** 0.42, across)
        fender = sum(math.exp(-(((x - axle) / 0.42) ** 2)) for axle in AXLES)
        middle, half = (low + high) / 2, (high - low) / 2
        z = middle + half * math.copysign(abs(up) ** 0.62, up)
        shoulder = 0.5 + 0.5 * math.tanh((z - middle) / 0.1)
        y *= 1 - 0.07 * shoulder * (z - middle) / half
        y += math.copysign(0.055 * fender * math.exp(-(((z - 0.52) / 0.24) ** 2)), y) * min(1.0, abs(across) * 3)
        z += 0.05 * fender * max(0.0, up) * abs(y / 0.8) ** 3 - 0.02 * max(0.0, up) * (1 - abs(y / 0.8) ** 2) * (
            x < -0.8
        )
        return x, y, z

    hull = b.sheet("Body", point, 48, 56, paint, closed=True)
    dark = b.material("Wheel Well", "#101010", 0.9)
    holes = b.turned("Wheel Wells", [(0, -1), (0.385, -1), (0.385, 1), (0, 1)], (0, 0, 0), dark, 40)
    holes.rotation_euler.x = math.pi / 2
    for name, axle in zip(("Front", "Rear"), AXLES, strict=True):
        hole = b.copy(holes, f"{name} Wheel Cut", (axle, 0, WHEEL))
        hole.hide_render, hole.display_type = True, "WIRE"
        cut = hull.modifiers.new(f"{name} Wheel Cut", "BOOLEAN")
        cut.object, cut.operation = hole, "DIFFERENCE"
        b.box(f"{name} Wheel Well", (0.9, 1.2, 0.5), (axle, 0, 0.5), dark, 0.05)
    b.bpy.data.objects.remove(holes)


def roof_line(x: float) -> float:
    """The height of the roof at a place; it falls off to the windshield and in a long curve to the tail."""
    front = 1 - max(0.0, (-0.12 - x) / 0.62) ** 2.1
    rear = 1 - max(0.0, (x - 0.30) / 1.28) ** 2.2
    return 0.84 + 0.52 * max(0.0, min(front, rear))


def cabin() -> None:
    """The glass house, the painted roof over it, pillars."""
    glass = b.material("Window Glass", "#14181b", 0.03, coat=1.0)
    paint = b.existing("Car Paint")

    def shell(x: float, side: float, out: float) -> b.Point:
        top = roof_line(x)
        # The side leans in toward the roof, whose edge is round.
        angle = math.pi / 2 * abs(side)
        wide = 0.70 - 0.10 * max(0.0, abs(x - 0.3) - 0.55) ** 1.5
        lean = math.sin(angle) ** 0.55
        y = math.copysign((wide + out) * lean * (1 - 0.16 * math.cos(angle) ** 0.8), side)
        return x, y, 0.83 + (top + out - 0.83) * math.cos(angle) ** 0.5

    b.sheet("Windows", lambda u, v: shell(-0.735 + 2.3 * v, 2 * u - 1, 0.0), 40, 48, glass)

    def panel(start: float, end: float, low: float, high: float) -> Callable[[float, float], b.Point]:
        return lambda u, v: shell(start + (end - start) * v, low + (high - low) * u, 0.012)

    b.sheet("Roof", panel(-0.24, 0.78, -0.55, 0.55), 24, 20, paint, thickness=-0.012)
    for number, side in enumerate((-1, 1), 1):
        low, high = sorted((0.5 * side, 1.0 * side))
        b.sheet(
            f"Pillar Front {number}",
            panel(-0.735, -0.2, *sorted((0.575 * side, 0.63 * side))),
            6,
            16,
            paint,
            thickness=-0.012,
        )
        b.sheet(f"Pillar Middle {number}", panel(0.36, 0.44, low, high), 10, 3, paint, thickness=-0.012)
        b.sheet(f"Pillar Rear {number}", panel(0.98, 1.565, low, high), 10, 18, paint, thickness=-0.012)
    b.sheet("Roof Rear", panel(0.77, 0.86, -0.56, 0.56), 24, 4, paint, thickness=-0.012)
    chrome = b.material("Chrome", "#c3c6c9", 0.08, metallic=1.0)
    belts = [[shell(-0.74 + 2.3 * i / 14, side * 0.985, 0.014) for i in range(15)] for side in (-1, 1)]
    b.tube("Window Trim", belts, 0.011, chrome).data.resolution_u = 3


def wheels() -> None:
    """Tires, steel rims with slots, hub caps."""
    rubber = b.material("Tire Rubber", "#161616", 0.75)
    rim, chrome = b.material("Rim", "#a2a5a7", 0.3, metallic=0.8), b.existing("Chrome")
    tire = [
        (0.2, -0.09),
        (0.28, -0.1),
        (0.32, -0.075),
        (WHEEL, -0.04),
        (WHEEL, 0.04),
        (0.32, 0.075),
        (0.28, 0.1),
        (0.2, 0.09),
    ]
    disc = [(0.235, -0.06), (0.235, 0.085), (0.215, 0.09), (0.2, 0.06), (0.14, 0.035), (0.09, 0.06), (0, 0.06)]
    cap = [(0.1, 0.055), (0.095, 0.08), (0.06, 0.098), (0, 0.105)]
    spokes = [((0.022, 0.13, 0.02), (0.0, 0.155, 0.062))]
    number = 0
    for axle in AXLES:
        for side in (-1, 1):
            number += 1
            parts = [
                b.turned("Tire", tire, (0, 0, 0), rubber, 48),
                b.turned("Rim", disc, (0, 0, 0), rim, 48),
                b.turned("Hub Cap", cap, (0, 0, 0), chrome, 32),
            ]
            for turn in range(0, 360, 30):
                bar = b.boxes(f"Spoke {turn}", spokes, rim, 0.006, 1)
                bar.rotation_euler.z = math.radians(turn)
                parts.append(bar)
            for part in parts:
                part.name = f"Wheel {number} {part.name.split('.')[0]}"
            carrier = b.group(f"Wheel {number}", parts, (axle, side * 0.70, WHEEL))
            carrier.rotation_euler.x = -side * math.pi / 2


def fittings() -> None:
    """Bumpers, grille, lights, door lines and handles, mirrors, wipers, plate."""
    chrome = b.existing("Chrome")
    lens, amber = (
        b.material("Headlight Glass", "#d9dcdd", 0.05, coat=1.0, metallic=0.6),
        b.material("Turn Signal Glass", "#c67a2b", 0.15, coat=1.0),
    )
    red, black = (b.material("Tail Light Glass", "#8c1d1b", 0.15, coat=1.0), b.material("Black Trim", "#141414", 0.5))
    for name, x, ways in (("Front", -2.0, -1), ("Rear", 1.97, 1)):
        bar = [
            (x - ways * 0.42, -0.83, 0.42),
            (x - ways * 0.1, -0.8, 0.42),
            (x + ways * 0.07, -0.55, 0.42),
            (x + ways * 0.11, 0, 0.42),
            (x + ways * 0.07, 0.55, 0.42),
            (x - ways * 0.1, 0.8, 0.42),
            (x - ways * 0.42, 0.83, 0.42),
        ]
        b.tube(f"Bumper {name}", [bar], 0.042, chrome)
    for side in (-1, 1):
        name = "Right" if side < 0 else "Left"
        parts = [
            b.turned(
                f"Headlight Ring {name}",
                [(0.105, -0.12), (0.128, -0.03), (0.132, 0.02), (0.118, 0.035), (0.11, 0.02)],
                (0, 0, 0),
                chrome,
                40,
            ),
            b.ball(f"Headlight {name}", (0.112, 0.112, 0.05), (0, 0, 0.01), lens, 32, 12),
            b.turned(
                f"Headlight Bowl {name}",
                [(0.0, -0.3), (0.09, -0.2), (0.125, -0.02)],
                (0, 0, 0),
                b.existing("Car Paint"),
                32,
            ),
        ]
        carrier = b.group(f"Headlight Unit {name}", parts, (-1.93, side * 0.575, 0.66))
        carrier.rotation_euler = (0, math.radians(-84), side * math.radians(8))
        b.ball(f"Turn Signal {name}", (0.03, 0.075, 0.036), (-1.985, side * 0.56, 0.49), amber)
        b.ball(f"Tail Light {name}", (0.04, 0.07, 0.1), (1.93, side * 0.56, 0.62), red)
        b.tube(
            f"Door Handle {name}",
            [
                [
                    (0.22, side * 0.845, 0.76),
                    (0.22, side * 0.875, 0.762),
                    (0.36, side * 0.875, 0.762),
                    (0.36, side * 0.845, 0.76),
                ]
            ],
            0.011,
            chrome,
        )
        mirror = b.cushion(f"Mirror {name}", (0.1, 0.16, 0.1), (-0.52, side * 0.86, 0.98), b.existing("Car Paint"), 0.7)
        mirror.rotation_euler.z = side * 0.2
        b.tube(f"Mirror Arm {name}", [[(-0.5, side * 0.72, 0.88), (-0.52, side * 0.84, 0.95)]], 0.012, chrome)
        door_line(side, name, black)
        b.tube(
            f"Side Strip {name}",
            [[(-0.78 + 0.156 * i, side * (0.838 + 0.004 * math.sin(i)), 0.5) for i in range(11)]],
            0.014,
            chrome,
        )
    grille = [((0.03, 0.72, 0.012), (-2.025, 0, 0.535 + 0.035 * i)) for i in range(4)]
    b.boxes("Grille", grille, chrome, 0.004, 1)
    b.box("Grille Opening", (0.03, 0.78, 0.16), (-2.006, 0, 0.588), black, 0.02)
    b.box("License Plate", (0.012, 0.46, 0.1), (-2.135, 0, 0.415), b.material("Plate White", "#d2d1cb", 0.4), 0.004)
    b.text("Plate Number", "VR 0220", 0.085, (-2.143, 0, 0.413), (90, 0, -90), black, 0.001)
    b.tube(
        "Wipers",
        [[(-0.83, y, 0.905), (-0.70, y + 0.2, 0.965), (-0.62, y + 0.4, 1.02)] for y in (-0.5, -0.02)],
        0.008,
        black,
    )
    b.tube("Hood Strip", [[(-1.96, 0, 0.672), (-1.7, 0, 0.757), (-1.22, 0, 0.828), (-0.78, 0, 0.885)]], 0.012, chrome)


def door_line(side: int, name: str, black: b.Stuff) -> None:
    """The gap around a door."""
    line = [
        (-0.55, 0.88),
        (-0.57, 0.6),
        (-0.52, 0.36),
        (-0.42, 0.3),
        (0.3, 0.3),
        (0.42, 0.36),
        (0.46, 0.6),
        (0.42, 0.88),
    ]

    def on_body(x: float, z: float) -> b.Point:
        wide, low, high = between(x)
        middle, half = (low + high) / 2, (high - low) / 2
        up = max(-1.0, min(1.0, (z - middle) / half))
        up = math.copysign(abs(up) ** (1 / 0.62), up)
        across = math.sqrt(max(0.0, 1 - up * up)) ** 0.42
        shoulder = 0.5 + 0.5 * math.tanh((z - middle) / 0.1)
        return x, side * wide * across * (1 - 0.07 * shoulder * (z - middle) / half), z

    b.tube(f"Door Gap {name}", [[on_body(x, z) for x, z in line]], 0.006, black)


def forecourt() -> None:
    """Concrete slabs, a garage with a gate and a lit sign, a planted bed, a lamp over the gate."""
    concrete = b.material("Concrete Slabs", "#8f8b85", 0.6)
    b.pattern(concrete, "Brick", bump=0.3, **{"Color1": "#94908a", "Color2": "#85817b", "Mortar": "#4a4743", "Scale": 1.0, "Mortar Size": 0.012, "Brick Width": 2.4, "Row Height": 2.4})  # fmt: skip
    b.box("Forecourt", (40, 30, 0.1), (4, 0, -0.05), concrete, 0)
    plaster = b.pattern(
        b.material("Garage Plaster", "#b0a797", 0.85), "Noise", ("#a69d8d", "#b8b0a1"), bump=0.12, Scale=2.5, Detail=8.0
    )
    trim = b.material("Garage Trim", "#4c5557", 0.5)
    b.boxes(
        "Garage Wall",
        [
            ((3.3, 0.4, 4.2), (-3.05, 3.4, 2.1)),
            ((7.5, 0.4, 4.2), (7.15, 3.4, 2.1)),
            ((4.8, 0.4, 1.3), (1.0, 3.4, 3.55)),
            ((9, 0.4, 4.2), (-9.2, 3.4, 2.1)),
        ],
        plaster,
        0,
    )
    gate = b.material("Garage Gate", "#6b4f3c", 0.5)
    b.pattern(gate, "Noise", ("#5a4130", "#7a5c47"), (9, 9, 1.2), Scale=1.6)
    b.boxes("Garage Gate", [((0.29, 0.08, 2.85), (-1.25 + 0.3 * i, 3.4, 1.43)) for i in range(16)], gate, 0.012, 1)
    b.boxes(
        "Gate Frame",
        [
            ((0.16, 0.5, 2.95), (-1.44, 3.38, 1.47)),
            ((0.16, 0.5, 2.95), (3.44, 3.38, 1.47)),
            ((5.04, 0.5, 0.16), (1.0, 3.38, 2.95)),
        ],
        trim,
        0.01,
    )
    b.box("Garage Eaves", (24, 0.9, 0.22), (-1, 3.2, 4.25), trim, 0.02)
    b.boxes(
        "Gate Hinges",
        [((0.5, 0.03, 0.06), (x, 3.34, z)) for x in (-1.0, 3.0) for z in (0.5, 2.3)],
        b.bpy.data.materials.get("Black Iron") or b.material("Black Iron", "#1b1b1b", 0.5),
        0.005,
        1,
    )
    iron = b.existing("Black Iron")
    b.tube("Wall Lamp Arm", [[(-2.6, 3.2, 2.6), (-2.6, 2.95, 2.75), (-2.6, 2.75, 2.65)]], 0.02, iron)
    b.turned("Wall Lamp Shade", [(0.03, 0.1), (0.06, 0.08), (0.2, -0.06)], (-2.6, 2.75, 2.56), iron, 32)
    b.ball(
        "Wall Lamp Bulb", (0.06, 0.06, 0.07), (-2.6, 2.75, 2.5), b.material("Bulb Glass", "#f0e2c8", 0.3, emission=3.0)
    )
    b.light("Wall Lamp", "POINT", (-2.6, 2.75, 2.42), (0, 0, 0), 25.0, (), "#ffe6c4", shadow_soft_size=0.06)
    planting()


def planting() -> None:
    """A tub with a clipped tree, a low bed with shrubs, an oil drum."""
    leaf = b.pattern(b.material("Laurel Leaves", "#3f5a35", 0.6), "Noise", ("#2c4226", "#587548"), bump=0.9, Scale=12.0)
    clay, bark = b.material("Tub Clay", "#8d5c45", 0.75), b.material("Bark", "#5a4636", 0.8)
    tub = [(0, 0), (0.26, 0), (0.33, 0.5), (0.37, 0.52), (0.37, 0.6), (0.3, 0.6), (0.28, 0.5), (0, 0.5)]
    for number, x in enumerate((-2.05, 4.05), 1):
        parts = [
            b.turned(f"Tub {number}", tub, (0, 0, 0), clay, 32),
            b.tube(f"Tree Trunk {number}", [[(0, 0, 0.5), (0.02, 0, 1.0), (0, 0, 1.5)]], 0.035, bark),
        ]

        def crown(u: float, v: float) -> b.Point:
            lon, lat = 2 * math.pi * u, math.pi * (v - 0.5)
            r = 0.52 + 0.03 * math.sin(9 * lon + 7 * lat) * math.cos(8 * lat)
            return (r * math.cos(lat) * math.cos(lon), r * math.cos(lat) * math.sin(lon), 1.75 + r * math.sin(lat))

        parts.append(b.sheet(f"Tree Crown {number}", crown, 40, 20, leaf, closed=True))
        b.group(f"Laurel Tree {number}", parts, (x, 2.75, 0))
    drum = [
        (0, 0),
        (0.29, 0),
        (0.3, 0.02),
        (0.29, 0.04),
        (0.29, 0.28),
        (0.305, 0.3),
        (0.29, 0.32),
        (0.29, 0.56),
        (0.305, 0.58),
        (0.29, 0.6),
        (0.29, 0.86),
        (0.3, 0.88),
        (0.28, 0.88),
        (0.28, 0.85),
        (0, 0.85),
    ]
    steel = b.pattern(
        b.material("Oil Drum Steel", "#4f6470", 0.45, metallic=0.3),
        "Noise",
        ("#465964", "#5c7280"),
        Scale=5.0,
        Detail=6.0,
    )
    b.turned("Oil Drum", drum, (5.1, 2.7, 0), steel, 40)


if __name__ == "__main__":
    b.run(build)
