# SPDX-License-Identifier: GPL-3.0-or-later
"""A reading corner: an armchair at a window, a floor lamp, a bookcase, a plant.

blender -b --python examples/interior.py -- interior.blend
"""

import math
import random
import sys
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parent))
import building as b

WEST, NORTH, HEIGHT = -2.2, 2.3, 2.7
"""The window's wall, the wall in the back, the ceiling; meters."""


def build() -> None:
    """Builds the room and what is in it."""
    room()
    window()
    bookcase()
    armchair()
    side_table()
    floor_lamp()
    plant()
    rug_and_picture()
    b.world("#c9d3dd", 1.0)
    b.light("Sun", "SUN", (-5.0, -1.5, 4.5), (0.1, 0.9, 0.0), 2.6, angle=math.radians(2.5))
    b.light("Window Light", "AREA", (WEST - 0.25, 0.55, 1.55), (2.0, 0.2, 0.7), 75.0, (1.9, 1.7))
    b.light("Fill", "AREA", (1.9, -3.0, 2.4), (-0.3, 1.2, 0.7), 38.0, (2.0, 1.4))
    b.camera((1.6, -2.35, 1.2), (-0.42, 0.9, 0.95), 26.0)


def room() -> None:
    """Floor, walls with an opening for the window, ceiling, skirting boards."""
    oak = b.material("Oak Floor", "#8a6a4c", 0.42)
    b.pattern(
        oak, "Brick", turn=(0, 0, math.pi / 2), bump=0.25, Scale=1.0, **{
            "Color1": "#8f6d4d", "Color2": "#71543a", "Mortar": "#2c2018", "Mortar Size": 0.004,
            "Brick Width": 1.3, "Row Height": 0.14, "Bias": 0.1,
        },
    )  # fmt: skip
    paint = b.pattern(b.material("Wall Paint", "#b9b7b0", 0.85), "Noise", bump=0.08, Scale=60.0)
    white = b.material("White Wood", "#d8d6d0", 0.45)
    b.box("Floor", (5.2, 6.6, 0.1), (0.4, -0.9, -0.05), oak, 0)
    b.box("Back Wall", (5.2, 0.12, HEIGHT), (0.4, NORTH + 0.06, HEIGHT / 2), paint, 0)
    x = WEST - 0.1
    parts = [((0.2, 6.6, 0.75), (x, -0.9, 0.375)), ((0.2, 6.6, 0.3), (x, -0.9, 2.55))]
    parts += [((0.2, 3.75, 1.65), (x, -2.325, 1.575)), ((0.2, 0.8, 1.65), (x, 1.95, 1.575))]
    b.boxes("Window Wall", parts, paint, 0)
    b.box("Ceiling", (5.2, 6.6, 0.1), (0.4, -0.9, HEIGHT + 0.05), b.material("Ceiling Paint", "#c9c8c4", 0.9), 0)
    b.boxes(
        "Skirting Boards",
        [((5.0, 0.03, 0.14), (0.4, NORTH - 0.015, 0.07)), ((0.03, 6.4, 0.14), (WEST + 0.015, -0.9, 0.07))],
        white,
        0.006,
    )


def window() -> None:
    """Frame, sill, glass, curtains on a rod, a hedge outside."""
    white = b.existing("White Wood")
    x, low, high, near, far = WEST - 0.09, 0.75, 2.4, -0.45, 1.55
    middle, tall = (near + far) / 2, (low + high) / 2
    parts = [((0.09, 2.0, 0.07), (x, middle, z)) for z in (low + 0.035, high - 0.035)]
    parts += [((0.09, 0.07, 1.65), (x, y, tall)) for y in (near + 0.035, middle, far - 0.035)]
    parts += [((0.04, 2.0, 0.03), (x, middle, 1.9))]
    parts += [((0.04, 0.03, 1.6), (x, y, tall)) for y in (near + 0.53, far - 0.53)]
    b.boxes("Window Frame", parts, white, 0.008)
    b.box("Window Sill", (0.34, 2.16, 0.045), (WEST + 0.04, middle, low), white, 0.012)
    linen = b.material("Curtain Linen", "#c7c0b2", 0.85, sheen=0.3)
    for name, start, width in (("Curtain Near", near - 0.42, 0.5), ("Curtain Far", far - 0.06, 0.5)):

        def fold(u: float, v: float, start: float = start, width: float = width) -> b.Point:
            wave = 0.05 * (0.6 + 0.4 * v) * math.sin(2 * math.pi * 5.5 * u + 0.7 * math.sin(3 * v))
            return WEST + 0.13 + wave, start + width * u + 0.015 * math.sin(5 * u + 4 * v), 0.03 + 2.5 * v

        b.sheet(name, fold, 72, 10, linen)
    brass = b.material("Brass", "#a98a52", 0.3, metallic=1.0)
    b.tube("Curtain Rod", [[(WEST + 0.13, near - 0.55, 2.54), (WEST + 0.13, far + 0.55, 2.54)]], 0.014, brass)
    hedge = b.pattern(b.material("Hedge", "#4c5f3a", 0.9), "Noise", ("#39492b", "#6d8052"), Scale=5.0)

    def leafage(u: float, v: float) -> b.Point:
        bump = 0.25 * math.sin(9 * u + 5 * v) * math.cos(13 * u - 4 * v)
        return -7.5 + bump - 1.2 * v, -8 + 22 * u, -0.6 + 2.1 * v + 0.35 * math.sin(11 * u) * v

    b.sheet("Hedge", leafage, 40, 8, hedge)


