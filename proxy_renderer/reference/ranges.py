# SPDX-License-Identifier: Apache-2.0
"""What may change so that a scene comes to look like a picture, and how far: wide ranges around the artist's values.

The picture says nothing of values; the solver finds them. What no picture can tell apart stays as the artist has it: the
view's exposure beside the power of the lamps, how large a lamp is, what surfaces are made of.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass

from ..planning.types import PlanEntry
from ..schema import Instance, Values
from .light_colors import LightColors

HELD_LIGHTLY = 0.05
"""Pull of what a picture lets move to the artist's value: of two ways that look the same, the nearer one."""


@dataclass(frozen=True)
class Leeway:
    """How far values of a family may go from the artist's.

    Attributes:
        trait: Of the picture that they serve.
        low: Factor, or what is added.
        high: Likewise.
        factor: Whether the ends are factors of the artist's value; else they are added to it.
        priority: In the plan; the smaller the more important.
        whole: Whether the ends are the range itself.
        needs: Measures of which one has to be claimed; none for always.
    """

    trait: str
    low: float
    high: float
    priority: int
    factor: bool = False
    whole: bool = False
    needs: tuple[str, ...] = ()


def _times(trait: str, factor: float, priority: int) -> Leeway:
    return Leeway(trait, 1 / factor, factor, priority, factor=True)


def _from(trait: str, low: float, high: float, priority: int) -> Leeway:
    return Leeway(trait, low, high, priority, whole=True)


_ANOTHER_SCENE = {
    "light/power": _times("light", 16.0, 0),
    "light/strength": _times("light", 16.0, 0),
    "light/color": _from("light", 0.08, 1.0, 1),
    "light/azimuth": Leeway("light", -75.0, 75.0, 3, needs=("from_right",)),
    "light/elevation": Leeway("light", -35.0, 35.0, 3, needs=("from_above",)),
    "world/strength": _from("light", 0.0, 4.0, 1),
    "world/color": _from("light", 0.0, 1.0, 1),
    "world/tint": _from("light", 0.05, 2.0, 1),
    "world/backdrop_color": _from("light", 0.0, 1.0, 1),
    "world/backdrop_tint": _from("light", 0.05, 2.0, 1),
    "world/backdrop_strength": _from("light", 0.0, 4.0, 1),
    "volume/density": Leeway("air", 0.0, 2.0, 2, whole=True, needs=("veil",)),
    "volume/color": Leeway("air", 0.1, 1.0, 3, whole=True, needs=("veil",)),
    "film/grade_exposure": _from("grade", -2.0, 2.0, 2),
    "film/lift": _from("grade", 0.9, 1.1, 2),
    "film/midtone": _from("grade", 0.75, 1.3, 2),
    "film/gain": _from("grade", 0.7, 1.3, 2),
    "film/contrast": _from("grade", 0.7, 1.4, 2),
    "film/saturation": _from("grade", 0.0, 1.4, 2),
    "film/grade_gamma": _from("grade", 0.6, 1.7, 3),
    "film/vignette": Leeway("grade", 0.0, 1.0, 3, whole=True, needs=("vignette",)),
    "material/base_color": _from("materials", 0.0, 1.0, 2),
    "material/tint": _from("materials", 0.05, 2.0, 2),
}
"""Family -> how far its values may go for a picture of another scene."""

_SAME_SCENE = {
    **_ANOTHER_SCENE,
    "light/power": _times("light", 100.0, 0),
    "light/strength": _times("light", 100.0, 0),
    "light/color": _from("light", 0.0, 1.0, 1),
    "light/temperature": _from("light", 1500.0, 15000.0, 1),
    "light/size": _times("light", 10.0, 3),
    "light/angle": _from("light", 0.0, 60.0, 3),
    "light/azimuth": Leeway("light", -180.0, 180.0, 0),
    "light/elevation": _from("light", -20.0, 89.0, 0),
    "world/strength": _from("light", 0.0, 10.0, 1),
    "world/rotation": Leeway("light", -180.0, 180.0, 1),
    "volume/density": _from("air", 0.0, 4.0, 2),
    "volume/color": _from("air", 0.0, 1.0, 3),
    "volume/falloff": _from("air", 0.0, 4.0, 3),
    "film/exposure": Leeway("grade", -4.0, 4.0, 2),
    "film/lift": _from("grade", 0.7, 1.3, 3),
    "film/midtone": _from("grade", 0.6, 1.5, 3),
    "film/gain": _from("grade", 0.5, 1.6, 3),
    "film/contrast": _from("grade", 0.5, 2.0, 2),
    "film/saturation": _from("grade", 0.0, 2.0, 2),
    "film/vignette": _from("grade", 0.0, 1.0, 3),
    "film/glare": _from("grade", 0.0, 1.0, 4),
    "material/roughness": _from("materials", 0.0, 1.0, 4),
    "material/metallic": _from("materials", 0.0, 1.0, 5),
}
"""The same for a picture of this very scene. What does the same as exposure, in the compositor, stays."""

