# SPDX-License-Identifier: Apache-2.0
"""Statements on a reference image, as claims.

An image of another scene gives tones, casts, light, palette and haze; one of the same scene the color of every place and
material.
"""

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import torch
import torch.nn.functional as F
from torch import Tensor

from ..claims.claim import Claim
from ..claims.measures import MEASURES
from ..claims.measures.color import corner_falls, grayness
from ..claims.measures.picture import MeasuredPicture
from ..color.tensors import lab_from_srgb
from ..render.surface.view_cache import GBuffer
from ..schema import Values
from ..words.lexicon.quantities import ClaimText
from ..words.types import Part
from .files import small_size
from .regions import PictureRegions


@dataclass(frozen=True)
class Statement:
    """A claim that the render resembles the reference image in one respect."""

    word: str  # what it is called: "teal shadows"
    claim: ClaimText
    trait: str = ""  # one of `schema.options.table.TRAITS`
    material: str = ""  # the scene's material that the claim is about; "" for a part of the image


_WORDS = ("upper", "middle", "lower")
_SIDES = ("left", "middle", "right")
_ALIKE = 0.4
"""Correlation of edges from which two images show one scene. Before and after a vibe it is .51 to .98 (19 scenes), for two
different scenes .26 at most (240 pairs)."""
_EXACT = 0.5  # noticeable steps by which the color of a cell or a material may differ


def is_same(reference: Tensor, rendered: Tensor) -> bool:
    """True if two images (H, W, 3) show the same objects in the same places: alike in aspect ratio and edges."""
    one, other = (picture.shape[1] / picture.shape[0] for picture in (reference, rendered))
    shape = small_size(rendered.shape[0], rendered.shape[1], longest=128)
    maps = []
    for picture in (reference, rendered):
        planes = F.interpolate(picture.detach().cpu().float().permute(2, 0, 1)[None], shape, mode="area")
        lab = lab_from_srgb(planes[0].permute(1, 2, 0))
        slopes = torch.stack(torch.gradient(lab, dim=(0, 1))).square().sum((0, -1)).sqrt()
        # Relative to the mean slope around, edges in a dim corner count as much. The logarithm compresses strengths, which a change
        # of light changes, unlike the places of edges.
        around = F.avg_pool2d(slopes[None, None], 31, 1, 15, count_include_pad=False)[0, 0]
        maps.append((1 + slopes / (around + 0.2)).log().flatten())
    likeness = float(torch.nan_to_num(torch.corrcoef(torch.stack(maps))[0, 1]))
    return abs(one / other - 1) < 0.02 and likeness > _ALIKE


def statements_by_place(picture: Tensor, alpha: np.ndarray | None, seen: GBuffer) -> list[Statement]:
    """Statements on an image of the same scene: the color of each cell of the frame and of each material.

    Cells and materials with transparent pixels are left out. `seen` is the scene's G-buffer.
    """
    measured = MeasuredPicture.of(picture, seen)
    hidden = torch.zeros_like(seen.subject, dtype=torch.bool)
    if alpha is not None:
        hidden = F.interpolate(torch.from_numpy(alpha)[None, None], seen.subject.shape, mode="area")[0, 0] < 0.99
    cells = []
    height, width = seen.subject.shape
    step = max(height, width) / 12  # cells along the longer side
    rows, columns = max(round(height / step), 1), max(round(width / step), 1)
    for row, column in itertools.product(range(rows), range(columns)):
        box = column / columns, row / rows, (column + 1) / columns, (row + 1) / rows
        place = f"{_WORDS[3 * row // rows]} {_SIDES[3 * column // columns]}"
        reason = f"as it is at the {place} of the picture"
        cells.append(Statement(place, ClaimText("picture", "mean", box=box, reason=reason)))
    looks = [(name, ClaimText("thing", "mean", reason=f"as {name} looks in it")) for name in sorted({*seen.materials})]
    materials = [Statement(name, claim, material=name) for name, claim in looks]
    said = []
    for each in (*sorted(cells, key=lambda cell: cell.word), *materials):
        claim, owners = each.claim, (each.material,) if each.material else ()
        where = Claim("", "picture", "mean", "picture", (), (), owners, box=claim.box).region(seen)
        if where is not None and not (where & hidden).any():
            value, reach = MEASURES["mean"].take(measured, where).tolist(), _EXACT * MEASURES["mean"].notice
            said.append(_with(each, lower=tuple(v - reach for v in value), upper=tuple(v + reach for v in value)))
    return said