def bookcase() -> None:
    """A case of four shelves with books and a few ceramics."""
    random.seed(7)
    walnut = b.material("Walnut", "#5b4030", 0.42)
    b.pattern(walnut, "Noise", ("#452e20", "#6d4c38"), (1.5, 9, 9), bump=0.06, Scale=3.0, Detail=5.0)
    left, right, depth, top = 0.72, 2.28, 0.32, 2.15
    middle, y = (left + right) / 2, NORTH - depth / 2
    shelves = [0.1, 0.58, 1.02, 1.44, 1.82]
    parts = [((0.035, depth, top), (x, y, top / 2)) for x in (left, middle, right)]
    parts += [((right - left, depth, 0.03), (middle, y, z)) for z in (*shelves, top)]
    parts += [((right - left, 0.015, top), (middle, NORTH - 0.008, top / 2))]
    b.boxes("Bookcase", parts, walnut, 0.004)
    cloths = [
        b.material(f"Book Cloth {name}", color, 0.75)
        for name, color in (
            ("Rust", "#8a4a35"),
            ("Ivory", "#c9bfa8"),
            ("Slate", "#4d5a66"),
            ("Sage", "#6f7d66"),
            ("Ink", "#2d3138"),
        )
    ]
    spines: dict[int, list] = {i: [] for i in range(len(cloths))}
    for shelf in shelves:
        for start, end in ((left + 0.03, middle - 0.03), (middle + 0.03, right - 0.03)):
            x = start
            stop = end - random.choice((0.0, 0.12, 0.3))
            while x < stop - 0.05:
                thick, tall = random.uniform(0.02, 0.048), random.uniform(0.21, 0.33)
                deep = random.uniform(0.17, 0.23)
                size, place = (
                    (thick - 0.002, deep, tall),
                    (x + thick / 2, NORTH - 0.04 - deep / 2, shelf + 0.016 + tall / 2),
                )
                spines[random.randrange(len(cloths))].append((size, place))
                x += thick
    for cloth, parts in zip(cloths, spines.values(), strict=True):
        b.boxes(cloth.name.replace("Cloth", "Row"), parts, cloth, 0.003, 1)
    glaze = b.material("Ceramic Glaze", "#b7ada0", 0.3, coat=0.4)
    vase = [(0, 0), (0.05, 0), (0.085, 0.06), (0.085, 0.12), (0.035, 0.2), (0.03, 0.24), (0.042, 0.26), (0.03, 0.255)]
    b.turned("Vase", vase, (0.95, y, top + 0.015), glaze, level=1)
    bowl = [(0, 0.0), (0.06, 0.0), (0.13, 0.07), (0.12, 0.07), (0.05, 0.02), (0, 0.02)]
    b.turned("Bowl", bowl, (1.95, y, top + 0.015), glaze, level=1)


