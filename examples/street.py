# SPDX-License-Identifier: GPL-3.0-or-later
"""A street at night: wet asphalt, shop windows, street lamps, a parked scooter, rows of facades.

blender -b --python examples/street.py -- street.blend
"""

import math
import random
import sys
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parent))
import building as b

EDGE, FACADE = 2.6, 4.6
"""Where the sidewalks begin and the houses stand, to both sides of the middle; meters."""
SHOPS = (
    ("Bakery", "BOULANGERIE", -1, 2.0, "#f2e3c8", "#6e3b2e"),
    ("Bookshop", "BOOKS", -1, 9.0, "#eee6d8", "#2f4a46"),
    ("Flower Shop", "FLORIST", -1, 16.0, "#f1ead9", "#4c5a3a"),
    ("Cafe", "CAFE", 1, 4.5, "#f3e4c6", "#3b4560"),
    ("Bar", "BAR", 1, 11.5, "#f0dcc0", "#5e2f3a"),
    ("Tailor", "TAILOR", 1, 18.5, "#efe7da", "#4a4038"),
)
"""Name, sign, side, place along the street, color of the inside, color of the front."""


def build() -> None:
    """Builds the street along +Y."""
    random.seed(4)
    ground()
    b.material("Dark Pane", "#15181d", 0.06, coat=0.5)
    b.material("Lit Pane", "#e8c48e", 0.4, emission=0.9)
    b.material("Window Frame", "#77736c", 0.5)
    b.material("Sign Light", "#f4ead6", 0.4, emission=2.5)
    b.material("Shop Interior", "#f2e3c8", 0.8, emission=0.8)
    for number, shop in enumerate(SHOPS, 1):
        house(number, shop)
    street_end()
    for number, (side, y) in enumerate(((-1, 5.6), (1, 8.2), (-1, 12.7), (1, 15.3)), 1):
        street_lamp(number, side, y)
    scooter()
    cafe_table()
    b.world("#1b2230", 0.9, horizon="#3c4658")
    b.light("Sky Fill", "AREA", (0, 0, 15), (0, 12, 0), 900.0, (8, 20), "#c9d6ee")
    b.camera((-0.9, -2.9, 1.4), (0.4, 8.0, 1.95), 29.0)


def ground() -> None:
    """Asphalt with puddles, curbs, sidewalks of slabs, a crosswalk."""
    asphalt = b.material("Wet Asphalt", "#1d1e20", 0.3)
    b.pattern(asphalt, "Noise", bump=0.22, Scale=70.0, Detail=4.0)
    b.pattern(
        asphalt,
        "Noise",
        ("#131416", "#26272a"),
        (1, 0.55, 1),
        roughness=(0.03, 0.42),
        span=(0.42, 0.62),
        Scale=0.9,
        Detail=5.0,
    )
    b.box("Street", (2 * EDGE, 60, 0.1), (0, 20, -0.05), asphalt, 0)
    slabs = b.material("Sidewalk Slabs", "#4a4846", 0.35)
    b.pattern(slabs, "Brick", bump=0.4, **{"Color1": "#4f4c49", "Color2": "#3c3a38", "Mortar": "#191817", "Scale": 1.0, "Mortar Size": 0.008, "Brick Width": 0.75, "Row Height": 0.5})  # fmt: skip
    b.boxes("Sidewalks", [((2.2, 60, 0.14), (s * (EDGE + 1.22), 20, 0.07)) for s in (-1, 1)], slabs, 0)
    granite = b.pattern(b.material("Curb Granite", "#6b6a68", 0.4), "Noise", ("#565553", "#7a7876"), Scale=40.0)
    stones = [((0.16, 0.96, 0.17), (s * (EDGE + 0.04), y, 0.075)) for s in (-1, 1) for y in range(-6, 34)]
    b.boxes("Curb Stones", stones, granite, 0.02, 1)
    paint = b.pattern(b.material("Road Paint", "#9a9892", 0.45), "Noise", ("#6d6c68", "#a9a7a0"), Scale=6.0)
    b.boxes("Crosswalk", [((0.42, 2.2, 0.006), (-2.1 + 0.84 * i, 1.0, 0.002)) for i in range(6)], paint, 0)
    b.boxes(
        "Drain",
        [((0.5, 0.035, 0.02), (EDGE - 0.35, 3.2 + 0.07 * i, 0.0)) for i in range(6)],
        b.existing("Curb Granite"),
        0,
    )


