# SPDX-License-Identifier: Apache-2.0
"""Claims about the image: a measure of a part of it, the interval that it is to be in, and the verdicts on them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import torch
from torch import Tensor

from ..color.floats import chroma, hex_from_srgb, lab_from_srgb, srgb_from_oklab
from ..render.surface.view_cache import GBuffer
from ..schema import Values
from ..words.lexicon.quantities import quantities
from ..words.types import Part
from .measures import MEASURES
from .measures.color import RegionMeans, chromaticity
from .measures.picture import MeasuredPicture, is_black, region_of

_FEW = 16  # pixels of which nothing can be said
_SEEN = 0.05  # share of a region that is left, at least, when what words color is left out
_OF_MEANS = ("mean", "chromaticity")  # measures of a region's mean color
_AIR = ("haze", "air_lightness", "tint")  # before what lies around; before the subject, if it is alone

_NEARLY = 1.0  # changes from the interval, from where a change is enough: what was very blue is not warm yet
HOLDS = 1.0  # a claim that is missed by no more noticeable steps holds

_INSIDE, _INSIDE_COLOR = 0.5, 0.85
"""Share of half an interval's width that is left at its ends when values are sought; the latter for colors: what only just
passes as navy is another blue to some who look at the picture."""

_FARTHER = 1e4  # beyond every value of a measure: the core of an interval with one end
_MARGIN = 2.0  # the same for an interval with one end, in noticeable steps

_SATURATED, _WIDENED = 40.0, 0.045
"""C* of a color from which the measure's own step counts for its chroma and hue. Between paler colors smaller differences are
seen, in the proportions of CIEDE2000's weights of chroma, 1 + 0.045 C* (Sharma, Wu and Dalal 2005): the second number."""

_FAINT, _HEAVIEST = 1.0, 2.0  # least chroma along a hue that its weight is computed from; the most weight
_MANY = 8  # claims about mean colors that are worth being measured together
_LEAST = 0.02  # share of the image below which judges did not see what a thing was like
_HARDEST = 100.0  # a miss, in noticeable steps, that nothing is worse than

_COLORS = ("color", "mean")  # measures in OKLab


