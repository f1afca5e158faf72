# SPDX-License-Identifier: Apache-2.0
"""From words to claims: what a prompt, understood, says that the picture has to look like."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import cast

from ..color.floats import chroma, lab_from_srgb, oklab_from_srgb, srgb_from_hex, srgb_from_lab
from ..prompt.lexicon.vocabulary import Vocabulary
from ..prompt.meaning import display_color, heads_of
from ..prompt.types import Attribute, Parsed
from ..schema import Values
from ..schema.spec import Region
from .claim import Claim
from .measures.picture import Part
from .notation import ClaimText, read_claim

_LIGHTNESS, _CHROMA, _LEAST_CHROMA = 12.0, 0.35, 4.0
"""How far a color may be from the named one, OKLab times 100: lightness, and a share of its chroma but at least this."""

_COLORED = 12.0  # C* below which a color tints nothing
_TINTED = (6.0, 3.0)
"""How far in a color's direction a tinted picture lies, or how much farther than before; in a* and b*."""

_DROWNED, _LEAST_DROWNED = 0.5, 25.0
"""Share of a color's chroma, but at least this, at which its light leaves nothing of the picture's other colors."""

_TONED = {"shadow": "shadow_warmth", "highlight": "highlight_warmth"}
"""Kinds of things whose color is a warmth of the picture's darks or lights -> its measure."""
_WARM = (4.0, 4.0)
"""How warm or cold they are, or by how much more than before; b*."""

_LIGHTING = ("light", "fill", "rim", "ambience", "tone")
"""Kinds of things whose color is a tint of the picture."""


def claims_of(parsed: Parsed, vocabulary: Vocabulary) -> tuple[Claim, ...]:
    """The claims of a prompt, and what holds of every picture: that its subject can be seen.

    Args:
        parsed: The prompt, bound to what the scene has.
        vocabulary: What words mean.

    Raises:
        VibeError: A claim in the vocabulary cannot be read.
    """
    claims: dict[tuple[object, ...], Claim] = {}
    for attribute in sorted(parsed.attributes, key=lambda a: bool(a.cause)):
        if attribute in parsed.overruled:
            continue
        for claim in _of_word(attribute, parsed, vocabulary):
            claims.setdefault((claim.measure, claim.part, claim.materials, claim.direction), claim)
    colored = tuple((c.part, c.materials) for c in claims.values() if c.measure == "color")
    lights = (replace(c, apart=colored) if _is_light(c) else c for c in claims.values())
    return (*lights, *_of_every_picture(parsed))


def _is_light(claim: Claim) -> bool:
    """Whether a claim is about the color of light, which things that have a color of their own hide."""
    return claim.part == "picture" and claim.measure in ("warmth", "tint")


def _of_word(attribute: Attribute, parsed: Parsed, vocabulary: Vocabulary) -> Iterator[Claim]:
    if attribute.color:
        yield from () if attribute.negated else _of_color(attribute, attribute.color)
        return
    entry = vocabulary.entries.get(attribute.entry)
    if entry and not attribute.negated:
        yield from (_bound(read_claim(text), attribute) for text in entry.claims)
        yield from _of_matter(attribute, vocabulary)
    for head, value in heads_of(attribute, vocabulary).items():
        if attribute.owners or parsed.targets.get(head) == value:
            yield from (_bound(text, attribute) for text in _of_heads().get((head, value), ()))


def _of_every_picture(parsed: Parsed) -> Iterator[Claim]:
    """That the subject stands out from what is around it, and neither burns out nor drowns, or no more than before."""
    silhouette = any(a.entry == "silhouette" and not a.negated for a in parsed.attributes)
    yield _of_subject("separation", lower=10.0)
    yield _of_subject("burnt", upper=0.06)
    if not silhouette and parsed.targets.get("brightness") != "dark":
        yield _of_subject("drowned", upper=0.3)


def _of_subject(measure: str, lower: float = -math.inf, upper: float = math.inf) -> Claim:
    return Claim("", "subject", measure, "subject", (lower,), (upper,), change=0.0)


