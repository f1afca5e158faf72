# SPDX-License-Identifier: Apache-2.0
"""Combines setups of light that a prompt names together: a source, an hour, a style or a mood with another setup."""

import math
from collections.abc import Sequence
from dataclasses import replace

from ..color.floats import hex_from_srgb, linear_from_srgb, luminance, mixed, srgb_from_hex
from ..schema import Values
from ..words.lexicon.rigs import Modifier, Rig
from ..words.types import Attribute
from .described import EDGES
from .levels import GRAY

_DIMMED = 0.6  # most stops by which an hour or a style lowers the exposure of a setup
_MOOD, _MOST = 0.6, 0.8  # share of a mood's sky, fill and exposure that an hour takes over; most stops

_SECOND = -1.0  # stops of another setup's key against the first one's


def with_source(rig: Rig, other: Rig) -> Rig:
    """A setup with the key of another one as an accent light, on the side where the first key is not."""
    if not other.lights or not rig.lights:
        return rig
    first, key = rig.lights[0], other.lights[0]
    if (first.color, first.kelvin) == (key.color, key.kelvin):
        return rig
    azimuth = -key.azimuth if first.azimuth * key.azimuth > 0 else key.azimuth
    rest = tuple(light for light in rig.lights if light.part != "accent")
    return replace(rig, lights=(*rest, replace(key, part="accent", stops=_SECOND, azimuth=azimuth)))


def at_an_hour(rig: Rig, hour: Rig) -> Rig:
    """A setup under the sky of an hour or a weather; of several, the darkest sky stays. Suns get the hour's color."""
    if rig.under_sky and rig.sky is not None and (hour.sky is None or hour.sky > rig.sky):
        return rig
    sun = next((light for light in hour.lights[:1] if light.type == "SUN"), None)
    lights = tuple(
        replace(light, kelvin=sun.kelvin, color=sun.color) if sun and light.type == "SUN" else light
        for light in rig.lights
    )
    return replace(
        rig,
        lights=lights,
        under_sky=True,
        sky=rig.sky if hour.sky is None else hour.sky,
        sky_color=hour.sky_color or rig.sky_color,
        world_color=hour.world_color or rig.world_color,
        exposure=min(rig.exposure, max(hour.exposure, rig.exposure - _DIMMED)),
    )


def sky_color_of(said: Sequence[Attribute]) -> Values | None:
    """The sRGB color that words give the sky; None if they give none."""
    skies = (a.color for a in said if a.kind == "sky" and not (a.negated or a.cause or a.owners))
    return next(filter(None, skies), None)


def under_named_sky(rig: Rig, said: Sequence[Attribute]) -> Rig:
    """A rig whose sky, if it has one, is shown in exactly the color that words give it.

    A color without the word "sky" is shown in a dark shade by night: "a blue night".
    """
    color = sky_color_of(said)
    if rig.sky is None or color is None:
        return rig
    named = any(a.kind == "sky" and a.color and a.thing != a.word for a in said)
    stops = math.log2(max(luminance(linear_from_srgb(color)), 1e-7) / GRAY)
    dark = rig.has_dark_sky and not named
    return replace(rig, sky=min(stops, rig.sky + 1.0) if dark else stops, sky_color=hex_from_srgb(color))


def in_a_style(rig: Rig, style: Rig) -> Rig:
    """A setup with a style's grade, an exposure lowered toward the style's, and, in a dark style, its sky and world."""
    # Sky and world stay if the setup's key is a sun, or its sky is that of an hour.
    has_own_sky = rig.under_sky or any(light.type == "SUN" for light in rig.lights[:1])
    darker = {}
    for name in () if has_own_sky else ("world", "sky"):
        mine, theirs = getattr(rig, name), getattr(style, name)
        if theirs is not None and theirs < -2.0:  # stops
            darker[name] = theirs if mine is None else min(mine, theirs)
    exposure = min(rig.exposure, max(style.exposure, rig.exposure - _DIMMED))
    return replace(rig, **darker, exposure=exposure, grade=(*rig.grade, *style.grade))


def denser(rig: Rig, other: Rig) -> float | None:
    """The denser air of two rigs; None if neither has air."""
    return max((air for air in (rig.air, other.air) if air is not None), default=None)


def in_a_mood(rig: Rig, mood: Rig, edges: bool) -> Rig:
    """The rig of an hour, a weather or a place in a mood: "gloomy noon".

    It takes over the mood's sky, world, air, exposure and grade and, if `edges` is True, its colored edge lights.
    """
    parts = {light.part for light in rig.lights}
    colored = [light for light in mood.lights if light.color and light.part in EDGES] if edges else []
    return replace(
        rig,
        world=_mixed(rig.world, mood.world),
        world_color=_mixed_color(rig.world_color, mood.world_color),
        sky=_mixed(rig.sky, mood.sky),
        sky_color=_mixed_color(rig.sky_color or rig.world_color, mood.sky_color or mood.world_color),
        air=denser(rig, mood),
        exposure=_mixed(rig.exposure, mood.exposure) or 0.0,
        grade=(*rig.grade, *mood.grade),
        lights=(*rig.lights, *(light for light in colored if light.part not in parts)),
    )


def _mixed(mine: float | None, theirs: float | None) -> float | None:
    if mine is None or theirs is None:
        return mine if theirs is None else theirs
    return mine + max(-_MOST, min(_MOOD * (theirs - mine), _MOST))


def _mixed_color(mine: str, theirs: str) -> str:
    if not (mine and theirs):
        return mine or theirs
    return hex_from_srgb(mixed(srgb_from_hex(mine), srgb_from_hex(theirs), _MOOD))


def deepened(rig: Rig, modifier: Modifier, strength: float) -> Rig:
    """A rig with a modifier's contrast and exposure added to its own, both times the `strength` of the word."""
    deeper = modifier.contrast * strength
    lights = tuple(
        light
        if light.part in ("key", *EDGES) or light.reach == "background"
        else replace(light, stops=light.stops + deeper)
        for light in rig.lights
    )
    world = None if rig.world is None else min(rig.world + deeper, 0.5)
    return replace(rig, lights=lights, world=world, exposure=rig.exposure + modifier.exposure * strength)


def added_to_scene(rig: Rig) -> Rig:
    """A setup whose lights are added to a scene that stays lit as it is."""
    lights = tuple(
        replace(light, part="accent", stops=_SECOND) if light.part == "key" else light for light in rig.lights
    )
    says = "The scene stays lit as it is; lights are added to that."
    rig = replace(rig, says=says, own=0.0, exposure=0.0, lights=lights, grade=(), under_sky=False)
    return replace(rig, world=None, world_color="", sky=None, sky_color="", air=None)
