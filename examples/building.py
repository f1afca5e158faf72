# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts that the example scenes are built of: materials, boxes, turned and lofted shapes, tubes, lights, a camera."""

import math
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import bpy
from mathutils import Vector

Point = Sequence[float]
Stuff = bpy.types.Material
SOCKETS = {
    "metallic": "Metallic",
    "transmission": "Transmission Weight",
    "ior": "IOR",
    "coat": "Coat Weight",
    "sheen": "Sheen Weight",
    "subsurface": "Subsurface Weight",
    "emission": "Emission Strength",
    "alpha": "Alpha",
}
"""Names of `material` for the sockets of the Principled BSDF."""


def run(build: Callable[[], None]) -> None:
    """Builds a scene into an empty file and saves it where the command line says."""
    arguments = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:]
    if len(arguments) != 1:
        raise SystemExit("Name the .blend to write: blender -b --python examples/NAME.py -- OUT.blend")
    empty()
    build()
    path = Path(arguments[0]).absolute()
    path.parent.mkdir(parents=True, exist_ok=True)
    bpy.ops.wm.save_as_mainfile(filepath=str(path))


def empty() -> None:
    """Starts an empty file with the render settings of all examples."""
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True, load_ui=False)
    scene = bpy.context.scene
    scene.render.engine, scene.cycles.samples = "CYCLES", 128
    scene.cycles.use_denoising = True
    scene.render.resolution_x, scene.render.resolution_y = 960, 540
    scene.view_settings.view_transform = "AgX"


def linear(color: str) -> tuple[float, float, float, float]:
    """The linear color of a "#rrggbb"."""
    shares = [int(color[i : i + 2], 16) / 255 for i in (1, 3, 5)]
    red, green, blue = (s / 12.92 if s <= 0.04045 else ((s + 0.055) / 1.055) ** 2.4 for s in shares)
    return red, green, blue, 1.0


def principled(stuff: Stuff) -> bpy.types.Node:
    """The Principled BSDF of a material."""
    return next(n for n in stuff.node_tree.nodes if n.type == "BSDF_PRINCIPLED")


def material(name: str, color: str, roughness: float = 0.5, **values: float) -> Stuff:
    """A Principled material; `values` are named as in `SOCKETS`. One that emits does so in its color."""
    stuff = bpy.data.materials.new(name)
    if not stuff.node_tree:
        stuff.use_nodes = True  # Blender 4.5
    inputs = principled(stuff).inputs
    inputs["Base Color"].default_value = linear(color)
    inputs["Roughness"].default_value = roughness
    for key, value in values.items():
        inputs[SOCKETS[key]].default_value = value
    if "emission" in values:
        inputs["Emission Color"].default_value = linear(color)
    return stuff


def existing(name: str) -> Stuff:
    """A material that another part of the scene has made."""
    return bpy.data.materials[name]


