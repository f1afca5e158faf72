# SPDX-License-Identifier: Apache-2.0
"""From one effect of a word to the range of one parameter instance, in the parameter's unit."""

import math

from ..color.floats import lab_from_srgb, linear_from_srgb, luminance, srgb_from_hex, srgb_from_lab, srgb_from_linear
from ..color.shades import hue_apart, relative_shade, shade
from ..schema import Instance, Values
from ..words.attributes import fog_color
from ..words.lexicon.entries import Effect
from ..words.types import Attribute
from .light_levels import Range, Sources, kelvin_color, radiance, watts

_BLACKEST, _WHITEST = 0.006, 0.85  # linear reflectance: hardly any real surface reflects less, or more
_BLACK = 0.02  # linear component up to which a backdrop is black
_MOOD = 0.6  # factor on a tint that light, air and film share: objects keep some color of their own
_SURFACE = (0.65, -0.1), (1.35, 0.15)
"""Lower and upper end of a surface's range: factor on the named color's largest display component, and a summand. The
range is wide: claims find the color in it that looks as named under the scene's light and view."""
_GLOW = (0.8, 0.0), (1.0, 0.1)  # as `_SURFACE`, for the color of a glow, whose strength is separate
_PALER = -0.25, 0.15  # share of the way to gray by which the ends of such a range are paler
_STEP = 0.6  # luminance of a color that is clearly darker than another, as a share of the other's
OWN_COLOR = ("base_color", "tint")  # parameters that hold a material's color


def named_color(effect: Effect, attribute: Attribute, instance: Instance, sources: Sources) -> Values | None:
    """The linear color that a word gives a surface, a glow or the visible background; None for other effects."""
    seen = effect.mode == "shown" and (effect.color in ("@", "own") or instance.parameter.group == "world")
    names = instance.parameter.kind == "color" and (seen or (effect.mode == "color" and effect.color == "@"))
    return painted(effect, attribute, instance, sources) if names else None


def color_range(effect: Effect, attribute: Attribute, instance: Instance, sources: Sources) -> Range:
    """The range that an effect with a color asks for: linear colors, or strengths of the world; not clipped."""
    if named := named_color(effect, attribute, instance, sources):
        return _of_its_hue(named, _GLOW if instance.parameter.name == "emission_color" else _SURFACE)
    srgb = _color_of(effect, attribute, sources)
    if effect.mode == "shown" and instance.parameter.kind == "scalar":
        return _shown_strength(srgb, instance, sources)
    if effect.mode == "cast":
        amount = _MOOD * 0.2 if attribute.kind in ("ambience", "fog") else 0.2
        amount = 0.06 if instance.parameter.name == "lift" else amount
        # factors (R, G, B) around 1; a pale color gets a visible cast, too
        gel = _gel(linear_from_srgb(srgb), 1.0)
        mean = sum(gel) / 3
        away = [(v - mean) / max(mean, 0.2) for v in gel]
        most = max(map(abs, away))
        scale = amount * max(most, 0.7) / most if most > 0.02 else 0.0
        cast = [1 + scale * v for v in away]
        faint, strong = (tuple(1 + share * (v - 1) for v in cast) for share in (0.6, 1.5))
        lower, upper = tuple(map(min, faint, strong)), tuple(map(max, faint, strong))
        return tuple(v - 0.01 for v in lower), tuple(v + 0.01 for v in upper)
    # All colors that look about like it: an equal margin in each display component. It is smaller for dark hues, which are
    # nearer, and for white and gray, which a little tint makes another color.
    shown = [max(v, 0.0) ** (1 / 2.2) for v in painted(effect, attribute, instance, sources)]
    neutral = max(shown) - min(shown) < 0.02 and min(shown) > 0.25
    half = 0.02 if neutral else 0.06 * min(max(max(shown) / 0.4, 0.5), 1.0)
    return tuple(max(v - half, 0.0) ** 2.2 for v in shown), tuple((v + half) ** 2.2 for v in shown)


def _of_its_hue(named: Values, ends: tuple[tuple[float, float], tuple[float, float]]) -> Range:
    """The range of colors that look like a linear color in some light: darker or lighter, purer or paler, of one hue.

    `ends` are `_SURFACE` or `_GLOW`.
    """
    shown = [max(v, 0.0) ** (1 / 2.2) for v in named]
    most, cap = max(*shown, 1e-3), max(*named, _WHITEST) ** (1 / 2.2)
    found = []
    for (factor, summand), pale in zip(ends, _PALER, strict=True):
        top = min(max(factor * most + summand, 0.0), cap)
        color = [top / most * v for v in shown]
        found.append(tuple(max(v + pale * (top - v), 0.0) ** 2.2 for v in color))
    return found[0], found[1]


