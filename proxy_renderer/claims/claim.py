# SPDX-License-Identifier: Apache-2.0
"""Claims about the image: a measure of a part of the image, the interval that satisfies it, and the verdicts on a render."""

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
from .measures.color import chromaticity_of
from .measures.picture import MeasuredPicture, is_black, region_of

_FEW = 16  # regions of fewer pixels are not measured
HOLDS = 1.0  # a claim is satisfied if it is missed by at most so many noticeable steps
_COLORS = ("color", "mean")  # measures in OKLab
_FARTHER = 1e4  # larger than any value of a measure: distance of the middle of an interval with one open end
_SATURATED, _WIDENED = 40.0, 0.045
"""`_SATURATED`: C* from which the measure's own noticeable step applies to chroma and hue. `_WIDENED`: between paler
colors people notice smaller differences, in proportion to CIEDE2000's weight of chroma, 1 + 0.045 C* (Sharma, Wu and
Dalal 2005)."""


@dataclass(frozen=True)
class Claim:
    """A claim about the image: the interval in which a measure of a part of the image has to be.

    With a `change`, it is also enough that the value has risen by that much since the artist's image (fallen, if the
    change is negative). With `near`, the value must then also be within one `change` of the interval. A value of the
    artist's image that is beyond the interval in the direction of the change may stay; with a change of 0, beyond
    either end.
    """

    word: str  # of the prompt; "" for claims without words, as that the subject can be seen
    thing: str  # the prompt's name for the target: "teapot", "background", "picture"
    measure: str  # a key of `MEASURES`
    part: Part  # of the image
    lower: Values  # one number for each number of the measure, after `direction` is applied
    upper: Values  # likewise
    materials: tuple[str, ...] = ()  # names of the target's materials; none for the whole part
    change: float | None = None  # a sufficient change; None if only the interval counts
    # (a, b) unit vector. A tint is projected on it. For a color it is the hue: the numbers are then lightness,
    # distance along the hue, and distance across it. () for the measure's own numbers
    direction: Values = ()
    color: Values | None = None  # the color that is asked for, sRGB; None for other claims
    box: Values = ()  # left, upper, right, lower end in the frame, as shares of its sides; () for all of it
    reason: str = ""  # why it is claimed; "" where the word says it
    # (part, names of materials) of regions that are left out: of a claim about light, those that words color
    apart: tuple[tuple[Part, tuple[str, ...]], ...] = ()
    weight: float = 1.0  # factor on noticeable steps in the search; less for a claim that a mood implies
    near: bool = True  # whether a change is enough only near the interval; if not, anywhere
    also: tuple[str, ...] = ()  # more words that share the claim and its verdict: they ask for the same rig
    by: bool = False  # whether both ends are differences from the artist's image, in noticeable steps

    @classmethod
    def unsaid(cls, part: Part, measure: str, lower: float = -math.inf, upper: float = math.inf) -> Claim:
        """A claim without words: a measure is in [lower, upper], or no farther from it than in the artist's image."""
        return cls("", part, measure, part, (lower,), (upper,), change=0.0)

    @property
    def is_of_thing(self) -> bool:
        """True for a claim about objects: people judge their colors relative to the light that falls on them."""
        return bool(self.materials) or self.part == "subject"

    def region(self, seen: GBuffer) -> Tensor | None:
        """The pixels (H, W) bool of the claim's target in a camera's view, `seen`; None if too few are visible."""
        if MEASURES[self.measure].beside and region_of(seen, "surroundings").sum() < _FEW:
            return None  # the subject fills the image
        where = region_of(seen, self.part, self.materials)
        of_air = self.part == "surroundings" and self.measure in ("haze", "air_lightness", "tint")
        if of_air and not self.materials and where.sum() < _FEW:
            where = torch.ones_like(where)  # if the subject fills the image, the air of all of it
        if self.box:
            left, upper, right, lower = (round(v * n) for v, n in zip(self.box, 2 * where.shape[::-1], strict=True))
            inside = torch.zeros_like(where)
            inside[upper:lower, left:right] = True
            where = where & inside
        apart, rest = self.apart, where.clone()
        if self.part == "subject" and self.measure == "color" and not self.materials and seen.surrounding:
            # A color word for the subject does not recolor materials that it shares with its surroundings.
            apart = (*apart, ("picture", seen.surrounding))
        for part, materials in apart:
            rest &= ~region_of(seen, part, materials)
        if self.by:
            return rest if rest.sum() >= _FEW else None
        where = rest if rest.sum() > 0.05 * where.sum() else where
        return where if where.sum() >= _FEW else None

    def value(self, picture: MeasuredPicture, where: Tensor) -> Tensor:
        """The claim's value (n,) in the region `where` of an image, differentiable in the image."""
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
        """OKLab color, times 100, of a value of a claim about a color: three numbers as in `lower` and `upper`."""
        light, along, across = value
        x, y = self.direction or (1.0, 0.0)
        across /= float(self._hue_weight(torch.tensor(along))) if self.direction else 1.0
        return light, x * along - y * across, y * along + x * across

    def _hue_weight(self, along: Tensor) -> Tensor:
        """The factor () from 1 to 2 on a color's distance across the wanted hue, by its chroma () along that hue."""
        # The tolerance is a share of the wanted chroma. In a paler color the same distance is a larger angle of hue.
        wanted = (self.lower[1] + self.upper[1]) / 2
        return (wanted / along.clamp_min(1.0)).clamp(1.0, 2.0)

    def interval(self, before: Tensor | None) -> tuple[Values, Values]:
        """(lower, upper) end, n numbers each; with the sufficient change from `before` (n,), the artist's value."""
        if self.by and before is not None:
            own, step = before.tolist(), before.new_tensor(self.notice).expand_as(before).tolist()
            least, most = (
                tuple(v + n * s for v, n, s in zip(own, end, step, strict=True)) for end in (self.lower, self.upper)
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
        # Farther from the interval no change is enough, as very blue is not warm yet.
        if self.near and rises:
            lower = max(lower, self.lower[0] - self.change)
        elif self.near:
            upper = min(upper, self.upper[0] - self.change)
        return (min(self.lower[0], lower),), (max(self.upper[0], upper),)

    @cached_property
    def notice(self) -> float | Values:
        """The noticeable step, the least difference that people notice: one number, or one for each number of the measure."""
        step = MEASURES[self.measure].notice
        if self.measure != "color" or self.color is None:
            return step
        own = min(chroma(lab_from_srgb(self.color)), _SATURATED)
        aside = step * (1.0 + _WIDENED * own) / (1.0 + _WIDENED * _SATURATED)
        return step, aside, aside

    def residual(self, value: Tensor, before: Tensor | None) -> Tensor:
        """Distance (n,) of a value (n,) from its `interval`, in noticeable steps: negative below it, 0 inside."""
        notice = value.new_tensor(self.notice)
        lower, upper = (value.new_tensor(end) / notice for end in self.interval(before))
        return outside(value / notice, lower, upper)

    def aim(
        self, value: Tensor, before: Tensor | None, ends: tuple[Tensor, Tensor] | None = None
    ) -> tuple[Tensor, Tensor, Tensor]:
        """(value, lower end, upper end) of the aim, which the search looks for: the interval with ends moved inward.

        All three are (n,), in noticeable steps times the weight. `ends` are both ends of an earlier call, or None.
        """
        notice = value.new_tensor(self.notice)
        if ends is None:  # not known from an earlier call for a value of the same type
            lower, upper = (value.new_tensor(end) / notice for end in self.interval(before))
            half = (upper - lower) / 2
            if self.measure == "color":  # the very end of the interval of navy looks like another blue to some people
                inward = 0.85 * half
            else:
                inward = (0.5 * half).clamp_max(2.0 if self.word else 0.0)
            ends = self.weight * (lower + inward), self.weight * (upper - inward)
        return self.weight * value / notice, *ends

    def miss(self, value: Tensor, before: Tensor | None) -> float:
        """The norm of the residual in noticeable steps, 100 at most. Up to `HOLDS`, the claim is satisfied."""
        return min(float(self.residual(value, before).norm()), 100.0)

    def was_so(self, before: Tensor, after: Tensor) -> bool:
        """True if both values satisfy the claim, and their `gain` is less than a noticeable step."""
        held = max(self.miss(before, None), self.miss(after, before)) <= HOLDS
        return not self.by and held and self.gain(before, after) < HOLDS

    def gain(self, before: Tensor, after: Tensor) -> float:
        """Noticeable steps from `before` to `after` toward the middle of the interval, or toward its open end."""
        notice = before.new_tensor(self.notice)
        lower, upper = (before.new_tensor(end) for end in (self.lower, self.upper))
        core = torch.where(lower.isinf(), before - _FARTHER, (lower + upper) / 2)
        core = torch.where(upper.isinf(), before + _FARTHER, core)
        return float(((before - core) / notice).norm() - ((after - core) / notice).norm())

    def is_sure(self, before: Tensor | None, after: Tensor | None, share: float) -> bool:
        """True if judges can see that the claim is satisfied: by a large enough gain, or as it was before.

        False for a target with a `share` of the image below 2 %, and for values that are not known.
        """
        steps = quantities().seen.get(self.measure, 1.0)  # that judges need
        if math.isinf(steps) or share < 0.02 or before is None or after is None:
            return False
        return self.was_so(before, after) or self.gain(before, after) >= steps


@dataclass(frozen=True)
class ClaimSet:
    """The claims of a prompt about a scene."""

    claims: tuple[Claim, ...]  # in the order of the words
    before: tuple[Tensor | None, ...]  # each claim's value (n,) in the artist's image; None if hardly visible
    regions: tuple[Tensor | None, ...]  # each claim's pixels (H, W) bool in the images that are measured

    @classmethod
    def about(cls, claims: tuple[Claim, ...], picture: MeasuredPicture) -> ClaimSet:
        """The claims, with their regions and their values in `picture`, the artist's image."""
        regions = tuple(claim.region(picture.seen) for claim in claims)
        with torch.no_grad():
            pairs = zip(claims, regions, strict=True)
            before = tuple(None if where is None else c.value(picture, where) for c, where in pairs)
        return cls(claims, before, regions)

    @property
    def words(self) -> set[str]:
        """The words of the claims that can be measured."""
        pairs = zip(self.claims, self.regions, strict=True)
        return {claim.word for claim, where in pairs if claim.word and where is not None}

    def in_view(self, seen: GBuffer) -> ClaimSet:
        """The same claims, with the regions of another view of the camera."""
        return replace(self, regions=tuple(claim.region(seen) for claim in self.claims))

    def values(self, picture: MeasuredPicture) -> list[Tensor | None]:
        """The value (n,) of each claim in an image, differentiable in the image; None if the target is hardly visible."""
        known: dict[int, Tensor] = {}
        if len(self._plain) > 8:  # together they are faster: a reference image of the same scene has one per place
            means = (self._shares.to(picture.oklab) @ picture.oklab.flatten(0, 1)).unbind()
            for i, mean in zip(self._plain, means, strict=True):
                known[i] = mean if self.claims[i].measure == "mean" else chromaticity_of(mean)
        return [
            None if where is None else known[i] if i in known else claim.value(picture, where)
            for i, (claim, where) in enumerate(zip(self.claims, self.regions, strict=True))
        ]

    @cached_property
    def _plain(self) -> dict[int, Tensor]:
        """Index of a claim -> its region (H, W) bool, for each visible claim about a mean color."""
        rows = enumerate(zip(self.claims, self.regions, strict=True))
        of_means = "mean", "chromaticity"
        return {i: where for i, (c, where) in rows if where is not None and c.measure in of_means and not c.direction}

    @cached_property
    def _shares(self) -> Tensor:
        """(n, H * W) share of each pixel in the mean of each region of `_plain`."""
        regions = torch.stack([*self._plain.values()]).flatten(1)
        return regions / regions.sum(1, keepdim=True)

    @cached_property
    def _ends(self) -> dict[tuple[int, torch.dtype, torch.device], tuple[Tensor, Tensor]]:
        """Cache of the ends of `Claim.aim`, by the claim's index and the value's type and device: equal for all images."""
        return {}

    def aims(self, picture: MeasuredPicture) -> list[tuple[Claim, Tensor, Tensor, Tensor]]:
        """(claim, value, lower end, upper end) for each claim that can be measured in an image, as in `Claim.aim`."""
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
        """The residual (n,) of each claim that can be measured in an image, see `Claim.residual`."""
        rows = zip(self.claims, self.values(picture), self.before, strict=True)
        return [claim.residual(value, before) for claim, value, before in rows if value is not None]


def outside(values: Tensor, lower: Tensor, upper: Tensor) -> Tensor:
    """Signed distance of values from [lower, upper], all of one shape: negative below, 0 inside, positive above."""
    return (values - upper).clamp_min(0.0) - (lower - values).clamp_min(0.0)


@dataclass(frozen=True)
class ShotClaims:
    """The claims about one shot, with the camera's view at the artist's values (`before`) and at the result's (`after`)."""

    claims: tuple[Claim, ...]
    before: GBuffer
    after: GBuffer

    def verdicts(self, before: Tensor, predicted: Tensor, after: Tensor) -> list[dict[str, Any]]:
        """The rows of `report.json`, one for each claim, from images (H, W, 3) of one size.

        Each row has: word, thing, measure, says, unit, wanted, before, predicted, after, `holds` (whether the claim is satisfied;
        None if the target is hardly visible), `miss` in noticeable steps, `already` (satisfied before, see `Claim.was_so`),
        `sure` (see `Claim.is_sure`), and, if there are any, `also` for its other words and `reason`.
        """
        with torch.no_grad():
            # Claims that a place stays as it is, which a further sentence adds, are not reported.
            told = tuple(claim for claim in self.claims if claim.word or not claim.by)
            judged = ClaimSet.about(told, MeasuredPicture.of(before, self.before)).in_view(self.after)
            guesses, values = (
                # a black image shows nothing that could be measured
                [None] * len(told) if is_black(each) else judged.values(MeasuredPicture.of(each, self.after))
                for each in (predicted, after)
            )
        shares = [0.0 if where is None else float(where.float().mean()) for where in judged.regions]
        rows = zip(judged.claims, judged.before, guesses, values, shares, strict=True)
        return [_verdict(*row) for row in rows]


def _verdict(
    claim: Claim, before: Tensor | None, predicted: Tensor | None, after: Tensor | None, share: float
) -> dict[str, Any]:
    miss = None if after is None else claim.miss(after, before)
    # The interval in a few words: "at least 8", "#1fb5b5"
    if claim.measure in _COLORS:
        wanted = _hex(claim.oklab(tuple((a + b) / 2 for a, b in zip(claim.lower, claim.upper, strict=True))))
    elif len(claim.lower) > 1:
        wanted = ", ".join(_range(*ends) for ends in zip(claim.lower, claim.upper, strict=True))
    else:
        wanted = _range(*(end[0] for end in claim.interval(before)))
    return {
        "word": claim.word,
        "thing": claim.thing,
        "measure": claim.measure,
        "says": MEASURES[claim.measure].says,
        "unit": MEASURES[claim.measure].unit,
        "wanted": wanted,
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