_GRAY = 4.0  # C* below which a tint counts as neutral
_SLIGHT = 10.0  # C* below which it is a slight one
_HUES = (
    (20.0, "pink"), (48.0, "red"), (72.0, "orange"), (105.0, "yellow"), (165.0, "green"), (225.0, "teal"),
    (255.0, "cyan-blue"), (300.0, "blue"), (335.0, "violet"), (360.0, "pink"),
)  # fmt: skip
"""Hue angles in CIE Lab, degrees, up to which a hue is called so."""


def hue(a: float, b: float) -> str:
    """The name of a tint with CIE Lab's a* and b*: "teal", "slightly orange", "neutral"."""
    strength = math.hypot(a, b)
    if strength < _GRAY:
        return "neutral"
    angle = math.degrees(math.atan2(b, a)) % 360
    name = next(name for end, name in _HUES if angle <= end)
    return f"slightly {name}" if strength < _SLIGHT else name


CLOSE, LOOSE = 1.5, 2.5  # noticeable steps from the image's value to either end of a claim
_MIXED = 0.35  # share of the spread of a part's a*, b* by which its cast may differ: in mixed colors it says little
_PAINTED, _GRAYEST = 18.0, 0.3
"""Greatest mean chroma that a claim asks for, and a quantile of the pixels' chroma that it does not exceed either. Color that
the grayest third of an image lacks is paint, which the scene may not have."""

_OF_CONTENT = 0.5  # weight of claims on quartiles and on the lightness of thirds: black and white objects count in them
_BLACK, _WHITE = 12.0, 80.0
"""L* that looks black, and white. A reference image with a black object in it asks for no darker black point, which would
only darken the shadows of a scene without such an object."""

_TONES = ("black_point", "lower_quartile", "median", "upper_quartile", "white_point")
_CASTS = {"shadow_cast": "shadows", "midtone_cast": "midtones", "highlight_cast": "lights"}
_THIRDS = {place: (0.0, n / 3, 1.0, (n + 1) / 3) for n, place in enumerate(_WORDS)}


def statements_of(regions: PictureRegions) -> list[Statement]:
    """Statements on an image of another scene: on its grade, light, palette and air, in this order."""
    reader = _Reader(regions)
    found = {"grade": reader.grade(), "light": reader.light(), "palette": reader.palette(), "air": reader.air()}
    return [replace(said, trait=trait) for trait, statements in found.items() for said in statements]


