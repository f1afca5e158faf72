# SPDX-License-Identifier: Apache-2.0
"""A subject that can be told from its surroundings: whichever of the two no word names makes way."""

from __future__ import annotations

import math

from ..color.constants import Lab
from ..color.floats import lab_from_srgb, luminance, srgb_from_linear
from ..prompt.types import Parsed, PlanContext, PlanEntry
from ..schema import Instance
from ..schema.spec import Region
from .display import lightness, radiance
from .owners import BACKDROP, Owners
from .ranges import clip
from .sources import Sources

LATE = 12  # priority of exposure; what words name comes first
_STAND_OUT = 20.0  # difference in L* at which a subject stands out by lightness alone
_DARK = 30.0  # L* below which two colors look alike
_AIRY = 66.0  # L* to which a bright picture's surroundings are darkened at most
_LIGHT = 84.0  # L* of what cannot get much lighter
_STEPS = (0.5, 2.0)  # the most that a world that no word names is dimmed or brightened
_SHADE = 18.0  # the most that L* of a surface that no word names may move
_STANDS_OUT = "supports the words: the subject stands out from its surroundings"
_STAND_OUT_COLOR = 38.0  # difference in Lab at which it does by color


def stand_out(
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
    darkest = _AIRY if parsed.targets.get("brightness") == "bright" else 12.0
    low, high = (
        (subject[0] + gap, 60.0 if dim else 85.0) if lighter else (5.0, max(subject[0] - gap, darkest))
    )
    # Two darks are one to the eye, so they must part; anything else keeps what the artist made if it can.
    merged = max(subject[0], around[0]) < _DARK
    shift = _shifted_albedo if merged else _shaded_albedo
    found = {}
    for key in (f"material/{name}/base_color" for name in owners.materials("surroundings")):
        if key in free:
            found[key] = shift(free[key], low, high)
    behind = _behind(instances)
    if behind in free and (not found or context.world_share is None or context.world_share > 0.1):
        glow = max(luminance(sources.backdrop.color), 0.02) * 2**sources.exposure
        world = free[behind]
        least, most = (0.0, math.inf) if merged else (v * world.value[0] for v in _STEPS)
        ends = (min(max(radiance(goal, context.view) / glow, least), most) for goal in (low, high))
        dimmest, brightest = ends
        lower, upper = clip((dimmest,), (brightest,), world)
        found[behind] = PlanEntry(lower, upper, LATE - 1, _STANDS_OUT, prior=0.2)
    return found


def _behind(instances: dict[str, Instance]) -> str:
    """The strength of what the camera sees of the world."""
    return BACKDROP if BACKDROP in instances else "world/strength"


def _movable(free: dict[str, Instance], owners: Owners, context: PlanContext) -> bool:
    """Whether something may change how light the surroundings are."""
    seen = [f"material/{name}/base_color" for name in owners.materials("surroundings")]
    return any(k in free for k in seen) or (_behind(free) in free and not owners.world_is_hidden())


def _shaded_subject(
    parsed: Parsed, free: dict[str, Instance], subject: Lab, around: Lab, owners: Owners
) -> dict[str, PlanEntry]:
    """Surroundings that words have settled: a subject that no word colors makes way, by a shade."""
    if "subject" in parsed.colors:
        return {}
    colors = [k for n in owners.materials("subject") if (k := f"material/{n}/base_color") in free]
    albedos = {key: lab_from_srgb(srgb_from_linear(free[key].value))[0] for key in colors}
    gap = 22.0 if around[0] > 50 or min(albedos.values(), default=0.0) > _LIGHT else -22.0
    factor = ((max(around[0] - gap, 1.0) + 16) / (subject[0] + 16)) ** 3
    found = {}
    for key, now in albedos.items():
        goal = (now + 16) * factor ** (1 / 3) - 16
        ends = (goal - 12, goal) if gap > 0 else (goal, goal + 12)
        found[key] = _shaded_albedo(free[key], max(ends[0], 12.0), min(max(ends[1], 20.0), 94.0))
    return found


def is_silhouette(parsed: Parsed) -> bool:
    """Whether the subject is meant to have no light on it."""
    return any(a.entry == "silhouette" for a in parsed.attributes)


def _expected(parsed: Parsed, context: PlanContext, region: Region) -> Lab | None:
    """Lab that a region is going to have: what words name, else what the picture shows."""
    if region == "subject" and is_silhouette(parsed):
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
        return 0.85 * sum(lab_from_srgb(srgb_from_linear(v))[0] for v in albedos) / len(albedos)
    key = _behind(instances)
    strength = instances[key].value[0] if key in instances else 1.0
    return lightness(luminance(sources.backdrop.color) * strength * 2**sources.exposure, sources.context.view)


def _shifted_albedo(instance: Instance, low: float, high: float) -> PlanEntry:
    """The artist's color, scaled so that its L* comes into a range."""
    factors = [_factor(instance, goal) for goal in (low, high)]
    bounds = [tuple(min(max(v, 0.01) * factor, 0.9) for v in instance.value) for factor in factors]
    lower, upper = clip(bounds[0], bounds[1], instance)
    return PlanEntry(lower, upper, LATE - 1, _STANDS_OUT, prior=0.2)


def _shaded_albedo(instance: Instance, low: float, high: float) -> PlanEntry:
    """From the artist's color to a shade of it nearer to that L*: only as far as the picture asks for."""
    now = lab_from_srgb(srgb_from_linear(instance.value))[0]
    goal = min(max(now, low), high)
    factor = _factor(instance, min(max(goal, now - _SHADE), now + _SHADE))
    ends = [tuple(min(v * f, 0.9) for v in instance.value) for f in sorted((1.0, factor))]
    lower, upper = clip(ends[0], ends[1], instance)
    return PlanEntry(lower, upper, LATE - 1, _STANDS_OUT, prior=0.5)


def _factor(instance: Instance, goal: float) -> float:
    """What the artist's color is multiplied by to have an L*."""
    now = max(lab_from_srgb(srgb_from_linear(instance.value))[0], 1.0)
    return ((goal + 16) / (now + 16)) ** 3
