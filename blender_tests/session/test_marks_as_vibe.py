# SPDX-License-Identifier: GPL-3.0-or-later
"""The marks of a prompt's words are what a vibe does: a sketch of the scene is read as its export is."""

import math

import bpy
import pytest
import scenes
from small_scenes import camera, cube, light, principled, world
from vibe_render.export import reading
from vibe_render.scene.subject import SubjectChoice

from proxy_renderer.engine import live
from proxy_renderer.optimize.stage import set_stage
from proxy_renderer.scene import load_scene
from proxy_renderer.schema import messages, schema_hash


def ball(name, location, radius=0.5, material=None):
    """A ball with a material of its own, or that of another."""
    bpy.ops.mesh.primitive_uv_sphere_add(radius=radius, location=location, segments=16, ring_count=8)
    obj = bpy.context.object
    obj.name = name
    if material:
        obj.data.materials.append(material)
    else:
        principled(f"{name} Paint", obj)
    return obj


def balls(scene):
    """Three balls on a floor before a wall, a key, a fill and a rim light."""
    for name, x in (("Ball", -1.5), ("Ball.001", 0.0), ("Ball.002", 1.5)):
        ball(name, (x, 0.0, 0.5))
    principled("Planks", cube(scene, "Floor", (0.0, 0.0, -5.0), 10.0))
    principled("Plaster", cube(scene, "Wall", (0.0, 15.0, 5.0), 20.0))
    light(scene, "AREA", (-3.0, -4.0, 4.0)).data.energy = 500.0
    light(scene, "SPOT", (3.0, -4.0, 3.0)).data.energy = 50.0
    light(scene, "POINT", (0.0, 4.0, 3.0)).data.energy = 100.0
    camera(scene, (0.0, -8.0, 1.5))
    world(scene)


def cars(scene):
    """A car of several objects that share materials, one with two materials, in a group; trees behind it as instances."""
    group = bpy.data.collections.new("Car")
    scene.collection.children.link(group)
    body = cube(scene, "Car Body", (0.0, 0.0, 0.8), 1.6)
    paint, glass = principled("Car Paint", body), bpy.data.materials.new("Glass")
    body.data.materials.append(glass)
    body.data.polygons[0].material_index = 1
    rubber = bpy.data.materials.new("Rubber")
    for number, x in enumerate((-0.7, 0.7)):
        group.objects.link(ball(f"Tyre.{number:03d}", (x, -0.9, 0.3), 0.3, rubber))
    tree = bpy.data.collections.new("Tree")
    leaf = ball("Leaves", (0.0, 0.0, 1.5), 1.0)
    for each in leaf.users_collection:
        each.objects.unlink(leaf)
    tree.objects.link(leaf)
    for x in (-4.0, 4.0):
        instance = bpy.data.objects.new("Tree", None)
        instance.instance_type, instance.instance_collection = "COLLECTION", tree
        instance.location = (x, 6.0, 0.0)
        scene.collection.objects.link(instance)
    principled("Asphalt", cube(scene, "Road", (0.0, 0.0, -10.0), 20.0))
    light(scene, "SUN")
    camera(scene, (0.0, -9.0, 2.0))
    world(scene)
    assert paint


def sweep(scene):
    """A vase before a curved backdrop, whose box holds the vase and the camera does not."""
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=1, y_subdivisions=8, size=10.0)
    paper = bpy.context.object
    paper.name = "Paper"
    for vertex in paper.data.vertices:
        vertex.co.z = max(vertex.co.y - 2.0, 0.0) ** 2
    principled("Backdrop Paper", paper)
    ball("Vase", (0.0, -2.0, 0.8), 0.6)
    light(scene, "AREA", (-3.0, -6.0, 4.0))
    camera(scene, (0.0, -12.0, 1.5))
    world(scene)


def room(scene):
    """A table with a lamp that glows, inside one box of walls."""
    walls = cube(scene, "Room", (0.0, 0.0, 2.5), 14.0)
    principled("Wallpaper", walls)
    principled("Oak", cube(scene, "Table", (0.0, 0.0, -3.5), 2.0))
    shade = ball("Lamp", (0.0, 0.0, -2.0), 0.4)
    shader = next(n for n in shade.data.materials[0].node_tree.nodes if n.type == "BSDF_PRINCIPLED")
    shader.inputs["Emission Strength"].default_value = 5.0
    light(scene, "POINT", (3.0, -3.0, 2.0))
    camera(scene, (0.0, -6.0, -2.0))
    world(scene)


