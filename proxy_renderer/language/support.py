# SPDX-License-Identifier: Apache-2.0
"""What no word names but pictures need: the subject stands out, and neither is it burnt nor drowned in black.

The paper's own failure is under-exposure of dark materials (section 4.2): these entries are why it does not happen.
"""

from __future__ import annotations

import math

from ..schema import Instance
from .color import luminance, to_lab, to_srgb
from .owners import Owners
from .ranges import clip
from .types import Lab, Parsed, PlanContext, PlanEntry, Prompts
from .view import radiance

_LATE = 12  # priority of exposure; what words name comes first
_STAND_OUT = 20.0  # difference in L* at which a subject stands out by lightness alone
_STAND_OUT_COLOR = 38.0  # difference in Lab at which it does by color


def supports(
    parsed: Parsed,
    prompts: Prompts,
    instances: dict[str, Instance],
    context: PlanContext,
    entries: dict[str, PlanEntry],
    owners: Owners,
) -> dict[str, PlanEntry]:
    """Entries that replace those of untouched parameters; never those of locked or named ones."""
    free = {k: i for k, i in instances.items() if entries[k].priority is None and not i.locked}
    found = _visibility(parsed, free, entries, context, owners)
    found |= _key_light(parsed, free, owners, context)
    if "film/exposure" in free:
        found["film/exposure"] = _exposure(parsed, free["film/exposure"], context)
    if "world/strength" in free and "world/strength" not in found:
        found["world/strength"] = _around(free["world/strength"], 0.5, 2.0, _LATE + 2, "keeps the shadows readable")
    found |= _camera(free)
    return found


def _around(instance: Instance, low: float, high: float, priority: int, why: str) -> PlanEntry:
    """May move between multiples of the artist's value."""
    lower, upper = clip(
        tuple(v * low for v in instance.value), tuple(v * high for v in instance.value), instance
    )
    return PlanEntry(lower, upper, priority, f"supports the words: {why}", prior=0.5)


def _expected(parsed: Parsed, context: PlanContext, region: str) -> Lab | None:
    """Lab that a region is going to have: what words name, else what the picture shows."""
    if region == "subject" and any(a.entry == "silhouette" for a in parsed.attributes):
        return 8.0, 0.0, 0.0
    if region in parsed.colors:
        return parsed.colors[region]  # type: ignore[index]
    return context.picture.lab.get(region) if context.picture else None  # type: ignore[call-overload]


def _visibility(
    parsed: Parsed,
    free: dict[str, Instance],
    entries: dict[str, PlanEntry],
    context: PlanContext,
    owners: Owners,
) -> dict[str, PlanEntry]:
    """Moves surroundings that no word names away from the subject's lightness."""
    subject, around = _expected(parsed, context, "subject"), _expected(parsed, context, "surroundings")
    if subject is None or "surroundings" in parsed.colors:
        return {}
    if around and (abs(subject[0] - around[0]) > _STAND_OUT or math.dist(subject, around) > _STAND_OUT_COLOR):
        return {}
    dim = parsed.targets.get("brightness") == "dark"
    lighter = subject[0] < (30 if dim else 50)
    reach = (12, 26) if dim else (24, 42)
    low, high = (subject[0] + reach[0], subject[0] + reach[1]) if lighter else (subject[0] - reach[1], subject[0] - reach[0])
    low, high = max(low, 5.0), min(max(high, 10.0), 85.0)
    why = "supports the words: the subject stands out from its surroundings"
    found = {}
    for key in (f"material/{name}/base_color" for name in owners.materials("surroundings")):
        if key in free:
            found[key] = _shifted_albedo(free[key], low, high, why)
    share = context.world_share
    if "world/strength" in free and (not found or share is None or share > 0.1):
        instance = free["world/strength"]
        glow = max(luminance(_world_color(instance, free, entries, context)), 0.02)
        lower, upper = clip(
            (radiance(low, context.view) / glow,), (radiance(high, context.view) / glow,), instance
        )
        found["world/strength"] = PlanEntry(lower, upper, _LATE - 1, why, prior=0.2)
    return found


def _world_color(
    _: Instance, free: dict[str, Instance], entries: dict[str, PlanEntry], context: PlanContext
) -> tuple[float, ...]:
    if "world/color" in free:
        return free["world/color"].value
    entry = entries.get("world/color")
    return entry.upper if entry else (context.environment_luminance,) * 3


def _shifted_albedo(instance: Instance, low: float, high: float, why: str) -> PlanEntry:
    """The artist's color, scaled so that its L* comes into a range."""
    now = max(to_lab(to_srgb(instance.value))[0], 1.0)
    if low <= now <= high:
        low, high = min(low, now), max(high, now)
    bounds = []
    for goal in (low, high):
        factor = (((goal + 16) / 116) ** 3) / (((now + 16) / 116) ** 3)
        bounds.append(tuple(min(max(v, 0.01) * factor, 0.9) for v in instance.value))
    lower, upper = clip(bounds[0], bounds[1], instance)
    return PlanEntry(lower, upper, _LATE - 1, why, prior=0.2)


def _key_light(
    parsed: Parsed, free: dict[str, Instance], owners: Owners, context: PlanContext
) -> dict[str, PlanEntry]:
    """The key may follow the exposure; less so where a white backdrop would burn the subject."""
    found = {}
    for name in owners.key:
        for parameter in ("power", "strength"):
            instance = free.get(f"light/{name}/{parameter}")
            if instance:
                found[instance.key] = _around(instance, 0.5, 2.0, _LATE + 1, "keeps the subject readable")
    return found


def _exposure(parsed: Parsed, instance: Instance, context: PlanContext) -> PlanEntry:
    """Within 0.7 stops of the artist's, moved so far that the subject is neither burnt nor black."""
    value, shift = instance.value[0], 0.0
    if context.picture and "subject" in context.picture.lab:
        now = context.picture.lab["subject"][0]
        named = parsed.colors.get("subject")
        dim = {"dark": -14.0, "bright": 10.0}.get(parsed.targets.get("brightness", ""), 0.0)
        middle = (named[0] if named else 50.0) + dim
        low, high = max(middle - 18.0, 8.0 if named else 30.0 + dim), min(middle + 18.0, 90.0)
        goal = min(max(now, low), high)
        if goal != now and not any(a.entry == "silhouette" for a in parsed.attributes):
            current = context.values.get(instance.key, instance.value)[0]
            shift = current - value + math.log2(radiance(goal, context.view) / radiance(now, context.view))
    shift = min(max(shift, -1.5), 1.5)
    lower, upper = clip((value + min(shift, 0.0) - 0.7,), (value + max(shift, 0.0) + 0.7,), instance)
    if shift > 0.7:
        lower = (min(value + shift - 0.7, upper[0]),)
    elif shift < -0.7:
        upper = (max(value + shift + 0.7, lower[0]),)
    return PlanEntry(lower, upper, _LATE, "supports the words: the subject is neither burnt nor black", prior=0.5)


def _camera(free: dict[str, Instance]) -> dict[str, PlanEntry]:
    """A camera that is not locked may look for a better view, last of all and not far."""
    found = {}
    reach = {"azimuth": 30.0, "elevation": 12.0}
    for instance in (i for i in free.values() if i.parameter.group == "camera"):
        name = instance.parameter.name
        if name in reach:
            value = instance.value[0]
            lower, upper = clip((value - reach[name],), (value + reach[name],), instance)
            found[instance.key] = PlanEntry(lower, upper, _LATE + 8, "supports the words: a better view", prior=0.5)
        else:
            found[instance.key] = _around(instance, 0.85, 1.2, _LATE + 9, "a better view")
    return found
