# SPDX-License-Identifier: Apache-2.0
"""The lighting of a scene by a rig: added lights, a plan for everything that sheds light, and claims on the image."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import torch

from ..color import arrays
from ..color.floats import hex_from_srgb, linear_from_srgb, luminance, mixed, srgb_from_hex, srgb_from_linear
from ..planning.glow import glows
from ..planning.light_levels import kelvin_color
from ..planning.ranges import within
from ..planning.types import LightPlan, PlanEntry
from ..render.material.inputs import geometry_of
from ..scene import SceneData
from ..schema import Instance, Values, orbit, radiometry
from ..schema.added_lights import CARD, CARD_AWAY, card
from ..words.lexicon.rigs import Rig
from ..words.types import GLOW, Attribute, Parsed
from .chosen import ChosenRig, sky_color_of
from .levels import GRAY, Exposing, Levels, measured
from .places import BRIGHTNESS, Placed, placed, shared_names
from .shown import wishes_of_rig
from .stage import LightStage

OFF = 2e-3  # W per squared meter of distance: power of an added light that is off
# How far a search may go from the rig's values: factors, and degrees
_DRIFT = {"power": 1.5, "strength": 1.5, "size": 1.25, "temperature": 1.06}
_TURN = {"azimuth": 5.0, "elevation": 4.0}
_ASPECTS = {"color": "color", "temperature": "color", "azimuth": "direction", "elevation": "direction"}
"""Parameter of a light -> the aspect of light that it gives."""
_FIRST, _LATER = 1, 4  # priorities of brightness, and of what else a light has
_POOL_MARGIN, _WIDEST = 1.5, 140.0
_GLOWS, _OF_GLOWS = 0.15, 0.5
"""Share of the key's light from which a glowing surface counts as a light; share of the stops by which it is then dimmed."""
_LAMPS = 0.7  # greatest light of a glowing surface at night, as a share of the key's
# least share of its wanted light on the subject; a world that gives less at full strength is shut out
_FAINT = 0.02
_FULL = 8.0  # the most strength of a world
# entries for air that is not clear; share of gray in its sky
_HAZES, _VEIL = ("haze", "mist", "fog", "smoke"), 0.5
_DARK_HAZE = 0.4
"""Albedo of haze at night. Thick haze is albedo / 4 as bright as a white surface in the same light: about L* 38."""
_BARELY = 1e-7
_SPREAD, _TOWARDS = 0.6, 0.35
"""Stops by which a sky is darker at the top and lighter at the horizon, and the share of other colors there."""
_GEL = 0.7  # share of a color's white, its least component, that a light of that color lacks
_GRAY_SKY = "#808080"
_NEUTRAL = 6500.0  # kelvins of white light


@dataclass(frozen=True)
class Lighting:
    """A rig in a scene: the shots with the lights that they get, and notes on which light plays which part."""

    scenes: list[SceneData]
    plan: LightPlan
    notes: tuple[str, ...]
    parts: Mapping[str, str]  # light -> the part that it plays


