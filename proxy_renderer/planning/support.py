# SPDX-License-Identifier: Apache-2.0
"""What no word names but pictures need: the subject stands out, and neither is it burnt nor drowned in black.

The paper's own failure is under-exposure of dark materials (section 4.2): these entries are why it does not happen.
"""

from __future__ import annotations

import math
from dataclasses import replace

from ..color.floats import chroma
from ..prompt.types import Parsed, PlanContext, PlanEntry
from ..schema import Instance
from ..schema.spec import Region
from .display import radiance
from .owners import Owners
from .ranges import clip, facing_white
from .sources import Sources
from .standing_out import LATE, is_silhouette, stand_out

_BEHIND = 68.0  # L* behind a silhouette
_FORMING = (82.0, 91.0)  # L* of a white surface that faces the light of a black subject
_ADDED = (64.0, 80.0)  # L* of a white surface that faces a light that is added
_WHITE, _SHOULDER = 93.0, 1.5  # L* of white, and the radiance from which a view shows it with a long shoulder
_PALE = 4.0  # chroma by which a color may exceed its name before everything is made more vivid
_VIVID, _BRIGHT = 30.0, 80.0  # chroma of a color that mirrored light bleaches, L* of what does so
_ALL_AROUND = 0.6  # share of the surroundings that is the world


def supports(
    parsed: Parsed,
    instances: dict[str, Instance],
    sources: Sources,
    entries: dict[str, PlanEntry],
    owners: Owners,
) -> dict[str, PlanEntry]:
    """Entries that replace those of untouched parameters; never those of locked or named ones.

    All of them hold the artist's value: what moves, and how far, is for the claims to say (`claims.wanted`). Only a
    light that is added has no such value.
    """
    free = {k: i for k, i in instances.items() if entries[k].priority is None and not i.locked}
    found = stand_out(parsed, instances, free, sources, owners)
    found |= _key_light(parsed, free, entries, sources, owners)
    if "film/exposure" in free:
        found["film/exposure"] = _exposure(parsed, free["film/exposure"], sources.context)
    if "world/strength" in free and "world/strength" not in found:
        found["world/strength"] = _around(
            free["world/strength"], 0.5, 2.0, LATE + 2, "keeps the shadows readable"
        )
    found |= _mirroring(parsed, free, owners, sources.context)
    if "film/contrast" in free and (entry := _contrast(parsed, free["film/contrast"], sources.context)):
        found["film/contrast"] = entry
    if "film/saturation" in free and (entry := _saturation(parsed, free["film/saturation"], sources.context)):
        found["film/saturation"] = entry
    found |= _camera(free)
    return {key: _from_home(entry, free[key]) for key, entry in found.items()} | _added_lights(free, sources)


def _from_home(entry: PlanEntry, instance: Instance) -> PlanEntry:
    """An entry that reaches from the artist's value to what is supposed to help."""
    home = instance.value
    lower = tuple(map(min, entry.lower, home))
    upper = tuple(map(max, entry.upper, home))
    return replace(entry, lower=lower, upper=upper)


def _around(instance: Instance, low: float, high: float, priority: int, why: str) -> PlanEntry:
    """May move between multiples of the artist's value."""
    lower, upper = clip(
        tuple(v * low for v in instance.value), tuple(v * high for v in instance.value), instance
    )
    return PlanEntry(lower, upper, priority, f"supports the words: {why}", prior=0.5)


def _needs_light(parsed: Parsed) -> bool:
    """Whether the subject is nearly black, and neither it nor the picture is meant to be without light."""
    named = parsed.colors.get("subject")
    dark = parsed.targets.get("brightness") == "dark"
    return named is not None and named[0] < 20 and not dark and not is_silhouette(parsed)