def pattern(
    stuff: Stuff,
    kind: str,
    colors: Sequence[str] = (),
    stretch: Point = (1, 1, 1),
    turn: Point = (0, 0, 0),
    bump: float = 0.0,
    roughness: Point = (),
    span: tuple[float, float] = (0.3, 0.7),
    **values: float | str,
) -> Stuff:
    """Gives a material a procedural texture ("Noise", "Wave", "Voronoi", "Brick"), in coordinates of the object.

    Args:
        stuff: The material.
        kind: The texture's node.
        colors: From dark to light; without, the color stays.
        stretch: The scale along the axes.
        turn: The rotation of the coordinates.
        bump: The strength of the relief.
        roughness: From dark to light; without, the roughness stays.
        span: The part of the texture's range that the colors cover.
        values: The texture's inputs and properties.
    """
    nodes, links = stuff.node_tree.nodes, stuff.node_tree.links
    place, mapping = nodes.new("ShaderNodeTexCoord"), nodes.new("ShaderNodeMapping")
    mapping.inputs["Scale"].default_value, mapping.inputs["Rotation"].default_value = stretch, turn
    texture = nodes.new(f"ShaderNodeTex{kind}")
    links.new(place.outputs["Object"], mapping.inputs["Vector"])
    links.new(mapping.outputs["Vector"], texture.inputs["Vector"])
    for key, value in values.items():
        if isinstance(value, str) and not value.startswith("#"):
            setattr(texture, key, value)
        else:
            texture.inputs[key].default_value = linear(value) if isinstance(value, str) else value
    shader = principled(stuff)
    out = texture.outputs["Distance" if kind == "Voronoi" else "Color" if kind == "Brick" else 0]
    if colors:
        ramp = nodes.new("ShaderNodeValToRGB")
        elements = ramp.color_ramp.elements
        for index, color in enumerate(colors):
            element = elements[index] if index < 2 else elements.new(1.0)
            element.color = linear(color)
        for index, element in enumerate(elements):
            element.position = span[0] + (span[1] - span[0]) * index / (len(colors) - 1)
        links.new(out, ramp.inputs[0])
        links.new(ramp.outputs["Color"], shader.inputs["Base Color"])
    elif kind == "Brick":
        links.new(out, shader.inputs["Base Color"])
    if roughness:
        range_ = nodes.new("ShaderNodeMapRange")
        for key, value in zip(("From Min", "From Max", "To Min", "To Max"), (*span, *roughness), strict=True):
            range_.inputs[key].default_value = value
        links.new(out, range_.inputs["Value"])
        links.new(range_.outputs["Result"], shader.inputs["Roughness"])
    if bump:
        relief = nodes.new("ShaderNodeBump")
        relief.inputs["Strength"].default_value, relief.inputs["Distance"].default_value = bump, 0.01
        links.new(texture.outputs[1 if kind == "Brick" else 0], relief.inputs["Height"])
        relief.invert = kind == "Brick"
        links.new(relief.outputs["Normal"], shader.inputs["Normal"])
    return stuff


def mesh(
    name: str, points: Sequence[Point], faces: Sequence[Sequence[int]], stuff: Stuff, smooth: bool = True
) -> bpy.types.Object:
    """An object of points and faces."""
    data = bpy.data.meshes.new(name)
    data.from_pydata([tuple(p) for p in points], [], faces)
    data.materials.append(stuff)
    data.polygons.foreach_set("use_smooth", [smooth] * len(data.polygons))
    data.update()
    return add(bpy.data.objects.new(name, data))


def add(obj: bpy.types.Object) -> bpy.types.Object:
    """An object, linked to the scene."""
    bpy.context.scene.collection.objects.link(obj)
    return obj


def boxes(
    name: str, parts: Sequence[tuple[Point, Point]], stuff: Stuff, bevel: float = 0.01, round_: int = 2
) -> bpy.types.Object:
    """Boxes with beveled edges in one object; each part is a size and the place of its center."""
    points, faces = [], []
    for size, place in parts:
        start = len(points)
        for corner in range(8):
            signs = [(corner >> axis & 1) - 0.5 for axis in range(3)]
            points.append([p + s * e for p, s, e in zip(place, signs, size, strict=True)])
        sides = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))
        faces += [[start + i for i in side] for side in sides]
    made = mesh(name, points, faces, stuff, smooth=bevel > 0)
    if bevel:
        modifier = made.modifiers.new("Bevel", "BEVEL")
        modifier.width, modifier.segments, modifier.harden_normals = bevel, round_, True
        modifier.limit_method = "ANGLE"
    return made


def box(
    name: str, size: Point, place: Point, stuff: Stuff, bevel: float = 0.01, turn: float = 0.0, round_: int = 2
) -> bpy.types.Object:
    """A box with beveled edges around its own origin, turned about the vertical by degrees."""
    made = boxes(name, [(size, (0, 0, 0))], stuff, bevel, round_)
    made.location, made.rotation_euler.z = place, math.radians(turn)
    return made


