# SPDX-License-Identifier: GPL-3.0-or-later
"""A perfume bottle on a stone plinth, with its box, an arch, pebbles and a twig.

blender -b --python examples/product.py -- product.blend
"""

import math
import random
import sys
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parent))
import building as b


def build() -> None:
    """Builds a set of a tabletop studio; one unit is a decimeter."""
    stage()
    bottle()
    carton()
    pebbles()
    twig()
    b.world("#b9bcc0", 0.35)
    b.light("Key Light", "AREA", (-3.2, -1.6, 3.4), (0, 0, 0.8), 190.0, (1.6, 1.6))
    b.light("Rim Light", "AREA", (2.8, 1.2, 2.4), (0.1, 0, 0.8), 90.0, (0.6, 2.0))
    b.light("Fill Light", "AREA", (1.8, -3.6, 2.0), (0, 0, 0.8), 45.0, (2.5, 2.0))
    b.camera((0.5, -6.6, 1.6), (-0.12, 0, 1.08), 58.0)


def stage() -> None:
    """Table, wall, an arch behind the bottle, the plinth."""
    plaster = b.pattern(
        b.material("Plaster", "#b3a79b", 0.8), "Noise", ("#a99d91", "#bdb2a6"), bump=0.12, Scale=3.0, Detail=6.0
    )
    stone = b.material("Travertine", "#b8a890", 0.5)
    b.pattern(
        stone,
        "Noise",
        ("#9c8b74", "#c2b49d", "#d0c4b0"),
        (0.6, 0.6, 5),
        bump=0.12,
        Scale=2.2,
        Detail=7.0,
        Distortion=0.6,
    )
    b.box("Table", (14, 6, 0.4), (0, 0.5, -0.2), plaster, 0.02)
    b.box("Wall", (14, 0.2, 8), (0, 2.6, 3.6), b.material("Wall Paint", "#a89e94", 0.85), 0)
    arch()
    b.turned("Plinth", [(0, 0), (0.95, 0), (1.0, 0.03), (1.0, 0.3), (0.97, 0.33), (0, 0.33)], (0, 0, 0), stone, 96)
    b.turned(
        "Low Plinth",
        [(0, 0), (0.72, 0), (0.75, 0.02), (0.75, 0.1), (0.73, 0.12), (0, 0.12)],
        (1.25, 0.35, 0),
        b.existing("Plaster"),
        96,
    )


def arch() -> None:
    """A solid arch, with a narrower opening cut into it."""
    clay = b.pattern(
        b.material("Arch Clay", "#9a7f6e", 0.75), "Noise", ("#8c7161", "#a58b79"), bump=0.1, Scale=4.0, Detail=6.0
    )

    def outline(u: float, radius: float, tall: float) -> tuple[float, float]:
        if u < 0.25:
            return -radius, tall * u * 4
        if u > 0.75:
            return radius, tall * (1 - u) * 4
        angle = math.pi * (1 - (u - 0.25) * 2)
        return radius * math.cos(angle), tall + radius * math.sin(angle)

    def point(u: float, v: float) -> b.Point:
        radius = (1.42, 1.42, 0.98, 0.98, 1.42)[round(v * 4)]
        x, z = outline(u, radius, 1.35)
        return x - 0.35, (0.95, 1.45, 1.45, 0.95, 0.95)[round(v * 4)], z

    made = b.sheet("Arch", point, 96, 4, clay)
    b.sharp(made, 30)
    bevel = made.modifiers.new("Bevel", "BEVEL")
    bevel.width, bevel.segments, bevel.limit_method = 0.015, 2, "ANGLE"


def bottle() -> None:
    """Thick glass, perfume, a metal collar, a cap, a label."""
    glass = b.material("Bottle Glass", "#f4f6f5", 0.0, transmission=1.0, ior=1.45)
    perfume = b.material("Perfume", "#d9a066", 0.0, transmission=1.0, ior=1.36)
    metal = b.material("Brushed Metal", "#b8b2a8", 0.25, metallic=1.0)
    cap = b.material("Cap Lacquer", "#1f1e1f", 0.18, coat=0.6)
    tall, wide, deep = 1.0, 0.82, 0.4
    parts = [
        b.box("Bottle", (wide, deep, tall), (0, 0, tall / 2), glass, 0.07, round_=5),
        b.box("Perfume", (wide - 0.14, deep - 0.12, 0.7), (0, 0, 0.47), perfume, 0.045, round_=4),
        b.turned("Neck", [(0, 0), (0.13, 0), (0.13, 0.1), (0, 0.1)], (0, 0, tall), glass, 48),
        b.turned(
            "Collar",
            [(0, 0), (0.17, 0), (0.185, 0.015), (0.185, 0.075), (0.17, 0.09), (0, 0.09)],
            (0, 0, tall),
            metal,
            64,
        ),
        b.turned(
            "Cap",
            [(0, 0), (0.19, 0), (0.205, 0.015), (0.205, 0.36), (0.185, 0.385), (0, 0.385)],
            (0, 0, tall + 0.1),
            cap,
            64,
        ),
        b.turned(
            "Cap Ring", [(0.206, 0), (0.212, 0.006), (0.212, 0.03), (0.206, 0.036)], (0, 0, tall + 0.13), metal, 64
        ),
        b.box(
            "Label", (0.46, 0.006, 0.34), (0, -deep / 2 - 0.002, 0.5), b.material("Label Paper", "#d8d2c6", 0.6), 0.002
        ),
        b.text(
            "Label Name",
            "AURELE",
            0.105,
            (0, -deep / 2 - 0.007, 0.54),
            (90, 0, 0),
            b.material("Label Ink", "#26221f", 0.4),
            0.001,
        ),
        b.text(
            "Label Line",
            "eau de parfum",
            0.042,
            (0, -deep / 2 - 0.007, 0.44),
            (90, 0, 0),
            b.existing("Label Ink"),
            0.001,
        ),
        b.tube(
            "Dip Tube",
            [[(0, 0, 0.14), (0.01, 0, 0.5), (0, 0, 1.0)]],
            0.014,
            b.material("Dip Tube", "#dddddd", 0.2, transmission=0.7),
        ),
    ]
    b.group("Perfume Bottle", parts, (-0.12, -0.05, 0.33), -14)