def house(number: int, shop: tuple) -> None:
    """A shop with three or four floors above it; built for the left side and mirrored for the right."""
    name, sign, side, y, inside, front = shop
    floors, wide = random.choice((3, 4)), 6.9
    tint = random.choice(("#6f6559", "#5d5f62", "#74604f", "#666058"))
    wall = b.material(f"{name} Facade", tint, 0.75)
    if number % 2:
        b.pattern(wall, "Brick", turn=(math.pi / 2, 0, math.pi / 2), bump=0.4, **{"Color1": "#6b4a3c", "Color2": "#573a30", "Mortar": "#4a443e", "Scale": 1.0, "Mortar Size": 0.006, "Brick Width": 0.26, "Row Height": 0.085})  # fmt: skip
    else:
        b.pattern(wall, "Noise", bump=0.2, Scale=9.0)
    tall = 3.4 + 2.9 * floors
    x = side * FACADE
    pieces = [
        b.box(f"{name} Wall", (0.5, wide, tall - 3.3), (x + side * 0.25, y, (tall + 3.3) / 2), wall, 0),
        b.boxes(
            f"{name} Cornice",
            [((0.34, wide, 0.22), (x - side * 0.1, y, tall - 0.1)), ((0.2, wide, 0.14), (x - side * 0.06, y, 3.42))],
            wall,
            0.03,
        ),
    ]
    pieces += shop_front(name, sign, side, y, inside, front)
    windows(name, side, y, floors)


def shop_front(name: str, sign: str, side: int, y: float, inside: str, front: str) -> list:
    """Frame, panes, door, a lit room with shelves behind, sign, awning and the light that falls out."""
    x = side * FACADE
    wood = b.material(f"{name} Front", front, 0.35, coat=0.3)
    posts = [
        ((0.3, w, 3.3), (x + side * 0.1, y + dy, 1.65))
        for dy, w in ((-3.3, 0.4), (-0.15, 0.12), (1.0, 0.12), (3.3, 0.4))
    ]
    rails = [
        ((0.3, 6.9, 0.75), (x + side * 0.1, y, 2.98)),
        ((0.26, 3.1, 0.6), (x + side * 0.1, y - 1.7, 0.3)),
        ((0.26, 2.2, 0.6), (x + side * 0.1, y + 2.1, 0.3)),
    ]
    bars = [((0.06, 3.0, 0.05), (x + side * 0.08, y - 1.7, 2.2)), ((0.06, 2.2, 0.05), (x + side * 0.08, y + 2.1, 2.2))]
    bars += [((0.06, 0.05, 2.1), (x + side * 0.08, y + dy, 1.6)) for dy in (-2.2, -1.2, 2.1)]
    door = [
        ((0.08, w, h), (x + side * 0.12, y + dy, z))
        for w, h, dy, z in (
            (0.13, 2.5, 0.0, 1.3),
            (0.13, 2.5, 0.86, 1.3),
            (0.9, 0.7, 0.43, 0.4),
            (0.9, 0.13, 0.43, 2.5),
        )
    ]
    lit = b.existing("Shop Interior")
    goods = b.material(f"{name} Goods", random.choice(("#7a4b32", "#54604a", "#6a5a70", "#80603a")), 0.6)
    shelf: list = []
    for row in range(4):
        z = 0.75 + 0.52 * row
        shelf.append(((0.3, 6.2, 0.05), (x + side * 1.05, y, z)))
        place = y - 3.0
        while place < y + 3.0:
            width, height = random.uniform(0.1, 0.3), random.uniform(0.14, 0.4)
            shelf.append(((0.2, width, height), (x + side * 1.05, place, z + height / 2)))
            place += width + random.uniform(0.03, 0.14)
    cloth = b.pattern(
        b.material(f"{name} Awning", front, 0.8),
        "Wave",
        (front, "#b9b2a4"),
        turn=(0, 0, math.pi / 2),
        span=(0.49, 0.51),
        Scale=0.8,
        bands_direction="X",
    )

    def slope(u: float, v: float) -> b.Point:
        drop = 0.18 + 0.03 * abs(math.sin(22 * u)) if v > 0.8 else 0.0
        reach = min(v / 0.8, 1.0)
        return (
            x - side * (0.05 + 1.15 * reach),
            y - 3.2 + 6.4 * u,
            2.72 - 0.5 * reach - drop * (v > 0.8) * (v - 0.8) * 5,
        )

    made = [
        b.boxes(f"{name} Shop Front", posts + rails + bars + door, wood, 0.012, 1),
        b.box(f"{name} Inside Wall", (0.05, 6.9, 3.3), (x + side * 1.3, y, 1.65), lit, 0),
        b.boxes(f"{name} Shelves", shelf, goods, 0),
        b.sheet(f"{name} Awning", slope, 44, 5, cloth),
    ]
    face = b.text(
        f"{name} Sign", sign, 0.42, (x - side * 0.07, y, 3.02), (90, 0, 90 * -side), b.existing("Sign Light"), 0.03
    )
    if y < 12:  # farther ones add little
        b.light(
            f"{name} Window Light",
            "AREA",
            (x - side * 0.25, y - 0.2, 1.9),
            (0, y - 0.2, 0.0),
            130.0,
            (5.2, 1.6),
            inside,
        )
    return [*made, face]


