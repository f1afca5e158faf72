# SPDX-License-Identifier: Apache-2.0
"""The lighting of a scene by a rig: added lights, a plan for everything that sheds light, and claims on the image."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product

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
from ..schema import Values, orbit, radiometry
from ..schema.added_lights import CARD, CARD_AWAY, card
from ..words.lexicon.rigs import Rig
from ..words.types import GLOW, Attribute, Parsed
from .chosen import ChosenRig
from .combined import sky_color_of
from .levels import GRAY, Exposing, Levels, measured
from .places import BRIGHTNESS, Placed, placed, shared_names
from .shown import wishes_of_rig
from .stage import LightStage

OFF = 2e-3  # W per squared meter of distance: power of an added light that is off
# How far a search may go from the rig's values: factors, and degrees
_DRIFT = {"power": 1.5, "strength": 1.5, "size": 1.25, "temperature": 1.06}
_TURN = {"azimuth": 5.0, "elevation": 4.0}
_FULL = 8.0  # the most strength of a world
_BARELY = 1e-7
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
    """Sets a rig up in one or several shots, by the view of the first one; `add` allows lights that the scene lacks."""
    rig = chosen.rig
    first = scenes[0]
    stage = LightStage(first, geometry_of(first, torch.device("cpu")))
    lights = placed(rig.lights, stage, add, chosen.anew)
    scenes = [_with_lights(scene, lights, stage) for scene in scenes]
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
    names, burning = {each.name for each in lights}, dict[str, Placed]()
    for each, own in product(lights, scene.lights):
        # The scene's other lamps of the rig's names burn, too: a street has several. A name that is only a type does not count.
        if own.type != "SUN" and own.name not in names and shared_names(each.light, own) - {own.type.lower()}:
            burning[own.name] = replace(each, own=True)
    playing = names | burning.keys() | {name for a in parsed.attributes for name in a.lights}
    values = _balanced(scene, rig, lights, playing, values, levels)
    values |= _sky(scene, rig, hazy) | _air(scene, rig, parsed, chosen.served)
    for name, lamp in burning.items():  # the same color as that of the rig's light
        shape = {f"light/{name}/{key}": value for key, value in _shape(lamp, stage).items()}
        values |= {key: value for key, value in shape.items() if key in scene.instances}
    grade = tuple((chosen.served[0], effect) for effect in rig.grade) if chosen.served else ()
    entries = _entries(scene, chosen, lights, values)
    plan = LightPlan(entries, chosen.served, grade, wishes_of_rig(chosen, lights, stage))
    whose = {True: "your light", False: "an added light"}
    notes = (f"{x.light.part.capitalize()}: {x.name}, {whose[x.own]}." for x in lights)
    return Lighting(list(scenes), plan, (f"Light: {rig.says}", *notes), {x.name: x.light.part for x in lights})


def _with_lights(scene: SceneData, lights: Sequence[Placed], stage: LightStage) -> SceneData:
    """A scene with the rig's lights that it lacks, off but in place, and with the cards (masks) that cast patterns."""
    mine = {each.name: _shape(each, stage) for each in lights if not each.own}
    lit = scene.with_lights(mine)
    instances = dict(lit.instances)
    for key, instance in lit.instances.items():
        if instance.parameter.group == "light" and instance.owner in mine:
            name = instance.parameter.name
            off = (OFF * instance.reference,) if name in ("power", "strength") else None
            value = off or mine[instance.owner].get(name)
            instances[key] = replace(instance, value=value) if value else instance
    lit = replace(lit, instances=instances)
    for each in lights:
        size = next((light.card for light in lit.lights if light.name == each.name), 0.0)
        if each.light.pattern and size and not each.own:  # a card as Blender builds it
            right, up, toward = np.array(orbit.frame(each.azimuth, each.elevation)).T
            middle = np.array(scene.pivot) + CARD_AWAY * size * toward
            quads = np.array(card(each.light.pattern, size))  # (Q, 4, 2)
            lit = lit.with_card(CARD, middle + quads[..., :1] * right + quads[..., 1:] * up)
    return lit


