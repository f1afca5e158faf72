# SPDX-License-Identifier: Apache-2.0
"""Change phrases, and nouns that only the present look of a material or its shape explains."""

import dataclasses

import pytest

from proxy_renderer.words.parser import Understood, parse
from proxy_renderer.words.types import LightDescription, MaterialLook, SceneDescription

RED, SAND, NAVY, GREEN = (0.6, 0.1, 0.1), (0.8, 0.75, 0.6), (0.1, 0.15, 0.45), (0.2, 0.5, 0.1)
LOOKS = {
    "M1": MaterialLook(RED, share=0.1, worn={"Cube.003": 0.1}, structures=frozenset({"roof"})),
    "M2": MaterialLook(SAND, share=0.2, worn={"Cube.001": 0.2}, structures=frozenset({"wall"})),
    "M3": MaterialLook(NAVY, share=0.02, worn={"Cube.002": 0.02}),
    "M4": MaterialLook(GREEN, share=0.4, worn={"Plane": 0.4}, structures=frozenset({"ground", "support"})),
    "M5": MaterialLook((0.5, 0.5, 0.5), share=0.01, worn={"Plane.001": 0.01}),
}
SCENE = SceneDescription(
    objects=dict.fromkeys(("Cube.001", "Cube.002", "Cube.003"), "subject")
    | {"Plane": "surroundings", "Plane.001": "surroundings"},
    materials={"M1": "subject", "M2": "subject", "M3": "subject", "M4": "surroundings", "M5": "surroundings"},
    object_materials={next(iter(look.worn)): (name,) for name, look in LOOKS.items()},
    lights={"Sun": LightDescription("SUN", "key")},
    looks=LOOKS,
)
CHANGES = (
    "change the {noun} from {old} to {new}",
    "the {noun} should go from {old} to {new}",
    "turn the {old} {noun} into a {new} one",
    "make the {old} {noun} {new}",
    "swap the {old} {noun} for a {new} one",
    "replace the {old} {noun} with {new}",
    "the {noun} {new} instead of {old}",
    "the {noun} is no longer {old} but {new}",
    "the {old} {noun} becomes {new}",
)
NOUNS = (("roof", "red", "M1"), ("shutter", "navy", "M3"), ("lawn", "green", "M4"), ("gate", "red", "M1"))


def surfaces(prompt, scene=SCENE):
    """Word -> materials, for all words that paint something."""
    said = parse(f"{prompt}, soft warm light", scene).attributes
    return {a.word: a.owners for a in said if a.kind in ("subject", "surroundings") and not a.cause}


@pytest.mark.parametrize("phrase", CHANGES)
@pytest.mark.parametrize(("noun", "old", "material"), NOUNS)
def test_the_present_look_says_which_object_changes(phrase, noun, old, material):
    assert surfaces(phrase.format(noun=noun, old=old, new="mustard")) == {"mustard": (material,)}


@pytest.mark.parametrize("phrase", CHANGES)
def test_nothing_changes_where_no_material_looks_so(phrase):
    assert surfaces(phrase.format(noun="gate", old="magenta", new="mustard")) == {}


@pytest.mark.parametrize(
    ("prompt", "meant"),
    [
        ("change the blue to orange", {"orange": ("M3",)}),
        ("turn the red into lilac", {"lilac": ("M1",)}),
        ("turn the navy plastic beside the window glossy", {"glossy": ("M3",)}),
        ("change the roof from red to slate grey, matte", {"slate grey": ("M1",), "matte": ("M1",)}),
    ],
)
def test_a_present_color_alone_names_what_has_it(prompt, meant):
    assert surfaces(prompt) == meant


@pytest.mark.parametrize("prompt", ["the sky goes from blue to orange", "a backdrop gradient from red to blue"])
def test_a_gradient_and_the_sky_are_no_change_of_an_object(prompt):
    assert not {name for owners in surfaces(prompt).values() for name in owners} & {"M1", "M2", "M3"}