def cushion(name: str, size: Point, place: Point, stuff: Stuff, puff: float = 0.3) -> bpy.types.Object:
    """A soft box: beveled, subdivided, fuller in the middle by the share `puff`."""

    def point(u: float, v: float) -> Point:
        lon, lat = 2 * math.pi * u, math.pi * (v - 0.5)
        ways = [math.cos(lat) * math.cos(lon), math.cos(lat) * math.sin(lon), math.sin(lat)]
        out = [math.copysign(abs(w) ** puff, w) for w in ways]
        # Between a ball and a box: the nearer to a corner, the less is left of the other sides.
        return [o * s / 2 * (1 - 0.1 * sum(abs(q) for q in out) / 3) for o, s in zip(out, size, strict=True)]

    made = sheet(name, point, 32, 16, stuff, closed=True)
    made.location = place
    return made


def sheet(
    name: str,
    point: Callable[[float, float], Point],
    columns: int,
    rows: int,
    stuff: Stuff,
    closed: bool = False,
    thickness: float = 0.0,
    smooth: bool = True,
) -> bpy.types.Object:
    """The surface point(u, v), u and v from 0 to 1; `closed` joins its first column to its last."""
    across = columns if closed else columns + 1
    points = [point(c / columns, r / rows) for r in range(rows + 1) for c in range(across)]
    faces = []
    for r in range(rows):
        for c in range(columns):
            right = (c + 1) % across
            low, high = r * across, (r + 1) * across
            faces.append([low + c, low + right, high + right, high + c])
    made = mesh(name, points, faces, stuff, smooth)
    weld(made)
    if thickness:
        made.modifiers.new("Solidify", "SOLIDIFY").thickness = thickness
    return made


def weld(made: bpy.types.Object) -> None:
    """Merges points at the same place, as at the poles of a ball."""
    modifier = made.modifiers.new("Weld", "WELD")
    modifier.merge_threshold = 1e-5


def turned(
    name: str, profile: Sequence[tuple[float, float]], place: Point, stuff: Stuff, steps: int = 32, level: int = 0
) -> bpy.types.Object:
    """A profile of (radius, height) turned around the vertical; `level` rounds it by subdivision."""

    def point(u: float, v: float) -> Point:
        radius, height = profile[round(v * (len(profile) - 1))]
        return radius * math.cos(2 * math.pi * u), radius * math.sin(2 * math.pi * u), height

    made = sheet(name, point, steps, len(profile) - 1, stuff, closed=True)
    if level:
        made.modifiers.new("Subdivision", "SUBSURF").levels = level
        made.modifiers["Subdivision"].render_levels = level
    made.data.shade_smooth()
    sharp(made)
    made.location = place
    return made


def sharp(made: bpy.types.Object, degrees: float = 40.0) -> bpy.types.Object:
    """Keeps edges sharp that are steeper than an angle."""
    made.data.set_sharp_from_angle(angle=math.radians(degrees))
    return made


def tube(
    name: str,
    lines: Sequence[Sequence[Point]],
    radius: float,
    stuff: Stuff,
    taper: Sequence[float] = (),
    closed: bool = False,
) -> bpy.types.Object:
    """Smooth tubes through points; `taper` is the share of the radius at each point."""
    data = bpy.data.curves.new(name, "CURVE")
    data.dimensions, data.bevel_depth, data.bevel_resolution, data.use_fill_caps = "3D", radius, 2, True
    data.resolution_u = 6
    for line in lines:
        spline = data.splines.new("NURBS")
        spline.points.add(len(line) - 1)
        spline.use_endpoint_u, spline.order_u, spline.use_cyclic_u = True, min(4, len(line)), closed
        for index, (knot, place) in enumerate(zip(spline.points, line, strict=True)):
            knot.co = (*place, 1.0)
            knot.radius = taper[index] if taper else 1.0
    data.materials.append(stuff)
    return add(bpy.data.objects.new(name, data))


def ball(name: str, radii: Point, place: Point, stuff: Stuff, columns: int = 24, rows: int = 12) -> bpy.types.Object:
    """An ellipsoid."""

    def point(u: float, v: float) -> Point:
        lon, lat = 2 * math.pi * u, math.pi * (v - 0.5)
        ways = (math.cos(lat) * math.cos(lon), math.cos(lat) * math.sin(lon), math.sin(lat))
        return [r * w for r, w in zip(radii, ways, strict=True)]

    made = sheet(name, point, columns, rows, stuff, closed=True)
    made.location = place
    return made