@dataclass(frozen=True)
class Claim:
    """An interval that a measure of a part of the image is to be in.

    Where `change` is given, it is also enough if the measure has risen (or fallen, below 0) by so much since the artist's image and,
    with `near`, is not far from the interval; an excess that is there already may stay, and all of it where `change` is 0.
    """

    word: str  # as the prompt has it; "" for claims without words, as that the subject can be seen
    thing: str  # the prompt's name for the target: "teapot", "background", "picture"
    measure: str  # a key of `MEASURES`
    part: Part  # of the image
    lower: Values  # one number for each that the measure gives, after `direction`
    upper: Values  # likewise
    materials: tuple[str, ...] = ()  # names of the target's materials; none for the whole part
    change: float | None = None  # a sufficient change; None if only the interval counts
    # unit vector along which a tint counts, or the hue of a color, whose numbers are then lightness, how far it lies
    # along the hue and how far across; none for the measure's own numbers
    direction: Values = ()
    color: Values | None = None  # the color that is asked for, sRGB; None for other claims
    box: Values = ()  # left, upper, right, lower end in the frame, as shares of its sides; () for all of it
    reason: str = ""  # why it is claimed; "" where the word says it
    # Parts, each with its materials, that are left out: those that words color, in a claim about light
    apart: tuple[tuple[Part, tuple[str, ...]], ...] = ()
    weight: float = 1.0  # of a step while values are sought: less, where a mood only usually stands for it
    near: bool = True  # whether a change is enough near the interval only; of words that compare, anywhere
    also: tuple[str, ...] = ()  # more words that stand or fall with it: they ask for the same of a light rig
    by: bool = False  # whether both ends are noticeable steps from what the artist's image has

    @classmethod
    def unsaid(cls, part: Part, measure: str, lower: float = -math.inf, upper: float = math.inf) -> Claim:
        """A claim without words: a part of the image is in an interval, or no farther from it than before."""
        return cls("", part, measure, part, (lower,), (upper,), change=0.0)

    @property
    def is_of_thing(self) -> bool:
        """True for a claim about objects, whose color is seen in the light that they stand in."""
        return bool(self.materials) or self.part == "subject"

    def region(self, seen: GBuffer) -> Tensor | None:
        """The pixels (H, W) bool of its target; None where that is hardly seen."""
        if MEASURES[self.measure].beside and region_of(seen, "surroundings").sum() < _FEW:
            return None  # the subject fills the image
        where = region_of(seen, self.part, self.materials)
        if self.part == "surroundings" and not self.materials and self.measure in _AIR and where.sum() < _FEW:
            where = torch.ones_like(where)
        if self.box:
            where = where & _inside(self.box, where)
        apart, rest = self.apart, where.clone()
        if self.part == "subject" and self.measure == "color" and not self.materials and seen.surrounding:
            # A color of the subject is not painted on materials of its surroundings, though it wears them.
            apart = (*apart, ("picture", seen.surrounding))
        for part, materials in apart:
            rest &= ~region_of(seen, part, materials)
        if self.by:
            return rest if rest.sum() >= _FEW else None
        where = rest if rest.sum() > _SEEN * where.sum() else where
        return where if where.sum() >= _FEW else None

    def value(self, picture: MeasuredPicture, where: Tensor) -> Tensor:
        """Its value (n,) in the region `where` of an image, differentiable in it."""
        measure = MEASURES[self.measure]
        if self.is_of_thing and self.measure in ("color", "tint"):
            picture = picture.in_white_light(where)
        if measure.directed:
            return measure.take(picture, where, picture.display.new_tensor(self.direction))
        taken = measure.take(picture, where)
        if not self.direction:
            return taken
        if len(taken) == 3:
            x, y = self.direction
            turned = taken @ taken.new_tensor([[1.0, 0.0, 0.0], [0.0, x, -y], [0.0, y, x]])
            return torch.cat([turned[:2], turned[2:] * self._hue_weight(turned[1].detach())])
        return (taken @ taken.new_tensor(self.direction))[None]

    def oklab(self, value: Values) -> Values:
        """The color, OKLab times 100, of the three numbers of a claim about one."""
        light, along, across = value
        x, y = self.direction or (1.0, 0.0)
        across /= float(self._hue_weight(torch.tensor(along))) if self.direction else 1.0
        return light, x * along - y * across, y * along + x * across

    def _hue_weight(self, along: Tensor) -> Tensor:
        """The weight () of a color's distance across the wanted hue, from its chroma () along that hue.

        A tolerance is a share of the wanted chroma. In a paler color the same distance is a larger angle of hue.
        """
        wanted = (self.lower[1] + self.upper[1]) / 2
        return (wanted / along.clamp_min(_FAINT)).clamp(1.0, _HEAVIEST)

    def interval(self, before: Tensor | None) -> tuple[Values, Values]:
        """The lower and the upper end, the change considered since `before` (n,), of the artist's image; None if that is not known."""
        if self.by and before is not None:
            own, step = before.tolist(), before.new_tensor(self.notice).expand_as(before).tolist()
            least, most = (
                tuple(v + n * s for v, n, s in zip(own, end, step, strict=True))
                for end in (self.lower, self.upper)
            )
            return least, most
        if self.change is None or before is None:
            return self.lower, self.upper
        if not self.change:
            stays = before.tolist()
            return tuple(map(min, self.lower, stays)), tuple(map(max, self.upper, stays))
        value = float(before[0])
        rises = self.change > 0.0
        lower, upper = value + self.change if rises else value, value if rises else value + self.change
        if self.near and rises:
            lower = max(lower, self.lower[0] - _NEARLY * self.change)
        elif self.near:
            upper = min(upper, self.upper[0] - _NEARLY * self.change)
        return (min(self.lower[0], lower),), (max(self.upper[0], upper),)

    @cached_property
    def notice(self) -> float | Values:
        """The least difference that people notice: one number, or one for each that the measure gives."""
        step = MEASURES[self.measure].notice
        if self.measure != "color" or self.color is None:
            return step
        own = min(chroma(lab_from_srgb(self.color)), _SATURATED)
        aside = step * (1.0 + _WIDENED * own) / (1.0 + _WIDENED * _SATURATED)
        return step, aside, aside

    def residual(self, value: Tensor, before: Tensor | None) -> Tensor:
        """Distance of a value (n,) from the interval: (n,) in noticeable steps, 0 inside."""
        return outside(*self.in_steps(value, before))

    def in_steps(self, value: Tensor, before: Tensor | None) -> tuple[Tensor, Tensor, Tensor]:
        """A value (n,), and the lower and the upper end of its interval, in noticeable steps."""
        notice = value.new_tensor(self.notice)
        lower, upper = (value.new_tensor(end) / notice for end in self.interval(before))
        return value / notice, lower, upper

    def aim(
        self, value: Tensor, before: Tensor | None, ends: tuple[Tensor, Tensor] | None = None
    ) -> tuple[Tensor, Tensor, Tensor]:
        """As `in_steps`, by weight, with ends inside of what satisfies it; `ends` of an earlier value of its type can be given."""
        if ends is None:
            _, lower, upper = self.in_steps(value.detach(), before)
            half = (upper - lower) / 2
            if self.measure == "color":
                inward = _INSIDE_COLOR * half
            else:
                inward = (_INSIDE * half).clamp_max(_MARGIN if self.word else 0.0)
            ends = self.weight * (lower + inward), self.weight * (upper - inward)
        return self.weight * value / value.new_tensor(self.notice), *ends

    def miss(self, value: Tensor, before: Tensor | None) -> float:
        """The length of the residual; a claim holds if it is at most `HOLDS`."""
        return min(float(self.residual(value, before).norm()), _HARDEST)

    def was_so(self, before: Tensor, after: Tensor) -> bool:
        """True if a value held before, and is no noticeable step nearer to the middle of the interval, or beyond its end, now."""
        held = max(self.miss(before, None), self.miss(after, before)) <= HOLDS
        return not self.by and held and self.gain(before, after) < HOLDS

    def gain(self, before: Tensor, after: Tensor) -> float:
        """Noticeable steps by which a value came nearer to the middle of the interval, or went on beyond its open end."""
        notice = before.new_tensor(self.notice)
        lower, upper = (before.new_tensor(end) for end in (self.lower, self.upper))
        core = torch.where(lower.isinf(), before - _FARTHER, (lower + upper) / 2)
        core = torch.where(upper.isinf(), before + _FARTHER, core)
        return float(((before - core) / notice).norm() - ((after - core) / notice).norm())

    def is_sure(self, before: Tensor | None, after: Tensor | None, share: float) -> bool:
        """True if judges see what its measure tells of a target with this share of the image: it was so, or changed enough."""
        steps = quantities().seen.get(self.measure, 1.0)
        if math.isinf(steps) or share < _LEAST or before is None or after is None:
            return False
        return self.was_so(before, after) or self.gain(before, after) >= steps


