# SPDX-License-Identifier: Apache-2.0
"""Claims of color words, and of materials with a color. Colors are in OKLab times 100, tints in a* and b* of CIE Lab."""

import math
from collections.abc import Iterable, Iterator
from dataclasses import replace

from ..color.floats import chroma, lab_from_srgb, oklab_from_srgb, srgb_from_hex, srgb_from_lab
from ..schema import Values
from ..schema.parameters import Region
from ..words.attributes import display_color
from ..words.lexicon.vocabulary import Vocabulary
from ..words.types import Attribute, Part
from .claim import Claim

# Intervals of a color, around the nearest color that an image can show
_LIGHTNESS = 10.0  # half the interval of lightness
_CHROMA, _LEAST_CHROMA = 0.25, 2.5  # half the interval of chroma: share of the chroma; its lower limit
_FAINTEST = 1.8  # chroma up to which a color counts as gray
_OFF_GRAY = 0.6  # share of the chroma above `_LEAST_CHROMA` by which a color may be paler, at most
_ASIDE, _LEAST_ASIDE = 0.2, 1.5  # half the interval across the hue: share of the chroma; its lower limit
_FARTHEST = 12.0  # distance in lightness from the named color, at most; more only if an image cannot show it

# Tints of colored light, air and film
COLORED = 12.0  # C* below which a color tints nothing
_TINTED, _TINTED_MORE = 6.0, 3.0  # least tint along the color's hue; increase that is enough instead
_LIT, _LIT_SHARE = 20.0, 0.4  # least tint if the color is the light's, but at most this share of its chroma
_LIT_MORE = 0.8  # increase that is enough, as a share of the least tint: white in yellow light looks yellow
_MOST_SHARE = 0.5  # largest tint, as a share of the color's chroma: more would leave no other colors
_LEAST_MOST = 25.0  # the largest tint is never limited to less than this
_OFF_HUE = 6.0  # largest tint across the color's hue, unless the artist's image has more
_ACCENT = 12.0  # least tint of a tenth of the image, if the color is that of one of several lights
_CAST = (6.0, 24.0)  # least and largest tint of the shadows or highlights

# Gray fog: L* of a named color up to which it is black, and from which it is white; L* of that fog at most, at least
_BLACK, _WHITE = 35.0, 85.0
_BLACK_AIR, _WHITE_AIR = 35.0, 74.0

# Gray materials
_DARKER = 0.65  # least lightness as a share of the material's own: white has shaded parts
_LIGHTER = 22.0  # L* above the material's own, at most: black has highlights
_REPAINTED = 20.0  # change of L* that is enough instead
_WHITE_MATERIAL = 75.0  # own L* above which there is no upper end
_BLACK_MATERIAL = 40.0  # own L* below which there is no lower end
_REFLECTING = {"material/metallic": 0.5, "material/transmission": 0.5}
"""Family -> value above which an object mirrors or transmits its surroundings, so that its lightness is not claimed."""

_TONE_CASTS = {"shadow": "shadow_cast", "highlight": "highlight_cast"}
_TINTING = ("light", "fill", "rim", "ambience", "tone")  # kinds of targets whose color is a tint of the image


def of_color(attribute: Attribute, srgb: Values) -> Iterator[Claim]:
    """Claims of a color word: the color of an object, or a tint of the light, the air or the film."""
    word, part, thing = attribute.word, attribute.part, attribute.thing or attribute.region
    if attribute.kind in ("subject", "surroundings", "sky"):
        region: Region = "subject" if part == "subject" else "surroundings"
        shown = srgb_from_lab(display_color(srgb, region))
        lower, upper, hue = _interval(shown, 100 * oklab_from_srgb(srgb)[0])
        yield Claim(word, thing, "color", part, lower, upper, attribute.owners, None, hue, color=shown)
    elif attribute.kind in _TINTING:
        for tint in tints(word, "picture", "picture", srgb):
            yield from [as_accent(tint)] if attribute.of_one_light else _of_all_light(attribute, tint, srgb)
    # "teal shadows": a cast of the shadows, independent of paint; no claim for gray
    elif attribute.kind in _TONE_CASTS:
        for tint in tints(word, "picture", "picture", srgb):
            lower, upper = ((end,) for end in _CAST)
            measure = _TONE_CASTS[attribute.kind]
            yield replace(tint, measure=measure, lower=lower, upper=upper, change=None)
    elif attribute.kind == "fog":
        yield from tints(word, thing, "surroundings", srgb)
        light, strength = lab_from_srgb(srgb)[0], chroma(lab_from_srgb(srgb))
        if strength < COLORED and not _BLACK < light < _WHITE:
            white = light >= _WHITE
            ends = ((_WHITE_AIR,), (math.inf,)) if white else ((-math.inf,), (_BLACK_AIR,))
            yield Claim(word, attribute.thing, "air_lightness", "surroundings", *ends)