def _key_light(
    parsed: Parsed, free: dict[str, Instance], entries: dict[str, PlanEntry], sources: Sources, owners: Owners
) -> dict[str, PlanEntry]:
    """The key may follow the exposure.

    A white world lights the subject too, so the key steps back; a colored one would tint it, so the key has
    to be the stronger of the two.
    """
    backdrop = parsed.colors.get("surroundings")
    world = entries.get("world/color")
    found = {}
    for name in owners.key:
        keys = [f"light/{name}/power", f"light/{name}/strength"]
        for instance in (free.get(key) for key in ([f"{name}/emission"] if name in owners.glows else keys)):
            if instance is None:
                continue
            entry = _around(instance, 0.5, 2.0, LATE + 1, "keeps the subject readable")
            if _needs_light(parsed):
                lower, upper = facing_white(instance, *_FORMING, sources)
                why = "supports the words: a dark subject needs light to show its form"
                entry = PlanEntry(lower, upper, LATE + 1, why, prior=0.2)
            if (
                backdrop
                and world
                and world.priority is not None
                and (backdrop[0] > 85 or chroma(backdrop) > 25)
            ):
                white = backdrop[0] > 85 and not owners.world_is_hidden()
                levels = (52.0, 74.0) if white else (78.0, 88.0)
                lower, upper = facing_white(instance, *levels, sources)
                why = "supports the words: the backdrop's own light must not drown the subject's color"
                entry = PlanEntry(lower, upper, LATE + 1, why, prior=0.2)
            found[instance.key] = entry
    return found


def _added_lights(free: dict[str, Instance], sources: Sources) -> dict[str, PlanEntry]:
    """A light that the words ask for has to show, whatever else they say of it."""
    why = "supports the words: they ask for a light that the scene lacks"
    keys = (f"light/{name}/power" for name in sources.context.added_lights)
    return {
        key: PlanEntry(*facing_white(free[key], *_ADDED, sources), LATE - 2, why, prior=0.0)
        for key in keys
        if key in free
    }


def _exposure(parsed: Parsed, instance: Instance, context: PlanContext) -> PlanEntry:
    """Within 0.7 stops of the artist's, moved so far that the subject is neither burnt nor black.

    Of a silhouette, it is what is behind it that has to be seen.
    """
    value, shift = instance.value[0], 0.0
    region: Region = "surroundings" if is_silhouette(parsed) else "subject"
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
    return PlanEntry(
        lower, upper, LATE, "supports the words: the subject is neither burnt nor black", prior=0.5
    )


def _contrast(parsed: Parsed, instance: Instance, context: PlanContext) -> PlanEntry | None:
    """Under a view with a long shoulder a lit white wall is gray: contrast lifts it and leaves the subject where it is."""
    backdrop = parsed.colors.get("surroundings")
    if backdrop is None or backdrop[0] < _WHITE or radiance(_WHITE, context.view) < _SHOULDER:
        return None
    value = instance.value[0]
    lower, upper = clip((1.15 * value,), (1.45 * value,), instance)
    return PlanEntry(lower, upper, LATE + 1, "supports the words: white is to look white", prior=0.2)


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
    most = 1.5 if min(missing) < 0.5 else 1.35 if min(missing) < 0.8 else 1.25
    lower, upper = clip(instance.value, (instance.value[0] * most,), instance)
    return PlanEntry(lower, upper, LATE + 2, "supports the words: the named colors are seen", prior=0.3)


def _mirroring(
    parsed: Parsed, free: dict[str, Instance], owners: Owners, context: PlanContext
) -> dict[str, PlanEntry]:
    """Under a white sky all around, mirrored light bleaches a vivid thing: less of it, where no word asks for it."""
    subject, around = parsed.colors.get("subject"), parsed.colors.get("surroundings")
    if not (subject and around) or chroma(subject) < _VIVID or around[0] < _BRIGHT:
        return {}
    if (context.world_share or 0.0) < _ALL_AROUND:
        return {}
    why = "supports the words: the bright surroundings must not bleach the subject's color"
    keys = (f"material/{name}/specular" for name in owners.materials("subject"))
    return {
        key: PlanEntry(*clip((0.1,), (0.2,), free[key]), LATE + 1, why, prior=0.2)
        for key in keys
        if key in free and free[key].value[0] > 0.2
    }


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
                lower, upper, LATE + 8, "supports the words: a better view", prior=0.5
            )
        else:
            found[instance.key] = _around(instance, 0.85, 1.2, LATE + 9, "a better view")
    return found
