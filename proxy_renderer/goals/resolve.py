# SPDX-License-Identifier: Apache-2.0
"""The one place that decides which word wins: finds contradicting wishes, and makes goals of the winners."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product

from ..color.constants import Lab
from ..color.floats import chroma, lab_from_srgb, srgb_from_hex
from ..color.shades import hue_apart, warm
from ..schema import Values, VibeError
from ..schema.parameters import SURFACES
from ..words.lexicon.entries import Effect
from ..words.lexicon.quantities import ClaimText, warmth_asked
from ..words.lexicon.vocabulary import Vocabulary, default_vocabulary
from ..words.parser import Understood
from ..words.types import Attribute, Parsed
from .wish import PAINTED, Wish, wishes_of

_COLORED, _VIVID, _GRAY = 12.0, 35.0, 8.0
"""C* from which light counts as colored, from which a color is vivid, and below which a color is gray."""
_ALL_LIGHT = ("light", "tone", "ambience")  # kinds of targets whose color is that of the light as a whole
CASTS = ("shadow_cast", "midtone_cast", "highlight_cast", "cast")  # measures of the color of light
_SETTLED = {
    **dict.fromkeys(("tint", "accent", "off_hue", "brown_distance"), CASTS),
    "color": ("cast", "lightness", "mean"),
    "burnt": ("white_point",),
}
"""Measure that a word claims -> measures of the same part about which claims of a reference image are dropped, too."""
_MATTER = ("color", "finish", "substance", "glow")


def contradicts(first: Wish, later: Wish) -> bool:
    """True if the wish `later` contradicts the wish `first`, which ranks before it."""
    a, b = first.attribute, later.attribute
    if a is b or first.word == later.word or a.is_of_another_light(b):
        return False
    if later.of_picture:
        return not first.of_picture and _settles(first, later)
    if a.color and not first.implied and _ruled_out(first, later):
        return True
    # Colored light also colors gray surroundings: a gallery is not gray at sunset.
    if _is_tinted(first) and any((c.part, c.measure) == ("surroundings", "chroma") for c in later.claims):
        return True
    if not _same_target(first, later):
        return False
    if _disjoint_claims(first, later) or _is_recolored(first, later):
        return True
    if first.quantity != later.quantity:
        return False
    own = a.color or _own_color(first, weak=True)
    is_gray = own is not None and chroma(lab_from_srgb(own)) < _COLORED
    if is_gray and any(c.measure == "chroma" and c.lower[0] > 0.0 for c in later.claims):
        return True
    if b.kind == "ambience" and b.color and not a.color:
        return _opposed(first, lab_from_srgb(b.color))
    if a.color and b.color:
        return first.quantity != "light_color" or later.implied
    classes, differ = first.about.classes, first.named and later.named and first.named != later.named
    if differ and "none" in (first.named, later.named):
        return True  # "no fog" contradicts "a little fog", though the intervals of their claims overlap
    if _overlapping(first.claims, later.claims):
        return False  # one image can satisfy both; for parameters that both need, the rank decides
    # Basic colors are compared by their claims alone.
    if differ and first.quantity not in PAINTED and not _overlapping(classes[first.named], classes[later.named]):
        return True
    if _disjoint_effects(first, later):
        return True
    if first.quantity == "light_color":  # warm against cool, or a named color against a temperature
        gels = [any(e.name == "color" and e.color for e in wish.effects) for wish in (first, later)]
        return later.implied and (gels[0] != gels[1] or _warmth(first) * _warmth(later) < 0)
    shared = {*map(_axis, first.claims)} & {*map(_axis, later.claims)}
    ours, theirs = ({(e.owner, e.name) for e in wish.effects if not e.weak} for wish in (first, later))
    return first.about.exclusive and later.implied and not (shared or ours & theirs)


def _settles(word: Wish, picture: Wish) -> bool:
    """True if a word is about a measure that the wish of a reference image claims: then only the word counts."""
    measured = [(str(word.part_of(claim)), claim.measure) for claim in word.claims]
    attribute = word.attribute
    color = attribute.color or _own_color(word, weak=True)
    # A named color decides a color, a cast or a tint.
    if attribute.color and word.quantity in PAINTED and attribute.kind != "glow":
        measured.append((attribute.part, "color"))
    elif attribute.color and attribute.kind in ("shadow", "highlight"):
        measured.append(("picture", f"{attribute.kind}_cast"))
    elif color and chroma(lab_from_srgb(color)) >= _COLORED:
        all_over = attribute.color and attribute.kind != "fog"
        measured.append(("picture" if all_over else attribute.part, "tint"))
    elif color and not attribute.color:  # a gray material
        measured.append((attribute.part, "lightness"))
    return any(
        part in ("picture", picture.part_of(claim))
        and (measure == claim.measure or claim.measure in _SETTLED.get(measure, ()))
        for claim in picture.claims
        if claim.weight
        for part, measure in measured
    )


def _same_target(first: Wish, later: Wish) -> bool:
    a, b = first.attribute, later.attribute
    roles = ["" if each.role == "key" else each.role for each in (a, b)]  # words without a role mean the key
    if (a.lights, roles[0]) != (b.lights, roles[1]):
        return False
    if a.owners and b.owners:
        return not {*a.owners}.isdisjoint(b.owners)
    if a.color and b.color:
        return a.kind == b.kind and bool(a.owners) == bool(b.owners)
    return a.region == b.region if first.quantity in _MATTER or later.quantity in _MATTER else True


def _overlapping(some: Sequence[ClaimText], others: Sequence[ClaimText]) -> bool:
    """True if two lists of claims have overlapping intervals for one measure, as those of thick and of light fog."""
    return any(not _apart(a, b) for a in some for b in others if _axis(a) == _axis(b))


def _apart(a: ClaimText, b: ClaimText) -> bool:
    every = zip(a.lower, b.lower, a.upper, b.upper, strict=True)
    return any(max(*ends[:2]) > min(*ends[2:]) for ends in every)


def _axis(claim: ClaimText) -> tuple[object, ...]:
    return claim.part, claim.measure, claim.color, claim.box


def _disjoint_claims(first: Wish, later: Wish) -> bool:
    """True if two wishes claim disjoint intervals of one measure of one part."""
    # A claim of the first about the whole image also counts against an implied or usual claim about the surroundings.
    yields = later.implied or later.usual > 0
    return any(
        _apart(a, b)
        for a in first.claims
        for b in later.claims
        if _axis(a) == _axis(b)
        or (yields and (a.part, b.part) == ("picture", "surroundings") and a.measure == b.measure)
    )


def _disjoint_effects(first: Wish, later: Wish) -> bool:
    """True if two wishes have disjoint ranges for one parameter; weak effects do not count."""
    for a, b in product(first.effects, later.effects):
        same = (a.owner, a.name, a.mode) == (b.owner, b.name, b.mode) and not (a.weak or b.weak)
        if same and a.lower and b.lower:
            ends = (a.lower, a.upper, b.lower, b.upper)
            most = max(map(len, ends))  # one number stands for all three of a color
            every = zip(*(end * (most // len(end)) for end in ends), strict=True)
            if any(max(x, y) > min(v, w) for x, v, y, w in every):
                return True
    return False


def _warmth(wish: Wish) -> int:
    """1 for a wish for warm light, -1 for cool light, else 0."""
    signs = [warmth_asked(claim.measure, claim.lower[0], claim.upper[0]) for claim in wish.claims]
    signs += [_kelvins(effect) for effect in wish.effects if not effect.weak]
    return next((sign for sign in signs if sign), 0)


def _ruled_out(color: Wish, wish: Wish) -> bool:
    """True if the named color of `color` rules out another wish: with a purple background, a forest is not green."""
    kind = color.attribute.kind
    of_style = wish.vague and wish.quantity == "saturation"  # "film noir" with orange lamps is not gray
    if (wish.implied or wish.usual or of_style) and _impossible(color, wish.quantity, wish.toward):
        return True
    if wish.attribute.color:
        return wish.implied and kind == wish.attribute.kind
    if wish.quantity == "light_color" and kind in _ALL_LIGHT:
        one_light = color.attribute.of_one_light or wish.attribute.of_one_light
        return not one_light and _opposed(wish, lab_from_srgb(color.attribute.color or ()))
    # The wish is the color that a place or a sky usually has.
    seen = wish.quantity == "surroundings_color" and kind in ("surroundings", "sky")
    fixed = any(c.measure in ("warmth", "tint", "accent", "chroma") and c.part == kind for c in wish.claims)
    return seen and fixed and not color.attribute.owners


def _impossible(color: Wish, quantity: str, named: str) -> bool:
    """True if an image cannot have the class `named` of a quantity, given the named color of `color` at its target."""
    light, a, b = lab = lab_from_srgb(color.attribute.color or ())
    attribute, strong = color.attribute, chroma(lab)
    around = attribute.kind == "surroundings" and not attribute.owners
    # The color of light and air is on everything in the image.
    tinted = attribute.kind in (*_ALL_LIGHT, "fog", "sky") and strong > _COLORED
    warmth = warm(a, b) if around and strong > _VIVID else 0.0
    rules = {  # by L*, C* and warmth, the cosine with warm light
        ("brightness", "bright"): around and light < 38.0,
        ("brightness", "dark"): around and light > 72.0,
        ("saturation", "vivid"): around and strong < _GRAY,
        ("saturation", "muted"): strong > _VIVID,
        ("light_color", "warm"): tinted or warmth < -0.3,
        ("light_color", "cool"): tinted or warmth > 0.3,
    }
    return rules.get((quantity, named), False)


def _opposed(wish: Wish, lab: Lab) -> bool:
    """True if a wish asks for light of a hue opposite to the color `lab`: for warm light if it is named blue."""
    strong, warmth = chroma(lab), warm(*lab[1:])
    if strong <= _GRAY:
        return False
    ways = [_kelvins(effect) * warmth for effect in wish.effects]
    for claim in (each for each in wish.claims if each.part == "picture"):
        if claim.color:
            _, a, b = lab_from_srgb(srgb_from_hex(claim.color))
            ways.append((a * lab[1] + b * lab[2]) / (math.hypot(a, b) * strong))
        else:
            ways.append(warmth_asked(claim.measure, claim.lower[0], claim.upper[0]) * warmth)
    return min(ways, default=0.0) < -0.5  # at less, one image can have both hues


def _kelvins(effect: Effect) -> int:
    """1 for an effect that makes light warm, -1 for one that makes it cool, else 0."""
    if effect.name != "temperature" or effect.mode:
        return 0
    middle = (effect.lower[0] + effect.upper[0]) / 2
    return 1 if middle < 5500.0 else -1 if middle > 7500.0 else 0  # white light between these


def _is_tinted(wish: Wish) -> bool:
    color = wish.attribute.color
    if color and wish.attribute.kind in _ALL_LIGHT and chroma(lab_from_srgb(color)) >= _COLORED:
        return True
    return wish.quantity == "light_color" and _warmth(wish) != 0


def _is_recolored(color: Wish, material: Wish) -> bool:
    """True if the named color of `color` has another hue than the color of the wish `material`: copper is not blue."""
    if not color.attribute.color or color.quantity not in PAINTED or material.quantity != "color":
        return False
    own = _own_color(material, weak=color.attribute.thing == material.attribute.thing)
    return own is not None and hue_apart(color.attribute.color, own) > 40.0  # degrees


def _own_color(wish: Wish, weak: bool) -> Values | None:
    """The color, sRGB, of a wish's material; None if it has none. Weak colors (mere defaults) count if `weak`."""
    for e in wish.effects:
        if e.family == "material/tint" and e.color[:1] == "#" and (weak or not e.weak):
            return srgb_from_hex(e.color)
    return None