@dataclass(frozen=True)
class ClaimSet:
    """The claims of a prompt about a scene."""

    claims: tuple[Claim, ...]  # in the order of the words
    before: tuple[Tensor | None, ...]  # of each, the artist's image's value; None where it is hardly seen
    regions: tuple[Tensor | None, ...]  # of each, its pixels (H, W) bool in the images that are measured

    @classmethod
    def about(cls, claims: tuple[Claim, ...], picture: MeasuredPicture) -> ClaimSet:
        """Claims about a scene whose artist's image is this one."""
        regions = tuple(claim.region(picture.seen) for claim in claims)
        with torch.no_grad():
            pairs = zip(claims, regions, strict=True)
            before = tuple(None if where is None else c.value(picture, where) for c, where in pairs)
        return cls(claims, before, regions)

    @property
    def words(self) -> set[str]:
        """Those that claim what can be measured."""
        pairs = zip(self.claims, self.regions, strict=True)
        return {claim.word for claim, where in pairs if claim.word and where is not None}

    def in_view(self, seen: GBuffer) -> ClaimSet:
        """The same claims about images with this view."""
        return replace(self, regions=tuple(claim.region(seen) for claim in self.claims))

    def values(self, picture: MeasuredPicture) -> list[Tensor | None]:
        """An image's value of each claim: (n,), differentiable in it; None where the target is hardly seen."""
        means = self._means.of(picture) if self._means else {}
        known = {i: _of_mean(self.claims[i], mean) for i, mean in means.items()}
        return [
            None if where is None else known[i] if i in known else claim.value(picture, where)
            for i, (claim, where) in enumerate(zip(self.claims, self.regions, strict=True))
        ]

    @cached_property
    def _means(self) -> RegionMeans | None:
        """The claims about mean colors, where there are many: a picture of this very scene has one for each place."""
        plain = {
            i: where
            for i, (claim, where) in enumerate(zip(self.claims, self.regions, strict=True))
            if where is not None and claim.measure in _OF_MEANS and not claim.direction
        }
        return RegionMeans(plain) if len(plain) > _MANY else None

    @cached_property
    def _ends(self) -> dict[tuple[int, torch.dtype, torch.device], tuple[Tensor, Tensor]]:
        """Ends of `Claim.aim`, by the claim's place and the value's type: they are the same for every picture."""
        return {}

    def aims(self, picture: MeasuredPicture) -> list[tuple[Claim, Tensor, Tensor, Tensor]]:
        """Claims that can be measured, with value (n,), differentiable in the image, and the interval that is sought, see `Claim.aim`."""
        found = []
        rows = zip(self.claims, self.values(picture), self.before, strict=True)
        for i, (claim, value, before) in enumerate(rows):
            if value is not None:
                kind = i, value.dtype, value.device
                aim = claim.aim(value, before, self._ends.get(kind))
                self._ends[kind] = aim[1:]
                found.append((claim, *aim))
        return found

    def residuals(self, picture: MeasuredPicture) -> list[Tensor]:
        """Distance of an image from each claim that can be measured: (n,) each, see `Claim.residual`."""
        rows = zip(self.claims, self.values(picture), self.before, strict=True)
        return [claim.residual(value, before) for claim, value, before in rows if value is not None]