_LIT = ("light/color", "world/color")
"""Families of what colors light: they take the hues of the picture's casts."""

_BESIDE_LIGHT = {
    "film/lift": _from("grade", 0.98, 1.08, 2),
    "film/midtone": _from("grade", 0.85, 1.2, 2),
    "film/gain": _from("grade", 0.8, 1.25, 2),
    "film/contrast": _from("grade", 0.7, 1.3, 2),
}
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
    """What a picture lets change, by key; what is locked is left out.

    Args:
        instances: The scene's parameters by key.
        traits: Of the picture that are taken over.
        measures: What is claimed of a picture that looks like it.
        same: Whether it shows this very scene.
        colors: That light may have for a picture of another scene.
    """
    table = dict(_SAME_SCENE if same else _ANOTHER_SCENE)
    if same:
        table.pop("film/grade_exposure")
    elif any(
        i.parameter.family in _LIT and not i.locked and _serves("light", i, traits)
        for i in instances.values()
    ):
        table |= _BESIDE_LIGHT
    entries = {}
    for key, instance in instances.items():
        reach = table.get(instance.parameter.family)
        needed = reach is not None and (not reach.needs or any(m in measures for m in reach.needs))
        if reach is None or instance.locked or not (needed and _serves(reach.trait, instance, traits)):
            continue
        lower, upper = _range(reach, instance)
        lit = instance.parameter.family in _LIT and not same
        if lit:
            lower, upper = _lit(colors, instance)
        elif instance.parameter.family == "film/saturation" and not same:
            lower, upper = _around((colors.paint,), upper, instance)
        reason = f"free to come to look like {name}"
        entries[key] = PlanEntry(lower, upper, reach.priority, reason, HELD_LIGHTLY, any_hue=not lit)
    return entries


def kept(instances: Mapping[str, Instance], entries: Collection[str]) -> tuple[str, ...]:
    """What stays because a picture cannot tell it, one sentence for each family.

    Args:
        instances: The scene's parameters by key.
    """
    families = {i.parameter.family for key, i in instances.items() if key not in entries and not i.locked}
    said = (f"{family}: {why}" for family, why in _STAYS.items() if family in families)
    return tuple(f"Kept as you have it, {text}." for text in said)


def _serves(trait: str, instance: Instance, traits: Collection[str]) -> bool:
    """Whether a value serves what is taken over; the colors of light serve a palette, too."""
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


def _range(reach: Leeway, instance: Instance) -> tuple[Values, Values]:
    """The ends for an instance, within its bounds, its own value among them."""
    value, unit = instance.value, instance.reference
    if reach.factor:
        ends = tuple(v * reach.low for v in value), tuple(v * reach.high for v in value)
    elif reach.whole:
        ends = tuple(reach.low * unit for _ in value), tuple(reach.high * unit for _ in value)
    else:
        ends = tuple(v + reach.low for v in value), tuple(v + reach.high for v in value)
    return _around(*ends, instance)


def _around(lower: Values, upper: Values, instance: Instance) -> tuple[Values, Values]:
    """Ends within an instance's bounds, its own value among them."""
    value = instance.value
    return (
        tuple(max(min(a, v), least) for a, v, least in zip(lower, value, instance.lower, strict=True)),
        tuple(min(max(b, v), most) for b, v, most in zip(upper, value, instance.upper, strict=True)),
    )
