# SPDX-License-Identifier: Apache-2.0
"""Color words as ranges: of surfaces, lights, fog, worlds and grades."""

from ..color.floats import lab_from_srgb, linear_from_srgb, luminance, srgb_from_hex
from ..color.shades import shade
from ..schema import Instance, Values
from ..words.attributes import fog_color
from ..words.lexicon.entries import Effect
from ..words.types import Attribute
from .light_levels import Range, Sources, radiance

_BLACKEST, _WHITEST = 0.006, 0.85  # hardly a real surface reflects less, or more
_BLACK = 0.02  # component below which a backdrop is black
_SEEN = 0.7  # relative departure from gray that a tint has at least
_DEEP = 0.4  # of the scale below: the box of a darker color is smaller, as its hues are nearer
_MOOD = 0.6  # of a tint, where light, air and film share it: things keep some color of their own
_BOX = 0.06  # half the width of a color's box, in steps that look even
_LESS, _MORE = (0.65, -0.1), (1.35, 0.15)
"""Ends of a surface's components, on the same scale: a share of the named color's, and what is added to that. Claims find
what looks as named under the scene's light and view."""
_SHOWN = (0.5, 3.0)  # multiples of a color's brightest component that a backdrop may have
_GLOW = (0.8, 0.0), (1.0, 0.1)  # the same of a glow: how bright it is, its strength says
_CAST, _EVEN = (0.6, 1.5), 0.01  # shares of a film's usual tint for claims, and a component's leeway
_DARKER, _LIGHTER = {"darker"}, {"lighter", "paler"}
_STEP = 0.6  # luminance of a color that is clearly darker than another, as a share of the other's
OWN_COLOR = ("base_color", "tint")  # parameters that hold a material's color
_NEUTRAL_BOX = 0.02  # the same for white and gray: a little tint makes them another color


def named_color(effect: Effect, attribute: Attribute, instance: Instance, sources: Sources) -> Values | None:
    """The linear color that a word gives to a surface, to a glow, or to what is seen of the world; None for all else."""
    seen = effect.mode == "shown" and (effect.color in ("@", "own") or instance.parameter.group == "world")
    if instance.parameter.kind == "color" and (seen or (effect.mode == "color" and effect.color == "@")):
        return painted(effect, attribute, instance, sources)
    return None


def color_range(effect: Effect, attribute: Attribute, instance: Instance, sources: Sources) -> Range:
    """The range that an effect with a color asks for; not clipped."""
    if named := named_color(effect, attribute, instance, sources):
        # all that may look like it in some light: darker and lighter, and purer or paler
        shown = [max(v, 0.0) ** (1 / 2.2) for v in named]
        ends = _GLOW if instance.parameter.name == "emission_color" else (_LESS, _MORE)
        lower, upper = (tuple(max(a * v + b, 0.0) ** 2.2 for v in shown) for a, b in ends)
        return lower, tuple(min(u, max(v, _WHITEST)) for u, v in zip(upper, named, strict=True))
    srgb = _color_of(effect, attribute, sources)
    if effect.mode == "shown" and instance.parameter.kind == "scalar":
        return _shown_strength(srgb, instance, sources)
    if effect.mode == "cast":
        amount = _MOOD * 0.2 if attribute.kind in ("ambience", "fog") else 0.2
        cast = _cast(linear_from_srgb(srgb), 0.06 if instance.parameter.name == "lift" else amount)
        faint, strong = (tuple(1 + share * (v - 1) for v in cast) for share in _CAST)
        lower, upper = tuple(map(min, faint, strong)), tuple(map(max, faint, strong))
        return tuple(v - _EVEN for v in lower), tuple(v + _EVEN for v in upper)
    return _box(painted(effect, attribute, instance, sources))


def painted(effect: Effect, attribute: Attribute, instance: Instance, sources: Sources) -> Values:
    """The linear color that an effect is about, as its parameter holds it."""
    srgb = _color_of(effect, attribute, sources)
    if effect.mode == "gel":
        muted = 1.0 - min(srgb) / max(max(srgb), 1e-6)  # a muted color makes little of a tint
        linear = _gel(linear_from_srgb(srgb), 0.9 * (_MOOD * muted if attribute.kind == "ambience" else 1.0))
    elif effect.mode == "albedo":
        # fog scatters many times: it is paler and much brighter than the color it is named for; black fog is smoke
        pale = linear_from_srgb(fog_color(srgb))
        darkness = min(luminance(linear_from_srgb(srgb)) * 12 + 0.25, 0.95)
        linear = tuple(v * darkness / max(pale) for v in pale)
    elif effect.mode == "shown":
        linear = linear_from_srgb(srgb)
        linear = tuple(v / max(linear) for v in linear) if max(linear) > _BLACK else linear
    else:
        # no real surface reflects nothing, or all
        linear = linear_from_srgb(srgb)
        most = min(_WHITEST / max(*linear, 1e-6), 1.0)
        linear = tuple(max(most * v, _BLACKEST) for v in linear)
    if instance.parameter.family == "material/tint":
        texture = max(sources.scene.texture_luminance.get(instance.owner, 0.4), 0.02)
        linear = tuple(v / texture for v in linear)
    if attribute.strength < 0.8:
        linear = tuple(a + (b - a) * attribute.strength for a, b in zip(instance.value, linear, strict=True))
    return linear


def _color_of(effect: Effect, attribute: Attribute, sources: Sources) -> Values:
    if effect.color == "@":
        return attribute.color or (0.5, 0.5, 0.5)
    if effect.color == "own":
        return sources.own_color
    named = srgb_from_hex(effect.color)
    return shaded(named, attribute) if effect.name in OWN_COLOR else named


def shaded(srgb: Values, attribute: Attribute) -> Values:
    """A material's own color as the words shade it: "dark oak"."""
    for arguments in attribute.shades:
        srgb = shade(srgb, *arguments)
    return srgb


def beyond_present(low: Values, high: Values, attribute: Attribute, instance: Instance) -> Range:
    """A range of linear colors, moved to the side of the present color that "darker walnut" or "paler oak" asks for."""
    said = {*(attribute.english or attribute.word).split()}
    present = luminance(instance.value)
    factor = 1.0
    if said & _DARKER:
        factor = min(_STEP * present / max(luminance(high), 1e-6), 1.0)
    elif said & _LIGHTER:
        factor = max(present / _STEP / max(luminance(low), 1e-6), 1.0)
    return tuple(v * factor for v in low), tuple(v * factor for v in high)


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
    scene = sources.scene
    if lab_from_srgb(srgb)[0] > 93:
        ends = tuple(radiance(goal, scene.view) for goal in (88.0, 93.0))
    else:
        bright = max(linear_from_srgb(srgb))
        ends = tuple(share * bright for share in _SHOWN) if bright > _BLACK else (0.0, 1.0)
    picture = sources.world.picture
    return tuple((min(v / 2**sources.exposure / picture, 10.0),) for v in ends)  # type: ignore[return-value]