def painted(effect: Effect, attribute: Attribute, instance: Instance, sources: Sources) -> Values:
    """The linear color that an effect asks for, in the form that its parameter stores: as a gel, an albedo or a tint."""
    srgb = _color_of(effect, attribute, sources)
    linear = linear_from_srgb(srgb)
    if effect.mode == "gel":
        muted = 1.0 - min(srgb) / max(max(srgb), 1e-6)  # a muted color tints the light only a little
        linear = _gel(linear, 0.9 * (_MOOD * muted if attribute.kind == "ambience" else 1.0))
    elif effect.mode == "albedo":
        # fog scatters many times: it is paler and much brighter than the color it is named for; black fog is smoke
        pale = linear_from_srgb(fog_color(srgb))
        darkness = min(luminance(linear) * 12 + 0.25, 0.95)
        linear = tuple(v * darkness / max(pale) for v in pale)
    elif effect.mode == "shown":
        linear = tuple(v / max(linear) for v in linear) if max(linear) > _BLACK else linear
    else:  # no real surface reflects nothing, or all
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
    """A material's own color, as words shade it: "dark oak"; sRGB."""
    for arguments in attribute.shades:
        srgb = shade(srgb, *arguments)
    return srgb


def _gel(linear: Values, purity: float) -> Values:
    """A linear color scaled to a largest component of 1, and mixed with 1 - `purity` of white; white for black."""
    top = max(linear)
    return tuple(1 - purity * (1 - v / top) for v in linear) if top > 0.01 else (1.0, 1.0, 1.0)


def _shown_strength(srgb: Values, instance: Instance, sources: Sources) -> Range:
    """The strengths at which a world with the "shown" color looks as named: white looks white, not gray."""
    scene = sources.scene
    if lab_from_srgb(srgb)[0] > 93:
        ends = tuple(radiance(goal, scene.view) for goal in (88.0, 93.0))
    else:
        bright = max(linear_from_srgb(srgb))
        ends = (0.5 * bright, 3.0 * bright) if bright > _BLACK else (0.0, 1.0)
    picture = sources.world.picture
    return tuple((min(v / 2**sources.exposure / picture, 10.0),) for v in ends)  # type: ignore[return-value]


_AS_NAMED = (
    "azimuth", "elevation", "rotation", "ior", "base_color", "color", "specular_tint", "tint", "backdrop_color",
    "backdrop_tint",
)  # fmt: skip
"""Parameters that "slightly" and "very" do not change: directions and colors."""


def effect_range(effect: Effect, attribute: Attribute, instance: Instance, sources: Sources) -> Range:
    """The range that an effect asks for, clipped to the instance's hard bounds (never empty)."""
    if attribute.shades and effect.name in OWN_COLOR and not (effect.color or effect.mode):
        low, high = (
            linear_from_srgb(shaded(srgb_from_linear(_spread(v, instance)), attribute))
            for v in (effect.lower, effect.upper)
        )
    elif effect.color:
        low, high = color_range(effect, attribute, instance, sources)
    elif effect.name == "temperature" and instance.parameter.kind == "color" and not effect.mode:
        low, high = _glow_color(effect, attribute.strength, instance, sources)
    else:
        low, high = _MODES.get(effect.mode, _plain)(effect, attribute.strength, instance, sources)
    if attribute.shades and effect.name in OWN_COLOR:
        # "darker walnut" and "paler oak" lie on that side of the present color
        said = (attribute.english or attribute.word).split()
        present, factor = luminance(instance.value), 1.0
        if "darker" in said:
            factor = min(_STEP * present / max(luminance(high), 1e-6), 1.0)
        elif "lighter" in said or "paler" in said:
            factor = max(present / _STEP / max(luminance(low), 1e-6), 1.0)
        low, high = tuple(v * factor for v in low), tuple(v * factor for v in high)
    if instance.parameter.name == "emission_color" and effect.family.startswith("light/"):
        low, high = _over_glow(low, high, _computed_glow(instance, sources))
    if effect.family == "material/emission" and not effect.mode and instance.owner in sources.scene.emitters:
        computed = max(sources.scene.emitters[instance.owner].strength, 1e-3)
        low, high = (low[0] / computed,), (high[0] / computed,)
    return clip(low, high, instance)


