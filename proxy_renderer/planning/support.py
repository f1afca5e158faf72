# SPDX-License-Identifier: Apache-2.0
"""Values that claims may need though no word names them, and lights and a backdrop that the scene lacks.

The subject has to stand out, and neither burn nor drown in black: the paper's own failure is under-exposure of dark materials
(section 4.2). Entries only say how far from the artist's values the search may look; whether and where to is for the claims.
Exposure, lights, world and grade support the words; no material does.
"""

import math
from collections.abc import Iterator, Mapping

from ..color.floats import chroma, lab_from_srgb, linear_from_srgb, luminance, srgb_from_linear
from ..goals.resolve import Goals
from ..schema import Instance, Values
from ..words.lexicon.entries import OWNERS, Effect, temperature
from ..words.lexicon.vocabulary import Vocabulary
from ..words.types import Attribute, Parsed, SceneDescription
from .acting import Act, acts, is_usual
from .light_levels import Range, Sources, kelvin_color, radiance
from .owners import BACKDROP, Owners
from .ranges import clip, facing_white
from .types import PlanEntry

_LATE = 12  # priority of exposure; what words name comes first
_STOPS = 1.5  # that exposure may change
_LIGHTEST, _DARKEST = 75.0, 50.0
"""L* that the lightest twentieth of a picture may get at least, and the darkest at most: an artist's scene may be all black."""
_KEY = (0.35, 4.0)  # multiples of the key's power; black things need much light
_WORLD = (0.5, 2.0)  # multiples of the strength of the world, and of what is seen of it
_FAINT = 0.1  # the least multiple of the world's strength where light has a color: what the world sheds has another
_SEEN = ("subject", "surroundings", "sky", "fog")  # kinds of things that have a color of their own
_AMBIENT = ("world/color", "world/tint")
_SATURATION = 1.4  # the most that named colors are strengthened: reflections and the view bleach them
_ADDED = (64.0, 80.0)  # L* of a white surface that faces a light that is added


def supports(
    parsed: Parsed,
    instances: dict[str, Instance],
    sources: Sources,
    entries: dict[str, PlanEntry],
    owners: Owners,
) -> dict[str, PlanEntry]:
    """Entries that replace those of untouched parameters, and hold the artist's value, which an added light's power lacks."""
    reaches = dict(_reaches(parsed, instances, sources, owners))
    free = {key for key in reaches if entries[key].priority is None and not instances[key].locked}
    found = {}
    for key in free:
        (lower, upper), late, why = reaches[key]
        ends = clip(lower, upper, instances[key])
        why = f"supports the words: {why}"
        found[key] = PlanEntry(*ends, _LATE + late, why, prior=0.5, any_hue=key in _AMBIENT)
    return {key: found[key] for key in reaches if key in found} | _added_lights(instances, entries, sources)


def _reaches(
    parsed: Parsed, instances: dict[str, Instance], sources: Sources, owners: Owners
) -> Iterator[tuple[str, tuple[Range, int, str]]]:
    """Keys, and for each how far it may go, how much later than exposure it comes, and why."""
    if BACKDROP in instances:
        yield BACKDROP, (_times(instances[BACKDROP].value, _WORLD), -1, "the subject stands out from it")
    if "film/exposure" in instances:
        ends = _exposures(instances["film/exposure"], sources)
        yield "film/exposure", (ends, 0, "the subject is neither burnt nor black")
    for name in owners.lights.key:
        for key in (f"light/{name}/power", f"light/{name}/strength", f"{name}/emission"):
            if key in instances:
                yield key, (_times(instances[key].value, _KEY), 1, "the subject is readable")
    of_all_light = [a for a in parsed.attributes if a.kind == "light" and not (a.negated or a.of_one_light)]
    several = any(a.is_of_another_light(b) for a in of_all_light for b in of_all_light)
    gel = None if several else next((gel for a in of_all_light if (gel := _gel(a))), None)
    if "world/strength" in instances:
        times = _WORLD if gel is None else (_FAINT, _WORLD[1])
        yield "world/strength", (_times(instances["world/strength"].value, times), 2, "shadows are readable")
    for key in _AMBIENT:
        if key in instances and gel is not None:
            color, lit = instances[key].value, linear_from_srgb(gel)
            bright = luminance(color) / max(luminance(lit), 1e-3)
            other = tuple(bright * v for v in lit)  # the light's color, as bright as the artist's
            ends = tuple(map(min, color, other)), tuple(map(max, color, other))
            yield key, (ends, 1, "the light's color is seen in shadows too")
    colored = any(a.color and not a.negated and a.kind in _SEEN for a in parsed.attributes)
    if colored and "film/saturation" in instances:
        ends = _times(instances["film/saturation"].value, (1.0, _SATURATION))
        yield "film/saturation", (ends, 2, "the named colors are seen")


