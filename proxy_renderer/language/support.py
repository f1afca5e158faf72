# SPDX-License-Identifier: Apache-2.0
"""What no word names but pictures need: the subject stands out, and neither is it burnt nor drowned in black.

The paper's own failure is under-exposure of dark materials (section 4.2): these entries are why it does not happen.
"""

from __future__ import annotations

import math

from ..schema import Instance
from .color import chroma, luminance, to_lab, to_srgb
from .owners import Owners
from .ranges import clip, facing_white
from .sources import Sources
from .types import Lab, Parsed, PlanContext, PlanEntry, Region
from .view import lightness, radiance

_LATE = 12  # priority of exposure; what words name comes first
_STAND_OUT = 20.0  # difference in L* at which a subject stands out by lightness alone
_DARK = 30.0  # L* below which two colors look alike
_BEHIND = 68.0  # L* behind a silhouette
_SHADE = 18.0  # the most that L* of a surface that no word names may move
_PALE = 4.0  # chroma by which a color may exceed its name before everything is made more vivid
_STANDS_OUT = "supports the words: the subject stands out from its surroundings"
_STAND_OUT_COLOR = 38.0  # difference in Lab at which it does by color


def supports(
    parsed: Parsed,
    instances: dict[str, Instance],
    sources: Sources,
    entries: dict[str, PlanEntry],
    owners: Owners,
) -> dict[str, PlanEntry]:
    """Entries that replace those of untouched parameters; never those of locked or named ones."""
    free = {k: i for k, i in instances.items() if entries[k].priority is None and not i.locked}
    found = _visibility(parsed, instances, free, sources, owners)
    found |= _key_light(parsed, free, entries, sources, owners)
    if "film/exposure" in free:
        found["film/exposure"] = _exposure(parsed, free["film/exposure"], sources.context)
    if "world/strength" in free and "world/strength" not in found:
        found["world/strength"] = _around(
            free["world/strength"], 0.5, 2.0, _LATE + 2, "keeps the shadows readable"
        )
    if "film/saturation" in free and (entry := _saturation(parsed, free["film/saturation"], sources.context)):
        found["film/saturation"] = entry
    return found | _camera(free)


def _around(instance: Instance, low: float, high: float, priority: int, why: str) -> PlanEntry:
    """May move between multiples of the artist's value."""
    lower, upper = clip(
        tuple(v * low for v in instance.value), tuple(v * high for v in instance.value), instance
    )
    return PlanEntry(lower, upper, priority, f"supports the words: {why}", prior=0.5)


def _visibility(
    parsed: Parsed,
    instances: dict[str, Instance],
    free: dict[str, Instance],
    sources: Sources,
    owners: Owners,
) -> dict[str, PlanEntry]:
    """Moves surroundings that no word names away from the subject's lightness, as far as it takes."""
    context = sources.context
    subject = _expected(parsed, context, "subject")
    around = _expected(parsed, context, "surroundings")
    if subject is None:
        return {}
    around = around or (_unlit(instances, sources, owners), 0.0, 0.0)
    if abs(subject[0] - around[0]) > _STAND_OUT or math.dist(subject, around) > _STAND_OUT_COLOR:
        return {}
    if "surroundings" in parsed.colors or not _movable(free, owners, context):
        return _shaded_subject(parsed, free, subject, around, owners)
    dim = parsed.targets.get("brightness") == "dark"
    gap = 14.0 if dim else 24.0
    lighter = subject[0] < (30 if dim else 50)
    low, high = (subject[0] + gap, 60.0 if dim else 85.0) if lighter else (5.0, max(subject[0] - gap, 12.0))
    # Two darks are one to the eye, so they must part; anything else keeps the artist's color if it can.
    shift = _shifted_albedo if max(subject[0], around[0]) < _DARK else _shaded_albedo
    found = {}
    for key in (f"material/{name}/base_color" for name in owners.materials("surroundings")):
        if key in free:
            found[key] = shift(free[key], low, high)
    if "world/strength" in free and (not found or context.world_share is None or context.world_share > 0.1):
        glow = max(luminance(sources.world_color), 0.02) * 2**sources.exposure
        dimmest, brightest = (radiance(goal, context.view) / glow for goal in (low, high))
        lower, upper = clip((dimmest,), (brightest,), free["world/strength"])
        found["world/strength"] = PlanEntry(lower, upper, _LATE - 1, _STANDS_OUT, prior=0.2)
    return found