def lighting(scenes: Sequence[SceneData], parsed: Parsed, chosen: ChosenRig, add: bool = True) -> Lighting:
    """Sets a rig up in one or several shots, by what the first sees; `add` allows lights that the scene lacks."""
    rig = chosen.rig
    first = scenes[0]
    stage = LightStage(first, geometry_of(first, torch.device("cpu")))
    lights = placed(rig.lights, stage, add, chosen.anew)
    scenes = [_with_cards(_with_lights(scene, lights, stage), lights) for scene in scenes]
    # without a backdrop, the camera would see the world as bright as its fill light needs it
    if (rig.sky, rig.world) != (None, None) and all(scene.may_have_backdrop for scene in scenes):
        scenes = [scene.with_backdrop() for scene in scenes]
    scene = scenes[0]
    values = _trial(scene, lights, stage, rig.world_color if rig.world is not None else "")
    ambient = scene.value("world/strength", (0.0,))[0] * _world_luminance(scene, {})
    levels = measured(scene, stage, lights, values, rig, ambient)
    hazy = _is_hazy(parsed)
    if rig.sky_color and hazy:  # a sky behind haze is paler
        rig = replace(rig, sky_color=_veiled(rig.sky_color))
    playing = {each.name for each in lights} | {name for a in parsed.attributes for name in a.lights}
    burning = _burning(scene, lights)
    playing |= burning.keys()
    values = _balanced(scene, rig, lights, playing, values, levels)
    values |= _sky(scene, rig, hazy) | _air(scene, rig, parsed, chosen.served)
    for name, lamp in burning.items():  # the same color as that of the rig's light
        shape = {f"light/{name}/{key}": value for key, value in _shape(lamp, stage).items()}
        values |= {key: value for key, value in shape.items() if key in scene.instances}
    values = {key: value for key, value in values.items() if not scene.instances[key].locked}
    parts = {x.name: x.light.part for x in lights}
    still = {each.name for each in lights if each.fixed or each.own}
    any_side = any(each.light.mirrored and not each.fixed for each in lights[:1])
    entries = {}
    for key, value in values.items():
        instance = scene.instances[key]
        word = _word_for(chosen, parts.get(instance.owner, ""), instance.parameter.name)
        entries[key] = _entry(instance, value, word, still, any_side)
    if any_side:
        entries |= _of_own(scene, lights)
    grade = tuple((chosen.served[0], effect) for effect in rig.grade) if chosen.served else ()
    plan = LightPlan(entries, chosen.served, grade, wishes_of_rig(chosen, lights, stage))
    whose = {True: "your light", False: "an added light"}
    notes = (f"{x.light.part.capitalize()}: {x.name}, {whose[x.own]}." for x in lights)
    return Lighting(list(scenes), plan, (f"Light: {rig.says}", *notes), parts)


def _with_lights(scene: SceneData, lights: Sequence[Placed], stage: LightStage) -> SceneData:
    """A scene with the rig's lights that it lacks, off, but at their places."""
    mine = {each.name: each for each in lights if not each.own}
    lit = scene.with_lights(mine)
    instances = dict(lit.instances)
    for each in mine.values():
        shape = _shape(each, stage)
        for key, instance in lit.instances.items():
            if instance.parameter.group != "light" or instance.owner != each.name:
                continue
            name = instance.parameter.name
            value = (OFF * instance.reference,) if name in ("power", "strength") else shape.get(name)
            instances[key] = replace(instance, value=value) if value else instance
    return replace(lit, instances=instances)


def _with_cards(scene: SceneData, lights: Sequence[Placed]) -> SceneData:
    """A scene with the cards by which added lights cast patterns, as Blender builds them."""
    for each in lights:
        size = next((light.card for light in scene.lights if light.name == each.name), 0.0)
        if each.light.pattern and size and not each.own:
            right, up, toward = np.array(orbit.frame(each.azimuth, each.elevation)).T
            middle = np.array(scene.pivot) + CARD_AWAY * size * toward
            quads = np.array(card(each.light.pattern, size))  # (Q, 4, 2)
            scene = scene.with_card(CARD, middle + quads[..., :1] * right + quads[..., 1:] * up)
    return scene


def _shape(each: Placed, stage: LightStage) -> dict[str, Values]:
    """Parameter name -> value of a rig's light, for all parameters but its power."""
    light = each.light
    found: dict[str, Values] = {}
    if light.color or light.kelvin or not each.own:
        found = {"color": (1.0, 1.0, 1.0), "temperature": (light.kelvin or _NEUTRAL,)}
    if light.color:
        linear = linear_from_srgb(srgb_from_hex(light.color))
        pale = _GEL * min(linear)
        found["color"] = tuple(max(v - pale, 0.0) / max(max(linear) - pale, 1e-6) for v in linear)
    if not each.own:
        found |= {"azimuth": (each.azimuth,), "elevation": (each.elevation,)}
    if each.type == "SUN":
        return found | {"angle": (light.size,)}
    if each.own:  # a lamp of the scene keeps its size
        return found
    found |= {"distance": (each.distance,), "size": (light.size * stage.radius,)}
    if each.type == "SPOT":
        pool = 1.0 if light.reach == "subject" else _POOL_MARGIN
        opening = 2 * math.degrees(math.atan(pool * 1.2 * stage.radius / each.distance))
        found["cone"] = (min(max(opening, 8.0), _WIDEST),)
    return found


