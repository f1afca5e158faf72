# SPDX-License-Identifier: GPL-3.0-or-later
"""A lake between wooded hills and mountains, with a cabin, a jetty, a boat and reeds.

blender -b --python examples/landscape.py -- landscape.blend
"""

import math
import random
import sys
from pathlib import Path

import bpy  # noqa: F401  (mathutils is part of it)
from mathutils import Vector, noise

sys.path.append(str(Path(__file__).resolve().parent))
import building as b


def build() -> None:
    """Builds the valley; the camera stands on the southern shore and looks north."""
    random.seed(12)
    terrain()
    water()
    trees()
    cabin()
    jetty()
    shore()
    b.world("#6f8fb5", 1.0, horizon="#c3ccd3")
    b.light("Sun", "SUN", (-60, -30, 60), (0, 40, 0), 3.6, angle=math.radians(3))
    b.camera((-2.5, -21.0, 3.9), (4.0, 40.0, 5.6), 32.0)


def height(x: float, y: float) -> float:
    """The height of the ground: a lake's bed, shores, hills to both sides, mountains in the north."""
    bend = x - 6 * math.sin(y / 30.0)
    lake = math.hypot(bend / (25.0 if y > 10 else 21.0), (y - 26) / 38.0) - 1
    rough = noise.fractal(Vector((x / 34, y / 34, 0.3)), 0.9, 2.1, 5)
    ridge = noise.ridged_multi_fractal(Vector((x / 95 + 3.1, y / 95, 1.7)), 0.95, 2.1, 6, 0.9, 2.0)
    bank = 2.2 * math.tanh(3.2 * lake) if lake < 0.5 else 2.05 + 1.8 * (lake - 0.5)
    hills = max(0.0, lake) ** 1.25 * (8.0 + 5.0 * rough)
    far = max(0.0, min(1.0, (y - 75) / 110))
    mountains = far * far * (3 - 2 * far) * (3 + 15 * ridge)
    headland = 3.9 * math.exp(-(min(0.0, x - 14) ** 2 + (y - 17) ** 2) / 34.0)
    front = 1.0 if y > -8 else 0.35
    return bank + hills * front * 0.55 + mountains + headland + 0.35 * rough


def ground(x: float, y: float, below: float = 0.0) -> b.Point:
    """The point of the ground at a place."""
    return x, y, height(x, y) - below


def terrain() -> None:
    """Ground near the lake, and mountains behind it, with colors by slope and height."""
    land = b.material("Meadow", "#5f6f3c", 0.95)
    b.pattern(land, "Noise", ("#2f3f22", "#5c6a38", "#8f8550"), Scale=0.11, Detail=9.0, bump=0.5)
    b.sheet("Hills", lambda u, v: ground(-85 + 170 * u, -26 + 126 * v), 70, 54, land)
    rock = b.material("Mountain Rock", "#6d7073", 0.9)
    snow_line(b.pattern(rock, "Noise", ("#4d5459", "#7b7d7c"), (1, 1, 2.2), bump=1.0, Scale=0.12, Detail=10.0))
    b.sheet("Mountains", lambda u, v: ground(-190 + 380 * u, 96 + 130 * v, 1.2 if v < 0.03 else 0.0), 92, 32, rock)


