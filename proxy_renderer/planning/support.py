# SPDX-License-Identifier: Apache-2.0
"""Supporting parameters, which claims may need though no word names them, and lights and a backdrop that the scene lacks.

The subject has to stand out, and be neither overexposed nor black: the paper's own failure is under-exposure of dark materials
(section 4.2). Entries only say how far from the artist's values the search may go; claims decide whether it goes there.
Exposure, lights, world and grade can be supporting parameters, but no materials.
"""

import math
from collections.abc import Iterator, Mapping

from ..color.floats import chroma, lab_from_srgb, linear_from_srgb, luminance, srgb_from_linear
from ..goals.resolve import Goals
from ..schema import Instance, Values
from ..words.lexicon.entries import OWNERS, temperature
from ..words.types import Parsed, SceneDescription
from .acting import Act, acts, is_usual
from .light_levels import Range, Sources, kelvin_color, radiance
from .owners import BACKDROP, Owners
from .ranges import clip, facing_white
from .types import PlanEntry

_LATE = 12  # priority of exposure; parameters that words name have smaller numbers, which come first
_STOPS = 1.5  # stops that exposure may change, up or down
_WORLD = (0.5, 2.0)  # multiples of the strength of the world, and of its backdrop
_AMBIENT = ("world/color", "world/tint")
_ADDED = (64.0, 80.0)  # L* of a white surface that faces a light that is added


def supports(
    parsed: Parsed, instances: dict[str, Instance], sources: Sources, entries: dict[str, PlanEntry], owners: Owners
) -> dict[str, PlanEntry]:
    """Key -> entry of each supporting parameter that words do not name and that is not locked."""
    found = {}
    for key, ((lower, upper), late, why) in _reaches(parsed, instances, sources, owners):
        if entries[key].priority is not None or instances[key].locked:
            continue
        ends = clip(lower, upper, instances[key])
        why = f"supports the words: {why}"
        found[key] = PlanEntry(*ends, _LATE + late, why, prior=0.5, any_hue=key in _AMBIENT)
    why = "supports the words: they ask for a light that the scene lacks"
    for key in (f"light/{name}/power" for name in sources.scene.added_lights):
        # An added light whose power no word sets has to be visible.
        if key in instances and entries[key].priority is None and not instances[key].locked:
            found[key] = PlanEntry(*facing_white(instances[key], *_ADDED, sources), _LATE - 2, why, prior=0.0)
    return found


def _reaches(
    parsed: Parsed, instances: dict[str, Instance], sources: Sources, owners: Owners
) -> Iterator[tuple[str, tuple[Range, int, str]]]:
    """(key, (range, priority minus that of exposure, reason)) of each parameter that may support the words."""
    if BACKDROP in instances:
        yield BACKDROP, (_times(instances[BACKDROP].value, _WORLD), -1, "the subject stands out from it")
    if "film/exposure" in instances:
        ends = _exposures(instances["film/exposure"], sources)
        yield "film/exposure", (ends, 0, "the subject is neither burnt nor black")
    for name in owners.lights.key:
        for key in (f"light/{name}/power", f"light/{name}/strength", f"{name}/emission"):
            if key in instances:
                # black objects need much light
                yield key, (_times(instances[key].value, (0.35, 4.0)), 1, "the subject is readable")
    of_all_light = [a for a in parsed.attributes if a.kind == "light" and not (a.negated or a.of_one_light)]
    several = any(a.is_of_another_light(b) for a in of_all_light for b in of_all_light)
    # the sRGB color that a word gives to light, by a name or by kelvins; words such as "warm" give none
    gels = (
        a.color or (srgb_from_linear(kelvin_color(k)) if (k := temperature(a.entry)) else None) for a in of_all_light
    )
    gel = None if several else next(filter(None, gels), None)
    if "world/strength" in instances:
        times = _WORLD if gel is None else (0.1, _WORLD[1])  # less of a light of another color
        yield "world/strength", (_times(instances["world/strength"].value, times), 2, "shadows are readable")
    for key in _AMBIENT:
        if key in instances and gel is not None:
            color, lit = instances[key].value, linear_from_srgb(gel)
            bright = luminance(color) / max(luminance(lit), 1e-3)
            other = tuple(bright * v for v in lit)  # the light's color, as bright as the artist's
            ends = tuple(map(min, color, other)), tuple(map(max, color, other))
            yield key, (ends, 1, "the light's color is seen in shadows too")
    seen = "subject", "surroundings", "sky", "fog"
    colored = any(a.color and not a.negated and a.kind in seen for a in parsed.attributes)
    if colored and "film/saturation" in instances:  # reflections and the view bleach colors
        ends = _times(instances["film/saturation"].value, (1.0, 1.4))
        yield "film/saturation", (ends, 2, "the named colors are seen")


