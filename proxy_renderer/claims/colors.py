# SPDX-License-Identifier: Apache-2.0
"""Claims of color words and of materials that have a color."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import replace

from ..color.floats import chroma, lab_from_srgb, oklab_from_srgb, srgb_from_hex, srgb_from_lab
from ..prompt.colors import display_color
from ..prompt.lexicon.vocabulary import Vocabulary, VocabularyEntry
from ..prompt.types import Attribute
from ..schema import Values
from ..schema.spec import Region
from .claim import Claim
from .measures.picture import Part

_LIGHTNESS, _CHROMA, _LEAST_CHROMA = 10.0, 0.25, 2.5
"""How far a color may be from the one that can be shown, OKLab times 100: lightness, and a share of its chroma but at least
this."""
_FAINTEST, _OFF_GRAY = 1.8, 0.6
"""Chroma from which a color is not gray, and how much of what it has beyond the least a picture of it may lack."""
_ASIDE, _LEAST_ASIDE = 0.2, 1.5
"""How far across its hue, as a share of its chroma, but at least this: hue says the more the more chroma there is."""
_FARTHEST = 12.0
"""How much lighter or darker than the named color it may be; more, only where it cannot be shown."""

_DIM, _DIMMEST = 45.0, 0.5
"""L* of a whole picture from where it is dark, and the share of a color's lightness that is left of it at least."""

_LIT_WHITE = 6.0
"""How far white things may lie in the direction of the light's color, OKLab times 100."""

COLORED = 12.0  # C* below which a color tints nothing
_TINTED = (6.0, 3.0)
"""How far in a color's direction a tinted picture lies, or how much farther than before; in a* and b*."""
_LIT, _LIT_SHARE, _LIT_CHANGE = 20.0, 0.4, 0.8
"""The same where the light itself has the color, but no more than this share of its chroma, and the share of that which is enough of a
change: in yellow light white things are yellow, not only less blue."""

_OFF_HUE = 6.0  # how far it may lie beside that direction, unless it did before

_BLACK, _WHITE = 35.0, 85.0  # L* of a name up to which air is black, and from which it is white
_AIR = (35.0, 74.0)
"""L* that black air has at most, and white air at least."""

_ACCENT = 12.0
"""The same for a tenth of the picture, where it is one of several lights that has the color."""

_DROWNED, _LEAST_DROWNED = 0.5, 25.0
"""Share of a color's chroma, but at least this, at which its light leaves nothing of the picture's other colors."""

_TONED = {"shadow": "shadow_cast", "highlight": "highlight_cast"}
"""Kinds of things whose color is a cast of the picture's darks or lights -> its measure."""
_CAST = (6.0, 24.0)
"""How far a cast lies in the color's direction at least, and at most; a* and b*. Less blue lights than before are not orange yet."""

_LIGHTING = ("light", "fill", "rim", "ambience", "tone")
"""Kinds of things whose color is a tint of the picture."""


def of_color(attribute: Attribute, srgb: Values) -> Iterator[Claim]:
    """A color word: the color of a thing, or a tint of the light, the air or the film."""
    part, thing = part_of(attribute), attribute.thing or attribute.region
    if attribute.kind in ("subject", "surroundings", "sky"):
        region: Region = "subject" if part == "subject" else "surroundings"
        shown = srgb_from_lab(display_color(srgb, region))
        lower, upper, hue = _around(shown, 100 * oklab_from_srgb(srgb)[0])
        yield Claim(
            attribute.word, thing, "color", part, lower, upper, attribute.owners, None, hue, color=shown
        )
    elif attribute.kind in _LIGHTING:
        for tint in tinted(attribute.word, "picture", "picture", srgb):
            yield from [as_accent(tint)] if attribute.of_one_light else _of_all_light(attribute, tint, srgb)
    elif attribute.kind in _TONED:
        yield from _toned(attribute, srgb)
    elif attribute.kind == "fog":
        yield from tinted(attribute.word, thing, "surroundings", srgb)
        yield from _of_gray_air(attribute, srgb)


