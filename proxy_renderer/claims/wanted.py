# SPDX-License-Identifier: Apache-2.0
"""From words to claims: what a prompt, understood, says that the picture has to look like."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import cast

from ..color.floats import chroma, lab_from_srgb, srgb_from_hex
from ..color.shades import warm
from ..prompt.lexicon.vocabulary import Vocabulary
from ..prompt.meaning import heads_of
from ..prompt.types import Attribute, Parsed
from ..schema import Values
from .claim import Claim
from .colored import as_accent, in_the_dark, of_color, of_matter, part_of
from .comparing import compares
from .measures.picture import Part
from .notation import ClaimText, read_claim

_OF_MOODS = 0.5
"""Weight of what a mood stands for."""

_SLIGHT = 0.8
"""Strength below which a word is a weak one."""

_TIMELY = "light_temperature"
"""A head that times of day have too: of several words for it claims choose, not the first one of the prompt."""

_DIMMEST = 24.0
"""L* of the lightest parts of a subject in the dark, at least."""

_OPPOSED = 0.5
"""Cosine between a tint and the other direction, from where a picture cannot have both."""

_LIT, _STILL = 44.0, 0.7
"""L* of a picture in colored light at least, and the share of the color's own lightness that is enough for dark colors."""

_USUAL = ("atmosphere", "setting")
"""Slots of words that say only what is usual of other measures than their own: the later, the less."""

_COLORED = ("warmth", "tint", "accent", "chroma")
"""Measures of what lies around that a color word for it fixes."""


def claims_of(parsed: Parsed, vocabulary: Vocabulary) -> tuple[Claim, ...]:
    """The claims of a prompt, and what holds of every picture: that its subject can be seen.

    Args:
        parsed: The prompt, bound to what the scene has.
        vocabulary: What words mean.

    Raises:
        VibeError: A claim in the vocabulary cannot be read.
    """
    words = [a for a in parsed.attributes if a not in parsed.overruled]
    said = _parted([(a, tuple(_of_word(a, parsed, vocabulary))) for a in words])
    claims: dict[tuple[object, ...], Claim] = {}
    for attribute, row in sorted(said, key=lambda pair: _rank(*pair)):
        compared = compares(attribute, parsed.attributes, vocabulary)
        for claim in row:
            hue = () if claim.measure == "color" else claim.direction
            key = (claim.measure, claim.part, claim.materials, hue)
            claims.setdefault(key, replace(claim, compares=compared))
    said_colors = [
        claim for attribute, row in said if attribute.color and not attribute.cause for claim in row
    ]
    casts = [c for c in claims.values() if c.part == "picture" and _asks(c)] + said_colors
    claims = {key: claim for key, claim in claims.items() if not _gives_way(claim, said_colors, casts)}
    darkest = min((c.upper[0] for c in claims.values() if _is_brightness(c)), default=math.inf)
    claims |= _still_light(said_colors, claims.values())
    painted = [c for attribute, row in said for c in row if _is_painted(c, attribute)]
    colored = [c for c in claims.values() if c.measure == "color"] + painted
    lights = (_lit(c, colored) if _is_light(c) else in_the_dark(c, darkest) for c in claims.values())
    return (*lights, *_of_every_picture(parsed))


def _parted(said: list[tuple[Attribute, tuple[Claim, ...]]]) -> list[tuple[Attribute, tuple[Claim, ...]]]:
    """Words with what they claim; colors of light that no picture can have all over, magenta and cyan, have a part of it each."""
    tints = [c for a, row in said if a.color for c in row if (c.part, c.measure) == ("picture", "tint")]
    apart = [c for c in tints if any(_against(c, other.direction) for other in tints)]
    return [(a, tuple(as_accent(c) if c in apart else c for c in row)) for a, row in said]


def _lit(claim: Claim, colored: Sequence[Claim]) -> Claim:
    """A claim about light, measured on what has no color of its own by other words."""
    apart = (
        (c.part, c.materials)
        for c in colored
        if c.measure == "color" or c.part == "sky" or c.word != claim.word
    )
    return replace(claim, apart=tuple(dict.fromkeys(apart)))


def _still_light(colors: Sequence[Claim], claims: Iterable[Claim]) -> dict[tuple[object, ...], Claim]:
    """That colored light is no dark light: where no word says how light the picture is, it stays as light as the color is.

    A tint could be had by exposing less, where it would drown the other colors.

    Args:
        colors: Claims of color words.
        claims: All of them.
    """
    tints = [c.color for c in colors if (c.part, c.measure) == ("picture", "tint") and c.color]
    if not tints or any(map(_is_brightness, claims)):
        return {}
    least = min(_STILL * min(lab_from_srgb(color)[0] for color in tints), _LIT)
    return {
        ("lightness", "picture"): Claim(
            "", "picture", "lightness", "picture", (least,), (math.inf,), change=0.0
        )
    }


def _rank(attribute: Attribute, claims: Sequence[Claim]) -> tuple[bool, int, int]:
    """Which of two words for one measure goes first, the least.

    The prompt's own before what another one stands for, light before weather and that before a setting, and what is about
    nothing else before what has it among other things: dusk is cool, but not in the light of a warm lamp.
    """
    usual = _USUAL.index(attribute.slot) + 1 if attribute.slot in _USUAL else 0
    return bool(attribute.cause), usual, len({(c.measure, c.part) for c in claims})


def _is_brightness(claim: Claim) -> bool:
    return claim.part == "picture" and claim.measure == "lightness"