def _shape(each: Placed, stage: LightStage) -> dict[str, Values]:
    """Parameter name -> value of a rig's light, for all parameters but its power."""
    light = each.light
    found: dict[str, Values] = {}
    if light.color or light.kelvin or not each.own:
        found = {"color": (1.0, 1.0, 1.0), "temperature": (light.kelvin or _NEUTRAL,)}
    if light.color:
        linear = linear_from_srgb(srgb_from_hex(light.color))
        pale = 0.7 * min(linear)  # of a color's white, a light of that color lacks most
        found["color"] = tuple(max(v - pale, 0.0) / max(max(linear) - pale, 1e-6) for v in linear)
    if not each.own:
        found |= {"azimuth": (each.azimuth,), "elevation": (each.elevation,)}
    if each.type == "SUN":
        return found | {"angle": (light.size,)}
    if each.own:  # a lamp of the scene keeps its size
        return found
    found |= {"distance": (each.distance,), "size": (light.size * stage.radius,)}
    if each.type == "SPOT":
        pool = 1.0 if light.reach == "subject" else 1.5
        opening = 2 * math.degrees(math.atan(pool * 1.2 * stage.radius / each.distance))
        found["cone"] = (min(max(opening, 8.0), 140.0),)
    return found


def _trial(scene: SceneData, lights: Sequence[Placed], stage: LightStage, world_color: str) -> dict[str, Values]:
    """Key -> trial value of the rig's lights and of the world, with which the light of each can be measured."""
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
    """Key -> value: the trial `values` with lights in the rig's ratios and a world of the rig's strength.

    The scene's lights that are not in `playing` are dimmed.
    """
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
        shut_out = _FULL * shed < 0.02 * wanted  # hardly any of its light reaches the subject
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
    """Key -> value to display the sky in the rig's color and lightness; a color that cannot be so light is darker."""
    if rig.sky is None or "world/backdrop_strength" not in scene.instances:
        return {}
    color = linear_from_srgb(srgb_from_hex(_sky_color(rig)))
    scale = min(GRAY * 2.0**rig.sky / max(luminance(color), _BARELY), 1.0 / max(color))
    shown = tuple(v * scale for v in color)
    exposing = Exposing(scene)
    if "world/backdrop_color" in scene.instances:
        # The horizon is lighter than the top, and nearer to the color of the key; the top to that of the world's light.
        ends, spread = [shown, shown], 0.6 * max(1.0 - luminance(shown), 0.0)
        if "world/backdrop_horizon" in scene.instances:
            colors = (rig.world_color, _key_color(rig)) if rig.sky_color and not hazy else ("", "")
            ends = [_tinged(shown, color, way * spread) for color, way in zip(colors, (-1, 1), strict=True)]
        top, horizon = map(exposing.color, ends)
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


def _tinged(shown: Values, color: str, stops: float) -> Values:
    """A linear display color, mixed by about a third with `color` ("#rrggbb"; "" for none), and lighter by `stops`."""
    mix = linear_from_srgb(srgb_from_hex(color)) if color else shown
    alike = luminance(shown) / max(luminance(mix), _BARELY)
    end = [(own + 0.35 * (alike * other - own)) * 2.0**stops for own, other in zip(shown, mix, strict=True)]
    return tuple(v / max(*end, 1.0) for v in end)


def _key_color(rig: Rig) -> str:
    key = next(iter(rig.lights), None)
    if key is None or key.color:
        return key.color if key else ""
    return hex_from_srgb(srgb_from_linear(kelvin_color(key.kelvin or _NEUTRAL)))


def _sky_color(rig: Rig) -> str:
    return rig.sky_color or rig.world_color or _GRAY_SKY


def _is_hazy(parsed: Parsed) -> bool:
    return any(a.entry in ("haze", "mist", "fog", "smoke") and not a.negated for a in parsed.attributes)


def _veiled(color: str) -> str:
    srgb = srgb_from_hex(color)
    gray = srgb_from_linear((luminance(linear_from_srgb(srgb)),) * 3)
    return hex_from_srgb(mixed(srgb, gray, 0.5))