def windows(name: str, side: int, y: float, floors: int) -> None:
    """Rows of windows; some are lit."""
    dark = b.existing("Dark Pane")
    lit = b.existing("Lit Pane")
    frame = b.existing("Window Frame")
    x = side * FACADE
    panes: dict[str, list] = {"Dark": [], "Lit": []}
    frames = []
    for floor in range(floors):
        z = 4.95 + 2.9 * floor
        for dy in (-2.3, 0.0, 2.3):
            panes["Lit" if random.random() < 0.3 else "Dark"].append(((0.04, 1.05, 1.75), (x - side * 0.01, y + dy, z)))
            frames += [((0.12, 1.25, 0.1), (x - side * 0.03, y + dy, z + s * 0.9)) for s in (-1, 1)]
            frames += [((0.08, 0.06, 1.8), (x - side * 0.03, y + dy + s * 0.54, z)) for s in (-1, 0, 1)]
            frames += [
                ((0.07, 1.05, 0.05), (x - side * 0.03, y + dy, z + 0.25)),
                ((0.22, 1.35, 0.07), (x - side * 0.1, y + dy, z - 0.95)),
            ]
    for kind, stuff in (("Dark", dark), ("Lit", lit)):
        if panes[kind]:
            b.boxes(f"{name} {kind} Panes", panes[kind], stuff, 0)
    b.boxes(f"{name} Window Frames", frames, frame, 0)


def street_end() -> None:
    """A house across the end of the street, with a clock tower."""
    wall = b.pattern(b.material("Town Hall Stone", "#57544f", 0.8), "Noise", bump=0.2, Scale=5.0)
    lit = b.existing("Lit Pane")
    roof = b.material("Slate Roof", "#2c3036", 0.5)
    b.boxes(
        "Town Hall",
        [((16, 2, 9), (0, 32, 4.5)), ((3.0, 2.6, 15), (1.2, 31.8, 7.5)), ((3.4, 3.0, 0.4), (1.2, 31.8, 12.3))],
        wall,
        0,
    )
    b.turned("Tower Roof", [(2.5, 15), (1.2, 17.2), (0.05, 20.5)], (1.2, 31.8, 0), roof, 4).rotation_euler.z = (
        math.pi / 4
    )
    b.boxes(
        "Town Hall Windows",
        [
            ((0.8, 0.1, 1.7), (-6 + 1.7 * i, 30.96, 3.0 + 3 * f))
            for i in range(8)
            for f in (0, 1)
            if (3 * i + 2 * f) % 4 != 1
        ],
        lit,
        0,
    )
    clock = b.turned(
        "Clock",
        [(0, 0), (0.85, 0), (0.95, 0.05)],
        (1.2, 30.42, 13.6),
        b.material("Clock Face", "#efe3c8", 0.5, emission=1.6),
        40,
    )
    clock.rotation_euler.x = math.radians(90)
    b.boxes(
        "Clock Hands", [((0.08, 0.04, 0.62), (1.2, 30.35, 13.88)), ((0.42, 0.04, 0.08), (1.38, 30.35, 13.6))], roof, 0
    )


