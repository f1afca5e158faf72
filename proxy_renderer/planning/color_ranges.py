# SPDX-License-Identifier: Apache-2.0
"""Color words as ranges: of surfaces, lights, fog, worlds and grades."""

from __future__ import annotations

from ..color.floats import chroma, lab_from_srgb, linear_from_srgb, luminance, srgb_from_hex, srgb_from_linear
from ..color.shades import hue_apart, shade
from ..prompt.colors import fog_color
from ..prompt.lexicon.entries import Effect
from ..prompt.lexicon.user_words import default_vocabulary
from ..prompt.types import Attribute
from ..schema import Instance, Values
from .display import radiance, reachable
from .sources import Range, Sources

_BLACKEST, _WHITEST = 0.006, 0.85  # hardly a real surface reflects less, or more
_BRIGHTEST = 2.5  # radiance of a backdrop that has a color
_DARK = 0.02  # radiance below which a backdrop is black
_SEEN = 0.7  # relative departure from gray that a tint has at least
_DEEP = 0.4  # of that scale: the box of a darker color is smaller, as its hues are nearer
_MOOD = 0.6  # of a tint, where light, air and film share it: things keep some color of their own
_ALIKE, _OPPOSED = 60.0, 120.0
"""Degrees of hue from warm light up to which a color bears it, and from which on it does not."""
_MADE_UP = 0.9  # share of such light's color that a surface then makes up for
_BOX = 0.06  # half the width of a color's box, in steps that look even
OWN_COLOR = ("base_color", "tint")
"""Parameters that hold a material's color."""
_NEUTRAL_BOX = 0.02  # the same for white and gray: a little tint makes them another color


def color_range(effect: Effect, attribute: Attribute, instance: Instance, sources: Sources) -> Range:
    """The range that an effect with a color asks for; not clipped."""
    srgb, view = _named(effect, attribute, sources), sources.context.view
    if effect.mode == "shown" and instance.parameter.kind == "scalar":
        return _shown_strength(srgb, instance, sources)
    if effect.mode == "cast":
        amount = _MOOD * 0.2 if attribute.kind in ("ambience", "fog") else 0.2
        cast = _cast(linear_from_srgb(srgb), 0.06 if instance.parameter.name == "lift" else amount)
        return tuple(v - 0.02 for v in cast), tuple(v + 0.02 for v in cast)
    if effect.mode == "gel":
        linear = _gel(
            linear_from_srgb(srgb), 0.9 * (_MOOD * _purity(srgb) if attribute.kind == "ambience" else 1.0)
        )
    elif effect.mode == "albedo":
        linear = _fog_albedo(srgb)
    elif effect.mode == "shown":
        linear = reachable(srgb, view, _BRIGHTEST)
        linear = tuple(v / max(linear) for v in linear) if max(linear) > _DARK else linear
    else:
        tint = _tint(srgb, sources)
        linear = _surface(srgb, view, sources.illumination, sources.veil, tint)
    if instance.parameter.family == "material/tint":
        texture = max(sources.context.texture_luminance.get(instance.owner, 0.4), 0.02)
        linear = tuple(v / texture for v in linear)
    if attribute.strength < 0.8:
        linear = tuple(a + (b - a) * attribute.strength for a, b in zip(instance.value, linear, strict=True))
    return _box(linear)


def _surface(srgb: Values, view: str, illumination: float, veil: float, tint: Values) -> Values:
    """The albedo that is displayed as a color under the light, of some tint, that is going to fall on it."""
    if lab_from_srgb(srgb)[0] > 93:
        return (
            (_WHITEST,) * 3
            if chroma(lab_from_srgb(srgb)) < 4
            else tuple(_WHITEST * v for v in linear_from_srgb(srgb))
        )
    light = min(max(illumination, 0.6), 5.0)
    wanted = reachable(srgb, view, _WHITEST * light)
    albedo = tuple(max(v - veil, 0.7 * v) / (light * t) for v, t in zip(wanted, tint, strict=True))
    return tuple(min(max(v, _BLACKEST), _WHITEST) for v in albedo)


