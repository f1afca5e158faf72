# SPDX-License-Identifier: Apache-2.0
"""Rigs: the file is checked, words choose and change one, and its lights stand and shine as it says."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
import torch
from tiny_job import write_job

from proxy_renderer.color.arrays import sphere_luminance
from proxy_renderer.color.floats import chroma, lab_from_srgb, luminance, srgb_from_hex
from proxy_renderer.color.floats import linear_from_srgb as float_linear
from proxy_renderer.color.tensors import linear_from_srgb
from proxy_renderer.color.view_transform import ViewTransform
from proxy_renderer.goals.resolve import goals_of
from proxy_renderer.optimize.scene_facts import described
from proxy_renderer.optimize.stage import set_stage
from proxy_renderer.render.material.inputs import geometry_of
from proxy_renderer.rigs.chosen import ChosenRig, chosen_rig
from proxy_renderer.rigs.combined import under_named_sky
from proxy_renderer.rigs.levels import Exposing, _bounce, _hot_spot, _shed, sky_irradiance
from proxy_renderer.rigs.lighting import _is_hazy, _sky, _veiled
from proxy_renderer.rigs.places import placed
from proxy_renderer.rigs.stage import LightStage
from proxy_renderer.scene import Light, SceneData, load_scene
from proxy_renderer.scene.data import Standby
from proxy_renderer.schema import FAMILIES, Instance, VibeError, orbit
from proxy_renderer.schema.added_lights import ADDED_LIGHTS, card
from proxy_renderer.words.lexicon.rigs import KINDS, read, rig_table
from proxy_renderer.words.lexicon.vocabulary import default_vocabulary
from proxy_renderer.words.parser import parse
from proxy_renderer.words.types import SceneDescription

RIG = '[rig.glow]\nsays = "A glow."\nlights = [{ part = "key", source = "point", from = [-40, 20] }]\n'
RIGS = sorted({rig.name: rig for rig in rig_table().rigs.values()}.values(), key=lambda rig: rig.name)
_AT_HOME = {"power": 40.0, "strength": 1.0, "size": 0.5, "angle": 0.5, "cone": 45.0, "elevation": 40.0, "distance": 4.0}
_COMMON = {"color": (1.0, 1.0, 1.0), "temperature": (6500.0,), "azimuth": (0.0,), "elevation": (40.0,)}


def _spare() -> Standby:
    """All lights that Blender offers, as it exports them."""
    lights, instances = [], {}
    for what in ADDED_LIGHTS.values():
        identity = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
        lights.append(Light(what.name, what.type, identity, (0.0, -4.0, 3.0), role=what.role, card=1.5))
        sun = what.type == "SUN"
        names = ["strength", "angle"] if sun else ["power", "size", "distance", *["cone"] * (what.type == "SPOT")]
        values = {**_COMMON, **{name: (_AT_HOME[name],) for name in names}}
        for name, value in values.items():
            instance = Instance(
                FAMILIES[f"light/{name}"], what.name, value, 4.0 if name == "distance" else 1.0, what.role
            )
            instances[instance.key] = instance
    return Standby(tuple(lights), instances)


@pytest.fixture(scope="module")
def scene(tmp_path_factory) -> SceneData:
    """A ball on a floor, which may get lights."""
    return replace(load_scene(write_job(tmp_path_factory.mktemp("job"))), standby=_spare())


def chosen(prompt: str) -> ChosenRig | None:
    """The rig of a prompt."""
    vocabulary = default_vocabulary()
    return chosen_rig(goals_of(parse(prompt, SceneDescription(), vocabulary)), rig_table(), vocabulary)


def rig_name(prompt: str) -> str:
    """Its name; "" if there is none."""
    found = chosen(prompt)
    return found.rig.name if found else ""


@pytest.mark.parametrize(
    ("broken", "said"),
    [
        (RIG.replace("says", "say"), "'say' is no row"),
        (RIG.replace("point", "bulb"), "'bulb' is no source"),
        (RIG.replace("key", "main"), "'main' is no part"),
        (RIG.replace('source = "point", from = [-40, 20]', 'source = "point"'), "lacks the row from"),
        (RIG.replace("[-40, 20] }", '[-40, 20], color = "red" }'), "'red' is no color"),
        (RIG.replace("[-40, 20] }", "[-40, 20], kelvin = 90 }"), "no color of light"),
        ("\n\n" + RIG.replace("lights", "light"), "line 3"),
    ],
)
def test_mistakes_in_a_file_are_named_with_line_and_remedy(broken, said):
    with pytest.raises(VibeError) as caught:
        read(broken, "rigs.toml")
    assert said in caught.value.message
    assert caught.value.remedy


def test_broken_toml_is_one_line():
    with pytest.raises(VibeError, match=r"rigs\.toml cannot be read"):
        read("[rig.glow", "rigs.toml")


@pytest.mark.parametrize("rig", RIGS, ids=lambda rig: rig.name)
def test_a_shipped_rig_is_one_that_a_gaffer_could_build(rig):
    assert rig.kind in KINDS
    assert rig.adds or -5.0 <= rig.exposure <= 1.0
    assert all(-90 <= light.elevation <= 90 and abs(light.azimuth) <= 180 for light in rig.lights)
    assert all(bool(light.color) != bool(light.kelvin) for light in rig.lights)
    assert not any(e.family.split("/")[0] != "film" for e in rig.grade)


@pytest.mark.parametrize(
    ("prompt", "name"),
    [
        ("cosy, by lamplight", "lamplight"),
        ("a candle at night", "candlelight"),
        ("lit by a candle, moody", "candlelight"),
        ("glossy red", ""),
        ("warm light", ""),
        ("warm light from the left", "plain key"),
        ("not by candlelight, glossy", ""),
    ],
)
def test_a_source_comes_before_an_hour_and_a_mood(prompt, name):
    assert rig_name(prompt) == name


def test_sides_swap_with_the_words():
    left, right = (chosen(f"candlelight from the {side}").rig.lights[0].azimuth for side in ("left", "right"))
    assert left < 0 < right


def test_two_colors_of_light_come_from_two_sides():
    lights = chosen("red light from the left and blue light from the right").rig.lights
    red, blue = (next(x for x in lights if x.color and int(x.color[i : i + 2], 16) > 150) for i in (1, 5))
    assert red.azimuth < 0 < blue.azimuth


def test_modifiers_change_lights_and_not_what_a_mood_stands_for():
    plain, deep = chosen("candlelight").rig, chosen("candlelight, deep shadows").rig
    assert deep.world < plain.world
    assert chosen("candlelight, cosy").rig.lights == plain.lights


def test_everything_else_falls_into_black():
    found = chosen("single warm spot, everything else falls into black")
    assert found.rig.sky < -5
    assert found.rig.world < -5
    assert any(a.color for a in found.served)  # the black is no paint


@pytest.mark.parametrize("rig", RIGS, ids=lambda rig: rig.name)
def test_no_rig_changes_a_material(rig, scene):
    addition = set_stage([scene], rig.entries[0])
    if addition.plan:
        assert not any(key.startswith("material") for key in addition.plan.entries)


@pytest.mark.parametrize("prompt", ["candlelight", "lamplight", "film noir", "golden hour"])
def test_stops_between_key_and_others_hold_in_irradiance(prompt, scene):
    addition = set_stage([scene], prompt)
    lit, rig = addition.scenes[0], chosen(prompt).rig
    values = {key: torch.tensor(entry.start) for key, entry in addition.plan.entries.items()}
    from proxy_renderer.render.lights.light_types import light_sources
    from proxy_renderer.scene.values import RenderValues

    stage = LightStage(lit, geometry_of(lit, torch.device("cpu")))
    lamps = {x.light.name: x for x in light_sources(lit, RenderValues(lit, values, "cpu"))}
    added = [x for x in lit.lights if x.added]
    assert added
    shed = {}
    for light in added:
        lamp = lamps[light.name]
        raw = lamp.irradiance(stage.subject.position, stage.subject.normal).irradiance * float(lamp.color.mean())
        shed[light.name] = float(raw.topk(len(raw) // 2).values.mean())
    key = next(name for name in shed if "Key" in name)
    fills = [name for name in shed if "Fill" in name]
    for name in fills:
        wanted = next(x.stops for x in rig.lights if x.part == "fill")
        assert math.log2(shed[name] / shed[key]) == pytest.approx(wanted, abs=1.5)  # colors and shadows aside


def test_an_added_light_is_off_before_the_vibe_and_written_with_all_its_values(scene):
    addition = set_stage([scene], "candlelight")
    name = next(light.name for light in addition.scenes[0].lights if light.added)
    power = addition.scenes[0].instances[f"light/{name}/power"]
    assert power.value[0] < 0.01 * addition.plan.entries[power.key].start[0]
    from proxy_renderer.optimize.shots import added_values

    assert f"light/{name}/azimuth" in added_values(addition.scenes[0])


def test_a_further_sentence_adds_another_rim_and_leaves_those_that_are_there(scene):
    """Without the article the rim that is there is meant."""
    lit = scene.with_lights(["Vibe Rim"])
    free = tuple(light for light in lit.standby.lights if light.name != "Vibe Rim")
    lit = replace(lit, standby=replace(lit.standby, lights=free))
    stage = set_stage([lit], "and a cool rim light", goes_on=True)
    assert {x.name for x in stage.scenes[0].lights} - {x.name for x in lit.lights} == {"Vibe Kicker"}
    assert {stage.scenes[0].instances[key].owner for key in stage.plan.entries} == {"Vibe Kicker"}
    assert stage.plan.entries["light/Vibe Kicker/temperature"].start[0] > 7000.0
    stage = set_stage([lit], "the rim light cooler", goes_on=True)
    assert stage.scenes[0].lights == lit.lights
    assert stage.plan is None


def with_street_lamps(scene: SceneData) -> SceneData:
    """The scene with two spots on posts that shine away from its subject."""
    away = ((1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, -1.0))
    lights, instances = [], {}
    for name, side in (("Street Lamp 1", -60.0), ("Street Lamp 2", 60.0)):
        place = tuple(4.0 * x for x in orbit.direction(side, 40.0))
        lights.append(Light(name, "SPOT", away, place))
        values = {**_COMMON, "power": (40.0,), "size": (0.1,), "distance": (4.0,), "cone": (60.0,), "azimuth": (side,)}
        for kind, value in values.items():
            instance = Instance(FAMILIES[f"light/{kind}"], name, value, 4.0 if kind == "distance" else 1.0)
            instances[instance.key] = instance
    return replace(scene, lights=(*scene.lights, *lights), instances={**scene.instances, **instances})


@pytest.mark.parametrize("prompt", ["sodium streetlights at night", "street lamps, rainy night"])
def test_the_lamps_of_a_street_burn_though_none_shines_on_the_subject(prompt, scene):
    entries = set_stage([with_street_lamps(scene)], prompt).plan.entries
    for lamp in ("Street Lamp 1", "Street Lamp 2"):
        power, color = (entries.get(f"light/{lamp}/{what}") for what in ("power", "color"))
        assert power is None or power.start[0] >= 20.0
        assert color.start[0] > color.start[2]
    assert entries["light/Key/power"].start[0] < 1.0


@pytest.mark.parametrize("signs", [1, 2])
def test_no_two_lights_burn_in_one_sign(signs, scene):
    """Pink and cyan in the same place would be one color."""
    stage = LightStage(scene, geometry_of(scene, torch.device("cpu")))
    places = [stage.middle + stage.radius * torch.tensor([side, -2.0, 0.5]) for side in (-2.0, 2.0)]
    stage.things = [(frozenset({"sign"}), place, 0.1) for place in places[:signs]]
    lights = [x for x in placed(rig_table().rigs["rainy night"].lights, stage) if "sign" in x.light.names]
    assert len({(x.azimuth, x.elevation, x.distance) for x in lights}) == len(lights) == 2
    assert sum(x.fixed for x in lights) == signs


def test_a_moon_in_the_color_of_a_mood_keeps_half_of_its_own():
    moon = srgb_from_hex(chosen("moonlit, quiet, blue").rig.lights[0].color)
    assert min(moon) > 0.4
    assert chroma(lab_from_srgb(moon)) > 20.0
    pure = chosen("blue light from the left, red light from the right").rig.lights[0].color
    assert min(srgb_from_hex(pure)) < 0.2


def test_without_new_lights_the_scenes_own_plays_the_key(scene):
    addition = set_stage([scene], "candlelight", new_lights=False)
    assert not any(light.added for light in addition.scenes[0].lights)
    assert addition.plan.entries["light/Key/temperature"].start[0] < 2500


def test_a_card_lets_half_of_the_sun_through_and_no_ray_but_shadows_sees_it(scene):
    addition = set_stage([scene], "sun through the blinds")
    lit = addition.scenes[0]
    shade = lit.objects[-1]
    assert set(shade.hidden) == {"camera", "diffuse", "glossy", "transmission"}
    stage = LightStage(lit, geometry_of(lit, torch.device("cpu")))
    sun = next(light for light in lit.lights if light.name == "Vibe Key Blinds")
    azimuth, elevation = (lit.value(f"light/{sun.name}/{name}")[0] for name in ("azimuth", "elevation"))
    facing = stage.sunlit(stage.subject, azimuth - stage.front, elevation)
    share = float((facing > 0.01).float().mean())
    assert 0.05 < share < 0.6


def test_patterns_are_made_of_flat_quads():
    for pattern in ("slats", "leaves"):
        quads = np.array(card(pattern, 2.0))
        assert quads.shape[1:] == (4, 2)
        x, y = quads[..., 0], quads[..., 1]
        area = 0.5 * (x * np.roll(y, -1, 1) - y * np.roll(x, -1, 1)).sum(1)
        assert (np.abs(area) > 0).all()


def test_the_open_sky_gives_pi(scene):
    stage = LightStage(scene, geometry_of(scene, torch.device("cpu")))
    assert 0.4 * math.pi < sky_irradiance(stage) < math.pi


def test_a_prompt_is_read_alike_before_and_after_lights_are_added(scene):
    prompt = "candlelight from the left, moonlight through the blinds"
    addition = set_stage([scene], prompt)
    again = parse(prompt, described(*addition.scenes), default_vocabulary())
    assert again.attributes == parse(prompt, described(scene), default_vocabulary()).attributes
    assert all(a in addition.plan.served for a in again.attributes)


def test_words_of_one_rig_share_its_claims_and_each_is_measured_once(scene):
    stage = set_stage([scene], "film noir, warm hard light from the left")
    rig = [c for c in stage.claims(stage.goals) if c.word in ("film noir", *c.also) and c.word]
    assert len({(c.measure, c.color) for c in rig}) == len(rig)
    sides = [c for c in stage.claims(stage.goals) if c.measure == "light_right"]
    assert [{c.word, *c.also} for c in sides] == [{"film noir", "from the left"}]
    warm = next(c for c in stage.claims(stage.goals) if c.measure == "highlight_warmth")
    assert "warm" in (warm.word, *warm.also)


@pytest.mark.parametrize("color", [(0.2, 0.4, 0.7), (0.8, 0.45, 0.3), (0.3, 0.3, 0.3), (0.01, 0.02, 0.06)])
def test_light_is_found_that_the_view_shows_as_a_color(color, scene):
    film = scene.film
    view = ViewTransform(film.ocio, film.display, film.view, film.look)
    shown = linear_from_srgb(view(torch.tensor(Exposing(scene).color(color))).clamp(0, 1))
    assert shown.tolist() == pytest.approx(color, abs=0.05)


def test_a_view_that_rolls_off_gets_more_light_for_a_white_wall(scene):
    standard = replace(scene, film=replace(scene.film, view="Standard"))
    assert Exposing(standard).gray(0.8) == pytest.approx(0.8, rel=0.05)
    assert Exposing(scene).gray(0.8) > 2.0
    assert Exposing(scene).gray(0.18) == pytest.approx(0.18, rel=0.15)


def test_the_artists_exposure_stays(scene):
    brighter = dict(scene.instances)
    brighter["film/exposure"] = replace(brighter["film/exposure"], value=(1.0,))
    lit = replace(scene, instances=brighter)
    assert Exposing(lit).gray(0.18) == pytest.approx(0.5 * Exposing(scene).gray(0.18), rel=1e-3)


SUNNY = [
    r
    for r in RIGS
    if r.kind in ("hour", "time")
    and (r.sky or -9.0) > 0.0
    and r.lights[0].type == "SUN"
    and abs(r.lights[0].azimuth) < 115.0
]
"""Rigs of the day whose sun does not stand behind the subject."""


@pytest.mark.parametrize("rig", SUNNY, ids=lambda rig: rig.name)
def test_a_sun_leaves_a_shadow_side(rig):
    fills = [light.stops for light in rig.lights if light.part in ("fill", "bounce")]
    total = sum(2.0**stops for stops in (*fills, rig.world))
    assert math.log2(total) < -0.9, "the shadow side is hardly darker"


def test_outdoors_a_sun_stands_where_its_rig_has_it(scene):
    stage = LightStage(scene, geometry_of(scene, torch.device("cpu")))
    assert stage.openness > 0.8
    for light in (chosen(prompt).rig.lights[0] for prompt in ("golden hour", "summer day", "late afternoon")):
        (sun,) = placed([light], stage)
        turn = abs((sun.azimuth - stage.front + 180.0) % 360.0 - 180.0)
        assert turn == pytest.approx(abs(light.azimuth), abs=21.0)


def test_the_rows_at_the_poles_of_an_environment_are_narrow():
    environment = np.zeros((64, 128, 3))
    environment[:4] = 100.0
    assert sphere_luminance(environment) < 0.5 * environment.mean()
    assert sphere_luminance(np.full((8, 16, 3), 0.25)) == pytest.approx(0.25)


def test_the_walls_of_a_box_throw_light_back(scene):
    stage = LightStage(scene, geometry_of(scene, torch.device("cpu")))
    light = torch.ones(len(stage.subject)), torch.ones(len(stage.around))
    in_the_open = _bounce(stage, light)
    stage.openness = 0.0  # a cached property
    assert in_the_open < 0.15 < _bounce(stage, light) <= 3.0


def test_a_sky_is_displayed_in_the_color_of_its_rig(scene):
    rig = rig_table().rigs["summery"]
    parted = replace(scene, instances={**scene.instances, **_backdrop()})
    values = _sky(parted, rig, False)
    light = torch.tensor(values["world/backdrop_color"]) * values["world/backdrop_strength"][0]
    film = scene.film
    shown = ViewTransform(film.ocio, film.display, film.view, film.look)(light).clamp(0, 1)
    lab, wanted = lab_from_srgb(shown.tolist()), lab_from_srgb(srgb_from_hex(rig.sky_color))
    assert lab[0] == pytest.approx(wanted[0], abs=4.0)
    assert math.atan2(lab[2], lab[1]) == pytest.approx(math.atan2(wanted[2], wanted[1]), abs=0.25)
    assert chroma(lab) > 0.5 * chroma(wanted)  # AgX shows no blue that is so pure and so light


def test_a_sky_is_lightest_and_warmest_at_the_horizon(scene):
    horizon = Instance(FAMILIES["world/backdrop_horizon"], "", (1.0, 1.0, 1.0), 1.0)
    parted = replace(scene, instances={**scene.instances, **_backdrop(), horizon.key: horizon})
    for name in ("sunset", "noon", "studio light"):
        values = _sky(parted, rig_table().rigs[name], False)
        red, green, blue = values["world/backdrop_horizon"]
        assert luminance((red, green, blue)) > 1.3
        assert red > 1.1 * blue or name != "sunset"


def _backdrop() -> dict[str, Instance]:
    """A backdrop of its own."""
    values = {"backdrop_color": (0.1, 0.1, 0.1), "backdrop_strength": (1.0,)}
    found = (Instance(FAMILIES[f"world/{name}"], "", value, 1.0) for name, value in values.items())
    return {instance.key: instance for instance in found}


def test_a_sky_behind_haze_is_pale():
    clear, hazy = (parse(prompt, SceneDescription(), default_vocabulary()) for prompt in ("sunset", "sunset, hazy air"))
    assert (_is_hazy(clear), _is_hazy(hazy)) == (False, True)
    pure, pale = (lab_from_srgb(srgb_from_hex(color)) for color in ("#56a2ec", _veiled("#56a2ec")))
    assert chroma(pale) < 0.7 * chroma(pure)
    assert pale[0] == pytest.approx(pure[0], abs=2.0)


@pytest.mark.parametrize("word", ["sandstorm", "blizzard"])
def test_a_weather_brings_its_air_unless_another_word_speaks_of_it(scene, word):
    air = Instance(FAMILIES["volume/density"], "", (0.0,), 0.2)
    hazy = replace(scene, instances={**scene.instances, air.key: air})
    entries = set_stage([hazy], f"in a {word}").plan.entries
    assert entries[air.key].lower[0] > 0.05 * air.reference
    assert air.key not in set_stage([hazy], f"in a {word}, clear air, no fog").plan.entries


def test_haze_is_darker_at_night_and_has_the_color_of_the_sky_behind_it(scene):
    color = Instance(FAMILIES["volume/color"], "", (0.8, 0.8, 0.8))
    air = Instance(FAMILIES["volume/density"], "", (0.0,), 0.2)
    hazy = replace(scene, instances={**scene.instances, air.key: air, color.key: color})

    def haze(prompt):
        return set_stage([hazy], prompt).plan.entries[color.key].start

    assert luminance(haze("foggy moonlight")) < 0.5
    day = haze("foggy storm light, green sky")
    assert day[1] == max(day) == pytest.approx(0.8)
    assert color.key not in set_stage([hazy], "foggy moonlight, red fog").plan.entries
    assert color.key not in set_stage([hazy], "foggy morning light").plan.entries


def test_water_mirrors_what_stands_where_the_camera_looks_by_way_of_it(scene):
    values = {key: (0.05,) for key in scene.instances if key.endswith("/roughness")}
    instances = {k: replace(i, value=values.get(k, i.value)) for k, i in scene.instances.items()}
    rough, wet = (
        LightStage(each, geometry_of(each, torch.device("cpu")))
        for each in (scene, replace(scene, instances=instances))
    )
    first = wet.around.polished.nonzero()[0, 0]
    place, toward = wet.around.position[:, first], wet.around.mirrored[:, first]
    assert wet.mirrors(place + 3.0 * toward, 1.0) > 0.0
    assert wet.mirrors(place - 3.0 * toward, 1.0) == 0.0
    assert rough.mirrors(place + 3.0 * toward, 1.0) == 0.0


@pytest.mark.parametrize("rig", ["desert", "golden hour", "night"])
def test_a_sky_has_the_color_that_words_give_it(rig):
    parsed = parse(f"{rig}, pale blue sky", SceneDescription(), default_vocabulary())
    (blue,) = {a.color for a in parsed.attributes if a.color}
    named = under_named_sky(rig_table().rigs[rig], parsed.attributes)
    assert srgb_from_hex(named.sky_color) == pytest.approx(blue, abs=0.01)
    assert 0.18 * 2.0**named.sky == pytest.approx(luminance(float_linear(blue)), rel=0.01)
    plain = parse(rig, SceneDescription(), default_vocabulary())
    assert under_named_sky(rig_table().rigs[rig], plain.attributes) == rig_table().rigs[rig]


def test_each_light_names_the_word_that_asked_for_it(scene):
    """In what is planned, and so in the panel's list of changes."""
    addition = set_stage([scene], "red light from the left, blue light from the right")
    colors = {k: e for k, e in addition.plan.entries.items() if k.startswith("light/") and k.endswith("/color")}
    words = {"'red'" if e.start[0] > e.start[2] else "'blue'": e.reason for e in colors.values()}
    assert words == {"'red'": "'red'", "'blue'": "'blue'"}