def within(values: Values, lower: Values, upper: Values) -> Values:
    """Values, projected into a range."""
    return tuple(min(max(v, a), b) for v, a, b in zip(values, lower, upper, strict=True))


def clip(low: Values, high: Values, instance: Instance) -> Range:
    """The range (low, high) within the instance's hard bounds, for each component; an end outside becomes a bound."""
    lower, upper = (within(_spread(end, instance), instance.lower, instance.upper) for end in (low, high))
    return lower, tuple(map(max, lower, upper))


def scaled(
    low: float, high: float, neutral: float, strength: float, bounds: tuple[float, float]
) -> tuple[float, float]:
    """The range (low, high), moved toward `neutral` for a strength below 1 ("slightly"), away from it above 1 ("very").

    A range around `neutral` stays as it is. `bounds` limit the end that moves away.
    """
    if strength == 1.0 or (low <= neutral <= high and not (low == neutral or high == neutral)):
        return low, high
    if strength < 1.0:
        return neutral + (low - neutral) * strength, neutral + (high - neutral) * strength
    near, far = (low, high) if low >= neutral else (high, low)
    far = min(max(neutral + (far - neutral) * strength, bounds[0]), bounds[1])
    near = near + (far - near) * min(strength - 1.0, 1.0)
    return min(near, far), max(near, far)


def _spread(values: Values, instance: Instance) -> Values:
    return values * instance.parameter.components if len(values) == 1 else values


def _computed_glow(instance: Instance, sources: Sources) -> Values:
    glow = sources.scene.emitters.get(instance.owner)
    return glow.color if glow else (1.0, 1.0, 1.0)