def _of_mean(claim: Claim, mean: Tensor) -> Tensor:
    """The value (n,) of a claim about a mean color (3,)."""
    return mean if claim.measure == "mean" else chromaticity(mean)


def _inside(box: Values, like: Tensor) -> Tensor:
    """(H, W) bool: the pixels in a part of the frame, see `Claim.box`."""
    height, width = like.shape
    left, upper, right, lower = box
    inside = torch.zeros_like(like)
    inside[round(upper * height) : round(lower * height), round(left * width) : round(right * width)] = True
    return inside


def outside(values: Tensor, lower: Tensor, upper: Tensor) -> Tensor:
    """Distance of values from [lower, upper], all of one shape; below it less than 0, inside 0."""
    return (values - upper).clamp_min(0.0) - (lower - values).clamp_min(0.0)


@dataclass(frozen=True)
class ShotClaims:
    """The claims about one shot, and the camera's view at the artist's values and at the result's."""

    claims: tuple[Claim, ...]
    before: GBuffer
    after: GBuffer

    def verdicts(self, before: Tensor, predicted: Tensor, after: Tensor) -> list[dict[str, Any]]:
        """The rows of `report.json` on every claim, of images (H, W, 3) of any one size.

        Each has: word, thing, measure, says, unit, wanted, before, predicted, after, holds, miss, whether it was
        `already` so, whether judges see that (`sure`), and, where there are any, `also` its other words, and the
        `reason`. `holds` is None where the target is hardly seen; `miss` is in noticeable steps.
        """
        with torch.no_grad():
            # The places that a further sentence leaves as they are come last, and are no news.
            told = tuple(claim for claim in self.claims if claim.word or not claim.by)
            judged = ClaimSet.about(told, MeasuredPicture.of(before, self.before)).in_view(self.after)
            guesses, values = (self._values(judged, picture) for picture in (predicted, after))
        shares = [0.0 if where is None else float(where.float().mean()) for where in judged.regions]
        rows = zip(judged.claims, judged.before, guesses, values, shares, strict=True)
        return [_verdict(*row) for row in rows]

    def _values(self, judged: ClaimSet, picture: Tensor) -> list[Tensor | None]:
        """An image's value of each claim: nothing, where all of it is black."""
        if is_black(picture):
            return [None] * len(judged.claims)
        return judged.values(MeasuredPicture.of(picture, self.after))


def _verdict(
    claim: Claim, before: Tensor | None, predicted: Tensor | None, after: Tensor | None, share: float
) -> dict[str, Any]:
    miss = None if after is None else claim.miss(after, before)
    return {
        "word": claim.word,
        "thing": claim.thing,
        "measure": claim.measure,
        "says": MEASURES[claim.measure].says,
        "unit": MEASURES[claim.measure].unit,
        "wanted": interval_text(claim, before),
        "before": _shown(claim, before),
        "predicted": _shown(claim, predicted),
        "after": _shown(claim, after),
        "holds": None if miss is None else miss <= HOLDS,
        "miss": None if miss is None else round(miss, 2),
        "already": before is not None and after is not None and claim.was_so(before, after),
        "sure": claim.is_sure(before, after, share),
        **({"also": list(claim.also)} if claim.also else {}),
        **({"reason": claim.reason} if claim.reason else {}),
    }


def interval_text(claim: Claim, before: Tensor | None) -> str:
    """The interval of a claim in a few words: "at least 8", "#1fb5b5"."""
    if claim.measure in _COLORS:
        return _hex(claim.oklab(tuple((a + b) / 2 for a, b in zip(claim.lower, claim.upper, strict=True))))
    if len(claim.lower) > 1:
        return ", ".join(_range(*ends) for ends in zip(claim.lower, claim.upper, strict=True))
    return _range(*(end[0] for end in claim.interval(before)))


def _range(lower: float, upper: float) -> str:
    if math.isinf(upper):
        return f"at least {lower:.3g}"
    return f"at most {upper:.3g}" if math.isinf(lower) else f"{lower:.3g} to {upper:.3g}"


def _shown(claim: Claim, value: Tensor | None) -> float | str | None:
    if value is None:
        return None
    if claim.measure in _COLORS:
        return _hex(claim.oklab(tuple(value.tolist())))
    return round(float(value[0]), 3) if len(value) == 1 else ", ".join(f"{v:.3g}" for v in value.tolist())


def _hex(oklab: Sequence[float]) -> str:
    return hex_from_srgb(srgb_from_oklab((oklab[0] / 100, oklab[1] / 100, oklab[2] / 100)))