def _tint(srgb: Values, sources: Sources) -> Values:
    """The color of the light that a surface makes up for, to look as named.

    Eyes are used to warm and cool lamps, but not so far that they see blue where candles leave violet.
    """
    against = hue_apart(srgb, srgb_from_linear(tuple(v / max(sources.warmth) for v in sources.warmth)))
    share = _MADE_UP * min(max((against - _ALIKE) / (_OPPOSED - _ALIKE), 0.0), 1.0)
    return tuple(
        gel**sources.constancy * warm**share for gel, warm in zip(sources.cast, sources.warmth, strict=True)
    )


def _named(effect: Effect, attribute: Attribute, sources: Sources) -> Values:
    if effect.color == "@":
        return attribute.color or (0.5, 0.5, 0.5)
    if effect.color == "own":
        return sources.own_color
    named = (
        srgb_from_hex(effect.color)
        if effect.color.startswith("#")
        else default_vocabulary().colors[effect.color]
    )
    return shaded(named, attribute) if effect.name in OWN_COLOR else named


def shaded(srgb: Values, attribute: Attribute) -> Values:
    """A material's own color as the words shade it: "dark oak"."""
    for arguments in attribute.shades:
        srgb = shade(srgb, *arguments)
    return srgb


def _box(linear: Values) -> Range:
    """All that looks about like a linear color: even steps on the screen's scale."""
    shown = [max(v, 0.0) ** (1 / 2.2) for v in linear]
    neutral = max(shown) - min(shown) < _NEUTRAL_BOX and min(shown) > 0.25
    half = _NEUTRAL_BOX if neutral else _BOX * min(max(max(shown) / _DEEP, 0.5), 1.0)
    return tuple(max(v - half, 0.0) ** 2.2 for v in shown), tuple((v + half) ** 2.2 for v in shown)


def _gel(linear: Values, purity: float) -> Values:
    """The color with its largest component at 1, and not fully saturated: filters and fog never are."""
    top = max(linear)
    return tuple(1 - purity * (1 - v / top) for v in linear) if top > 0.01 else (1.0, 1.0, 1.0)


def _purity(srgb: Values) -> float:
    """How much of a tint a color makes, 0 to 1: a muted one little, though its linear components differ greatly."""
    return 1.0 - min(srgb) / max(max(srgb), 1e-6)


def _fog_albedo(srgb: Values) -> Values:
    """Fog scatters many times: it is paler and much brighter than the color it is named for."""
    pale = linear_from_srgb(fog_color(srgb))
    darkness = min(luminance(linear_from_srgb(srgb)) * 12 + 0.25, 0.95)  # black fog is smoke
    return tuple(v * darkness / max(pale) for v in pale)


def _cast(linear: Values, amount: float) -> Values:
    """A tint of the film; that of a pale color has to be seen too."""
    gel = _gel(linear, 1.0)
    mean = sum(gel) / 3
    away = [(v - mean) / max(mean, 0.2) for v in gel]
    most = max(map(abs, away))
    scale = amount * max(most, _SEEN) / most if most > 0.02 else 0.0
    return tuple(1 + scale * v for v in away)


def _shown_strength(srgb: Values, instance: Instance, sources: Sources) -> Range:
    """Strength at which a world of the "shown" color looks as named; white as white, not gray."""
    context = sources.context
    if lab_from_srgb(srgb)[0] > 93:
        ends = tuple(radiance(goal, context.view) for goal in (88.0, 93.0))
    else:
        bright = max(reachable(srgb, context.view, _BRIGHTEST))
        ends = (0.8 * bright, 1.25 * bright) if bright > _DARK else (0.0, 1.0)
    picture = sources.world.picture
    return tuple((min(v / 2**sources.exposure / picture, 10.0),) for v in ends)  # type: ignore[return-value]