def _movable(free: dict[str, Instance], owners: Owners, context: PlanContext) -> bool:
    """Whether something may change how light the surroundings are."""
    seen = [f"material/{name}/base_color" for name in owners.materials("surroundings")]
    return any(k in free for k in seen) or ("world/strength" in free and not owners.world_is_hidden())


def _shaded_subject(
    parsed: Parsed, free: dict[str, Instance], subject: Lab, around: Lab, owners: Owners
) -> dict[str, PlanEntry]:
    """Surroundings that words have settled: a subject that no word colors makes way, by a shade."""
    if "subject" in parsed.colors:
        return {}
    gap = 22.0 if around[0] > 50 else -22.0
    factor = ((max(around[0] - gap, 1.0) + 16) / (subject[0] + 16)) ** 3
    found = {}
    for key in (f"material/{name}/base_color" for name in owners.materials("subject")):
        if key in free:
            now = to_lab(to_srgb(free[key].value))[0]
            goal = (now + 16) * factor ** (1 / 3) - 16
            ends = (goal - 12, goal) if gap > 0 else (goal, goal + 12)
            found[key] = _shifted_albedo(free[key], max(ends[0], 12.0), min(max(ends[1], 20.0), 94.0))
    return found


def _is_silhouette(parsed: Parsed) -> bool:
    return any(a.entry == "silhouette" for a in parsed.attributes)


def _expected(parsed: Parsed, context: PlanContext, region: Region) -> Lab | None:
    """Lab that a region is going to have: what words name, else what the picture shows."""
    if region == "subject" and _is_silhouette(parsed):
        return 8.0, 0.0, 0.0
    named = parsed.colors.get(region)
    shown = context.picture.lab.get(region) if context.picture else None
    if named and shown and region == "surroundings":  # never quite reached
        return (named[0] + shown[0]) / 2, (named[1] + shown[1]) / 2, (named[2] + shown[2]) / 2
    return named or shown


def _unlit(instances: dict[str, Instance], sources: Sources, owners: Owners) -> float:
    """A guess at the surroundings' L* before there is a picture: their albedo's, else the world's."""
    names = owners.materials("surroundings")
    albedos = [i.value for n in names if (i := instances.get(f"material/{n}/base_color"))]
    if albedos:
        return 0.85 * sum(to_lab(to_srgb(v))[0] for v in albedos) / len(albedos)
    strength = instances["world/strength"].value[0] if "world/strength" in instances else 1.0
    return lightness(luminance(sources.world_color) * strength * 2**sources.exposure, sources.context.view)


def _shifted_albedo(instance: Instance, low: float, high: float) -> PlanEntry:
    """The artist's color, scaled so that its L* comes into a range."""
    factors = [_factor(instance, goal) for goal in (low, high)]
    bounds = [tuple(min(max(v, 0.01) * factor, 0.9) for v in instance.value) for factor in factors]
    lower, upper = clip(bounds[0], bounds[1], instance)
    return PlanEntry(lower, upper, _LATE - 1, _STANDS_OUT, prior=0.2)


def _shaded_albedo(instance: Instance, low: float, high: float) -> PlanEntry:
    """From the artist's color to a shade of it nearer to that L*: only as far as the picture asks for."""
    now = to_lab(to_srgb(instance.value))[0]
    goal = min(max(now, low), high)
    factor = _factor(instance, min(max(goal, now - _SHADE), now + _SHADE))
    ends = [tuple(min(v * f, 0.9) for v in instance.value) for f in sorted((1.0, factor))]
    lower, upper = clip(ends[0], ends[1], instance)
    return PlanEntry(lower, upper, _LATE - 1, _STANDS_OUT, prior=0.5)


def _factor(instance: Instance, goal: float) -> float:
    """What the artist's color is multiplied by to have an L*."""
    now = max(to_lab(to_srgb(instance.value))[0], 1.0)
    return ((goal + 16) / (now + 16)) ** 3


