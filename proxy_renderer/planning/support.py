# SPDX-License-Identifier: Apache-2.0
"""What no word names but claims may need: that the subject stands out, and neither burns nor drowns in black.

The paper's own failure is under-exposure of dark materials (section 4.2): these entries are why it does not happen. They
only say how far from the artist's values the search may look; whether and where to is for the claims. Exposure, lights, world
and grade support the words; no material does (`schema/means.py`).
"""

import math
from collections.abc import Iterator

from ..color.floats import linear_from_srgb, luminance, srgb_from_linear
from ..schema import Instance, Values
from ..words.lexicon.entries import temperature
from ..words.types import Attribute, Parsed
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
    """Entries that replace those of untouched parameters; never those of locked or named ones.

    All of them hold the artist's value, but for the power of a light that is added, which has none.
    """
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
    gel = next((gel for a in of_all_light if (gel := _gel(a))), None)
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