def _trial(scene: SceneData, lights: Sequence[Placed], stage: LightStage, world_color: str) -> dict[str, Values]:
    """Trial values of lights and world, by which the light of each can be measured."""
    values: dict[str, Values] = {}
    for each in lights:
        key = f"light/{each.name}/"
        energy = (radiometry.unit_energy(each.type, max(each.distance, 1e-3)),)
        for name, value in {**_shape(each, stage), "power": energy, "strength": energy}.items():
            instance = scene.instances.get(key + name)
            if instance and not instance.locked:
                values[key + name] = value
        if f"{key}temperature" not in scene.instances and each.light.kelvin and f"{key}color" in values:
            values[f"{key}color"] = kelvin_color(each.light.kelvin)
    if world_color:
        linear = linear_from_srgb(srgb_from_hex(world_color))
        tint = tuple(v / max(luminance(linear), 1e-3) for v in linear)  # of a linked environment
        world = _within(scene, {"world/color": linear, "world/tint": tint})
        values |= {key: value for key, value in world.items() if not scene.instances[key].locked}
    return values


def _balanced(
    scene: SceneData, rig: Rig, lights: Sequence[Placed], playing: set[str], values: dict[str, Values], levels: Levels
) -> dict[str, Values]:
    """Values with the powers that the rig's ratios ask for, its world and its sky, and the scene's other lights dimmed."""
    out = dict(values)
    for each in lights:
        for key in (f"light/{each.name}/power", f"light/{each.name}/strength"):
            if key in out and each.own and not levels.factors[each.name]:
                out[key] = scene.value(key)  # it reaches no measured point, but it stays on
            elif key in out:
                out[key] = (out[key][0] * levels.factors[each.name],)
    if rig.world is not None and "world/strength" in scene.instances:
        wanted = levels.key * 2.0**rig.world
        shed = levels.world * _world_luminance(scene, out)
        own = scene.value("world/strength")[0]
        shut_out = _FULL * shed < _FAINT * wanted
        out["world/strength"] = (min(own, 1.0),) if shut_out else (min(wanted / max(shed, _BARELY), _FULL),)
    if lights:
        out |= _dimmed(scene, rig, playing, levels.key / math.pi)
    return out


def _world_luminance(scene: SceneData, values: Mapping[str, Values], part: str = "") -> float:
    """Luminance of the world at strength 1, or of its backdrop, for a `part` of "backdrop_"."""
    key = f"world/{part}color"
    if key in scene.instances:
        return luminance(values.get(key, scene.value(key)))
    picture = scene.world.backdrop if part and scene.world.backdrop is not None else scene.world.image
    tint = luminance(values.get(f"world/{part}tint", scene.value(f"world/{part}tint", (1.0, 1.0, 1.0))))
    return tint * (arrays.sphere_luminance(picture) if picture is not None else 0.5)


def _sky(scene: SceneData, rig: Rig, hazy: bool) -> dict[str, Values]:
    """Values for the sky to be displayed with the rig's color and lightness; a color that cannot be so light is darker."""
    if rig.sky is None or "world/backdrop_strength" not in scene.instances:
        return {}
    color = linear_from_srgb(srgb_from_hex(_sky_color(rig)))
    scale = min(GRAY * 2.0**rig.sky / max(luminance(color), _BARELY), 1.0 / max(color))
    shown = tuple(v * scale for v in color)
    exposing = Exposing(scene)
    if "world/backdrop_color" in scene.instances:
        has_horizon = "world/backdrop_horizon" in scene.instances
        ends = _ends_of_sky(rig, shown, hazy) if has_horizon else (shown, shown)
        top, horizon = (exposing.color(end) for end in ends)
        strength = max(*top, _BARELY)
        found = {"world/backdrop_color": tuple(v / strength for v in top)}
        tint = tuple(h / max(t, _BARELY) for h, t in zip(horizon, top, strict=True))
        found |= _within(scene, {"world/backdrop_horizon": tint})
    else:
        light = exposing.color(shown)
        pure = tuple(v / max(luminance(light), _BARELY) for v in light)
        found = _within(scene, {"world/backdrop_tint": pure})
        strength = luminance(light) / max(_world_luminance(scene, found, "backdrop_"), _BARELY)
    return found | _within(scene, {"world/backdrop_strength": (strength,)})


