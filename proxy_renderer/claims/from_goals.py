# SPDX-License-Identifier: Apache-2.0
"""From goals to claims about the image: the claims of single wishes, how they limit each other, and those of every image."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import product
from typing import Any

from ..color.floats import chroma, lab_from_srgb, srgb_from_hex
from ..goals.relative import goals_with_picture
from ..goals.resolve import Goals
from ..goals.wish import Wish
from ..schema import Values
from ..words.lexicon.quantities import ClaimText, quantities
from ..words.lexicon.vocabulary import Vocabulary
from ..words.types import Attribute, Part
from .claim import Claim
from .colors import as_accent, of_color, of_material

_OF_MOODS = 0.5  # weight of the claims that a mood implies
_BURNT = 0.06  # largest overexposed share of the image or of the subject

_TINTS = ("tint", "accent")

# Most change of a mean color after a further sentence, OKLab times 100: of a place in the image, of what is protected
_STILL, _EXACT = (1.0, 0.4, 0.4), (0.5, 0.2, 0.2)
_HAZY = 3.0  # OKLab lightness times 100 by which more or less fog may change the mean of the image


def claims_of(goals: Goals, vocabulary: Vocabulary) -> tuple[Claim, ...]:
    """The claims of the wishes in goals, and those that every image has to satisfy, as that its subject can be seen."""
    goals = goals_with_picture(goals, vocabulary)
    ranked = sorted((wish for wish in goals.wishes if not wish.of_picture), key=lambda wish: wish.rank)
    rows = _with_accents([(wish, [*_of_wish(wish, goals, vocabulary)]) for wish in ranked])
    colors = [c for wish, row in rows if wish.attribute.color and not wish.implied for c in row]

    # A word adds only claims that words of higher rank do not make already.
    claims: list[Claim] = []
    for wish, row in rows:
        for claim in row:
            if all(_narrows(claim, wish.usual > 0, first) for first in claims):
                claims.append(claim)
    # Less exposure would drown other colors in colored light. Without a claim on lightness, its color sets the least.
    tints = [c.color for c in colors if (c.part, c.measure) == ("picture", "tint") and c.color]
    if tints and not any((c.part, c.measure) == ("picture", "lightness") for c in claims):
        least = min(0.7 * min(lab_from_srgb(color)[0] for color in tints), 44.0)
        claims.append(Claim.unsaid("picture", "lightness", lower=least))

    # Claims about the color of light are measured where words give no color to objects.
    colored = [c for c in claims if c.measure == "color"]
    colored += [c for wish, row in rows for c in row if _is_painted(c, wish.attribute)]
    shown = []
    for claim in claims:
        if claim.part == "picture" and claim.measure in (*_TINTS, "warmth", "off_hue"):
            others = (c for c in colored if c.measure == "color" or c.part == "sky" or c.word != claim.word)
            claim = replace(claim, apart=tuple(dict.fromkeys((c.part, c.materials) for c in others)))
        if (claim.part, claim.measure) == ("picture", "chroma") and claim.lower[0] > 0.0:
            # "Vivid" is about objects: the world behind them may be gray, for it also lights them.
            claim = replace(claim, apart=(("sky", ()),))
        shown.append(claim)
    rig, pictured = (
        [_of_text(text, wish) for wish in wishes for text in wish.claims if text.weight]
        for wishes in (goals.shown, goals.pictured)
    )
    if goals.holds:
        every = [*_held(goals, [*claims, *rig])]
    else:
        every = [claim for claim in _of_every_image(goals, claims) if not _is_told(claim, pictured)]
    return (*light_claims(rig, claims), *shown, *every, *pictured)


def light_claims(light: Sequence[Claim], claims: Sequence[Claim]) -> Iterator[Claim]:
    """The claims `light` of a rig, each once: its `word` is the first that asks for it, other words are in its `also`.

    `claims` are those of single words.
    """
    # If words color the subject, the light's warmth is measured around it, and `standing_out` is not claimed.
    painted = any(c.part == "subject" and c.measure in ("color", "tint") for c in claims)
    words: dict[tuple[object, ...], dict[str, Claim]] = {}
    for claim in light:
        words.setdefault((claim.measure, claim.color), {}).setdefault(claim.word, claim)
    for same in words.values():
        claim = replace(next(iter(same.values())), also=tuple(same)[1:])
        if painted and claim.measure == "highlight_warmth":
            claim = replace(claim, thing="picture", part="picture", apart=(("subject", ()),))
        if not (painted and claim.measure == "standing_out"):
            yield claim


def _of_wish(wish: Wish, goals: Goals, vocabulary: Vocabulary) -> Iterator[Claim]:
    attribute = wish.attribute
    if attribute.color:
        weight = _OF_MOODS if wish.implied else 1.0
        for claim in of_color(attribute, attribute.color):
            yield replace(claim, word=wish.word, weight=weight)
        return
    yield from (_of_text(wish.asked_of(text), wish) for text in wish.claims if text.weight)
    if wish.quantity == "color" and not attribute.negated:
        yield from of_material(attribute, goals.parsed.attributes, vocabulary)


def _of_text(text: ClaimText, wish: Wish) -> Claim:
    """The claim of a wish that a text states. A claim that a mood implies has less weight than that of a named look."""
    attribute, part, own = wish.attribute, wish.part_of(text), text.part == "thing"
    color = srgb_from_hex(text.color) if text.color else None
    named = lab_from_srgb(color) if color else (0.0, 0.0, 0.0)
    return Claim(
        word=wish.word,
        thing=(attribute.thing or part) if own else part,
        measure=text.measure,
        part=part,
        lower=text.lower,
        upper=text.upper,
        materials=attribute.owners if own else (),
        change=text.change,
        direction=tuple(v / chroma(named) for v in named[1:]) if color else (),
        color=color,
        box=text.box,
        reason=f"{attribute.entry}: {text.reason}" if text.reason and wish.of_picture else text.reason,
        weight=text.weight * (_OF_MOODS if wish.implied else 1.0),
        near=text.near,
        by=text.by,
    )


def _with_accents(rows: list[tuple[Wish, list[Claim]]]) -> list[tuple[Wish, list[Claim]]]:
    """The rows (wish, its claims), in which some tints of the whole image become accents, see `as_accent`."""
    # Tints of opposite hues, which one image cannot have all over, and tints of several lights
    colored = [(wish.attribute, c) for wish, row in rows if wish.attribute.color for c in row]
    tints = [(a, c) for a, c in colored if (c.part, c.measure) == ("picture", "tint")]
    lights = [wish.attribute for wish, _ in rows if wish.quantity == "light_color"]
    cosines = [
        (c, sum(a * b for a, b in zip(c.direction, d.direction, strict=True))) for _, c in tints for _, d in tints
    ]
    opposed = [c for c, cosine in cosines if cosine < -0.5]
    opposed += [c for a, c in tints if any(a.is_of_another_light(light) for light in lights)]
    words, found = {c.word for c in opposed}, []
    for wish, row in rows:
        row = [c for c in row if c.measure != "off_hue" or c.word not in words]
        found.append((wish, [as_accent(c) if c in opposed else c for c in row]))
    return found


def _narrows(claim: Claim, usual: bool, first: Claim) -> bool:
    """True if a claim adds anything to `first`, one of higher rank; `usual`: it only says what a place usually has."""
    if _measured(claim) != _measured(first):
        return True
    # If several words color one part, the first counts.
    if first.color or claim.word == first.word or usual:
        return False
    # It has to exclude a part of the first: an old detective movie is as gray as the movie.
    low, high = max(claim.lower[0], first.lower[0]), min(claim.upper[0], first.upper[0])
    return low <= high and (low, high) != (first.lower[0], first.upper[0])


def _measured(claim: Claim) -> tuple[object, ...]:
    """(measure, part, materials, direction), equal for claims about the same property; a color's direction is ()."""
    return claim.measure, claim.part, claim.materials, () if claim.measure == "color" else claim.direction


