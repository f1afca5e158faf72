# SPDX-License-Identifier: Apache-2.0
"""An object that a prompt names gets a copy of a material that other objects wear too: no other object changes with it."""

from dataclasses import replace

import pytest

from proxy_renderer.schema.material_copies import copied, copied_key, copy_name, is_worn_by
from proxy_renderer.words.parser import Understood
from proxy_renderer.words.types import MaterialLook, SceneDescription

SHARES = {"wall": 0.3, "rug": 0.05, "couch": 0.04, "couch.001": 0.03, "cushion": 0.01, "couch leg": 0.0}
ROOM = SceneDescription(
    objects=dict.fromkeys((*SHARES, "table"), "subject"),
    materials={"Material": "subject", "Material.006": "subject"},
    object_materials={
        **dict.fromkeys(SHARES, ("Material",)),
        "couch leg": ("Material.006",),
        "table": ("Material.006",),
    },
    looks={
        "Material": MaterialLook((0.9, 0.5, 0.5), share=sum(SHARES.values()), worn=SHARES),
        "Material.006": MaterialLook((0.5, 0.4, 0.2), share=0.05, worn={"couch leg": 0.01, "table": 0.04}),
    },
)


def painted(prompt, scene=ROOM):
    """Word -> the objects that wear what it describes."""
    understood = Understood(prompt, scene)
    worn = understood.scene.object_materials.items()
    return {
        a.word: {o for o, materials in worn if not {*materials}.isdisjoint(a.owners)}
        for a in understood.parsed.attributes
    }


@pytest.mark.parametrize(
    ("prompt", "objects"),
    [
        ("the couch in mustard", {"couch", "couch.001"}),  # not its legs
        ("a mustard rug", {"rug"}),
        ("mustard walls", {"wall"}),
        ("the table is mustard", {"table"}),
        ("the cushion is mustard", {"cushion"}),
    ],
)
def test_only_the_named_object_and_its_parts_are_painted(prompt, objects):
    assert painted(prompt) == {"mustard": objects}


def test_a_part_with_a_look_of_its_own_is_no_part_of_the_whole():
    said = painted("mustard couch, white cushions")
    assert said["white"] == {"cushion"}
    assert said["mustard"] == {"couch", "couch.001"}


def test_a_material_that_is_named_after_the_object_is_the_objects_own():
    worn = {"Coat": 0.2, "Lapel": 0.05}
    scene = SceneDescription(
        objects=dict.fromkeys(worn, "subject"),
        materials={"Coat Wool": "subject"},
        object_materials=dict.fromkeys(worn, ("Coat Wool",)),
        looks={"Coat Wool": MaterialLook((0.2, 0.3, 0.4), share=0.25, worn=worn)},
    )
    assert painted("mustard jacket", scene) == painted("mustard coat", scene) == {"mustard": {"Coat", "Lapel"}}


def test_an_object_that_is_left_out_keeps_what_it_shares():
    assert painted("everything white but the couch")["white"].isdisjoint({"couch", "couch.001"})


def test_the_copies_and_what_they_leave_have_looks_of_their_own():
    scene = Understood("a mustard rug", ROOM).scene
    (name,) = scene.copies
    assert scene.copies[name] == ("rug",)
    assert scene.looks[name].worn == {"rug": 0.05}
    assert "rug" not in scene.looks["Material"].worn
    assert sum(look.share for look in scene.looks.values()) == pytest.approx(
        sum(look.share for look in ROOM.looks.values())
    )
    assert not ROOM.copies  # the scene itself is as it was


def test_where_no_other_object_wears_it_nothing_is_copied():
    assert not Understood("warm light, everything white", ROOM).scene.copies
    alone = Understood("the wall is white, the rug is white, the couch and the cushion are white", ROOM)
    assert "Material" not in {m for worn in alone.scene.object_materials.values() for m in worn}


def test_what_cannot_be_copied_is_not_painted_and_one_line_says_so():
    """Blender could not hold the name of a copy."""
    long = "M" * 60
    scene = replace(
        ROOM,
        materials={long: "subject", "Material.006": "subject"},
        object_materials={
            o: tuple(long if m == "Material" else m for m in worn) for o, worn in ROOM.object_materials.items()
        },
        looks={long: ROOM.looks["Material"], "Material.006": ROOM.looks["Material.006"]},
    )
    understood = Understood("the rug in mustard, warm light", scene)
    assert f"material/{long}" in understood.parsed.protected
    assert any("Make it single-user" in note for note in understood.parsed.notes)


def test_names_of_copies_are_read_back():
    name = copy_name("Paint (old)", ["Chair.*", "Seat"])
    assert copied(name) == ("Paint (old)", "Chair.*, Seat")
    wearers = copied(name)[1]
    assert [is_worn_by(wearers, each) for each in ("Chair", "Chair.002", "Seat", "Seat.001", "Chairs")] == [
        True, True, True, False, False,
    ]  # fmt: skip
    assert copied_key(f"material/{name}/roughness") == "material/Paint (old)/roughness"
    assert copied("Glass (dark)") == ("Glass (dark)", "")
    assert copy_name("M" * 60, ["Chair"]) == ""


def test_the_scene_that_was_given_stays_as_it_is():
    room = replace(ROOM, texture_luminance={"Material": 0.3})
    read = Understood("the couch in mustard", room).scene
    assert set(read.texture_luminance.values()) == {0.3}
    assert len(read.texture_luminance) == 2
    assert room.texture_luminance == {"Material": 0.3}