def text(
    name: str, words: str, size: float, place: Point, turn: Point, stuff: Stuff, depth: float = 0.0
) -> bpy.types.Object:
    """Words as an object, centered; `turn` in degrees."""
    data = bpy.data.curves.new(name, "FONT")
    data.body, data.size, data.extrude, data.resolution_u = words, size, depth, 3
    data.align_x, data.align_y = "CENTER", "CENTER"
    data.materials.append(stuff)
    made = add(bpy.data.objects.new(name, data))
    made.location, made.rotation_euler = place, [math.radians(t) for t in turn]
    return made


def copy(
    made: bpy.types.Object, name: str, place: Point, scale: float | Point = 1.0, turn: float = 0.0
) -> bpy.types.Object:
    """A linked duplicate with its modifiers."""
    other = made.copy()
    other.name, other.location = name, place
    other.scale = (scale,) * 3 if isinstance(scale, int | float) else scale
    other.rotation_euler.z = math.radians(turn)
    return add(other)


def group(name: str, parts: Sequence[bpy.types.Object], place: Point, turn: float = 0.0) -> bpy.types.Object:
    """An empty that carries parts built around the origin, turned about the vertical by degrees."""
    carrier = add(bpy.data.objects.new(name, None))
    carrier.empty_display_size = 0.2
    for part in parts:
        part.parent = carrier
    carrier.location, carrier.rotation_euler.z = place, math.radians(turn)
    return carrier


def aimed(made: bpy.types.Object, place: Point, target: Point) -> bpy.types.Object:
    """An object at a place that looks at a target."""
    made.location = place
    made.rotation_euler = (Vector(target) - Vector(place)).to_track_quat("-Z", "Y").to_euler()
    return made


def camera(place: Point, target: Point, focal: float, shift: Point = (0, 0)) -> None:
    """The scene's camera."""
    data = bpy.data.cameras.new("Camera")
    data.lens, data.clip_end = focal, 2000.0
    data.shift_x, data.shift_y = shift
    bpy.context.scene.camera = aimed(add(bpy.data.objects.new("Camera", data)), place, target)


def light(
    name: str,
    kind: str,
    place: Point,
    target: Point,
    power: float,
    size: Point = (),
    color: str = "#ffffff",
    **values: float,
) -> bpy.types.Object:
    """A light that looks at a target; `size` is an area's width and height."""
    data = bpy.data.lights.new(name, kind)
    data.energy, data.color = power, linear(color)[:3]
    if size:
        data.shape, data.size, data.size_y = "RECTANGLE", *size
    for key, value in values.items():
        setattr(data, key, value)
    return aimed(add(bpy.data.objects.new(name, data)), place, target)


def world(color: str, strength: float, horizon: str = "") -> None:
    """The scene's world: one color, or from `horizon` to `color` overhead."""
    made = bpy.data.worlds.new("Sky")
    if not made.node_tree:
        made.use_nodes = True  # Blender 4.5
    bpy.context.scene.world = made
    nodes, links = made.node_tree.nodes, made.node_tree.links
    background = next(n for n in nodes if n.type == "BACKGROUND")
    background.inputs["Color"].default_value = linear(color)
    background.inputs["Strength"].default_value = strength
    if horizon:
        place, split, ramp = (nodes.new(f"ShaderNode{n}") for n in ("TexCoord", "SeparateXYZ", "ValToRGB"))
        ramp.color_ramp.elements[0].color, ramp.color_ramp.elements[1].color = linear(horizon), linear(color)
        ramp.color_ramp.elements[1].position = 0.5
        links.new(place.outputs["Generated"], split.inputs["Vector"])
        links.new(split.outputs["Z"], ramp.inputs[0])
        links.new(ramp.outputs["Color"], background.inputs["Color"])