@dataclass(frozen=True)
class Lost:
    """A wish that is overridden, and the winner: a wish that it contradicts and that ranks before it."""

    wish: Wish
    winner: Wish

    @property
    def is_news(self) -> bool:
        """True if the artist needs a note: both are in the prompt, and neither is implied, usual or of an image."""
        return not any(w.implied or w.usual or w.of_picture for w in (self.wish, self.winner))

    def __str__(self) -> str:
        return f"'{self.wish.word}' gives way to '{self.winner.word}': they contradict each other on {self.wish.about.says}."


@dataclass(frozen=True)
class Goals:
    """Goals for the image: the bound prompt, the sought wishes in its order, and the overridden wishes."""

    parsed: Parsed
    wishes: tuple[Wish, ...] = ()
    lost: tuple[Lost, ...] = ()
    shown: tuple[Wish, ...] = ()  # wishes about how the light of a rig looks in the image
    holds: bool = False  # whether the rest of the present image stays as it is, see `further`

    @cached_property
    def pictured(self) -> tuple[Wish, ...]:
        """The wishes of a reference image that are sought."""
        return tuple(wish for wish in self.wishes if wish.of_picture)

    def with_picture(self, pictured: Iterable[Wish]) -> Goals:
        """The same goals with the wishes of a reference image, which replace the wishes of an earlier one."""
        every = (*self.wishes, *(each.wish for each in self.lost))
        return resolved(self.parsed, [*(wish for wish in every if not wish.of_picture), *pictured])

    @cached_property
    def classes(self) -> dict[str, str]:
        """Quantity -> the class that the image or its subject should have, from the wish that ranks first."""
        ranked = sorted(self.wishes, key=lambda wish: wish.rank)
        return {wish.quantity: wish.named for wish in reversed(ranked) if wish.named}

    @cached_property
    def overruled(self) -> tuple[Attribute, ...]:
        """The words that lost all their wishes, or all wishes in which they name a class."""
        named = [wish.attribute for wish in self.wishes if wish.named]
        sought = [wish.attribute for wish in self.wishes]
        lost = (each.wish for each in self.lost)
        return tuple(dict.fromkeys(w.attribute for w in lost if w.attribute not in (named if w.named else sought)))

    def notes(self) -> Iterator[str]:
        """Sentences about the words that other words override."""
        return (str(each) for each in self.lost if each.is_news)


