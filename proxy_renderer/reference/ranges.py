# SPDX-License-Identifier: Apache-2.0
"""How far the values of a scene may go to look like a picture."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

from ..claims.claim import Claim
from ..color.floats import linear_from_srgb, srgb_from_lab
from ..planning.types import PlanEntry
from ..schema import Instance, Values
from ..words.lexicon.entries import Effect, parse_effect

CASTS = ("shadow_cast", "midtone_cast", "highlight_cast", "cast")

_LIGHTNESS = 65.0  # L* at which a cast is taken for a color
_STRONGER, _WEAKER = 1.6, 0.5
"""How much stronger than the strongest cast a light's color may be, since other light lies over it, and how much weaker than
any. A range up to white would hold hues that are in no cast: pink and yellow beside orange."""
_FEW_HUES = 0.0  # cosine between the hues of two casts from where each has a light of its own
_PALE, _COLORFUL = 6.0, 16.0
"""Mean C* up to which a picture is as good as gray, and how much more it has where all paint keeps its saturation."""
_STRONG = 6.0  # C* of a cast whose hue counts


@dataclass(frozen=True)
class LightColors:
    """The colors that light may have: on the line between the two ends of a range, for more than one line has more hues."""

    key: tuple[Values, Values]  # of key lights: lower and upper end, linear, in [0, 1]
    fill: tuple[Values, Values]  # of all other light, that of the world included
    paint: float  # saturation that paint keeps at least, so that a colorful picture makes nothing gray


def light_colors(claims: Sequence[Claim]) -> LightColors:
    """The colors that the casts among some claims ask for.

    All light takes the hue of the strongest cast. Where there is another one more than 90 degrees of hue apart, as teal
    beside orange, each has its own light: the key that of the picture's lights, all other light the opposite one.
    """
    casts = [_middle(claim) for claim in claims if claim.measure in CASTS] or [(0.0, 0.0)]
    lights = [_middle(claim) for claim in claims if claim.measure == "highlight_cast"]
    strong = [cast for cast in casts if math.hypot(*cast) > _STRONG]
    strongest = max(casts, key=lambda cast: math.hypot(*cast))
    key = next((cast for cast in lights if cast in strong), strongest)
    fill = min(strong, key=lambda cast: _cosine(cast, key), default=key)
    if _cosine(key, fill) >= _FEW_HUES:
        key = fill = strongest
    vivid = max((claim.upper[0] for claim in claims if claim.measure == "chroma"), default=0.0)
    paint = min(max(vivid - _PALE, 0.0) / _COLORFUL, 1.0)
    return LightColors(_line(key, casts), _line(fill, casts), paint)


def _line(cast: tuple[float, float], casts: Sequence[tuple[float, float]]) -> tuple[Values, Values]:
    """From a stronger one than a cast to a weaker one than any of its hue."""
    alike = [each for each in casts if _cosine(each, cast) >= _FEW_HUES]
    ends = [_color(*cast), *(_color(a, b, _WEAKER) for a, b in alike)]
    return ends[0], tuple(map(max, zip(*ends, strict=True)))


def _middle(claim: Claim) -> tuple[float, float]:
    a, b = ((low + high) / 2 for low, high in zip(claim.lower, claim.upper, strict=True))
    return a, b


def _color(a: float, b: float, times: float = _STRONGER) -> Values:
    """Linear color of light for so many times a cast, its greatest component 1."""
    linear = linear_from_srgb(srgb_from_lab((_LIGHTNESS, times * a, times * b)))
    return tuple(v / max(linear) for v in linear)


def _cosine(one: tuple[float, float], other: tuple[float, float]) -> float:
    lengths = math.hypot(*one) * math.hypot(*other)
    return (one[0] * other[0] + one[1] * other[1]) / lengths if lengths > 1e-9 else 1.0


HELD_LIGHTLY = 0.05
"""Pull of what a picture lets move to the artist's value: of two ways that look the same, the nearer one."""


def _effects(*texts: str) -> dict[str, Effect]:
    """Family -> what a picture may do to its values, written as in the vocabulary; a bare range holds the artist's value too."""
    return {effect.family: effect for effect in map(parse_effect, texts)}


_ANOTHER_SCENE = _effects(
    "light/power times 0.0625..16 !0", "light/strength times 0.0625..16 !0", "light/color 0.08..1 !1",
    "light/azimuth plus -75..75 !3", "light/elevation plus -35..35 !3",
    "world/strength 0..4 !1", "world/color 0..1 !1", "world/tint 0.05..2 !1",
    "world/backdrop_strength 0..4 !1", "world/backdrop_color 0..1 !1", "world/backdrop_tint 0.05..2 !1",
    "volume/density 0..2 !2", "volume/color 0.1..1 !3",
    "film/grade_exposure -2..2 !2", "film/lift 0.9..1.1 !2", "film/midtone 0.75..1.3 !2", "film/gain 0.7..1.3 !2",
    "film/contrast 0.7..1.4 !2", "film/saturation 0..1.4 !2", "film/grade_gamma 0.6..1.7 !3", "film/vignette 0..1 !3",
    "material/base_color 0..1 !2", "material/tint 0.05..2 !2",
)  # fmt: skip
"""For a picture of another scene."""
_NEEDS = {
    "light/azimuth": "from_right", "light/elevation": "from_above", "volume/density": "veil", "volume/color": "veil",
    "film/vignette": "vignette",
}  # fmt: skip
"""Family -> the measure that such a picture has to claim for it."""

