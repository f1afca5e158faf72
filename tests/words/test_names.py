# SPDX-License-Identifier: Apache-2.0
"""Names in a scene and things in a prompt: what is the same thing, what is a part of it, and what is a mood instead."""

import pytest

from proxy_renderer.goals.resolve import goals_of
from proxy_renderer.planning.planner import plan
from proxy_renderer.schema import FAMILIES, Instance
from proxy_renderer.words import names as fitted
from proxy_renderer.words.lexicon.languages import senses
from proxy_renderer.words.lexicon.vocabulary import extend, shipped_vocabulary
from proxy_renderer.words.model import reading
from proxy_renderer.words.names import fit, is_detail, is_of_surfaces, kind_of, plain_name
from proxy_renderer.words.parser import parse
from proxy_renderer.words.types import SceneDescription


def scene(worn: dict[str, str]) -> SceneDescription:
    """Subjects with a material each."""
    materials = dict.fromkeys(worn.values(), "subject")
    return SceneDescription(
        "", dict.fromkeys(worn, "subject"), materials, {name: (stuff,) for name, stuff in worn.items()}
    )


CAR = scene(
    {"Body": "Body", "Cabin": "Cabin", **{f"Wheel {i}": f"Tyre {n}" for i, n in enumerate(("", "Two", "Three"))}}
)
DUCK = scene({"Duck": "Duck", "Duck Head": "Duck Head", "Bill": "Beak"})
TEAPOT = scene({"Teapot": "Glaze", "Lid": "Lid Glaze", "Handle": "Bamboo"})


def painted(prompt: str, words: SceneDescription, shares: dict[str, float], alike: bool = False) -> set[str]:
    """Materials whose color a plan changes; each has a gray of its own, or all the same."""
    family = FAMILIES["material/base_color"]
    instances = [
        Instance(family, name, (0.5 if alike else 0.1 * i,) * 3, 1.0, "subject")
        for i, name in enumerate(words.materials)
    ]
    parsed = parse(prompt, words)
    made = plan(goals_of(parsed), {i.key: i for i in instances}, SceneDescription(material_share=shares))
    return {i.owner for i in instances if made[i.key].priority is not None}


def test_parts_of_a_kind_are_painted_alike_and_details_are_not():
    seen = {"Body": 0.5, "Cabin": 0.2, "Tyre ": 0.16, "Tyre Two": 0.1, "Tyre Three": 0.04}
    assert painted("red car", CAR, seen) == {"Body", "Cabin"}
    assert painted("golden tyres", CAR, seen) == {"Tyre ", "Tyre Two", "Tyre Three"}
    columns = scene({"Column 0": "Stone", "Column 1": "Stone.001", "Top": "Rope"})
    assert painted("white columns", columns, {"Stone": 0.7, "Stone.001": 0.08, "Rope": 0.06}) == {"Stone", "Stone.001"}


def test_small_parts_that_look_like_the_large_ones_are_painted_with_them():
    """A file without materials: fenders are as gray as the hood."""
    seen = {"Body": 0.7, "Cabin": 0.05, "Tyre ": 0.1, "Tyre Two": 0.1, "Tyre Three": 0.05}
    assert painted("red car", CAR, seen) == {"Body"}
    assert painted("red car", CAR, seen, alike=True) == {"Body", "Cabin"}


def test_a_thing_has_its_limbs():
    for prompt in ("red duck", "the duck is red"):
        assert {a.owners for a in parse(prompt, DUCK).attributes} == {("Duck", "Duck Head")}
    assert {a.owners for a in parse("yellow beak", DUCK).attributes} == {("Beak",)}
    assert painted("red teapot", TEAPOT, {}) == {"Glaze", "Lid Glaze", "Bamboo"}


def test_a_limb_alone_is_the_thing():
    """The paint of a car whose objects are called "Cube.012" is none of its brakes."""
    car = scene({"Cube": "CarShellNew", "Cube.001": "Brake", "Plane": "Plate"})
    assert {a.owners for a in parse("deep blue car", car).attributes} == {("CarShellNew",)}