def made(build):
    """A scene that a module of its own opens."""

    def open_it(_scene):
        build()

    return open_it


CASES = [
    (balls, "the left ball copper, the right ball glossy red, warm rim light, misty background"),
    (balls, "the middle one gold, everything else white"),
    (balls, "black wall, the key light orange, cold blue rim light"),
    (balls, "glossy balls on a dark floor, soft light from the left, vignette"),
    (balls, "copper subject, teal surroundings"),
    (cars, "a red car with black tyres, green trees, wet asphalt"),
    (cars, "matte paint, clear glass, golden hour"),
    (cars, "rusty, foggy road, the rest gray"),
    (sweep, "teal vase, white background, soft light"),
    (sweep, "marble, pink backdrop"),
    (room, "walnut table, warm lamp, green walls"),
    (room, "dim, blue glow, noir"),
    (made(scenes.still_life), "a red apple, yellow lemon, dark leather book, warm light from the window"),
    (made(scenes.columns_in_fog), "marble columns, misty morning, cold light"),
    (made(scenes.textured), "glossy, blue sky, warm"),
]


def marked(folder, prompt, target=()):
    """What the panel marks."""
    reading.sketch_scene(bpy.context.scene, folder, SubjectChoice())
    asked = messages.AskReadings(schema_hash(), prompt, str(folder), target=target)
    return live.answer(asked).words


def understood(folder, prompt, target=()):
    """What the report of a vibe says of the words."""
    scene = load_scene(reading.export_scene(bpy.context.scene, folder, SubjectChoice()).folder)
    return set_stage([scene], prompt, target=target).understood.words


@pytest.mark.parametrize(("build", "prompt"), CASES, ids=[prompt[:30] for _, prompt in CASES])
def test_marks_have_the_targets_of_the_vibe(scene, tmp_path, build, prompt):
    build(scene)
    marks = {word.key: word.candidates[:1] for word in marked(tmp_path / "sketch", prompt)}
    vibe = {word.key: [c.name for c in word.candidates[:1]] for word in understood(tmp_path / "job", prompt)}
    assert marks == vibe
    assert any(name != ["not used"] for name in marks.values())


def test_a_choice_counts_for_marks_and_vibe(scene, tmp_path):
    balls(scene)
    prompt, target = "copper, warm", ("copper=Ball.002",)
    (mark, *_), (word, *_) = (read(tmp_path / read.__name__, prompt, target) for read in (marked, understood))
    assert mark.candidates[0] == word.target == "Ball.002"


def test_a_sketch_changes_nothing(scene, tmp_path):
    cars(scene)
    before = {block: len(getattr(bpy.data, block)) for block in ("objects", "materials", "meshes", "scenes")}
    reading.sketch_scene(scene, tmp_path, SubjectChoice())
    assert before == {block: len(getattr(bpy.data, block)) for block in before}


def test_what_a_render_hides_is_no_target(scene, tmp_path):
    balls(scene)
    scene.objects["Ball.002"].hide_render = True
    names = {name for word in marked(tmp_path, "copper") for name in (*word.candidates, *word.targets)}
    assert "Ball.001" in " ".join(names)
    assert "Ball.002" not in " ".join(names)


def test_what_only_the_viewport_hides_is_a_target(scene, tmp_path):
    balls(scene)
    scene.objects["Ball.002"].hide_set(True)
    scene.objects["Ball.001"].hide_viewport = True
    (mark,) = marked(tmp_path, "copper balls")
    assert mark.candidates[0] == "Ball + Ball.001 + Ball.002"


def test_a_turned_flat_thing_is_where_it_is(scene, tmp_path):
    balls(scene)
    bpy.ops.mesh.primitive_plane_add(size=1.0, location=(3.0, 0.0, 1.0), rotation=(math.pi / 2, 0.0, 0.5))
    principled("Paper", bpy.context.object)
    places = load_scene(write(tmp_path)).objects
    assert "Plane" in [thing.name for thing in places]


def write(folder):
    """The folder of a sketch."""
    reading.sketch_scene(bpy.context.scene, folder, SubjectChoice())
    return folder