def _is_painted(claim: Claim, attribute: Attribute) -> bool:
    """True for a claim about the color of a place or a sky, not of the light there: sand is yellow at noon."""
    if claim.part == "sky":
        return claim.measure in (*_TINTS, "warmth")
    return attribute.slot == "setting" and claim.part == "surroundings" and claim.measure in _TINTS


def _is_told(claim: Claim, pictured: Sequence[Claim]) -> bool:
    """True if the claims `pictured` of a reference image replace a claim that every image has to satisfy."""
    # A reference image of the same scene decides exposure and separation.
    if any(each.measure == "mean" for each in pictured) and claim.measure in ("burnt", "drowned", "separation"):
        return True
    # Any other one decides how much may drown in black; of the subject only if the reference image itself is dim.
    medians = [each.lower[0] for each in pictured if each.measure == "median"]
    return claim.measure == "drowned" and bool(medians) and (claim.part == "picture" or min(medians) < 22.0)


def _held(goals: Goals, claims: Sequence[Claim]) -> Iterator[Claim]:
    """Claims that the rest of the image stays as it is after a further sentence, which makes the given `claims`.

    They are about the materials and the world that the prompt protects, and about each cell of a 6 x 4 grid. If the
    sentence changes brightness, a cell keeps only its color; if it changes color, only its lightness; if it changes
    both, nothing.
    """
    for owner in goals.parsed.protected:
        group, _, name = owner.partition("/")
        if group in ("material", "world"):
            part: Part = "picture" if name else "sky"
            yield _still(part, _EXACT, materials=(name,) if name else ())
    measured = {id(wish.attribute) for wish in goals.wishes if wish.is_measured}
    acting = [w for w in goals.wishes if id(w.attribute) not in measured]
    roles = {wish.attribute.role for wish in goals.wishes}
    relit = goals.shown or not roles.isdisjoint(("rim", "fill"))
    kinds = {c: quantities().measures.get(c.measure, "") for c in claims}
    whole = {kind for c, kind in kinds.items() if c.part == "picture" and not c.materials}
    cells = [(x / 6, y / 4, (x + 1) / 6, (y + 1) / 4) for x, y in product(range(6), range(4))]
    if roles == {"rim"}:  # an edge light does not flood what is around
        yield from (_still("surroundings", _STILL, box=cell, weight=0.3) for cell in cells)
        return
    if relit or "direction" in kinds.values():
        return  # new or turned light changes the whole image
    if "haze" in kinds.values():  # fog hides and brightens, but the exposure stays
        yield _still("picture", (_HAZY, math.inf, math.inf))
        return
    if any(not e.family.startswith("material/") for w in acting for e in w.effects):
        return  # an effect that no measure covers may change any place
    light, color = "brightness" in whole, not whole.isdisjoint(("light_color", "cast", "saturation", "color"))
    if whole and not (light or color):  # about how light falls: places may change, but not the mean lightness
        yield _still("picture", (_EXACT[0], math.inf, math.inf))
        light = True
    if light and color:
        return
    # Where lightness may change, chromaticity stays: a darker version of a color has less chroma.
    measure = "chromaticity" if light else "mean"
    width = _STILL[1:] if light else (_STILL[0], math.inf, math.inf) if color else _STILL
    apart = [(c.part, c.materials) for c in claims if c.part != "picture" or c.materials]
    apart += [("picture", w.attribute.owners) for w in acting if w.attribute.owners]
    place = {"weight": 0.3, "apart": tuple(dict.fromkeys(apart))}
    for cell in cells:
        yield _still("picture", width, measure, box=cell, **place)