def _of_all_light(attribute: Attribute, tint: Claim, srgb: Values) -> Iterator[Claim]:
    """That a color tints all of the picture, and, where it is the light's, that nothing else does."""
    strength, (least, change) = chroma(lab_from_srgb(srgb)), _TINTED
    if attribute.kind == "light":
        least = max(min(_LIT, _LIT_SHARE * strength), least)
        change = max(_LIT_CHANGE * least, change)
    most = max(_DROWNED * strength, _LEAST_DROWNED)
    yield replace(tint, lower=(least,), upper=(most,), change=change)
    if attribute.kind == "light":
        yield _beside(tint)


def _beside(tint: Claim) -> Claim:
    """That a picture in colored light has no other tint besides: in green light it is green, not turquoise."""
    a, b = tint.direction
    return replace(
        tint, measure="off_hue", direction=(-b, a), lower=(-_OFF_HUE,), upper=(_OFF_HUE,), change=0.0
    )


def as_accent(tint: Claim) -> Claim:
    """A tint of the picture where it is one of several: a tenth of the picture has it."""
    return replace(tint, measure="accent", lower=(_ACCENT,), upper=(math.inf,))


def _of_gray_air(attribute: Attribute, srgb: Values) -> Iterator[Claim]:
    """ "White fog" is light, "black smoke" is dark; nothing for air that has a color, or is gray."""
    light, a, b = lab_from_srgb(srgb)
    dark, bright = _AIR
    if math.hypot(a, b) < COLORED and not _BLACK < light < _WHITE:
        ends = ((bright,), (math.inf,)) if light >= _WHITE else ((-math.inf,), (dark,))
        yield Claim(attribute.word, attribute.thing, "air_lightness", "surroundings", *ends)


def _toned(attribute: Attribute, srgb: Values) -> Iterator[Claim]:
    """ "Teal shadows": a cast of what is dark, whatever is painted; nothing for gray."""
    measure, (least, most) = _TONED[attribute.kind], _CAST
    tints = tinted(attribute.word, "picture", "picture", srgb)
    yield from (replace(t, measure=measure, lower=(least,), upper=(most,), change=None) for t in tints)


def _around(shown: Values, named: float) -> tuple[Values, Values, Values]:
    """The interval of a color, OKLab times 100, and its hue: a unit vector in a and b; none for gray.

    Lightness, then chroma and what lies across the hue, or, of gray, a and b.

    Args:
        shown: What a picture can show of it, sRGB.
        named: Lightness of the color itself: yellow is shown darker, but not as dark as mustard.
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


def in_the_dark(claim: Claim, darkest: float) -> Claim:
    """A claim about a thing's color as it is in a picture that is to be dark: blue nights are no light blue, but no gray either.

    Args:
        claim: Any; others than those of the color or the lightness of a part stay.
        darkest: L* that the whole picture has at most.
    """
    if darkest >= _DIM:
        return claim
    if claim.measure == "lightness" and claim.part != "picture":
        return replace(claim, lower=(max(darkest / _DIM, _DIMMEST) * claim.lower[0],))
    if claim.measure != "color":
        return claim
    middle = (claim.lower[0] + claim.upper[0]) / 2
    level = 100 * oklab_from_srgb(srgb_from_lab((darkest, 0.0, 0.0)))[0]
    share = min(max(level / middle, _DIMMEST), 1.0)
    shares = share, math.sqrt(share), math.sqrt(share)  # of lightness; chroma is what the color is known by
    return replace(
        claim,
        lower=tuple(min(end, part * end) for end, part in zip(claim.lower, shares, strict=True)),
        upper=tuple(max(end, part * end) for end, part in zip(claim.upper, shares, strict=True)),
    )


def in_colored_light(claim: Claim, casts: Iterable[Values]) -> Claim:
    """A claim about white or gray as it is in colored light: at blue hour a white car is bluish, and is not painted yellow for it.

    Args:
        claim: Any; others than those of white and gray stay.
        casts: Unit vectors in a and b, where light is to have a color.
    """
    if claim.measure != "color" or claim.direction:
        return claim
    (light, *lower), (lightest, *upper) = claim.lower, claim.upper
    for cast in casts:
        lower = [min(end, end + _LIT_WHITE * part) for end, part in zip(lower, cast, strict=True)]
        upper = [max(end, end + _LIT_WHITE * part) for end, part in zip(upper, cast, strict=True)]
    return replace(claim, lower=(light, *lower), upper=(lightest, *upper))


def tinted(
    word: str, thing: str, part: Part, srgb: Values, materials: tuple[str, ...] = ()
) -> Iterator[Claim]:
    """That the mean color lies in a color's direction; nothing for a color that is none."""
    named = lab_from_srgb(srgb)
    if (strength := chroma(named)) >= COLORED:
        direction = named[1] / strength, named[2] / strength
        least, change = _TINTED
        yield Claim(word, thing, "tint", part, (least,), (math.inf,), materials, change, direction, srgb)