@pytest.mark.parametrize(
    ("prompt", "meant"),
    [("walls in dusty pink", "M2"), ("the roof is copper", "M1"), ("white floor", "M4"), ("a marble platform", "M4")],
)
def test_a_shape_says_what_a_structure_is(prompt, meant):
    assert set(surfaces(prompt).values()) == {(meant,)}


@pytest.mark.parametrize(
    "prompt",
    [
        "{look} {noun}",
        "the {noun} in {look}",
        "{noun}: {look}",
        "the {noun} should be {look}",
        "cushion and {noun} in {look}",
        "paint the {noun} {look}",
    ],
)
@pytest.mark.parametrize("noun", ["sofa", "wine", "kettle"])
@pytest.mark.parametrize("look", ["navy velvet", "candy apple red", "glossy black"])
def test_a_look_of_what_the_scene_lacks_paints_nothing(prompt, noun, look):
    assert surfaces(prompt.format(noun=noun, look=look)) == {}


def test_a_ceiling_that_no_material_is_stays_unused():
    assert surfaces("white ceiling") == {}


def test_the_name_of_the_only_material_may_be_anything():
    looks = {"A": MaterialLook(RED, share=0.3), "B": MaterialLook(SAND, share=0.02)}
    scene = SceneDescription(
        "", {"Torus": "subject"}, dict.fromkeys("AB", "subject"), {"Torus": ("A", "B")}, looks=looks
    )
    assert surfaces("pastel pink donut", scene)


def test_an_object_that_shares_its_material_gets_a_copy_whoever_has_most_of_it():
    worn = {"Couch": 0.07, "Window": 0.3}
    scene = SceneDescription(
        objects=dict.fromkeys((*worn, "Lamp"), "subject"),
        materials={"Paint": "subject", "Metal": "subject"},
        object_materials={"Couch": ("Paint",), "Window": ("Paint",), "Lamp": ("Metal",)},
        looks={"Paint": MaterialLook(RED, share=0.37, worn=worn), "Metal": MaterialLook(SAND, share=0.1)},
    )
    for thing in worn:
        understood = Understood(f"navy {thing.lower()}", scene)
        (navy,) = understood.parsed.attributes
        assert navy.owners == (f"Paint (on {thing})",)
        assert understood.scene.copies == {f"Paint (on {thing})": (thing,)}


@pytest.mark.parametrize("prompt", ["make everything pink", "everything pink but the roof", "everything white"])
def test_everything_can_be_painted(prompt):
    assert surfaces(prompt)


@pytest.mark.parametrize("prompt", ["red moonlight from the left"])
def test_a_color_of_light_paints_no_object(prompt):
    assert surfaces(prompt) == {}


@pytest.mark.parametrize(
    ("prompt", "meant"),
    [
        ("Das Dach soll statt rot dunkelgrün sein", "M1"),
        ("mach die blaue Tür gelb", "M3"),
        ("remplace le toit rouge par du vert foncé", "M1"),
    ],
)
def test_changes_are_read_in_other_languages(prompt, meant):
    said = parse(prompt, SCENE).attributes
    assert {a.owners for a in said if a.kind == "subject" and not a.cause} == {(meant,)}


def test_a_room_has_walls_and_a_ground():
    looks = dict(LOOKS)
    looks["M3"] = MaterialLook(NAVY, share=0.15, worn={"Cube.002": 0.15}, structures=frozenset({"walls"}))
    looks["M2"] = MaterialLook(SAND, share=0.2, worn={"Cube.001": 0.2}, structures=frozenset({"wall", "walls"}))
    room = dataclasses.replace(SCENE, looks=looks)
    assert surfaces("peach walls, walnut floor", room) == {"peach": ("M2", "M3"), "walnut": ("M4",)}
    assert surfaces("the ground is pink", room) == {"pink": ("M4",)}
    assert surfaces("the wall is pink", room) == {"pink": ("M2",)}