def test_behind_a_silhouette_it_is_bright(scene):
    """A silhouette's low exposure is the subject's own, and dims no light behind it."""
    from proxy_renderer.render.lights.light_types import light_sources
    from proxy_renderer.scene.values import RenderValues

    addition = set_stage([scene], "silhouette")
    lit = addition.scenes[0]
    values = {key: torch.tensor(entry.start) for key, entry in addition.plan.entries.items()}
    stage = LightStage(lit, geometry_of(lit, torch.device("cpu")))
    lamp = next(x for x in light_sources(lit, RenderValues(lit, values, "cpu")) if x.light.added)
    gray = Exposing(lit).gray(0.18)
    assert _hot_spot(stage.around, _shed(lamp, stage, stage.around)) > gray


def test_the_light_behind_a_silhouette_does_not_bleach_what_lies_in_it(scene, monkeypatch):
    """A watch on a floor, seen from above, gets as much of it as the floor."""

    def lying(*given):
        stage = LightStage(*given)
        stage.subject = stage.around
        return stage

    def power():
        addition = set_stage([scene], "silhouette")
        (added,) = (light.name for light in addition.scenes[0].lights if light.added)
        return addition.plan.entries[f"light/{added}/power"].start[0]

    standing = power()
    monkeypatch.setattr("proxy_renderer.rigs.lighting.LightStage", lying)
    assert power() < 0.25 * standing