_SAME_SCENE = _ANOTHER_SCENE | _effects(
    "light/power times 0.01..100 !0", "light/strength times 0.01..100 !0", "light/color 0..1 !1",
    "light/temperature 1500..15000 !1", "light/size times 0.1..10 !3", "light/angle 0..60 !3",
    "light/azimuth plus -180..180 !0", "light/elevation -20..89 !0",
    "world/strength 0..10 !1", "world/rotation plus -180..180 !1",
    "volume/density 0..4 !2", "volume/color 0..1 !3", "volume/falloff 0..4 !3",
    "film/exposure plus -4..4 !2", "film/lift 0.7..1.3 !3", "film/midtone 0.6..1.5 !3", "film/gain 0.5..1.6 !3",
    "film/contrast 0.5..2 !2", "film/saturation 0..2 !2", "film/vignette 0..1 !3", "film/glare 0..1 !4",
    "material/roughness 0..1 !4", "material/metallic 0..1 !5",
)  # fmt: skip
"""The same for a picture of the artist's scene. What does the same as exposure, in the compositor, stays."""
_TRAITS = {"light": "light", "world": "light", "volume": "air", "film": "grade", "material": "materials"}
"""Group of parameters -> the trait of a picture that they serve."""

_LIT = ("light/color", "world/color")
"""Families of what colors light: they take the hues of the picture's casts."""

_BESIDE_LIGHT = _effects(
    "film/lift 0.98..1.08 !2",
    "film/midtone 0.85..1.2 !2",
    "film/gain 0.8..1.25 !2",
    "film/contrast 0.7..1.3 !2",
)
"""The grade where the light's color may change, too: what tints gray things is light. A grade that cancels it tints paint, and
a lift that cuts off more colors the shadows."""

_STAYS = {
    "film/exposure": "exposure looks like more or less light in the scene",
    "film/gamma": "gamma looks like the grade's own",
    "light/temperature": "a warm lamp looks like one of a warm color",
    "light/size": "how soft shadows are cannot be told from a flat picture",
    "light/distance": "a lamp that is nearer looks like a stronger one",
    "volume/anisotropy": "where fog scatters looks like more or less of it",
}
"""Families that stay as the artist has them, and why."""


def entries_of(
    instances: Mapping[str, Instance],
    traits: Collection[str],
    measures: Collection[str],
    same: bool,
    name: str,
    colors: LightColors,
) -> dict[str, PlanEntry]:
    """Entries of what a picture lets change, by key; what is locked is left out.

    Args:
        traits: Of the picture that are taken over.
        measures: What is claimed of an image that looks like it.
        same: Whether it shows this very scene.
        colors: That light may have for a picture of another scene.
    """
    table = dict(_SAME_SCENE if same else _ANOTHER_SCENE)
    if same:
        table.pop("film/grade_exposure")
    elif any(i.parameter.family in _LIT and not i.locked and _serves(i, traits) for i in instances.values()):
        table |= _BESIDE_LIGHT
    entries = {}
    for key, instance in instances.items():
        effect, needs = table.get(instance.parameter.family), _NEEDS.get(instance.parameter.family)
        if effect is None or instance.locked or not _serves(instance, traits):
            continue
        if needs and not same and needs not in measures:
            continue
        lower, upper = _range(effect, instance)
        lit = instance.parameter.family in _LIT and not same
        if lit:
            lower, upper = _lit(colors, instance)
        elif instance.parameter.family == "film/saturation" and not same:
            lower, upper = _around((colors.paint,), upper, instance)
        reason = f"free to come to look like {name}"
        entries[key] = PlanEntry(lower, upper, effect.priority, reason, HELD_LIGHTLY, any_hue=not lit)
    return entries


def kept_values(instances: Mapping[str, Instance], entries: Collection[str]) -> tuple[str, ...]:
    """What stays because a picture cannot tell it, one sentence for each family."""
    families = {i.parameter.family for key, i in instances.items() if key not in entries and not i.locked}
    said = (f"{family}: {why}" for family, why in _STAYS.items() if family in families)
    return tuple(f"Kept as you have it, {text}." for text in said)


def _serves(instance: Instance, traits: Collection[str]) -> bool:
    """Whether a value serves what is taken over; the colors of light serve a palette, too."""
    trait = _TRAITS.get(instance.parameter.group, "")
    colors = instance.parameter.group in ("light", "world") or instance.parameter.family == "film/saturation"
    return trait in traits or ("palette" in traits and colors and trait != "materials")


def _lit(colors: LightColors, instance: Instance) -> tuple[Values, Values]:
    """Ends for a color of light, as dark as the artist's or lighter; the artist's own hue is not among them.

    It would open the range to hues between the two, which neither has.
    """
    level = max(instance.value)
    strong, weak = colors.key if instance.role == "key" else colors.fill
    lower = tuple(max(level * v, least) for v, least in zip(strong, instance.lower, strict=True))
    return lower, tuple(map(min, weak, instance.upper))


def _range(effect: Effect, instance: Instance) -> tuple[Values, Values]:
    """The ends for an instance, within its bounds, its own value among them."""
    value, unit, low, high = instance.value, instance.reference, effect.lower[0], effect.upper[0]
    if effect.mode == "times":
        ends = tuple(v * low for v in value), tuple(v * high for v in value)
    elif effect.mode == "plus":
        ends = tuple(v + low for v in value), tuple(v + high for v in value)
    else:
        ends = tuple(low * unit for _ in value), tuple(high * unit for _ in value)
    return _around(*ends, instance)


def _around(lower: Values, upper: Values, instance: Instance) -> tuple[Values, Values]:
    value = instance.value
    return (
        tuple(max(min(a, v), least) for a, v, least in zip(lower, value, instance.lower, strict=True)),
        tuple(min(max(b, v), most) for b, v, most in zip(upper, value, instance.upper, strict=True)),
    )