def test_names_that_say_nothing_are_kinds_of_their_own():
    assert kind_of("Material.001") != kind_of("Material.002")
    assert kind_of("Tyre.001") == kind_of("tyre_02") == "tyre"
    assert is_detail("Eyes")
    assert is_detail("car_window.001")
    assert not is_detail("Body")


@pytest.mark.parametrize(
    ("prompt", "moods"),
    [
        ("a gold castle in the mist", {"gold", "mist"}),
        ("lit by a candle, gold", {"candlelight", "gold"}),
        ("castle", {"medieval"}),
    ],
)
def test_a_word_for_a_mood_may_be_the_thing_itself(prompt, moods):
    parsed = parse(prompt, SceneDescription())
    assert {a.entry for a in parsed.attributes if not a.cause} == moods


def test_names_in_the_scene_come_before_moods():
    words = scene({"Candle": "Wax"})
    assert {a.owners for a in parse("the candle is red", words).attributes} == {("Wax",)}


@pytest.mark.parametrize(
    ("prompt", "entries"),
    [
        ('{"fog": "none", "light": "warm"}', {("fog", True), ("warm light", False)}),
        ("vignette=off; background: white", {("vignette", True), ("white", False)}),
        ("Candlelit: a red bowl", {("candlelight", False), ("red", False)}),
    ],
)
def test_keys_and_values_are_read_as_a_sentence(prompt, entries):
    parsed = parse(prompt, SceneDescription())
    assert {(a.entry, a.negated) for a in parsed.attributes if not a.cause} == entries


@pytest.mark.parametrize(
    ("prompt", "kind"), [("cottage, cold blue", "subject"), ("cup, warm light, pale blue", "subject")]
)
def test_a_color_after_light_or_air_is_theirs_if_light_can_have_it(prompt, kind):
    assert {a.kind for a in parse(prompt, SceneDescription()).attributes if a.color} == {kind}


def test_light_of_gold_is_no_metal():
    assert "substance" not in goals_of(parse("red vase, gold light", SceneDescription())).classes


def test_of_two_materials_of_one_name_the_subjects_is_meant():
    """After Make Single-User the subject has "Monkey.001", and the floor keeps "Monkey"."""
    words = SceneDescription(materials={"Monkey": "surroundings", "Monkey.001": "subject"})
    assert {a.owners for a in parse("red monkey, glossy", words).attributes if a.color} == {("Monkey.001",)}


def test_a_color_before_a_thing_of_the_scene_is_its_color_though_both_are_a_place():
    words = scene({"Water": "Water", "Boat": "Hull"})
    assert painted("turquoise water", words, {"Water": 0.5, "Hull": 0.5}) == {"Water"}


def test_a_named_color_comes_before_a_word_that_only_changes_one():
    """The ball is teal, and as dark as its claim makes it; not a darker gray, which 0.5 was."""
    words = scene({"Ball": "Ball"})
    instance = Instance(FAMILIES["material/base_color"], "Ball", (0.5, 0.5, 0.5), 1.0, "subject")
    parsed = parse("the ball is teal, the ball is darker", words)
    entry = plan(goals_of(parsed), {instance.key: instance}, SceneDescription())[instance.key]
    assert entry.upper[0] < 0.1 < entry.upper[1]


@pytest.mark.parametrize(
    ("prompt", "things", "looks"),
    [
        ("a rubber tire and a wooden desk", ("tire", "desk"), {"rubber": "tire", "wooden": "desk"}),
        ("a wooden spoon and a glass window", ("spoon", "window"), {"wooden": "spoon", "glass": "window"}),
        ("a fabric curtain and a fluffy towel", ("curtain", "towel"), {"fabric": "curtain", "fluffy": "towel"}),
    ],
)
def test_a_material_before_a_thing_is_its_look_though_things_are_called_so(prompt, things, looks):
    worn = {thing: (thing,) for thing in things}
    scene = SceneDescription(
        objects=dict.fromkeys(things, "subject"), materials=dict.fromkeys(things, "subject"), object_materials=worn
    )
    assert {a.word: a.owners for a in parse(prompt, scene).attributes} == {w: (t,) for w, t in looks.items()}