def _within(scene: SceneData, values: dict[str, Values]) -> dict[str, Values]:
    """The `values` of parameters that the scene has, by key, at most the parameters' upper bounds."""
    return {
        key: tuple(min(v, high) for v, high in zip(value, scene.instances[key].upper, strict=True))
        for key, value in values.items()
        if key in scene.instances
    }


def _air(scene: SceneData, rig: Rig, parsed: Parsed, served: Sequence[Attribute]) -> dict[str, Values]:
    """Key -> value of the air: the rig's density unless a word is about air; haze in the sky's color, dark at night."""
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
            # Thick haze is albedo / 4 as bright as a white surface in the same light: at night about L* 38.
            scale = 0.4 / max(luminance(tint), _BARELY) if rig.has_dark_sky else color.value[0] / max(tint)
            found[color.key] = tuple(min(scale * v, 1.0) for v in tint)
    return found


def _dimmed(scene: SceneData, rig: Rig, playing: set[str], white: float) -> dict[str, Values]:
    """Key -> value that dims the lights and glowing surfaces without a part in the rig.

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
            if material not in subject and shed > 0.7 * white:  # a lantern stays lit
                found[key] = (own * 0.7 * white / shed,)
        elif shed > 0.15 * white:  # it counts as a light
            found[key] = (own * 2.0 ** (rig.own / 2),)
    return found


def _word_for(chosen: ChosenRig, part: str, name: str) -> str:
    """The word that is the reason for the value of a parameter, `name`, of a light in a part of the rig; "" if none."""
    of_part = {word: asked for word, (parts, asked) in chosen.words.items() if part in parts}
    last = sorted(of_part, key=lambda word: "rim" in of_part[word])  # words that add the part
    aspects = {"color": "color", "temperature": "color", "azimuth": "direction", "elevation": "direction"}
    asking = [word for aspect in (aspects.get(name), "rim") for word in last if aspect in of_part[word]]
    setups = (word for word, (parts, _) in chosen.words.items() if not parts)
    # A word for this aspect of the part, else one that adds the part, else the setup, else the first about the part
    return next(iter([*asking, *setups, *of_part, *chosen.words]), "")


def _entries(
    scene: SceneData, chosen: ChosenRig, lights: Sequence[Placed], values: Mapping[str, Values]
) -> dict[str, PlanEntry]:
    """Key -> entry with a range around the rig's value, where the search begins.

    If the key light may stand on either side, variants may turn lights.
    """
    any_side = any(each.light.mirrored and not each.fixed for each in lights[:1])
    parts = {x.name: x.light.part for x in lights}
    still = {each.name for each in lights if each.fixed or each.own}
    free = {i.key: i for i in scene.instances.values() if not i.locked}
    entries = {}
    for key, value in values.items():
        if key in free:
            instance, name = free[key], free[key].parameter.name
            ends, turns = (value, value), name in _TURN and instance.owner not in still
            if name in _DRIFT:
                ends = tuple(v / _DRIFT[name] for v in value), tuple(v * _DRIFT[name] for v in value)
            elif turns:
                ends = tuple(v - _TURN[name] for v in value), tuple(v + _TURN[name] for v in value)
            lower, upper = (within(end, instance.lower, instance.upper) for end in ends)
            bright = name in ("power", "strength") and instance.parameter.group in ("light", "world")
            reason = f"'{_word_for(chosen, parts.get(instance.owner, ''), name)}'"
            priority, varies, start = 1 if bright else 4, turns and any_side, within(value, lower, upper)
            entries[key] = PlanEntry(lower, upper, priority, reason, 0.0, usual=True, varies=varies, start=start)
    # The scene's lights that play a part but hang in no lamp stay, but variants may vary.
    hanging = [x.name for x in lights if any_side and x.own and not (x.fixed or x.light.worn)]
    for key in (f"light/{name}/{angle}" for name in hanging for angle in _TURN):
        if key in free:
            own = free[key].value
            entries[key] = PlanEntry(own, own, None, "stays where it is", 0.0, usual=True, varies=True)
    return entries