def part_of(attribute: Attribute) -> Part:
    """The part of the picture that a word describes."""
    if attribute.kind == "sky":
        return "sky"
    return "picture" if attribute.region == "whole" else attribute.region


_DARKER, _LIGHTER, _REPAINTED = 0.65, 22.0, 20.0
"""Share of a gray material's lightness that it has at least, for white things have shades; L* that it may have beyond its own,
for black ones have highlights; and what is enough of a change."""
_WHITE_MATTER, _GRAY_MATTER = 75.0, 40.0
"""L* from where a material cannot be too light, and up to which it cannot be too dark."""
_REFLECTING = {"material/metallic": 0.5, "material/transmission": 0.5}
"""Components -> the value from where a thing shows its surroundings, and is as light as they are."""


def of_matter(attribute: Attribute, beside: Iterable[Attribute], vocabulary: Vocabulary) -> Iterator[Claim]:
    """A material with a color of its own: gold tints the thing, coal is as dark as coal is.

    Args:
        beside: All of the prompt: a color that is named for the same thing is the color of what may have any, as leather.
    """
    entry, part = vocabulary.entries.get(attribute.entry), part_of(attribute)
    if entry is None or entry.slot != "material" or part == "picture":
        return
    painted = any(_paints(other, attribute) for other in beside)
    for effect in entry.effects:
        own = effect.family == "material/tint" and effect.mode == "color" and effect.color[0] == "#"
        if own and not (effect.weak and painted):
            srgb = srgb_from_hex(effect.color)
            claims = tinted(attribute.word, attribute.thing or part, part, srgb, attribute.owners)
            # Gold that is blue is none, however much less blue than before.
            yield from (replace(claim, change=None) for claim in claims)
            if not _reflects(entry):
                yield from _as_light(attribute, srgb)


def _reflects(entry: VocabularyEntry) -> bool:
    """Whether a material mirrors its surroundings or lets them be seen, as metals and glass do."""
    return any(
        max(effect.upper, default=0.0) > _REFLECTING.get(effect.family, math.inf) for effect in entry.effects
    )


def _as_light(attribute: Attribute, srgb: Values) -> Iterator[Claim]:
    """That a thing of a gray material is about as light as that: snow is white, and asphalt is not."""
    light, strength = lab_from_srgb(srgb)[0], chroma(lab_from_srgb(srgb))
    if strength >= COLORED:
        return
    lower = -math.inf if light < _GRAY_MATTER else _DARKER * light
    upper = math.inf if light > _WHITE_MATTER else light + _LIGHTER
    change = _REPAINTED if upper == math.inf else -_REPAINTED if lower == -math.inf else None
    part = part_of(attribute)
    thing, ends = attribute.thing or part, ((lower,), (upper,))
    yield Claim(attribute.word, thing, "lightness", part, *ends, attribute.owners, change, color=srgb)


def _paints(color: Attribute, matter: Attribute) -> bool:
    """Whether one of two attributes is the color of what the other says is the material."""
    same = not (color.owners and matter.owners) or not {*color.owners}.isdisjoint(matter.owners)
    return color.color is not None and not color.negated and color.region == matter.region and same