def street_lamp(number: int, side: int, y: float) -> None:
    """A cast-iron post with a lantern and its light."""
    iron = b.bpy.data.materials.get("Cast Iron") or b.material("Cast Iron", "#1c1d1e", 0.4, metallic=0.6)
    glass = b.bpy.data.materials.get("Lantern Glass") or b.material("Lantern Glass", "#f2dfbb", 0.4, emission=14.0)
    post = [
        (0, 0),
        (0.17, 0),
        (0.17, 0.1),
        (0.11, 0.2),
        (0.1, 0.75),
        (0.13, 0.8),
        (0.06, 0.95),
        (0.045, 3.3),
        (0.08, 3.36),
        (0.05, 3.42),
    ]
    parts = [
        b.turned("Post", post, (0, 0, 0), iron, 16),
        b.turned("Lantern", [(0.09, 3.45), (0.17, 3.85)], (0, 0, 0), glass, 6),
        b.turned(
            "Lantern Roof",
            [(0.24, 3.84), (0.2, 3.9), (0.07, 4.02), (0.04, 4.03), (0.03, 4.12), (0, 4.15)],
            (0, 0, 0),
            iron,
            6,
        ),
        b.light(
            "Light",
            "SPOT",
            (0, 0, 3.4),
            (0, 0, 0),
            620.0,
            (),
            "#ffe9cc",
            spot_size=math.radians(150),
            spot_blend=0.7,
            shadow_soft_size=0.12,
        ),
    ]
    for part in parts:
        part.name = f"Street Lamp {part.name} {number}"
    b.group(f"Street Lamp {number}", parts, (side * (EDGE + 0.45), y, 0.14))


def scooter() -> None:
    """A parked scooter at the right curb."""
    paint = b.material("Scooter Paint", "#8b9a97", 0.25, coat=0.7)
    rubber, chrome = b.material("Rubber", "#141414", 0.7), b.material("Chrome", "#b9bcc0", 0.12, metallic=1.0)
    seat = b.material("Scooter Seat", "#3a2a20", 0.5)
    tire = [(0.13, -0.04), (0.2, -0.055), (0.235, 0), (0.2, 0.055), (0.13, 0.04)]
    hub = [(0, -0.045), (0.13, -0.03), (0.135, 0.0), (0.13, 0.03), (0, 0.045)]
    parts = []
    for end, y in (("Front", -0.62), ("Rear", 0.62)):
        for kind, profile, stuff in (("Tire", tire, rubber), ("Hub", hub, chrome)):
            wheel = b.turned(f"Scooter {kind} {end}", profile, (0, y, 0.235), stuff, 28)
            wheel.rotation_euler.y = math.radians(90)
            parts.append(wheel)
    shield = b.sheet(
        "Scooter Shield",
        lambda u, v: (
            0.25 * (1 - 0.35 * v * v) * (2 * u - 1),
            -0.42 - 0.16 * v + 0.14 * abs(2 * u - 1) ** 2,
            0.22 + 0.72 * v,
        ),
        12,
        12,
        paint,
        thickness=0.03,
    )
    fender = b.sheet(
        "Scooter Fender",
        lambda u, v: (
            0.085 * math.sin((u - 0.5) * 2.6),
            -0.62 - 0.29 * math.cos(0.35 + 2.2 * v) * (1 - 0.35 * (2 * u - 1) ** 2),
            0.235 + 0.29 * math.sin(0.35 + 2.2 * v) * (1 - 0.35 * (2 * u - 1) ** 2),
        ),
        8,
        12,
        paint,
        thickness=0.01,
    )
    parts += [
        shield,
        fender,
        b.cushion("Scooter Body", (0.36, 0.86, 0.42), (0, 0.55, 0.5), paint, 0.6),
        b.cushion("Scooter Seat", (0.27, 0.68, 0.12), (0, 0.42, 0.74), seat, 0.5),
    ]
    parts += [b.box("Scooter Floor", (0.34, 0.55, 0.05), (0, -0.12, 0.23), paint, 0.02)]
    parts += [
        b.tube(
            "Scooter Handlebar",
            [[(-0.33, -0.44, 1.0), (-0.2, -0.56, 1.03), (0.2, -0.56, 1.03), (0.33, -0.44, 1.0)]],
            0.018,
            chrome,
        )
    ]
    parts += [
        b.tube(
            "Scooter Mirrors",
            [[(s * 0.2, -0.55, 1.03), (s * 0.24, -0.57, 1.15), (s * 0.3, -0.56, 1.22)] for s in (-1, 1)],
            0.008,
            chrome,
        )
    ]
    parts += [b.cushion("Scooter Head", (0.2, 0.22, 0.16), (0, -0.57, 1.02), paint, 0.7)]
    parts += [
        b.ball(
            "Scooter Headlight",
            (0.065, 0.03, 0.065),
            (0, -0.675, 1.02),
            b.material("Headlight Glass", "#d8dadc", 0.1, coat=1.0),
        )
    ]
    parts += [
        b.box(
            "Scooter Tail Light",
            (0.1, 0.03, 0.06),
            (0, 0.985, 0.58),
            b.material("Tail Light Glass", "#8e1c1a", 0.2),
            0.01,
        )
    ]
    parts += [
        b.tube("Scooter Fork", [[(s * 0.07, -0.62, 0.235), (s * 0.06, -0.58, 0.55)] for s in (-1, 1)], 0.02, chrome)
    ]
    carrier = b.group("Scooter", parts, (EDGE - 1.25, 2.7, 0), 140)
    carrier.rotation_euler.y = math.radians(-6)