def armchair() -> None:
    """Seat, back, arms, legs, a pillow and a blanket."""
    wool = b.material("Armchair Wool", "#75828a", 0.85, sheen=0.4)
    b.pattern(wool, "Noise", bump=0.25, Scale=220.0)
    legs = b.material("Beech", "#a57f56", 0.4)
    cloth = b.pattern(b.material("Pillow Linen", "#b99a5f", 0.85, sheen=0.3), "Noise", bump=0.2, Scale=160.0)
    throw = b.material("Throw Blanket", "#c4b8a6", 0.9, sheen=0.5)
    b.pattern(throw, "Wave", ("#b3a692", "#cfc4b3"), bump=0.3, Scale=9.0)
    back = b.cushion("Armchair Back", (0.74, 0.22, 0.78), (0, 0.33, 0.66), wool, 0.42)
    back.rotation_euler.x = math.radians(-13)
    pillow = b.cushion("Pillow", (0.44, 0.16, 0.42), (0.1, 0.13, 0.66), cloth, 0.5)
    pillow.rotation_euler = (math.radians(-20), math.radians(12), math.radians(8))
    lines = [[(x, y, 0.27), (x * 1.12, y * 1.12, 0.0)] for x in (-0.32, 0.32) for y in (-0.3, 0.3)]

    def drape(u: float, v: float) -> b.Point:
        turn = math.pi * (v - 0.5) * 0.94
        down = 0.17 * max(0.0, abs(v - 0.5) * 4 - 1)
        fold = 0.012 * math.sin(14 * u + 2 * v)
        x = 0.405 + (0.098 + fold) * math.copysign(min(1.0, abs(math.sin(turn)) * 1.08), turn)
        return x, -0.3 + 0.36 * u + 0.02 * math.sin(7 * v), 0.652 - down - 0.03 * (1 - math.cos(turn))

    parts = [
        b.cushion("Armchair Seat", (0.64, 0.7, 0.2), (0, -0.04, 0.43), wool, 0.35),
        b.cushion("Armchair Base", (0.84, 0.78, 0.2), (0, 0.02, 0.3), wool, 0.25),
        b.cushion("Armchair Arm Left", (0.17, 0.78, 0.42), (-0.4, 0.0, 0.45), wool, 0.38),
        b.cushion("Armchair Arm Right", (0.17, 0.78, 0.42), (0.4, 0.0, 0.45), wool, 0.38),
        b.tube("Armchair Legs", lines, 0.024, legs),
        b.sheet("Throw", drape, 24, 28, throw, thickness=0.012),
        back,
        pillow,
    ]
    b.group("Armchair", parts, (-0.35, 0.8, 0), 22)


def side_table() -> None:
    """A small round table with books, a cup and glasses."""
    wood = b.existing("Walnut")
    top = [(0, 0.5), (0.22, 0.5), (0.235, 0.515), (0.22, 0.53), (0, 0.53)]
    lines = [
        [(0.05 * math.cos(a), 0.05 * math.sin(a), 0.5), (0.19 * math.cos(a), 0.19 * math.sin(a), 0)]
        for a in (0.4, 2.5, 4.6)
    ]
    porcelain = b.material("Porcelain", "#d9d6cf", 0.2, coat=0.5)
    cup = [(0, 0), (0.028, 0), (0.042, 0.03), (0.045, 0.075), (0.041, 0.075), (0.036, 0.02), (0, 0.015)]
    saucer = [(0, 0), (0.04, 0), (0.075, 0.014), (0.073, 0.017), (0.04, 0.005), (0, 0.005)]
    tea = [(0, 0.062), (0.0405, 0.062)]
    place = (-0.09, -0.07, 0.53)
    parts = [
        b.turned("Side Table Top", top, (0, 0, 0), wood, 48),
        b.tube("Side Table Legs", lines, 0.016, wood),
        b.turned("Cup", cup, place, porcelain, level=1),
        b.turned("Saucer", saucer, place, porcelain, level=1),
        b.turned("Tea", tea, place, b.material("Tea", "#5c2f16", 0.08)),
        b.tube(
            "Cup Handle",
            [[(-0.13, -0.07, 0.595), (-0.165, -0.07, 0.595), (-0.16, -0.07, 0.555), (-0.125, -0.07, 0.55)]],
            0.006,
            porcelain,
        ),
        b.box("Book Below", (0.17, 0.24, 0.03), (0.08, 0.05, 0.546), b.existing("Book Cloth Slate"), 0.004, 20),
        b.box("Book Above", (0.15, 0.21, 0.026), (0.08, 0.05, 0.575), b.existing("Book Cloth Rust"), 0.004, -8),
    ]
    b.group("Side Table", parts, (0.42, 0.5, 0))


