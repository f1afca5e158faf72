# SPDX-License-Identifier: Apache-2.0
"""The effects of a picture's wishes: values that may change in a scene to look like it."""

from collections.abc import Collection, Mapping

from ..schema import Instance
from ..words.lexicon.entries import Effect, parse_effect


def _effects(*texts: str) -> dict[str, Effect]:
    """Family -> what a picture may do to its values, written as in the vocabulary; a bare range holds the artist's value too."""
    return {effect.family: effect for effect in map(parse_effect, texts)}


_ANOTHER_SCENE = _effects(
    "lights/power times 0.0625..16 !0", "lights/strength times 0.0625..16 !0", "lights/color 0.08..1 !1",
    "lights/azimuth plus -75..75 !3", "lights/elevation plus -35..35 !3",
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
    "lights/power times 0.01..100 !0", "lights/strength times 0.01..100 !0", "lights/color 0..1 !1",
    "lights/temperature 1500..15000 !1", "lights/size times 0.1..10 !3", "lights/angle 0..60 !3",
    "lights/azimuth plus -180..180 !0", "lights/elevation -20..89 !0",
    "world/strength 0..10 !1", "world/rotation plus -180..180 !1",
    "volume/density 0..4 !2", "volume/color 0..1 !3", "volume/falloff 0..4 !3",
    "film/exposure plus -4..4 !2", "film/lift 0.7..1.3 !3", "film/midtone 0.6..1.5 !3", "film/gain 0.5..1.6 !3",
    "film/contrast 0.5..2 !2", "film/saturation 0..2 !2", "film/vignette 0..1 !3", "film/glare 0..1 !4",
    "material/roughness 0..1 !4", "material/metallic 0..1 !5",
)  # fmt: skip
"""The same for a picture of the artist's scene. What does the same as exposure, in the compositor, stays."""
_TRAITS = {"light": "light", "world": "light", "volume": "air", "film": "grade", "material": "materials"}
"""Group of parameters -> the trait of a picture that they serve."""

_BESIDE_LIGHT = _effects(
    "film/lift 0.98..1.08 !2", "film/midtone 0.85..1.2 !2", "film/gain 0.8..1.25 !2",
    "film/contrast 0.7..1.3 !2",
)  # fmt: skip
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


def effects_of(
    instances: Collection[Instance], traits: Collection[str], measures: Collection[str], same: bool
) -> list[Effect]:
    """The effects that a picture lets act for traits that are taken over, where these measures are claimed of an image like it."""
    table = dict(_SAME_SCENE if same else _ANOTHER_SCENE)
    lit = any(
        i.parameter.name == "color" and i.parameter.group in ("light", "world") and not i.locked
        for i in instances
    )
    if same:
        table.pop("film/grade_exposure")
    elif lit and {"light", "palette"} & {*traits}:
        table |= _BESIDE_LIGHT
    return [
        effect
        for family, effect in table.items()
        if _serves(family, traits) and (same or _NEEDS.get(family, "") in ("", *measures))
    ]


def kept_values(instances: Mapping[str, Instance], entries: Collection[str]) -> tuple[str, ...]:
    """Sentences on the families that stay because a picture cannot tell them."""
    families = {i.parameter.family for key, i in instances.items() if key not in entries and not i.locked}
    said = (f"{family}: {why}" for family, why in _STAYS.items() if family in families)
    return tuple(f"Kept as you have it, {text}." for text in said)


def _serves(family: str, traits: Collection[str]) -> bool:
    """True if values of a family serve what is taken over; the colors of light serve a palette, too."""
    group = family.partition("/")[0]
    colors = group in ("light", "world") or family == "film/saturation"
    return _TRAITS[group] in traits or ("palette" in traits and colors)