class _Reader:
    def __init__(self, regions: PictureRegions) -> None:
        self.regions, self.picture = regions, regions.picture

    def grade(self) -> Iterator[Statement]:
        """Statements on tones, tints of shadows, midtones and lights, saturation and vignette."""
        for measure in _TONES:
            said = self._near("tones", measure, f"{MEASURES[measure].says} is L* {{:.0f}}", steps=CLOSE)
            # Black and white objects of the reference need not be in the scene.
            if measure == "black_point":
                said = _with(said, upper=(max(*said.claim.upper, _BLACK),))
            elif measure == "white_point":
                said = _with(said, lower=(min(*said.claim.lower, _WHITE),))
            elif "quartile" in measure:
                said = _with(said, weight=_OF_CONTENT)
            yield said
        for measure, what in _CASTS.items():
            name = hue(*self._value(measure))
            yield self._near(f"{name} {what}", measure, f"its {what} are {name}", steps=CLOSE)
        (vivid,) = self._value("chroma")
        word = "pale" if vivid < 10 else "vivid" if vivid > 35 else "colors"
        said = self._near(word, "chroma", "its mean chroma is {:.0f}", steps=CLOSE)
        all_over = self.picture.lab[self.regions.counts][:, 1:].norm(dim=-1).quantile(_GRAYEST)
        yield _with(said, lower=(min(*said.claim.lower, _PAINTED, float(all_over)),))
        said = self._near("no gaudy colors", "vividest", "its most vivid colors have a chroma of {:.0f}")
        yield _with(said, lower=(-math.inf,), change=0.0)  # more vivid colors that the scene has may stay
        if min(corner_falls(self.picture), default=0.0) > 8.0:  # L* by which every corner is darker
            yield self._near("vignette", "vignette", "its corners are L* {:.0f} darker than its middle")

    def light(self) -> Iterator[Statement]:
        """Statements on the subject's light, and its contrast with the rest; none without a clear subject."""
        if not self.regions.subject:
            return
        (range_,) = self._value("spread", "subject")
        word = "contrasty light" if range_ > 45 else "soft light" if range_ < 25 else "light"
        yield self._near(word, "spread", "its subject ranges over L* {:.0f} from dark to light", "subject")
        for measure, sides in (("from_right", ("right", "left")), ("from_above", ("above", "below"))):
            (slope,) = self._value(measure, "subject")
            if abs(slope) > 8.0:  # L*, of a subject that is lit from one side
                side = sides[slope < 0]
                reason = f"its subject is L* {abs(slope):.0f} lighter on the side that is {side}"
                yield self._near(f"light from {side}", measure, reason, "subject")
        (above,) = self._value("standing_out", "subject")
        how = "lighter" if above > 0 else "darker"
        reason = f"its subject is L* {abs(above):.0f} {how} than the rest"
        yield self._near(f"subject {how} than its ground", "standing_out", reason, "subject")

    def palette(self) -> Iterator[Statement]:
        """Statements on the colors of subject, surroundings and sky; without a clear subject, of horizontal thirds."""
        if not self.regions.subject:
            for place, box in _THIRDS.items():
                yield from self._colors("picture", f"{place} third", box)
            return
        yield from self._colors("subject", "subject")
        yield from self._colors("surroundings", "surroundings")
        if self.regions.sky:
            yield from self._colors("sky", "sky")

    def air(self) -> Iterator[Statement]:
        """A statement on haze, if nothing in the image is dark or pure in color."""
        if self._value("veil")[0] > 35.0 and self._value("black_point")[0] > 20.0:  # percent of white; L*
            reason = "nothing in it is dark or pure in color: at least {:.0f} % of white lies over it"
            yield self._near("haze", "veil", reason)

    def _colors(self, part: Part, what: str, box: Values = ()) -> Iterator[Statement]:
        """Statements on lightness and cast of a part; none if it has too few pixels.

        The color of the reference's subject may be paint. So the render's subject is to have the cast of the whole reference,
        and may keep its own paint. The color of a third may be paint, too: the cast of the render's third may lie anywhere
        from that of the whole reference to that of the same third.
        """
        if self.regions.region(part, box) is None:
            return
        all_over, own = self._value("cast"), self._value("cast", part, box)
        word = f"{hue(*(all_over if part == 'subject' else own))} {what}"
        if part == "subject":
            said = self._near(word, "cast", f"the light all over it is {hue(*all_over)}")
            yield _with(said, part=part, change=0.0)
        else:
            said = self._near(word, "cast", f"its {what} is {hue(*own)}", part, box)
            lower, upper = said.claim.lower, said.claim.upper
            ends = {"lower": tuple(map(min, lower, all_over)), "upper": tuple(map(max, upper, all_over))}
            yield _with(said, **ends) if box else said
        said = self._near(word, "lightness", f"the mean lightness of its {what} is L* {{:.0f}}", part, box)
        yield _with(said, weight=_OF_CONTENT) if box else said

    def _value(self, measure: str, part: Part = "picture", box: Values = ()) -> Values:
        where = self.regions.region(part, box)
        where = self.regions.counts if where is None else where
        return tuple(MEASURES[measure].take(self.picture, where).tolist())

    def _near(
        self, word: str, measure: str, reason: str, part: Part = "picture", box: Values = (), steps: float = LOOSE
    ) -> Statement:
        """The claim that `measure` is within `steps` just-noticeable differences of its value in the reference image.

        The value is filled into `reason`. In a part of mixed colors, a color may differ by more.
        """
        value = self._value(measure, part, box)
        reach = steps * MEASURES[measure].notice / math.sqrt(len(value))
        if MEASURES[measure].unit == "a*b*":
            # Spread of the colors around the cast, with the weights by which the cast is measured
            where = self.regions.region(part, box)
            lab = self.picture.lab[self.regions.counts if where is None else where]
            tints, weights = lab[:, 1:], grayness(lab)
            mixture = (weights @ (tints - weights @ tints).square()).mean().sqrt()
            reach = max(reach, _MIXED * float(mixture))
        lower, upper = tuple(v - reach for v in value), tuple(v + reach for v in value)
        return Statement(word, ClaimText(part, measure, lower, upper, box=box, reason=reason.format(*value)))


def _with(statement: Statement, **changes: Any) -> Statement:
    return replace(statement, claim=replace(statement.claim, **changes))
