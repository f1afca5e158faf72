# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials that the subject shares with other things: found, and separated so that Revert takes it back."""

import bpy
import pytest
import small_scenes as scenes
from dump import difference, dump
from vibe_render.core.schema_import import messages
from vibe_render.run.session import Session
from vibe_render.scene import bindings, snapshot
from vibe_render.scene.prepare import described_materials, separate_materials, shared_materials

from proxy_renderer.schema import material_copies

PIVOT = (0.0, 0.0, 0.5)


def sharing(scene):
    """A studio whose floor has the subject's material too."""
    subject = scenes.studio(scene)
    bpy.data.objects["Floor"].data.materials[0] = bpy.data.materials["Body"]
    return subject


def names(subject):
    return {m.name: [o.name for o in users] for m, users in shared_materials(subject).items()}


def test_other_things_and_other_scenes_count_and_the_subject_does_not(scene):
    subject = scenes.studio(scene)
    assert names(subject) == {}
    bpy.data.objects["Floor"].data.materials[0] = bpy.data.materials["Body"]
    elsewhere = scenes.cube(bpy.data.scenes.new("Other"), "Elsewhere")
    elsewhere.data.materials.append(bpy.data.materials["Body"])
    assert names(subject) == {"Body": ["Elsewhere", "Floor"]}
    assert names([*subject, bpy.data.objects["Floor"], elsewhere]) == {}


def test_single_user_copies_change_alone_and_revert_takes_them_away(scene):
    subject = sharing(scene)
    before = dump()
    separate_materials(scene, subject)
    own = subject[0].material_slots[0].material
    assert own.name == "Body.001"
    assert names(subject) == {}
    bindings.write(scene, {"material/Body.001/roughness": (0.9,)}, subject, PIVOT)
    assert scenes.shader(bpy.data.materials["Body"]).inputs["Roughness"].default_value == 0.5
    assert snapshot.revert(scene) == []
    assert difference(before, dump()) == {}


def test_a_mesh_that_others_use_keeps_its_material(scene):
    subject = scenes.studio(scene)
    twin = bpy.data.objects.new("Twin", subject[0].data)
    scene.collection.objects.link(twin)
    before = dump()
    separate_materials(scene, subject)
    assert twin.material_slots[0].material.name == "Body"
    assert subject[0].material_slots[0].material.name == "Body.001"
    assert snapshot.revert(scene) == []
    assert difference(before, dump()) == {}


def test_materials_from_a_library_are_nobodys_to_change(scene, tmp_path):
    subject = scenes.studio(scene)
    path = str(tmp_path / "library.blend")
    bpy.data.libraries.write(path, {bpy.data.materials["Body"]}, fake_user=True)
    with bpy.data.libraries.load(path, link=True) as (there, here):
        here.materials = there.materials
    for obj in (*subject, bpy.data.objects["Floor"]):
        obj.data.materials[0] = here.materials[0]
    assert names(subject) == {}


def test_the_value_of_a_copy_makes_it_for_its_objects_and_revert_takes_it_away(scene):
    """All objects of a name wear it, also one that shares its mesh with another object."""
    subject = sharing(scene)
    floor = bpy.data.objects["Floor"]
    for name in ("Tile", "Tile.001", "Other"):
        scene.collection.objects.link(bpy.data.objects.new(name, floor.data))
    key = f"material/{material_copies.copy_name('Body', ['Tile.*', 'Floor'])}/roughness"
    before, values = dump(), {key: (0.9,), "material/Body/roughness": (0.2,)}
    assert bindings.write(scene, values, subject, PIVOT) == {}
    worn = {o.name: o.material_slots[0].material for o in scene.objects if o.material_slots}
    assert worn["Floor"] == worn["Tile"] == worn["Tile.001"] != worn["Other"] == worn[subject[0].name]
    for name, roughness in (("Floor", 0.9), ("Other", 0.2)):
        assert scenes.shader(worn[name]).inputs["Roughness"].default_value == pytest.approx(roughness)
    assert bindings.read(scene, subject, PIVOT)[key] == pytest.approx((0.9,))
    assert bindings.write(scene, {key: (0.8,)}, subject, PIVOT) == {}  # the same copy
    assert snapshot.revert(scene) == []
    assert difference(before, dump()) == {}


def test_a_copy_whose_objects_are_gone_is_not_made(scene):
    subject = sharing(scene)
    before, key = dump(), f"material/{material_copies.copy_name('Body', ['Gone'])}/roughness"
    assert [*bindings.write(scene, {key: (0.9,)}, subject, PIVOT)] == [key]
    assert difference(before, dump()) == {}


def test_nothing_is_asked_where_no_material_may_change(addon):
    body, floor = bpy.data.materials["Body"], bpy.data.objects["Floor"]
    subject = [obj for obj in addon.objects if any(slot.material == body for slot in obj.material_slots)]
    floor.data.materials[0] = body
    session = object.__new__(Session)
    session.shared, session._find_scene, session.subject = "ASK", lambda: addon, lambda scene: subject
    session.like = "dusk.png"  # which may change everything
    assert next(session._ask_about_shared()) == "Waiting for your answer"
    assert session.question == {"Body": ["Floor"]}
    addon.vibe.change_material = False
    assert list(session._ask_about_shared()) == []


@pytest.mark.parametrize(
    ("described", "asked"),
    [("subject", {"Body"}), ("Body", {"Body"}), ("Lamp + Floor", {"Body"}), ("lights", set()), ("Lamp", set())],
)
def test_only_what_words_describe_is_asked_about(scene, described, asked):
    subject = sharing(scene)
    word = messages.WordReading("warm", "understood", candidates=[described, "Body"])
    session = object.__new__(Session)
    session.prompt, session.like, session.stage, session._job = "warm", "", "", None
    session._options, session._engine = (messages.Options(), Reader([messages.WordReading("hm", "left out"), word]))
    names = []

    def read():
        names.append((yield from session._described()))

    assert [*read()] == [""]
    assert {m.name for m in described_materials(shared_materials(subject), *names)} == asked


class Reader:
    """An engine that understands all words, once it has been asked."""

    def __init__(self, words):
        self.words, self.readings = words, [None]

    def send(self, request):
        self.readings.append(messages.Readings(request.prompt, self.words))

    def poll_readings(self):
        return self.readings.pop(0)
