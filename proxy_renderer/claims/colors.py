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

# Tints of colored light, air and film
COLORED = 12.0  # C* below which a color tints nothing
_TINTED, _TINTED_MORE = 6.0, 3.0  # least tint along the color's hue; increase that is enough instead

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
    elif attribute.kind in ("shadow", "highlight"):
        for tint in tints(word, "picture", "picture", srgb):
            yield replace(tint, measure=f"{attribute.kind}_cast", lower=(6.0,), upper=(24.0,), change=None)
    elif attribute.kind == "fog":
        yield from tints(word, thing, "surroundings", srgb)
        light, strength = lab_from_srgb(srgb)[0], chroma(lab_from_srgb(srgb))
        if strength < COLORED and not 35.0 < light < 85.0:  # white or black fog
            ends = ((74.0,), (math.inf,)) if light >= 85.0 else ((-math.inf,), (35.0,))
            yield Claim(word, attribute.thing, "air_lightness", "surroundings", *ends)


def _interval(shown: Values, named: float) -> tuple[Values, Values, Values]:
    """The lower and upper end of a color's interval, and its hue: a unit vector (a, b), or () for gray.

    An end has lightness, chroma along the hue and distance across it; for gray: lightness, a and b. `shown` is the sRGB
    color that an image can show nearest to the named color, whose lightness is `named`. Yellow is shown darker than
    named, but not as dark as mustard.
    """
    light, a, b = (100 * v for v in oklab_from_srgb(shown))
    strength = math.hypot(a, b)
    # Not far from the named color's lightness, unless an image cannot show it
    darkest = max(light - 10.0, min(named - 12.0, light))
    lightest = min(light + 10.0, max(named + 12.0, light))
    reach = max(0.25 * strength, 2.5)
    if strength <= 1.8:
        return (darkest, a - reach, b - reach), (lightest, a + reach, b + reach), ()
    reach = min(reach, max(0.6 * (strength - 2.5), 1.0))  # pale, but no gray
    across = min(reach, max(0.2 * strength, 1.5))
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
    return replace(tint, measure="accent", lower=(12.0,), upper=(math.inf,))


def _of_all_light(attribute: Attribute, tint: Claim, srgb: Values) -> Iterator[Claim]:
    """Claims that a color tints the image and, for colored light, that its hue is right: green is not turquoise."""
    strength, least, change = chroma(lab_from_srgb(srgb)), _TINTED, _TINTED_MORE
    if attribute.kind == "light":
        least = max(min(20.0, 0.4 * strength), least)
        change = max(0.8 * least, change)  # white in yellow light looks yellow
    most = max(0.5 * strength, 25.0)  # more would leave no other colors
    yield replace(tint, lower=(least,), upper=(most,), change=change)
    if attribute.kind == "light":
        a, b = tint.direction
        yield replace(tint, measure="off_hue", direction=(-b, a), lower=(-6.0,), upper=(6.0,), change=0.0)


def of_material(attribute: Attribute, others: Iterable[Attribute], vocabulary: Vocabulary) -> Iterator[Claim]:
    """Claims of a material with a color of its own, as gold.

    A color that a material only usually has, as leather, is overridden by a color word for it in `others`.
    """
    entry, part = vocabulary.entries.get(attribute.entry), attribute.part
    if entry is None or entry.slot != "material" or part == "picture":
        return
    colors = [a for a in others if a.color is not None and not a.negated and a.region == attribute.region]
    mine = {*attribute.owners}
    painted = any(not (a.owners and mine) or not mine.isdisjoint(a.owners) for a in colors)
    # An object that mirrors or transmits its surroundings has no lightness of its own.
    families = "material/metallic", "material/transmission"
    reflects = any(e.family in families and max(e.upper, default=0.0) > 0.5 for e in entry.effects)
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
        lower = -math.inf if light < 40.0 else 0.65 * light  # white has shaded parts
        upper = math.inf if light > 75.0 else light + 22.0  # black has highlights
        change = 20.0 if upper == math.inf else -20.0 if lower == -math.inf else None
        ends = (lower,), (upper,)
        yield Claim(attribute.word, thing, "lightness", part, *ends, attribute.owners, change, color=srgb)