def floor_lamp() -> None:
    """A lamp with a linen shade behind the armchair."""
    brass = b.existing("Brass")
    shade = b.material("Lamp Shade", "#d8cdb8", 0.8, subsurface=0.0)
    b.principled(shade).inputs["Transmission Weight"].default_value = 0.35
    parts = [
        b.turned("Lamp Base", [(0, 0), (0.15, 0), (0.15, 0.018), (0.03, 0.03), (0.0, 0.03)], (0, 0, 0), brass, 40),
        b.tube("Lamp Pole", [[(0, 0, 0.02), (0, 0, 1.55)]], 0.011, brass),
        b.turned("Lamp Shade", [(0.235, 1.38), (0.165, 1.7)], (0, 0, 0), shade, 40),
        b.ball(
            "Lamp Bulb", (0.035, 0.035, 0.045), (0, 0, 1.52), b.material("Bulb Glass", "#e8e2d6", 0.3, emission=2.0)
        ),
        b.light("Floor Lamp", "POINT", (0, 0, 1.52), (0, 0, 0), 9.0, shadow_soft_size=0.05),
    ]
    b.group("Floor Lamp Stand", parts, (0.3, 1.75, 0))


def plant() -> None:
    """A rubber plant in a clay pot in the corner by the window."""
    random.seed(3)
    clay = b.pattern(b.material("Clay Pot", "#a8643f", 0.8), "Noise", ("#96583a", "#b5734f"), Scale=9.0)
    pot = [(0, 0), (0.13, 0), (0.17, 0.27), (0.185, 0.27), (0.185, 0.31), (0.16, 0.31), (0.15, 0.26), (0, 0.26)]
    leaf = b.material("Leaf", "#40603a", 0.32, coat=0.2)
    stem = b.material("Stem", "#5d4a36", 0.7)
    parts = [b.turned("Plant Pot", pot, (0, 0, 0), clay, 40)]
    tips = [(0.04, 0.05, 1.25), (-0.12, -0.08, 1.0), (0.15, -0.1, 0.95)]
    parts.append(b.tube("Plant Stems", [[(0, 0, 0.25), (t[0] * 0.3, t[1] * 0.3, 0.6), t] for t in tips], 0.012, stem))

    def blade(u: float, v: float) -> b.Point:
        width = 0.065 * math.sin(math.pi * v**0.8) ** 0.8
        side = 2 * u - 1
        return width * side, 0.3 * v, 0.05 * math.sin(2.2 * v) - 0.09 * v * v + 0.02 * abs(side)

    first = b.sheet("Leaf", blade, 4, 8, leaf)
    count = 0
    for tip in tips:
        for step in range(9):
            share = 0.35 + 0.65 * step / 8
            place = (tip[0] * share, tip[1] * share, 0.25 + (tip[2] - 0.25) * share)
            count += 1
            other = b.copy(first, f"Leaf {count}", place, random.uniform(0.75, 1.05), 137.5 * count)
            other.rotation_euler.x = math.radians(random.uniform(5, 55) * (0.3 + share * 0.7))
            parts.append(other)
    b.bpy.data.objects.remove(first)
    b.group("Plant", parts, (-1.68, 1.86, 0), 20)


def rug_and_picture() -> None:
    """A woven rug and a framed print."""
    wool = b.material("Rug Wool", "#a59a88", 0.95, sheen=0.3)
    b.pattern(wool, "Wave", ("#b9ae9b", "#8d8272", "#c3b9a7"), bump=0.5, Scale=2.2, Distortion=0.6)
    b.box("Rug", (2.3, 1.6, 0.016), (-0.35, 0.35, 0.008), wool, 0.006, 4)
    frame, paper = b.material("Frame", "#2b2622", 0.4), b.material("Print Paper", "#cfcabf", 0.7)
    y, x, z = NORTH - 0.02, -0.62, 1.72
    b.boxes(
        "Picture Frame",
        [((0.62, 0.03, 0.025), (x, y, z + s * 0.4)) for s in (-1, 1)]
        + [((0.025, 0.03, 0.8), (x + s * 0.3, y, z)) for s in (-1, 1)],
        frame,
        0.004,
    )
    b.box("Print", (0.6, 0.01, 0.8), (x, y + 0.005, z), paper, 0)
    hills = b.material("Print Hills", "#5f6f73", 0.7)
    b.sheet(
        "Print Landscape",
        lambda u, v: (
            x - 0.2 + 0.4 * u,
            y - 0.003,
            z - 0.25 + v * (0.2 + 0.07 * math.sin(5 * u) + 0.04 * math.sin(13 * u)),
        ),
        24,
        1,
        hills,
    )
    b.turned(
        "Print Sun",
        [(0, 0), (0.06, 0)],
        (x + 0.08, y - 0.003, z + 0.15),
        b.material("Print Sun Yellow", "#b9814a", 0.7),
    ).rotation_euler.x = math.radians(90)


if __name__ == "__main__":
    b.run(build)