def _exposures(exposure: Instance, sources: Sources) -> Range:
    """The range of exposures: some stops around the artist's, wider if the present image is all dark or all light."""
    (artist,), (now,) = exposure.value, sources.scene.values.get(exposure.key, exposure.value)
    lower, upper = artist - _STOPS, artist + _STOPS
    if sources.scene.picture and sources.scene.picture.percentiles:
        darkest, _, lightest = (radiance(v, sources.scene.view) for v in sources.scene.picture.percentiles)
        # The darkest twentieth of an image may always come down to L* 50, and the lightest up to 75: a scene may be all black.
        dark, light = (radiance(v, sources.scene.view) for v in (50.0, 75.0))
        lower = min(lower, now + min(math.log2(dark / darkest), 0.0))
        upper = max(upper, now + max(math.log2(light / lightest), 0.0))
    return (lower,), (upper,)


def _times(value: Values, multiples: tuple[float, float]) -> Range:
    low, high = multiples
    return tuple(v * low for v in value), tuple(v * high for v in value)


def added_power(instance: Instance, sources: Sources) -> Values:
    """The power of an added light: the geometric mean of its range."""
    (low,), (high,) = facing_white(instance, *_ADDED, sources)
    return (math.sqrt(low * high),)


def missing_lights(
    goals: Goals, instances: dict[str, Instance], scene: SceneDescription, standby: Mapping[str, str]
) -> list[str]:
    """Names of lights to add for the words, one for each missing role; `standby`: light that may be added -> role."""
    owners, roles = Owners(goals.parsed, instances, scene), list[str]()
    for wish, effect in acts(goals, owners):
        attribute = wish.attribute
        if effect.weak or effect.mode == "times" or OWNERS[effect.owner] != "light" or attribute.lights:
            continue
        role = attribute.role if effect.owner in ("light", "lights") and attribute.role else effect.owner
        if role in ("rim", "fill") and not owners.lights.of_role(role):
            roles.append(role)
        elif role == "others" and not owners.of(effect, attribute):
            roles.append("fill")
    wanted = (role for role in dict.fromkeys(roles) if role in standby.values())
    return [next(name for name in standby if standby[name] == role) for role in wanted]


def asks_for_backdrop(goals: Goals, instances: dict[str, Instance], scene: SceneDescription) -> bool:
    """True if the visible background has to differ from the world that lights the scene.

    That is so if words give the background a vivid color, which would tint the scene, or a lightness that contradicts
    the light that other words ask for. Otherwise a white background lights the scene, too, as in a photographer's
    studio. Effects that a place usually has do not count: a garden at night has the sky of the night.
    """
    owners = Owners(goals.parsed, instances, scene)
    of_world = [
        (wish, effect)
        for wish, effect in acts(goals, owners)
        if effect.family == "world/strength" and owners.of(effect, wish.attribute)
    ]
    seen = [act for act in of_world if act[0].attribute.kind == "surroundings" and not is_usual(*act)]
    shed = [act for act in of_world if act[0].attribute.kind not in ("surroundings", "sky")]
    shown = [wish.attribute.color for wish, effect in seen if effect.mode == "shown"]
    if any(chroma(lab_from_srgb(color)) > 20.0 for color in shown if color):
        return True
    # No strength of the world serves two effects that ask for different lightness.
    pairs = [(a, b) for one in seen for other in shed if (a := _lightness(one)) and (b := _lightness(other))]
    return any(a[1] < b[0] or b[1] < a[0] for a, b in pairs)


def _lightness(act: Act) -> tuple[float, float] | None:
    """(lowest, highest) L* that an effect asks for of the world; None if it asks for none."""
    wish, effect = act
    if effect.mode == "shown" and wish.attribute.color:
        return (lab_from_srgb(wish.attribute.color)[0],) * 2
    return (effect.lower[0], effect.upper[0]) if effect.mode == "lightness" else None