def cafe_table() -> None:
    """A bistro table with two chairs in front of the cafe, and flower tubs at the bakery."""
    iron = b.existing("Cast Iron")
    x, y = FACADE - 0.85, 5.9
    top = [(0, 0.72), (0.3, 0.72), (0.31, 0.735), (0.3, 0.75), (0, 0.75)]
    parts = [b.turned("Bistro Table Top", top, (0, 0, 0), b.material("Marble Top", "#a9a7a4", 0.25), 32)]
    parts += [
        b.tube(
            "Bistro Table Foot",
            [
                [(0, 0, 0.72), (0, 0, 0.05)],
                *([(0, 0, 0.12), (0.25 * math.cos(a), 0.25 * math.sin(a), 0)] for a in (0.3, 2.4, 4.5)),
            ],
            0.018,
            iron,
        )
    ]
    b.group("Bistro Table", parts, (x, y, 0.14))
    for number, (dx, dy, turn) in enumerate(((0.0, -0.62, 180), (-0.05, 0.62, 10)), 1):
        legs = [[(s * 0.19, t * 0.18, 0.45), (s * 0.21, t * 0.22, 0)] for s in (-1, 1) for t in (-1, 1)]
        back = [
            [
                (-0.2, 0.18, 0.45),
                (-0.2, 0.26, 0.8),
                (-0.1, 0.29, 0.92),
                (0.1, 0.29, 0.92),
                (0.2, 0.26, 0.8),
                (0.2, 0.18, 0.45),
            ]
        ]
        chair = [
            b.tube(f"Chair Frame {number}", legs + back, 0.013, iron),
            b.turned(
                f"Chair Seat {number}",
                [(0, 0.45), (0.21, 0.45), (0.22, 0.465), (0.2, 0.48), (0, 0.47)],
                (0, 0, 0),
                b.existing("Scooter Seat"),
                24,
            ),
        ]
        b.group(f"Bistro Chair {number}", chair, (x + dx, y + dy, 0.14), turn)
    clay, leaf = (
        b.material("Tub Clay", "#7d5442", 0.7),
        b.pattern(b.material("Boxwood", "#33452b", 0.7), "Noise", ("#22301c", "#4a6138"), bump=0.8, Scale=14.0),
    )
    for number, place in enumerate(
        ((-FACADE + 0.42, 1.55), (-FACADE + 0.42, 3.25), (-FACADE + 0.42, 8.6), (FACADE - 0.42, 4.05)), 1
    ):
        tub = b.turned(
            f"Tub {number}",
            [(0, 0), (0.17, 0), (0.22, 0.38), (0.24, 0.42), (0.2, 0.42), (0, 0.38)],
            (0, 0, 0),
            clay,
            20,
        )
        bush = b.ball(f"Boxwood {number}", (0.3, 0.3, 0.32), (0, 0, 0.68), leaf, 20, 12)
        b.group(f"Flower Tub {number}", [tub, bush], (*place, 0.14))


if __name__ == "__main__":
    b.run(build)