def _interval(shown: Values, named: float) -> tuple[Values, Values, Values]:
    """The lower and upper end of a color's interval, and its hue: a unit vector (a, b), or () for gray.

    The three numbers of an end are lightness, chroma along the hue and distance across the hue; for gray they are lightness, a and b.

    Args:
        shown: sRGB color nearest to the named one that an image can show. Yellow is shown darker, but not as dark as mustard.
        named: Lightness of the named color itself.
    """
    light, a, b = (100 * v for v in oklab_from_srgb(shown))
    strength = math.hypot(a, b)
    darkest = max(light - _LIGHTNESS, min(named - _FARTHEST, light))
    lightest = min(light + _LIGHTNESS, max(named + _FARTHEST, light))
    reach = max(_CHROMA * strength, _LEAST_CHROMA)
    if strength <= _FAINTEST:
        return (darkest, a - reach, b - reach), (lightest, a + reach, b + reach), ()
    reach = min(reach, max(_OFF_GRAY * (strength - _LEAST_CHROMA), 1.0))  # pale, but no gray
    across = min(reach, max(_ASIDE * strength, _LEAST_ASIDE))
    ends = (darkest, strength - reach, -across), (lightest, strength + reach, across)
    return *ends, (a / strength, b / strength)


def tints(word: str, thing: str, part: Part, srgb: Values, materials: tuple[str, ...] = ()) -> Iterator[Claim]:
    """The claim that the mean color of a part is tinted toward a color; none if the color is gray."""
    named = lab_from_srgb(srgb)
    if (strength := chroma(named)) >= COLORED:
        hue = named[1] / strength, named[2] / strength
        yield Claim(word, thing, "tint", part, (_TINTED,), (math.inf,), materials, _TINTED_MORE, hue, srgb)


def as_accent(tint: Claim) -> Claim:
    """The claim for a tint that is one of several in the image: only a tenth of the image has to have it."""
    return replace(tint, measure="accent", lower=(_ACCENT,), upper=(math.inf,))


def _of_all_light(attribute: Attribute, tint: Claim, srgb: Values) -> Iterator[Claim]:
    """Claims that a color tints the whole image and, if it is the light's, that the hue is right: green light is not turquoise."""
    strength, least, change = chroma(lab_from_srgb(srgb)), _TINTED, _TINTED_MORE
    if attribute.kind == "light":
        least = max(min(_LIT, _LIT_SHARE * strength), least)
        change = max(_LIT_MORE * least, change)
    most = max(_MOST_SHARE * strength, _LEAST_MOST)
    yield replace(tint, lower=(least,), upper=(most,), change=change)
    if attribute.kind == "light":
        a, b = tint.direction
        aside = replace(tint, measure="off_hue", direction=(-b, a), change=0.0)
        yield replace(aside, lower=(-_OFF_HUE,), upper=(_OFF_HUE,))


def of_material(attribute: Attribute, others: Iterable[Attribute], vocabulary: Vocabulary) -> Iterator[Claim]:
    """Claims of a material with a color of its own, as gold. For one with only a usual color, as leather, a color in `others` wins."""
    entry, part = vocabulary.entries.get(attribute.entry), attribute.part
    if entry is None or entry.slot != "material" or part == "picture":
        return
    painted = any(_colors(other, attribute) for other in others)
    reflects = any(max(e.upper, default=0.0) > _REFLECTING.get(e.family, math.inf) for e in entry.effects)
    for effect in entry.effects:
        own = effect.family == "material/tint" and effect.mode == "color" and effect.color[0] == "#"
        if not own or (effect.weak and painted):
            continue
        srgb, thing = srgb_from_hex(effect.color), attribute.thing or part
        for tint in tints(attribute.word, thing, part, srgb, attribute.owners):
            yield replace(tint, change=None)  # no change is enough: less blue gold is still not gold
        light, strength = lab_from_srgb(srgb)[0], chroma(lab_from_srgb(srgb))
        if reflects or strength >= COLORED:
            continue
        # A gray material has about its own lightness: snow is white, and asphalt is not.
        lower = -math.inf if light < _BLACK_MATERIAL else _DARKER * light
        upper = math.inf if light > _WHITE_MATERIAL else light + _LIGHTER
        change = _REPAINTED if upper == math.inf else -_REPAINTED if lower == -math.inf else None
        ends = (lower,), (upper,)
        yield Claim(attribute.word, thing, "lightness", part, *ends, attribute.owners, change, color=srgb)


def _colors(color: Attribute, material: Attribute) -> bool:
    """True if a color word describes the same objects as a material word."""
    owners = {*color.owners}, {*material.owners}
    same = not all(owners) or not owners[0].isdisjoint(owners[1])
    return color.color is not None and not color.negated and color.region == material.region and same