def snow_line(rock: b.Stuff) -> None:
    """Covers what is high with snow and what is low with woods."""
    nodes, links = rock.node_tree.nodes, rock.node_tree.links
    shader = b.principled(rock)
    below = shader.inputs["Base Color"].links[0].from_socket
    place, split = nodes.new("ShaderNodeTexCoord"), nodes.new("ShaderNodeSeparateXYZ")
    spread, total = nodes.new("ShaderNodeTexNoise"), nodes.new("ShaderNodeMath")
    spread.inputs["Scale"].default_value, spread.inputs["Detail"].default_value = 0.09, 8.0
    total.operation, total.inputs[2].default_value = "MULTIPLY_ADD", -7.0
    total.inputs[1].default_value = 14.0
    height_ = nodes.new("ShaderNodeMath")
    links.new(place.outputs["Object"], split.inputs["Vector"])
    links.new(place.outputs["Object"], spread.inputs["Vector"])
    links.new(spread.outputs[0], total.inputs[0])
    links.new(split.outputs["Z"], height_.inputs[0])
    links.new(total.outputs[0], height_.inputs[1])
    color = below
    for low, high, over, up in ((9.0, 17.0, "#33432c", False), (27.0, 31.0, "#d5dade", True)):
        share, mix = nodes.new("ShaderNodeMapRange"), nodes.new("ShaderNodeMixRGB")
        share.inputs["From Min"].default_value, share.inputs["From Max"].default_value = low, high
        links.new(height_.outputs[0], share.inputs["Value"])
        links.new(share.outputs["Result"], mix.inputs[0])
        links.new(color, mix.inputs[1 if up else 2])
        mix.inputs[2 if up else 1].default_value = b.linear(over)
        color = mix.outputs[0]
    links.new(color, shader.inputs["Base Color"])


def water() -> None:
    """The lake with small ripples."""
    lake = b.material("Lake Water", "#1d3238", 0.04, ior=1.33)
    b.pattern(lake, "Noise", stretch=(0.5, 1.6, 1), bump=0.25, Scale=1.6, Detail=3.0)
    b.box("Lake", (190, 130, 0.02), (0, 39, -0.01), lake, 0)


def conifer(name: str, stuff: b.Stuff, layers: int) -> b.bpy.types.Object:
    """A tree of drooping cones, ten meters tall."""
    profile: list[tuple[float, float]] = []
    for layer in range(layers):
        low, wide = 1.0 + 8.2 * layer / layers, 2.3 * (1 - layer / (layers + 0.7))
        profile += [(wide, low), (wide * 0.32, low + 8.2 / layers * 0.95)]
    profile.append((0.0, 10.0))

    def point(u: float, v: float) -> b.Point:
        radius, z = profile[round(v * (len(profile) - 1))]
        ragged = 1 + 0.22 * math.sin(3 * 2 * math.pi * u + 2.4 * z) * (radius > 0.7)
        angle = 2 * math.pi * u + 0.35 * z
        return (radius * ragged * math.cos(angle), radius * ragged * math.sin(angle), z - 0.25 * (ragged - 1) * radius)

    return b.sheet(name, point, 8, len(profile) - 1, stuff, closed=True)


def trees() -> None:
    """Conifers on the slopes, denser away from the shore, and a few near the camera."""
    needles = b.pattern(
        b.material("Spruce Needles", "#2f4330", 0.9), "Noise", ("#22341f", "#435b3a"), bump=0.9, Scale=2.4, Detail=6.0
    )
    light = b.pattern(
        b.material("Larch Needles", "#5b6a37", 0.9), "Noise", ("#4a5a2c", "#77804a"), bump=0.9, Scale=2.4, Detail=6.0
    )
    kinds = [conifer("Spruce", needles, 5), conifer("Larch", light, 4)]
    count, tries = 0, 0
    while count < 185 and tries < 6000:
        tries += 1
        x, y = random.uniform(-62, 66), random.uniform(-4, 98)
        z = height(x, y)
        if z < 1.3 or math.hypot(x - 14, y - 14) < 7 or random.random() > 0.25 + z / 12:
            continue
        count += 1
        kind = kinds[random.random() < 0.25]
        b.copy(kind, f"{kind.name} {count}", (x, y, z - 0.3), random.uniform(0.45, 1.0), random.uniform(0, 360))
    for x, y, size in (
        (-13.5, -3.5, 0.95),
        (-15.5, 1.5, 1.15),
        (-11.2, -8.0, 0.62),
        (-17.5, -6.0, 1.0),
        (-9.3, -11.5, 0.3),
    ):
        count += 1
        b.copy(kinds[0], f"Spruce {count}", (x, y, height(x, y) - 0.3), size, 40 * count)
    for kind in kinds:
        b.bpy.data.objects.remove(kind)