def _still(part: Part, width: Values, measure: str = "mean", **where: Any) -> Claim:
    """A claim without words: a region's mean color changes by `width` at most, OKLab times 100.

    `where` are further fields of the claim.
    """
    return Claim("", "rest of the image", measure, part, tuple(-v for v in width), width, by=True, **where)


def _of_every_image(goals: Goals, claims: Sequence[Claim]) -> Iterator[Claim]:
    """The claims of every image: the subject is visible, and nothing is overexposed, clipped, gaudy or drowned in black."""
    dark = goals.classes.get("brightness") == "dark"
    lightness = [lab_from_srgb(c.color)[0] for c in claims if c.color]
    yield Claim.unsaid("subject", "separation", lower=10.0)
    yield Claim.unsaid("subject", "burnt", upper=_BURNT)
    if not any(a.entry == "silhouette" and not a.negated for a in goals.parsed.attributes):
        yield Claim.unsaid("subject", "white_point", lower=24.0)  # even at night its highlights are visible
        if goals.classes.get("haze") != "thick":  # thick fog takes the contrast of what is in it
            flat = dark or goals.classes.get("contrast") == "low"
            yield Claim.unsaid("subject", "spread", lower=8.0 if flat else 14.0)  # shading shows its shape
        if not dark:
            yield Claim.unsaid("subject", "drowned", upper=0.3)

    # Words for white or a bright image allow overexposed parts; those for black or a dark image allow black ones.
    bright = any((c.part, c.measure) == ("picture", "lightness") and c.lower[0] > 60.0 for c in claims)
    if not bright and max(lightness, default=0.0) <= 90.0:
        yield Claim.unsaid("picture", "burnt", upper=_BURNT)
        glowing = any(wish.quantity == "glow" for wish in goals.wishes)
        full = any(max(c.color) > 0.97 for c in claims if c.color and c.measure == "color")
        if not glowing and not full:
            yield Claim.unsaid("picture", "clipped", upper=0.005)  # a clipped color shows no shading
    if goals.classes.get("saturation") != "vivid":
        # What people call high, Hasler and Süsstrunk 2003
        yield Claim.unsaid("picture", "colorfulness", upper=82.0)
    dark |= any(c.measure in ("lightness", "black_point") and c.upper[0] < 50.0 for c in claims)
    dark |= any(c.measure == "silhouette" for c in claims)
    if not dark and min(lightness, default=100.0) >= 22.0:
        yield Claim.unsaid("picture", "drowned", upper=0.12)
