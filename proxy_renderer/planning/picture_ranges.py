# SPDX-License-Identifier: Apache-2.0
"""Ranges of a scene's values from the wishes of a reference image, next to those of words."""

import math
import operator
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from ..color.floats import linear_from_srgb, srgb_from_lab
from ..goals.relative import goals_with_picture
from ..goals.resolve import CASTS, Goals
from ..goals.wish import Wish
from ..schema import Instance, Values
from ..words.lexicon.entries import OWNERS, Effect
from ..words.lexicon.quantities import ClaimText
from ..words.lexicon.vocabulary import Vocabulary
from .owners import protected
from .ranges import clip
from .types import Plan, PlanEntry

_STRONGER, _WEAKER = 1.6, 0.5
"""Factors on a cast for the ends of a light's range of colors. The strong end exceeds the cast because other light lies over it.
A weak end at white would put hues of no cast into the range: pink and yellow next to orange."""
_FEW_HUES = 0.0  # cosine between the hues of two casts below which each has a light of its own
HELD_LIGHTLY = 0.05  # `PlanEntry.prior` of values that a reference image lets move: of two solutions, the nearer one
UNTOUCHED = "the picture does not speak of it: keeps the artist's value"


@dataclass(frozen=True)
class LightColors:
    """The colors that light may have: a range for each light, between two colors of one hue."""

    key: tuple[Values, Values]  # for key lights: lower and upper end, linear, in [0, 1]
    fill: tuple[Values, Values]  # for all other light, including the world
    paint: float  # least saturation of the film in [0, 1], so that a colorful image keeps the colors of paint


def light_colors(claims: Sequence[ClaimText]) -> LightColors:
    """The colors of light that the claims about casts ask for.

    All light takes the hue of the strongest cast. If another cast is more than 90 degrees of hue apart, as teal is from
    orange, each has a light of its own: the key takes the cast of the image's highlights, and all other light the
    opposite one.
    """
    casts = [_middle(claim) for claim in claims if claim.measure in CASTS] or [(0.0, 0.0)]
    lights = [_middle(claim) for claim in claims if claim.measure == "highlight_cast"]
    strong = [cast for cast in casts if math.hypot(*cast) > 6.0]
    strongest = max(casts, key=lambda cast: math.hypot(*cast))
    key = next((cast for cast in lights if cast in strong), strongest)
    fill = min(strong, key=lambda cast: _cosine(cast, key), default=key)
    if _cosine(key, fill) >= _FEW_HUES:
        key = fill = strongest
    vivid = max((claim.upper[0] for claim in claims if claim.measure == "chroma"), default=0.0)
    paint = min(max(vivid - 6.0, 0.0) / 16.0, 1.0)  # from C* 6 of a gray image on
    return LightColors(_line(key, casts), _line(fill, casts), paint)


def _line(cast: tuple[float, float], casts: Sequence[tuple[float, float]]) -> tuple[Values, Values]:
    """(lower, upper) end of linear light colors: stronger than `cast`, and weaker than all `casts` of a similar hue."""
    alike = [each for each in casts if _cosine(each, cast) >= _FEW_HUES]
    ends = [_color(*cast), *(_color(a, b, _WEAKER) for a, b in alike)]
    return ends[0], tuple(map(max, zip(*ends, strict=True)))


def _middle(claim: ClaimText) -> tuple[float, float]:
    a, b = ((low + high) / 2 for low, high in zip(claim.lower, claim.upper, strict=True))
    return a, b


def _color(a: float, b: float, times: float = _STRONGER) -> Values:
    """Linear color of light for a cast (a*, b*) times a factor, scaled to a largest component of 1."""
    linear = linear_from_srgb(srgb_from_lab((65.0, times * a, times * b)))
    return tuple(v / max(linear) for v in linear)


def _cosine(one: tuple[float, float], other: tuple[float, float]) -> float:
    lengths = math.hypot(*one) * math.hypot(*other)
    return (one[0] * other[0] + one[1] * other[1]) / lengths if lengths > 1e-9 else 1.0


def plan_with_picture(plan: Plan, goals: Goals, instances: Mapping[str, Instance], vocabulary: Vocabulary) -> Plan:
    """A plan of words with the entries of a reference image, if any. Values that words name keep their entries."""
    pictured = goals_with_picture(goals, vocabulary).pictured
    if not pictured:
        return plan
    free = {key: protected(instance, goals.parsed) for key, instance in instances.items()}
    named = {key: entry for key, entry in plan.items() if entry.is_named}
    kept = {k: replace(e, priority=None, reason=UNTOUCHED) for k, e in plan.items() if e.priority is not None}
    return Plan({**plan, **kept, **entries_of(pictured, free), **named}, plan.notes)


def entries_of(pictured: Sequence[Wish], instances: Mapping[str, Instance]) -> dict[str, PlanEntry]:
    """Key -> entry of each value that a reference image's wishes let change; locked values are left out.

    Colors of light are those of the casts that the wishes claim. An image of the same scene has claims for each place
    instead, so its casts are not used. Wishes without claims, as those of an HDRI panorama, name the values themselves.
    """
    claims = [claim for wish in pictured for claim in wish.claims if claim.weight]
    effects = [(wish.attribute.entry, effect) for wish in pictured for effect in wish.effects]
    same, exact = any(claim.measure == "mean" for claim in claims), not any(wish.claims for wish in pictured)
    colors = None if same or exact else light_colors(claims)
    entries = {}
    for key, instance in instances.items():
        family, owners = instance.parameter.family, ("lights", instance.role)
        acting = ((n, e) for n, e in effects if e.family == family and e.owner in (*owners, OWNERS[e.owner]))
        name, effect = next(acting, ("", None))
        if effect is None or instance.locked:
            continue
        lower, upper = _range(effect, instance)
        if exact:
            ends, reason = clip(lower, upper, instance), f"as light comes in {name}"
            entries[key] = PlanEntry(*ends, effect.priority, reason, prior=0.0)
            continue
        if colors and family == "film/saturation":
            lower = (colors.paint,)
        lit = colors if family in ("light/color", "world/color") else None
        if lit:  # the hue of the casts alone, from the artist's brightness up to the weakest cast
            level, (strong, weak) = max(instance.value), lit.key if instance.role == "key" else lit.fill
            lower = tuple(max(level * v, least) for v, least in zip(strong, instance.lower, strict=True))
            ends = lower, tuple(map(min, weak, instance.upper))
        else:
            own = tuple(map(min, lower, instance.value)), tuple(map(max, upper, instance.value))
            ends = clip(*own, instance)
        reason = f"free to come to look like {name}"
        entries[key] = PlanEntry(*ends, effect.priority, reason, HELD_LIGHTLY, any_hue=not lit)
    return entries


def _range(effect: Effect, instance: Instance) -> tuple[Values, Values]:
    """The range of an effect for an instance, in its unit; it may exceed the hard bounds."""
    modes = {"times": operator.mul, "plus": operator.add}
    act = modes.get(effect.mode, lambda _, end: end * instance.reference)
    times = len(instance.value) // len(effect.lower)
    lower, upper = (tuple(map(act, instance.value, end * times)) for end in (effect.lower, effect.upper))
    return lower, upper