def _exposures(exposure: Instance, sources: Sources) -> Range:
    """Some stops around the artist's, and as many as a picture that is all dark, or all light, lacks."""
    (artist,), (now,) = exposure.value, sources.scene.values.get(exposure.key, exposure.value)
    lower, upper = artist - _STOPS, artist + _STOPS
    if sources.scene.picture and sources.scene.picture.percentiles:
        darkest, _, lightest = (radiance(v, sources.scene.view) for v in sources.scene.picture.percentiles)
        dark, light = (radiance(v, sources.scene.view) for v in (_DARKEST, _LIGHTEST))
        lower = min(lower, now + min(math.log2(dark / darkest), 0.0))
        upper = max(upper, now + max(math.log2(light / lightest), 0.0))
    return (lower,), (upper,)


def _times(value: Values, multiples: tuple[float, float]) -> Range:
    low, high = multiples
    return tuple(v * low for v in value), tuple(v * high for v in value)


def _gel(attribute: Attribute) -> Values | None:
    """The color that a word gives to light, by its name or by kelvins; None where light is only warm."""
    kelvins = temperature(attribute.entry)
    return attribute.color or (srgb_from_linear(kelvin_color(kelvins)) if kelvins else None)


def added_power(instance: Instance, sources: Sources) -> Values:
    """The power that a light gets in the middle, where words ask for one that the scene lacks."""
    (low,), (high,) = facing_white(instance, *_ADDED, sources)
    return (math.sqrt(low * high),)


def _added_lights(
    instances: dict[str, Instance], entries: dict[str, PlanEntry], sources: Sources
) -> dict[str, PlanEntry]:
    """A light that the words ask for has to show, whatever else they say of it."""
    why = "supports the words: they ask for a light that the scene lacks"
    keys = (f"light/{name}/power" for name in sources.scene.added_lights)
    return {
        key: PlanEntry(*facing_white(instances[key], *_ADDED, sources), _LATE - 2, why, prior=0.0)
        for key in keys
        if key in instances and entries[key].priority is None and not instances[key].locked
    }


def missing_lights(
    goals: Goals,
    instances: dict[str, Instance],
    scene: SceneDescription,
    standby: Mapping[str, str],
    vocabulary: Vocabulary,
) -> list[str]:
    """The lights on standby, given with their roles, that the words ask for."""
    owners, roles = Owners(goals.parsed, instances, scene), list[str]()
    for wish, effect in acts(goals, vocabulary, owners):
        role = _asked(effect, wish.attribute, owners)
        roles += [role] if role and role not in roles else []
    return [
        next(name for name in standby if standby[name] == role) for role in roles if role in standby.values()
    ]


def _asked(effect: Effect, attribute: Attribute, owners: Owners) -> str:
    """The role of the light that an effect needs and that nothing in the scene has; else ""."""
    if effect.weak or effect.mode == "times" or OWNERS[effect.owner] != "light" or attribute.lights:
        return ""
    owner = attribute.role if effect.owner in ("light", "lights") and attribute.role else effect.owner
    if owner in ("rim", "fill"):
        return "" if owners.lights.of_role(owner) else owner
    if owner == "others":
        return "" if owners.of(effect, attribute) else "fill"
    return ""


_VIVID = 20.0  # chroma from which a world tints what it lights


def asks_for_backdrop(
    goals: Goals, instances: dict[str, Instance], scene: SceneDescription, vocabulary: Vocabulary
) -> bool:
    """True if words give the background a color that is not to tint the scene, or a lightness that its light cannot have.

    A white or pale background is a light too, as in a photographer's studio, if no other word wants less light. What a
    place usually has is no such wish: the sky of a garden at night is the night's.
    """
    owners = Owners(goals.parsed, instances, scene)
    of_world = [
        (wish, effect)
        for wish, effect in acts(goals, vocabulary, owners)
        if effect.family == "world/strength" and owners.of(effect, wish.attribute)
    ]
    seen = [act for act in of_world if act[0].attribute.kind == "surroundings" and not is_usual(*act)]
    shed = [act for act in of_world if act[0].attribute.kind not in ("surroundings", "sky")]
    shown = [wish.attribute.color for wish, effect in seen if effect.mode == "shown"]
    tints = any(chroma(lab_from_srgb(color)) > _VIVID for color in shown if color)
    return tints or any(_apart(one, other) for one in seen for other in shed)


def _apart(one: Act, other: Act) -> bool:
    """True if no strength of the world serves both."""
    a, b = _lightness(one), _lightness(other)
    return a is not None and b is not None and (a[1] < b[0] or b[1] < a[0])


def _lightness(act: Act) -> tuple[float, float] | None:
    """The L* that the world is to have, from and to; None where a wish says nothing of it."""
    wish, effect = act
    if effect.mode == "shown" and wish.attribute.color:
        return (lab_from_srgb(wish.attribute.color)[0],) * 2
    return (effect.lower[0], effect.upper[0]) if effect.mode == "lightness" else None