def cabin() -> None:
    """A log cabin with a gable roof, a chimney, a porch and lit windows."""
    log = b.material("Cabin Logs", "#6b4a33", 0.75)
    b.pattern(log, "Noise", ("#523724", "#7d5a40"), (0.6, 3, 6), Scale=1.6)
    shingle = b.pattern(b.material("Roof Shingles", "#43382f", 0.8), "Brick", bump=0.6, turn=(math.pi / 2, 0, 0), **{"Color1": "#4a3e34", "Color2": "#382e27", "Mortar": "#1d1814", "Scale": 1.0, "Brick Width": 0.35, "Row Height": 0.3, "Mortar Size": 0.015})  # fmt: skip
    stone = b.pattern(b.material("Chimney Stone", "#77746e", 0.85), "Voronoi", ("#5c5a56", "#85827b"), Scale=3.0)
    pane = b.material("Cabin Window", "#f0cf97", 0.3, emission=1.2)
    frame = b.material("Cabin Trim", "#a99d8a", 0.6)
    walls = [((5.2, 0.26, 0.27), (0, s * 2.0, 0.5 + 0.26 * i)) for i in range(9) for s in (-1, 1)]
    walls += [((0.26, 4.2, 0.27), (s * 2.5, 0, 0.5 + 0.26 * i)) for i in range(9) for s in (-1, 1)]
    walls += [((0.24, 4.0 * (1 - i / 6.2), 0.27), (s * 2.5, 0, 2.84 + 0.26 * i)) for i in range(6) for s in (-1, 1)]
    parts = [b.boxes("Cabin Walls", walls, log, 0.09, 1)]
    for side, name in ((-1, "Front"), (1, "Back")):
        roof = b.box(f"Cabin Roof {name}", (6.2, 3.1, 0.14), (0, side * 1.22, 3.65), shingle, 0.02)
        roof.rotation_euler.x = math.radians(-38 * side)
        parts.append(roof)
    parts += [
        b.box("Cabin Base", (5.4, 4.3, 1.4), (0, 0, -0.3), stone, 0.05),
        b.box("Cabin Chimney", (0.7, 0.7, 2.4), (1.6, 0.6, 4.1), stone, 0.04),
        b.boxes("Cabin Windows", [((0.8, 0.05, 0.9), (x, -2.15, 1.6)) for x in (-1.5, 1.5)], pane, 0),
        b.boxes("Cabin Window Frames", [((0.95, 0.08, 0.08), (x, -2.17, 1.6 + s * 0.47)) for x in (-1.5, 1.5) for s in (-1, 1)] + [((0.08, 0.08, 0.95), (x + s * 0.43, -2.17, 1.6)) for x in (-1.5, 1.5) for s in (-1, 0, 1)], frame, 0.01),
        b.box("Cabin Door", (0.95, 0.08, 1.95), (0, -2.15, 1.3), b.material("Cabin Door", "#3f5148", 0.6), 0.02),
        b.boxes("Cabin Porch", [((5.4, 1.5, 0.14), (0, -2.85, 0.3)), ((1.2, 0.4, 0.14), (0, -3.75, 0.1)), ((0.14, 0.14, 1.8), (-2.5, -3.5, 0.9)), ((0.14, 0.14, 1.8), (2.5, -3.5, 0.9)), ((1.9, 0.08, 0.08), (-1.6, -3.5, 1.1)), ((1.9, 0.08, 0.08), (1.6, -3.5, 1.1))], log, 0.02),
    ]  # fmt: skip
    x, y = 15.0, 17.0
    b.group("Cabin", parts, (x, y, height(x, y) - 0.1), -38)