def _ends_of_sky(rig: Rig, shown: Values, hazy: bool) -> tuple[Values, Values]:
    """Display colors at the sky's top and at its horizon, which is lighter than the top.

    The top of a clear sky is nearer to the color of the world's light, and its horizon to that of the key.
    """
    clear = rig.sky_color and not hazy
    spread = _SPREAD * max(1.0 - luminance(shown), 0.0)
    ends = []
    for color, stops in ((rig.world_color, -spread), (_key_color(rig), spread)):
        mix = linear_from_srgb(srgb_from_hex(color)) if color and clear else shown
        alike = luminance(shown) / max(luminance(mix), _BARELY)
        pairs = zip(shown, mix, strict=True)
        end = [(own + _TOWARDS * (alike * other - own)) * 2.0**stops for own, other in pairs]
        ends.append(tuple(v / max(*end, 1.0) for v in end))
    return ends[0], ends[1]


def _key_color(rig: Rig) -> str:
    key = next(iter(rig.lights), None)
    if key is None or key.color:
        return key.color if key else ""
    return hex_from_srgb(srgb_from_linear(kelvin_color(key.kelvin or _NEUTRAL)))


def _sky_color(rig: Rig) -> str:
    return rig.sky_color or rig.world_color or _GRAY_SKY


def _is_hazy(parsed: Parsed) -> bool:
    return any(a.entry in _HAZES and not a.negated for a in parsed.attributes)


def _veiled(color: str) -> str:
    srgb = srgb_from_hex(color)
    gray = srgb_from_linear((luminance(linear_from_srgb(srgb)),) * 3)
    return hex_from_srgb(mixed(srgb, gray, _VEIL))


def _within(scene: SceneData, values: dict[str, Values]) -> dict[str, Values]:
    """Values of parameters that the scene has, at most the parameters' upper bounds."""
    return {
        key: tuple(min(v, high) for v, high in zip(value, scene.instances[key].upper, strict=True))
        for key, value in values.items()
        if key in scene.instances
    }


def _air(scene: SceneData, rig: Rig, parsed: Parsed, served: Sequence[Attribute]) -> dict[str, Values]:
    """Values for the air: the rig's density unless a word is about it; haze has the named sky's color, and is dark at night."""
    density, color = (scene.instances.get(f"volume/{name}") for name in ("density", "color"))
    said = any(a.slot == "atmosphere" and not a.cause and a not in served for a in parsed.attributes)
    found: dict[str, Values] = {}
    if not (rig.air is None or density is None or density.locked or said):
        found[density.key] = (rig.air * density.reference,)
    if color and not color.locked and _is_hazy(parsed):
        colored = any(a.kind == "fog" and a.color for a in parsed.attributes)
        named = sky_color_of(parsed.attributes) is not None
        if not colored and (rig.has_dark_sky or named):
            red, _, blue = srgb_from_hex(_key_color(rig) or _GRAY_SKY)
            # In the blue haze of a night the glow of a warm lamp would be gray.
            lamplit = rig.has_dark_sky and not named and red > blue
            tint = (1.0, 1.0, 1.0) if lamplit else linear_from_srgb(srgb_from_hex(_sky_color(rig)))
            scale = _DARK_HAZE / max(luminance(tint), _BARELY) if rig.has_dark_sky else color.value[0] / max(tint)
            found[color.key] = tuple(min(scale * v, 1.0) for v in tint)
    return found