def _over_glow(low: Values, high: Values, own: Values) -> Range:
    """The range of tints that turn the mean color of a glow's nodes, `own`, into the colors of a range, if they can."""
    if max(own) - min(own) < 1e-3:
        return low, high
    least = 0.25 * max(*own, 1e-6)
    tints = [
        tuple(w / max(v, least) for w, v in zip(wanted * (3 // len(wanted)), own, strict=True))
        for wanted in (low, high)
    ]
    top = max(tints[1])
    return tuple(v / top for v in tints[0]), tuple(v / top for v in tints[1])


def _glow_color(effect: Effect, strength: float, instance: Instance, sources: Sources) -> Range:
    """The range of a glow's color between two color temperatures; they only tint a glow with another hue, as green."""
    computed = _computed_glow(instance, sources)
    color = tuple(a * b for a, b in zip(instance.value, computed, strict=True))
    own = srgb_from_linear(tuple(v / max(*color, 1e-6) for v in color))
    ends = scaled(effect.lower[0], effect.upper[0], 6500.0, strength, (1200.0, 16000.0))
    tints = [kelvin_color(k) for k in ends]
    # its hue is far, in degrees, from those of warm and of cool light
    if all(hue_apart(own, srgb_from_linear(kelvin_color(k))) > 50.0 for k in (2700.0, 11000.0)):
        tints = [tuple(a * b for a, b in zip(color, tint, strict=True)) for tint in tints]
    return tuple(map(min, *tints)), tuple(map(max, *tints))


def _plain(effect: Effect, strength: float, instance: Instance, _: Sources) -> Range:
    parameter, unit = instance.parameter, instance.reference
    if parameter.name in _AS_NAMED:
        strength = 1.0
    there, back = (math.log, math.exp) if parameter.scale.name == "log" else (float, float)
    limits = there(parameter.lower), there(parameter.upper)
    pairs = []
    for low, high in zip(effect.lower, effect.upper, strict=True):
        a, b = scaled(there(low), there(high), there(parameter.default), strength, limits)
        pairs.append((back(a) * unit, back(b) * unit))
    lower, upper = zip(*pairs, strict=True)
    return lower, upper


def _times(effect: Effect, strength: float, instance: Instance, _: Sources) -> Range:
    """Multiples of the artist's value; for an increase, a value near 0 counts as a small one, so that it can grow."""
    scalar, logs = instance.parameter.kind == "scalar", instance.parameter.scale.name == "log"
    ends = zip(instance.lower, instance.upper, strict=True)
    least = tuple(
        a * (b / a) ** 0.2 if logs else 0.01 * b for a, b in ends
    )  # of a light's power ten times its lower bound
    floor = least if scalar else (0.0,) * len(instance.value)
    value = tuple(map(max, instance.value, floor)) if effect.lower[0] > 1 else instance.value
    low = tuple(v * a**strength for v, a in zip(value, _spread(effect.lower, instance), strict=True))
    return low, tuple(v * b**strength for v, b in zip(value, _spread(effect.upper, instance), strict=True))


def _plus(effect: Effect, strength: float, instance: Instance, _: Sources) -> Range:
    low, high = (instance.value[0] + end[0] * strength for end in (effect.lower, effect.upper))
    return (low,), (high,)


def _near(effect: Effect, strength: float, instance: Instance, _: Sources) -> Range:
    """The range from the artist's value plus one share of its whole range to plus another, on the perceptual scale."""
    scale = instance.parameter.scale
    bounds = list(zip(instance.value, instance.lower, instance.upper, strict=True))
    low, high = (
        tuple(scale.from_unit(scale.to_unit(v, a, b) + way, a, b) for v, a, b in bounds)
        for way in (effect.lower[0], effect.upper[0])
    )
    return low, high


def _shade(effect: Effect, strength: float, instance: Instance, _: Sources) -> Range:
    """The range around the artist's color when its lightness and its chroma change by the effect's two numbers."""
    own = srgb_from_linear(instance.value)
    corners = [
        linear_from_srgb(relative_shade(own, lighter, chroma, strength))
        for lighter in (effect.lower[0], effect.upper[0])
        for chroma in (effect.lower[1], effect.upper[1])
    ]
    return tuple(map(min, *corners)), tuple(map(max, *corners))


def _lightness(effect: Effect, strength: float, instance: Instance, sources: Sources) -> Range:
    # L* 45 neither brightens nor darkens.
    low, high = scaled(effect.lower[0], effect.upper[0], 45.0, strength, (0.5, 97.0))
    if instance.parameter.kind == "color":
        light, a, b = lab_from_srgb(srgb_from_linear(instance.value))
        fades = [(goal, min(1.0, goal / max(light, 10.0))) for goal in (low, high)]  # darker colors have less chroma
        shades = [linear_from_srgb(srgb_from_lab((goal, a * fade, b * fade))) for goal, fade in fades]
        return tuple(map(min, *shades)), tuple(map(max, *shades))
    scale = _per_radiance(instance, sources) / 2**sources.exposure
    return tuple((radiance(goal, sources.scene.view) * scale,) for goal in (low, high))  # type: ignore[return-value]


def _per_radiance(instance: Instance, sources: Sources) -> float:
    """The strength of the world, or of a light, at which a white surface that faces it has a radiance of 1."""
    if instance.parameter.group == "world":
        return 1 / max(luminance(sources.world.color), 1e-3)
    return watts(instance, sources.scene) * instance.reference


def _share(effect: Effect, strength: float, instance: Instance, sources: Sources) -> Range:
    """The range of strengths that give shares of the key's light; in a scene without a key, L* 62 to 88."""
    if not sources.key:
        return _lightness(Effect("world", "strength", "lightness", (62.0,), (88.0,)), 1.0, instance, sources)
    scale = sources.key * _per_radiance(instance, sources)
    return (effect.lower[0] * scale,), (effect.upper[0] * scale,)


def facing_white(instance: Instance, low: float, high: float, sources: Sources) -> Range:
    """The range of a light's power at which a white surface that faces it is displayed with L* from `low` to `high`."""
    effect = Effect("light", "power", "lightness", (low,), (high,))
    return clip(*_lightness(effect, 1.0, instance, sources), instance)


def _azimuth(effect: Effect, strength: float, instance: Instance, sources: Sources) -> Range:
    """The range of azimuth, of all that mean the same direction, that is nearest to the artist's value."""
    low, high, camera = effect.lower[0], effect.upper[0], sources.scene.camera_azimuth
    sides = [(low, high)] if effect.mode == "camera" else [(low, high), (-high, -low)]
    turns = [(camera + a + 360 * k, camera + b + 360 * k) for a, b in sides for k in (-2, -1, 0, 1, 2)]
    legal = [t for t in turns if instance.lower[0] <= t[0] and t[1] <= instance.upper[0]] or turns
    value = instance.value[0]
    best = min(legal, key=lambda t: (max(t[0] - value, value - t[1], 0.0), abs(t[0] + t[1] - 2 * value)))
    return (best[0],), (best[1],)


_MODES = {
    "times": _times, "plus": _plus, "near": _near, "shade": _shade, "lightness": _lightness, "share": _share,
    "camera": _azimuth, "sides": _azimuth,
}  # fmt: skip