def _of_color(attribute: Attribute, srgb: Values) -> Iterator[Claim]:
    """A color word: the color of a thing, or a tint of the light, the air or the film."""
    part, thing = _part(attribute), attribute.thing or attribute.region
    if attribute.kind in ("subject", "surroundings", "sky"):
        region: Region = "subject" if part == "subject" else "surroundings"
        shown = srgb_from_lab(display_color(srgb, region))
        named = tuple(100 * v for v in oklab_from_srgb(shown))
        reach = max(_CHROMA * math.hypot(*named[1:]), _LEAST_CHROMA)
        reaches = (_LIGHTNESS, reach, reach)
        lower, upper = (tuple(v + sign * r for v, r in zip(named, reaches, strict=True)) for sign in (-1, 1))
        yield Claim(attribute.word, thing, "color", part, lower, upper, attribute.owners, color=shown)
    elif attribute.kind in _LIGHTING:
        most = max(_DROWNED * chroma(lab_from_srgb(srgb)), _LEAST_DROWNED)
        tints = _tinted(attribute.word, "picture", "picture", srgb)
        yield from (replace(claim, upper=(most,)) for claim in tints)
    elif attribute.kind in _TONED:
        yield from _toned(attribute, srgb)
    elif attribute.kind == "fog":
        yield from _tinted(attribute.word, thing, "surroundings", srgb)


def _toned(attribute: Attribute, srgb: Values) -> Iterator[Claim]:
    """ "Orange highlights": warm ones; nothing for a color that is neither warm nor cold."""
    warmth, (least, change) = lab_from_srgb(srgb)[2], _WARM
    if abs(warmth) >= _COLORED:
        sign = math.copysign(1.0, warmth)
        ends = ((least,), (math.inf,)) if sign > 0 else ((-math.inf,), (-least,))
        measure = _TONED[attribute.kind]
        yield Claim(attribute.word, "picture", measure, "picture", *ends, change=sign * change)


def _of_matter(attribute: Attribute, vocabulary: Vocabulary) -> Iterator[Claim]:
    """A material with a color of its own, as gold has: the thing is tinted by it."""
    entry = vocabulary.entries[attribute.entry]
    part = _part(attribute)
    if entry.slot != "material" or part == "picture":
        return
    for effect in entry.effects:
        if (
            effect.family == "material/tint"
            and effect.mode == "color"
            and not effect.weak
            and effect.color[0] == "#"
        ):
            own = srgb_from_hex(effect.color)
            claims = _tinted(attribute.word, attribute.thing or part, part, own, attribute.owners)
            # Gold that is blue is none, however much less blue than before.
            yield from (replace(claim, change=None) for claim in claims)


def _tinted(
    word: str, thing: str, part: Part, srgb: Values, materials: tuple[str, ...] = ()
) -> Iterator[Claim]:
    """That the mean color lies in a color's direction; nothing for a color that is none."""
    named = lab_from_srgb(srgb)
    if (strength := chroma(named)) >= _COLORED:
        direction = named[1] / strength, named[2] / strength
        least, change = _TINTED
        yield Claim(word, thing, "tint", part, (least,), (math.inf,), materials, change, direction, srgb)


def _bound(text: ClaimText, attribute: Attribute) -> Claim:
    """A claim about what a word describes; a strong word asks for more of a change, a weak one for less."""
    own = text.part == "thing"
    part = _part(attribute) if own else cast(Part, text.part)
    return Claim(
        word=attribute.cause or attribute.word,
        thing=(attribute.thing or part) if own else part,
        measure=text.measure,
        part=part,
        lower=(text.lower,),
        upper=(text.upper,),
        materials=attribute.owners if own else (),
        change=None if text.change is None else text.change * attribute.strength,
    )


def _part(attribute: Attribute) -> Part:
    if attribute.kind == "sky":
        return "sky"
    return "picture" if attribute.region == "whole" else attribute.region


@cache
def _of_heads() -> dict[tuple[str, str], tuple[ClaimText, ...]]:
    """(head, class) -> its claims, from `heads.toml`."""
    rows = tomllib.loads(Path(__file__).with_name("heads.toml").read_text("utf-8"))
    return {
        (head, value): tuple(map(read_claim, texts))
        for head, classes in rows.items()
        for value, texts in classes.items()
    }