def _gives_way(claim: Claim, colors: Sequence[Claim], casts: Sequence[Claim]) -> bool:
    """Whether what colors claim that the prompt names rules out what a word usually is like.

    A forest before a purple background is not green, a morning of pale blue light not warm, and a gallery at sunset not gray.

    Args:
        claim: Of any word.
        colors: Claims of color words.
        casts: Claims that light is warm, cool or of a color.
    """
    if claim in colors:
        return False
    if claim.part == "picture" and claim.measure in ("warmth", "tint"):
        tints = [c for c in colors if (c.part, c.measure) == ("picture", "tint")]
        return any(_against(claim, c.direction) for c in tints)
    if claim.part in ("surroundings", "sky") and claim.measure in _COLORED and not claim.materials:
        gray = (claim.part, claim.measure) == ("surroundings", "chroma")
        if gray and any(c.part == "picture" and c.word != claim.word for c in casts):
            return True
        same = [c for c in colors if c.part == claim.part and not c.materials]
        return any(c.measure == "color" or _against(claim, c.direction) for c in same)
    return False


def _against(claim: Claim, direction: Values) -> bool:
    """Whether a color lies on the other side of what a claim about warmth or a tint asks for."""
    if not direction:
        return False
    if claim.direction:
        return sum(a * b for a, b in zip(claim.direction, direction, strict=True)) < -_OPPOSED
    return _asks(claim) * warm(*direction) < -_OPPOSED


def _asks(claim: Claim) -> int:
    """Whether a claim asks for warmth (1), for coolness (-1), or for neither."""
    if claim.measure != "warmth":
        return 0
    return 1 if claim.lower[0] > 0.0 else -1 if claim.upper[0] < 0.0 else 0


def _is_painted(claim: Claim, attribute: Attribute) -> bool:
    """Whether a claim is the color of a place or a sky, not of the light there: sand is yellow at noon, and a sunset's sky orange."""
    if claim.part == "sky":
        return claim.measure in ("tint", "accent", "warmth")
    return (
        attribute.slot == "setting" and claim.part == "surroundings" and claim.measure in ("tint", "accent")
    )


def _is_light(claim: Claim) -> bool:
    """Whether a claim is about the color of light, which things that have a color of their own hide."""
    return claim.part == "picture" and claim.measure in ("warmth", "tint", "accent")


def _of_word(attribute: Attribute, parsed: Parsed, vocabulary: Vocabulary) -> Iterator[Claim]:
    if attribute.color:
        word, weight = attribute.cause or attribute.word, _OF_MOODS if attribute.cause else 1.0
        claims = () if attribute.negated else of_color(attribute, attribute.color)
        yield from (replace(claim, word=word, weight=weight) for claim in claims)
        return
    entry = vocabulary.entries.get(attribute.entry)
    if entry and not attribute.negated:
        yield from (_bound(read_claim(text), attribute) for text in entry.claims)
        yield from of_matter(attribute, vocabulary)
    for head, value in heads_of(attribute, vocabulary).items():
        if attribute.owners or head == _TIMELY or parsed.targets.get(head) == value:
            yield from (_bound(text, attribute) for text in _of_heads().get((head, value), ()))


def _of_every_picture(parsed: Parsed) -> Iterator[Claim]:
    """That the subject stands out from what is around it, and neither burns out nor drowns, or no more than before."""
    silhouette = any(a.entry == "silhouette" and not a.negated for a in parsed.attributes)
    yield _of_subject("separation", lower=10.0)
    yield _of_subject("burnt", upper=0.06)
    if silhouette:
        return
    if parsed.targets.get("brightness") == "dark":  # even at night its lights are seen
        yield _of_subject("white_point", lower=_DIMMEST)
    else:
        yield _of_subject("drowned", upper=0.3)


def _of_subject(measure: str, lower: float = -math.inf, upper: float = math.inf) -> Claim:
    return Claim("", "subject", measure, "subject", (lower,), (upper,), change=0.0)


def _bound(text: ClaimText, attribute: Attribute) -> Claim:
    """A claim about what a word describes; a strong word asks for more of a change, a weak one for less.

    What a mood stands for counts less than what is said, and too much of it comes sooner: a summery picture is not all orange.
    """
    own = text.part == "thing"
    part = part_of(attribute) if own else cast(Part, text.part)
    lower, upper = (
        _milder(text) if attribute.cause or attribute.strength < _SLIGHT else (text.lower, text.upper)
    )
    named = lab_from_srgb(srgb_from_hex(text.color)) if text.color else (0.0, 0.0, 0.0)
    return Claim(
        word=attribute.cause or attribute.word,
        thing=(attribute.thing or part) if own else part,
        measure=text.measure,
        part=part,
        lower=(lower,),
        upper=(upper,),
        materials=attribute.owners if own else (),
        change=None if text.change is None else text.change * attribute.strength,
        direction=tuple(v / chroma(named) for v in named[1:]) if text.color else (),
        color=srgb_from_hex(text.color) if text.color else None,
        weight=_OF_MOODS if attribute.cause else 1.0,
        near=text.near,
    )


def _milder(text: ClaimText) -> tuple[float, float]:
    """The ends of an interval whose far end, where there is too much, is nearer; others stay."""
    middle = (text.lower + text.upper) / 2
    if text.change is None or not math.isfinite(middle):
        return text.lower, text.upper
    return (text.lower, middle) if text.change > 0 else (middle, text.upper)


@cache
def _of_heads() -> dict[tuple[str, str], tuple[ClaimText, ...]]:
    """(head, class) -> its claims, from `heads.toml`."""
    rows = tomllib.loads(Path(__file__).with_name("heads.toml").read_text("utf-8"))
    return {
        (head, value): tuple(map(read_claim, texts))
        for head, classes in rows.items()
        for value, texts in classes.items()
    }