def _key_light(
    parsed: Parsed, free: dict[str, Instance], entries: dict[str, PlanEntry], sources: Sources, owners: Owners
) -> dict[str, PlanEntry]:
    """The key may follow the exposure. A white world lights the subject too, so the key steps back; a colored
    one would tint it, so the key has to be the stronger of the two."""
    backdrop = parsed.colors.get("surroundings")
    world = entries.get("world/color")
    found = {}
    for name in owners.key:
        for instance in (free.get(f"light/{name}/{parameter}") for parameter in ("power", "strength")):
            if instance is None:
                continue
            entry = _around(instance, 0.5, 2.0, _LATE + 1, "keeps the subject readable")
            if (
                backdrop
                and world
                and world.priority is not None
                and (backdrop[0] > 85 or chroma(backdrop) > 25)
            ):
                levels = (52.0, 74.0) if backdrop[0] > 85 else (78.0, 88.0)
                lower, upper = facing_white(instance, *levels, sources)
                why = "supports the words: the backdrop's own light must not drown the subject's color"
                entry = PlanEntry(lower, upper, _LATE + 1, why, prior=0.2)
            found[instance.key] = entry
    return found


def _exposure(parsed: Parsed, instance: Instance, context: PlanContext) -> PlanEntry:
    """Within 0.7 stops of the artist's, moved so far that the subject is neither burnt nor black.

    Of a silhouette, it is what is behind it that has to be seen.
    """
    value, shift = instance.value[0], 0.0
    region: Region = "surroundings" if _is_silhouette(parsed) else "subject"
    if context.picture and region in context.picture.lab:
        now = context.picture.lab[region][0]
        named = parsed.colors.get("subject") if region == "subject" else None
        dim = {"dark": -14.0, "bright": 10.0}.get(parsed.targets.get("brightness", ""), 0.0)
        behind = _BEHIND if region == "surroundings" else 50.0
        middle = (named[0] if named else behind) + dim
        low, high = max(middle - 18.0, 8.0 if named else 30.0 + dim), min(middle + 18.0, 90.0)
        goal = min(max(now, low), high)
        if goal != now:
            current = context.values.get(instance.key, instance.value)[0]
            shift = current - value + math.log2(radiance(goal, context.view) / radiance(now, context.view))
    shift = min(max(shift, -1.5), 1.5)
    lower, upper = clip((value + min(shift, 0.0) - 0.7,), (value + max(shift, 0.0) + 0.7,), instance)
    if shift > 0.7:
        lower = (min(value + shift - 0.7, upper[0]),)
    elif shift < -0.7:
        upper = (max(value + shift + 0.7, lower[0]),)
    return PlanEntry(
        lower, upper, _LATE, "supports the words: the subject is neither burnt nor black", prior=0.5
    )


def _saturation(parsed: Parsed, instance: Instance, context: PlanContext) -> PlanEntry | None:
    """Named colors may be strengthened: reflections and the view's shoulder bleach them."""
    missing = []
    for region, wanted in parsed.colors.items():
        shown = context.picture.lab.get(region) if context.picture else None
        if shown and chroma(shown) > _PALE + chroma(wanted):
            return None  # a pale color would become another one
        if chroma(wanted) > 20:
            missing.append(1.0 if shown is None else chroma(shown) / (0.75 * chroma(wanted)))
    if not missing:
        return None
    low, high = (1.25, 1.5) if min(missing) < 0.5 else (1.12, 1.35) if min(missing) < 0.8 else (1.0, 1.25)
    lower, upper = clip((instance.value[0] * low,), (instance.value[0] * high,), instance)
    return PlanEntry(lower, upper, _LATE + 2, "supports the words: the named colors are seen", prior=0.3)


def _camera(free: dict[str, Instance]) -> dict[str, PlanEntry]:
    """A camera that is not locked may look for a better view, last of all and not far."""
    found = {}
    reach = {"azimuth": 30.0, "elevation": 12.0}
    for instance in (i for i in free.values() if i.parameter.group == "camera"):
        name = instance.parameter.name
        if name in reach:
            value = instance.value[0]
            lower, upper = clip((value - reach[name],), (value + reach[name],), instance)
            found[instance.key] = PlanEntry(
                lower, upper, _LATE + 8, "supports the words: a better view", prior=0.5
            )
        else:
            found[instance.key] = _around(instance, 0.85, 1.2, _LATE + 9, "a better view")
    return found