def test_a_walled_garden_is_no_wall():
    parsed = parse("a walled garden", scene({"Wall": "Plaster"}))
    assert [a.thing for a in parsed.attributes if not a.cause] == ["garden"]


@pytest.mark.parametrize(
    ("prompt", "owners"),
    [
        ("oak shelves", ("Board",)),  # a plural that no ending tells
        ("black bathtub", ("Enamel",)),  # its noun is not the last word of its name
    ],
)
def test_names_are_found_by_their_nouns(prompt: str, owners: tuple[str, ...]) -> None:
    things = {"Shelf_mdf": "Board", "bathtub_freestanding": "Enamel"}
    found = {o for a in parse(prompt, scene(things)).attributes for o in a.owners}
    assert found == set(owners)


@pytest.mark.parametrize("prompt", ["burnt red ball", "charred red ball", "coal ball in red"])
def test_a_color_that_is_said_comes_before_that_of_a_material(prompt: str) -> None:
    instance = Instance(FAMILIES["material/base_color"], "Ball", (0.5, 0.5, 0.5), 1.0, "subject")
    parsed = parse(prompt, scene({"Ball": "Ball"}))
    entry = plan(goals_of(parsed), {instance.key: instance}, SceneDescription())[instance.key]
    assert entry.upper[0] > 0.5 > 0.2 > entry.upper[1]


def test_the_leather_of_a_leather_seat_is_a_look() -> None:
    found = reading("tan leather seat", scene({"Seat": "leatherSeat"}), shipped_vocabulary())
    assert [look.text for look in found.passage.looks] == ["tan", "leather"]


def test_paint_the_crate_names_no_paint() -> None:
    things = {"Crate": "Wood", "Car": "CarPaint"}
    assert {a.owners for a in parse("paint the crate blue", scene(things)).attributes} == {("Wood",)}


def test_names_are_fitted_by_the_artists_own_vocabulary(tmp_path):
    path = tmp_path / "own.toml"
    path.write_text("[look.kryptonite]\nslot = 'material'\nwishes = ['material/roughness 0.1..0.2 !2']\n")
    own = extend(shipped_vocabulary(), path)
    said, name = ("kryptonite", "glorb"), ("glorb", "rock")
    assert [is_of_surfaces(said[0], v) for v in (shipped_vocabulary(), own)] == [False, True]
    assert fit(said[1:], name, own) == "part"


def test_what_is_remembered_of_names_is_bounded():
    for cached in (plain_name, fitted.parts, senses):
        assert cached.cache_info().maxsize


def test_of_several_of_a_shape_none_is_guessed_and_names_come_first():
    several = scene({"Sphere": "a", "Sphere.001": "b", "Cylinder": "c", "Mug": "d"})
    found = parse("green apple, blue mug", several).attributes
    assert {a.word: a.owners for a in found}.get("blue") == ("d",)
    assert not any(a.owners for a in found if a.word == "green")


@pytest.mark.parametrize("focus", ["shallow focus on", "focused on", "selective focus on"])
def test_what_is_in_focus_is_not_painted(focus: str) -> None:
    parsed = parse(f"warm light, {focus} the red cup in front", scene({"Cup": "Clay", "Wall": "Plaster"}))
    assert [a.entry for a in parsed.attributes] == ["warm light"]


@pytest.mark.parametrize("prompt", ["blue light from the right", "red light to the left"])
def test_the_side_of_a_light_is_no_part_of_that_side(prompt: str) -> None:
    parts = {"Seat": ("Wool",), "Arm Left": ("Wool",), "Arm Right": ("Wool",)}
    scene = SceneDescription("Seat", dict.fromkeys(parts, "subject"), {"Wool": "subject"}, parts)
    assert not any(attribute.owners for attribute in parse(prompt, scene).attributes)