def _dimmed(scene: SceneData, rig: Rig, playing: set[str], white: float) -> dict[str, Values]:
    """Dimmed values of the scene's own lights and glowing surfaces that play no part in the rig.

    `white` is the radiance of a white surface in the key's light.
    """
    found: dict[str, Values] = {}
    if not rig.own:
        return found
    for key, instance in scene.instances.items():
        if instance.parameter.family in BRIGHTNESS and instance.owner not in playing:
            found[key] = (instance.value[0] * 2.0**rig.own,)
    subject = {material.name for material in scene.materials if material.role == "subject"}
    for material, glow in glows(scene).items():
        key, color = f"material/{material}/emission", f"material/{material}/emission_color"
        if key not in scene.instances or f"{GLOW}{material}" in playing:
            continue
        own = scene.instances[key].value[0]
        tint = luminance(scene.value(color, (1.0, 1.0, 1.0)))
        shed = own * tint * luminance(glow.color) * glow.strength * glow.light
        if rig.has_dark_sky:  # glowing surfaces are lamps then, and must not outshine the key
            if material not in subject and shed > _LAMPS * white:  # a lantern stays lit
                found[key] = (own * _LAMPS * white / shed,)
        elif shed > _GLOWS * white:
            found[key] = (own * 2.0 ** (rig.own * _OF_GLOWS),)
    return found


def _burning(scene: SceneData, lights: Sequence[Placed]) -> dict[str, Placed]:
    """The scene's other lights that share a name with a light of the rig, each with that light: a street has several lamps.

    A shared name that is only the type of the light, such as "Spot", does not count.
    """
    found: dict[str, Placed] = {}
    playing = {each.name for each in lights}
    free = [x for x in scene.lights if x.type != "SUN" and x.name not in playing]
    for each in lights:
        mine = (x.name for x in free if shared_names(each.light, x) - {x.type.lower()})
        found |= dict.fromkeys(mine, replace(each, own=True))
    return found


def _word_for(chosen: ChosenRig, part: str, name: str) -> str:
    """The word that is the reason for a parameter's value in a part of the rig.

    It is the word that asks for this aspect of the part, or else the one that adds the part, or else the setup, or else the
    first word about the part.
    """
    of_part = {word: aspects for word, (parts, aspects) in chosen.words.items() if part in parts}
    last = sorted(of_part, key=lambda word: "rim" in of_part[word])  # words that add the part
    asking = [word for aspect in (_ASPECTS.get(name), "rim") for word in last if aspect in of_part[word]]
    setups = (word for word, (parts, _) in chosen.words.items() if not parts)
    return next(iter([*asking, *setups, *of_part, *chosen.words]), "")


def _of_own(scene: SceneData, lights: Sequence[Placed]) -> dict[str, PlanEntry]:
    """Entries for the angles of the scene's lights that play a part but hang in no lamp: they stay, but variants may vary."""
    free = [x.name for x in lights if x.own and not (x.fixed or x.light.worn)]
    instances = (scene.instances.get(f"light/{name}/{angle}") for name in free for angle in _TURN)
    return {
        i.key: PlanEntry(i.value, i.value, None, "stays where it is", 0.0, usual=True, varies=True)
        for i in instances
        if i and not i.locked
    }


def _entry(instance: Instance, value: Values, word: str, still: set[str], any_side: bool) -> PlanEntry:
    """The range around the value that the rig gives a parameter; the search begins at that value.

    With `any_side`, variants may turn the lights.
    """
    name, reason = instance.parameter.name, f"'{word}'"
    turns = name in _TURN and instance.owner not in still
    if name in _DRIFT:
        ends = tuple(v / _DRIFT[name] for v in value), tuple(v * _DRIFT[name] for v in value)
    elif turns:
        ends = tuple(v - _TURN[name] for v in value), tuple(v + _TURN[name] for v in value)
    else:
        ends = value, value
    lower, upper = (within(end, instance.lower, instance.upper) for end in ends)
    bright = name in ("power", "strength") and instance.parameter.group in ("light", "world")
    priority, start = _FIRST if bright else _LATER, within(value, lower, upper)
    return PlanEntry(lower, upper, priority, reason, 0.0, usual=True, varies=turns and any_side, start=start)
