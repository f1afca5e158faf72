# SPDX-License-Identifier: Apache-2.0
"""From words to claims: what a prompt, understood, says that the picture has to look like."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Container, Iterator, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import cast

from ..color.floats import chroma, lab_from_srgb, srgb_from_hex
from ..prompt.heads import heads_of
from ..prompt.lexicon.vocabulary import Vocabulary
from ..prompt.types import Attribute, Parsed
from .claim import Claim
from .colored import in_colored_light, in_the_dark, of_color, part_of
from .comparing import compares
from .conflicts import (
    USUAL,
    adds,
    asks,
    beside_painted,
    cast_of,
    gives_way,
    is_brightness,
    is_light,
    is_painted,
    lit,
    on_things,
    parted,
    still_light,
)
from .matter import of_matter
from .measures.picture import Part
from .notation import ClaimText, read_claim

_OF_MOODS = 0.5
"""Weight of what a mood stands for."""

_SLIGHT = 0.8
"""Strength below which a word is a weak one."""

_TIMELY = "light_temperature"
"""A head that times of day have too: of several words for it claims choose, not the first one of the prompt."""

_BURNT = 0.06
"""Share of a thing, or of the picture, that may burn out."""

_WHITE, _BRIGHT = 90.0, 60.0
"""L* of a color from where it is white, and of a picture that words ask for from where parts of it may burn out."""

_DROWNED = 0.12
"""Share of the picture that may drown in black, where no word asks for a dark one or a black thing."""

_OF_DARKNESS, _DARK, _BLACK = ("lightness", "black_point"), 50.0, 22.0
"""Measures of how dark something is, what words for dark ask for at most, and L* of a color up to which it is black."""

_DIMMEST = 24.0
"""L* of the lightest parts of a subject in the dark, at least."""


def claims_of(parsed: Parsed, vocabulary: Vocabulary, served: Container[Attribute] = ()) -> tuple[Claim, ...]:
    """The claims of a prompt, and what holds of every picture: that its subject can be seen.

    Args:
        parsed: The prompt, bound to what the scene has.
        vocabulary: What words mean.
        served: Words that a rig stands for, which claims what is to be seen of them.

    Raises:
        VibeError: A claim in the vocabulary cannot be read.
    """
    moods = bool(served)  # of which the rig is what is to be seen
    words = [
        a
        for a in parsed.attributes
        if a not in parsed.overruled and a not in served and not (moods and a.cause)
    ]
    said = parted([(a, tuple(_of_word(a, parsed, vocabulary))) for a in words])
    said_colors = [
        claim for attribute, row in said if attribute.color and not attribute.cause for claim in row
    ]
    claims: list[Claim] = []
    for attribute, row in sorted(said, key=lambda pair: _rank(*pair)):
        compared = compares(attribute, parsed.attributes, vocabulary)
        for claim in row:
            claim = replace(beside_painted(claim, attribute, said_colors), compares=compared)
            if all(adds(claim, attribute, first) for first in claims):
                claims.append(claim)
    casts = [c for c in claims if c.part == "picture" and asks(c)] + said_colors
    grays = [c for c in claims if c.color and c.measure == "lightness"]
    claims = [claim for claim in claims if not gives_way(claim, said_colors + grays, casts)]
    darkest = min((c.upper[0] for c in claims if is_brightness(c)), default=math.inf)
    claims += still_light(said_colors, claims)
    painted = [c for attribute, row in said for c in row if is_painted(c, attribute)]
    colored = [c for c in claims if c.measure == "color"] + painted
    tints = [cast for c in claims if (cast := cast_of(c))]
    shown = (
        lit(c, colored) if is_light(c) else in_colored_light(in_the_dark(c, darkest), tints) for c in claims
    )
    return (
        *map(on_things, shown),
        *_of_every_picture(parsed),
        *_unburnt(claims),
        *_undrowned(parsed, claims),
    )


def _rank(attribute: Attribute, claims: Sequence[Claim]) -> tuple[bool, int, int]:
    """Which of two words for one measure goes first, the least.

    The prompt's own before what another one stands for, light before weather and that before a setting, and what is about
    nothing else before what has it among other things: dusk is cool, but not in the light of a warm lamp.
    """
    usual = USUAL.index(attribute.slot) + 1 if attribute.slot in USUAL else 0
    return bool(attribute.cause), usual, len({(c.measure, c.part) for c in claims})


def _of_word(attribute: Attribute, parsed: Parsed, vocabulary: Vocabulary) -> Iterator[Claim]:
    if attribute.color:
        word, weight = attribute.cause or attribute.word, _OF_MOODS if attribute.cause else 1.0
        claims = () if attribute.negated else of_color(attribute, attribute.color)
        yield from (replace(claim, word=word, weight=weight) for claim in claims)
        return
    entry = vocabulary.entries.get(attribute.entry)
    if entry and not attribute.negated:
        yield from (_bound(read_claim(text), attribute) for text in entry.claims)
        yield from of_matter(attribute, parsed.attributes, vocabulary)
    for head, value in heads_of(attribute, vocabulary).items():
        if attribute.owners or head == _TIMELY or parsed.targets.get(head) == value:
            yield from (_bound(text, attribute) for text in _of_heads().get((head, value), ()))


def _of_every_picture(parsed: Parsed) -> Iterator[Claim]:
    """That the subject stands out from what is around it, and neither burns out nor drowns, or no more than before."""
    silhouette = any(a.entry == "silhouette" and not a.negated for a in parsed.attributes)
    yield Claim.unsaid("subject", "separation", lower=10.0)
    yield Claim.unsaid("subject", "burnt", upper=_BURNT)
    if silhouette:
        return
    if parsed.targets.get("brightness") == "dark":  # even at night its lights are seen
        yield Claim.unsaid("subject", "white_point", lower=_DIMMEST)
    else:
        yield Claim.unsaid("subject", "drowned", upper=0.3)


def _unburnt(claims: Sequence[Claim]) -> Iterator[Claim]:
    """That no more of the picture burns out than before, unless words ask for white or for a bright picture."""
    white = any(c.color and lab_from_srgb(c.color)[0] > _WHITE for c in claims)
    if not white and not any(is_brightness(c) and c.lower[0] > _BRIGHT for c in claims):
        yield Claim.unsaid("picture", "burnt", upper=_BURNT)


def _undrowned(parsed: Parsed, claims: Sequence[Claim]) -> Iterator[Claim]:
    """That no more of the picture drowns in black than before, unless words ask for dark, or for something that is."""
    black = any(c.color and lab_from_srgb(c.color)[0] < _BLACK for c in claims)
    dark = any(
        (c.measure in _OF_DARKNESS and c.upper[0] < _DARK) or c.measure == "silhouette" for c in claims
    )
    if not black and not dark and parsed.targets.get("brightness") != "dark":
        yield Claim.unsaid("picture", "drowned", upper=_DROWNED)


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