def carton() -> None:
    """The bottle's box on the low plinth."""
    paper = b.pattern(b.material("Carton Paper", "#7d7468", 0.6), "Noise", bump=0.08, Scale=40.0)
    parts = [
        b.box("Carton", (0.62, 0.4, 0.95), (0, 0, 0.475), paper, 0.008),
        b.box("Carton Label", (0.36, 0.004, 0.24), (0, -0.202, 0.56), b.existing("Label Paper"), 0.001),
        b.text("Carton Name", "AURELE", 0.08, (0, -0.206, 0.575), (90, 0, 0), b.existing("Label Ink"), 0.001),
        b.boxes(
            "Carton Bands",
            [((0.63, 0.41, 0.012), (0, 0, 0.1)), ((0.63, 0.41, 0.012), (0, 0, 0.86))],
            b.existing("Brushed Metal"),
            0.002,
        ),
    ]
    b.group("Carton Box", parts, (1.2, 0.42, 0.12), 22)


def pebbles() -> None:
    """Smooth stones in front of the plinth."""
    random.seed(5)
    dark = b.pattern(b.material("Pebble", "#77716a", 0.55), "Noise", ("#5f5a55", "#8f8880"), Scale=7.0, Detail=6.0)
    stones = [(-1.35, -0.55, 0.2), (-1.02, -0.86, 0.12), (0.98, -0.75, 0.15), (1.32, -0.62, 0.1), (-1.7, -0.2, 0.13)]
    for count, (x, y, size) in enumerate(stones, 1):
        radii = (size * 1.25, size, size * 0.62)
        b.ball(f"Pebble {count}", radii, (x, y, size * 0.58), dark, 32, 16).rotation_euler.z = random.uniform(0, 3)
    b.ball("Stone Ball", (0.3, 0.3, 0.3), (-1.28, 0.35, 0.3), b.existing("Travertine"), 48, 24)


def twig() -> None:
    """A eucalyptus twig that leans from the left over the arch's foot."""
    random.seed(11)
    leaf, bark = b.material("Eucalyptus Leaf", "#74857a", 0.55), b.material("Bark", "#6b5546", 0.7)
    vase = [
        (0, 0),
        (0.2, 0),
        (0.3, 0.2),
        (0.28, 0.42),
        (0.11, 0.62),
        (0.1, 0.72),
        (0.13, 0.76),
        (0.11, 0.75),
        (0.08, 0.6),
        (0, 0.5),
    ]
    b.turned("Vase", vase, (-1.95, 0.55, 0), b.material("Vase Glaze", "#8d8a84", 0.45), 48, level=1)

    def blade(u: float, v: float) -> b.Point:
        side = 2 * u - 1
        return (0.095 * math.sin(math.pi * v) ** 0.6 * side, 0.2 * v, 0.035 * abs(side) + 0.02 * math.sin(3 * v))

    first = b.sheet("Leaf", blade, 4, 8, leaf)
    count = 0
    for lean, tall in ((0.55, 1.15), (-0.35, 1.35), (0.1, 1.6)):
        line = [(-1.95 + lean * s * s, 0.55 - 0.25 * lean * s, 0.6 + tall * s) for s in (0, 0.25, 0.5, 0.75, 1)]
        b.tube(f"Twig {lean}", [line], 0.014, bark, (1, 0.9, 0.8, 0.6, 0.4))
        for step in range(15):
            s = 0.22 + 0.78 * step / 14
            count += 1
            place = (-1.95 + lean * s * s, 0.55 - 0.25 * lean * s, 0.6 + tall * s)
            other = b.copy(
                first,
                f"Eucalyptus Leaf {count}",
                place,
                (1.15 - 0.5 * s) * random.uniform(0.85, 1.1),
                180 * (step % 2) + random.uniform(-40, 40) + 70,
            )
            other.rotation_euler.x = math.radians(random.uniform(10, 60))
            other.rotation_euler.y = math.radians(random.uniform(-50, 50))
    b.bpy.data.objects.remove(first)


if __name__ == "__main__":
    b.run(build)