def goals_or_why(understood: Understood) -> Goals | VibeError:
    """The goals of a prompt, or the error that says why nothing in it is understood."""
    return understood.unknown or goals_of(understood.parsed)


def goals_of(parsed: Parsed, vocabulary: Vocabulary | None = None) -> Goals:
    """The goals of a prompt, its contradictions resolved."""
    return resolved(parsed, wishes_of(parsed.attributes, vocabulary or default_vocabulary()))


def resolved(parsed: Parsed, wishes: Sequence[Wish]) -> Goals:
    """The goals of `wishes`: in order of rank, each wish is kept unless it contradicts one that is kept already."""
    # Ids of words whose visible wishes are all lost; their other wishes are dropped, so that others can win
    idle: set[int] = set()
    ranked = sorted(wishes, key=lambda each: each.rank)  # equal ranks stay in the order of the prompt
    kept, lost = list[Wish](), list[Lost]()

    def compete(wish: Wish, winner: Wish | None = None) -> None:
        """Adds a wish to `kept`; to `lost`, if `winner` is given or the wish and a kept one contradict each other."""
        pairs = ((each, sorted((each, wish), key=lambda w: w.rank)) for each in kept)
        winner = winner or next((each for each, pair in pairs if contradicts(*pair)), None)
        if winner is None:
            kept.append(wish)
        else:
            lost.append(Lost(wish, winner))

    while True:
        kept, lost = [], []
        for wish in ranked:
            if wish.is_seen or id(wish.attribute) not in idle:
                compete(wish)
        # Words whose visible wishes are all overridden -> the first winner. Words for surfaces are never among them.
        seen = (each for each in reversed(lost) if each.wish.is_seen and each.wish.attribute.slot not in SURFACES)
        unseen = {id(each.wish.attribute): each.winner for each in seen}
        for wish in kept:
            if wish.is_seen:
                unseen.pop(id(wish.attribute), None)
        if unseen.keys() <= idle:
            break
        idle |= unseen.keys()
    for wish in ranked:
        if not wish.is_seen and id(wish.attribute) in idle:
            compete(wish, unseen.get(id(wish.attribute)))
    sought = {id(wish) for wish in kept}
    return Goals(parsed, tuple(wish for wish in wishes if id(wish) in sought), tuple(lost))