def jetty() -> None:
    """A jetty of planks in front of the camera, and a rowing boat."""
    plank = b.pattern(
        b.material("Jetty Planks", "#83766a", 0.8), "Noise", ("#6a5e54", "#988b7d"), (1, 12, 6), Scale=1.4
    )
    boards = [((1.7, 0.27, 0.06), (0.02 * (i % 3), 0.29 * i, 0.62)) for i in range(38)]
    posts = [((0.17, 0.17, 2.4), (s * 0.8, 0.4 + 2.5 * i, -0.1)) for s in (-1, 1) for i in range(5)]
    b.group(
        "Jetty",
        [b.boxes("Jetty Boards", boards, plank, 0.012, 1), b.boxes("Jetty Posts", posts, plank, 0.03, 1)],
        (3.3, -12.5, 0),
        -9,
    )
    paint = b.material("Boat Paint", "#8f3f32", 0.45)

    def hull(u: float, v: float) -> b.Point:
        along, side = 2 * u - 1, math.pi * (v - 0.5)
        wide = 0.62 * (1 - abs(along) ** 2.4) ** 0.8 + 0.01
        return (
            1.9 * along * (1 + 0.04 * abs(math.sin(side))),
            wide * math.sin(side),
            0.42 - 0.55 * math.cos(side) * (1 - abs(along) ** 3) + 0.2 * along * along,
        )

    parts = [b.sheet("Boat Hull", hull, 28, 12, paint, thickness=0.04)]
    parts += [b.boxes("Boat Seats", [((0.26, 0.98, 0.04), (x, 0, 0.3)) for x in (-0.8, 0.3)], plank, 0.01)]
    oar = [[(-0.9, 0.25, 0.34), (1.1, 0.1, 0.5)]]
    parts += [
        b.tube("Boat Oar", oar, 0.025, plank),
        b.box("Oar Blade", (0.5, 0.14, 0.03), (1.3, 0.09, 0.51), plank, 0.01),
    ]
    b.group("Rowing Boat", parts, (0.2, -2.6, 0.02), 28)


def shore() -> None:
    """Stones and reeds along the near shore."""
    stone = b.pattern(
        b.material("Shore Stone", "#77756f", 0.8), "Noise", ("#56554f", "#8f8c84"), bump=0.6, Scale=2.0, Detail=7.0
    )
    first = b.ball("Stone", (0.6, 0.5, 0.34), (0, 0, 0), stone, 14, 8)
    for count in range(26):
        x = random.uniform(-9, 12)
        y = next((y / 4 for y in range(-72, 20) if height(x, y / 4) < 0.12), -9.0) + random.gauss(0, 0.5)
        other = b.copy(first, f"Stone {count + 1}", (x, y, 0.02), random.uniform(0.25, 1.3), random.uniform(0, 360))
        other.rotation_euler.x = random.uniform(-0.3, 0.3)
    b.bpy.data.objects.remove(first)
    reed = b.material("Reed", "#7d7a45", 0.85)
    stalks, tips = [], []
    for cluster_x, cluster_y in ((-6.5, -11.8), (-4.6, -11.2), (9.2, -11.5)):
        for _ in range(34):
            x, y = random.gauss(cluster_x, 0.7), random.gauss(cluster_y, 0.5)
            tall, lean = random.uniform(0.9, 1.9), random.uniform(-0.25, 0.3)
            stalks.append([(x, y, -0.2), (x + lean * 0.3, y, tall * 0.6), (x + lean, y, tall)])
            tips.append(stalks[-1][-1])
    made = b.tube("Reeds", stalks, 0.016, reed, (1.0, 0.8, 0.3))
    made.data.bevel_resolution, made.data.resolution_u = 0, 1
    b.boxes("Cattails", [((0.06, 0.06, 0.24), t) for t in tips[::4]], b.material("Cattail", "#4a3222", 0.9), 0.02, 1)


if __name__ == "__main__":
    b.run(build)
