# SPDX-License-Identifier: Apache-2.0
"""A reference image, and its claims next to those of words."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from pathlib import Path

import numpy as np
import torch
from torch import Tensor

from ..claims.claim import Claim
from ..render.film import Film
from ..render.gbuffer import GBuffer
from ..scene import SceneData
from ..schema.options.table import TRAITS, Options
from . import light_probe, statements
from .picture import ReferencePicture, read_reference
from .ranges import CASTS
from .regions import PictureRegions, regions_of

_WARMER = (0.4, 0.8)
"""In a* and b*, one step of warmth, see `claims.measures.color.warmth`."""

_LIGHTER = {
    "black_point": (0.2,),
    "lower_quartile": (0.8,),
    "median": (1.0,),
    "upper_quartile": (0.8,),
    "white_point": (0.2,),
    "lightness": (1.0,),
}
"""The ends move less: a picture that is lighter has black in it all the same."""

MOVED: Mapping[str, Mapping[str, tuple[float, ...]]] = {
    "lightness": _LIGHTER,
    "warmth": dict.fromkeys(CASTS, _WARMER),
    "shadow_warmth": {"shadow_cast": _WARMER},
    "highlight_warmth": {"highlight_cast": _WARMER},
    "contrast": {
        "black_point": (-0.5,),
        "lower_quartile": (-0.25,),
        "upper_quartile": (0.25,),
        "white_point": (0.5,),
    },
}
"""What words measure -> what a picture measures of the same, and how far each of its numbers moves for one of the word's.
The picture's own pattern stays: lights that are warmer than shadows are so in a colder picture, too."""

_SETTLED = {
    "tint": CASTS,
    "accent": CASTS,
    "off_hue": CASTS,
    "color": ("cast", "lightness", "mean"),
    "brown_distance": CASTS,
    "burnt": ("white_point",),
}
"""What words measure -> what they settle of the same part, whatever the picture has."""

_SEEN = 2.5
"""Changes that are enough in words alone, from where "colder" is seen beside a picture."""
_HOLDS = 0.8
"""Share of the way from where a comparison holds."""


def merged_claims(
    words: Sequence[Claim], picture: Sequence[Claim], has: Callable[[Claim], float | None]
) -> tuple[Claim, ...]:
    """The words' claims, and those of a picture that they leave.

    Of one measure and part the picture's is dropped. Where words ask for more or less of something than the picture has, its
    claims of the same move along: to where the word holds, or, of a word that compares, as "colder" does, by what is clearly
    seen. Such a word is then measured against the picture, too, if `has` tells what the picture has of its claim.
    """
    said, left = [], list(picture)
    for word in words:
        if not word.word:  # it holds of every picture
            said.append(word)
            continue
        left = [claim for claim in left if not _settles(word, claim)]
        own = has(word) if word.measure in MOVED or word.compares else None
        if own is None:
            said.append(word)
            continue
        way = _way(word, own)
        left = [_moved(claim, word, way) for claim in left]
        said.append(_against(word, own, way) if word.compares else word)
    return (*said, *left)


def _settles(word: Claim, claim: Claim) -> bool:
    same = word.part == claim.part or word.part == "picture"
    return same and (word.measure == claim.measure or claim.measure in _SETTLED.get(word.measure, ()))


def _way(word: Claim, own: float) -> float:
    """How far a word moves what a picture has."""
    if word.change is not None and (word.compares or not word.near):
        return _SEEN * word.change
    return min(max(own, word.lower[0]), word.upper[0]) - own


def _moved(claim: Claim, word: Claim, way: float) -> Claim:
    along = MOVED.get(word.measure, {}).get(claim.measure)
    if along is None or word.part not in ("picture", claim.part):
        return claim
    lower, upper = (
        tuple(v + way * share for v, share in zip(end, along, strict=True))
        for end in (claim.lower, claim.upper)
    )
    return replace(claim, lower=lower, upper=upper)


def _against(word: Claim, own: float, way: float) -> Claim:
    """A word that compares, as a claim against what the picture has."""
    if word.change is None:
        return word
    border = own + _HOLDS * way
    lower, upper = (border, math.inf) if way > 0.0 else (-math.inf, border)
    return replace(word, lower=(lower,), upper=(upper,), change=None)


_DIM = 22.0  # L* of the median from where a picture's subject may drown in black
_OWN = ("burnt", "drowned", "separation")
"""What is claimed of every subject: a picture of this very scene says more of it."""

_FLAT = frozenset(MOVED) | {"chroma", "vignette"}
"""What words measure that a flat picture has, too."""


class Reference:
    """The picture that a look is taken from, named by its file.

    Attributes:
        same: Whether it shows the artist's scene; None before the artist's own image was seen.
    """

    def __init__(self, picture: ReferencePicture, name: str, options: Options) -> None:
        self.picture, self.name, self._only = picture, name, options.like_only
        self.same: bool | None = True if options.like_same else None

    @classmethod
    def of(cls, options: Options, scene: SceneData) -> Reference | None:
        """The picture that the options name; None if they name none. Linear light is shown as the scene shows its own.

        Raises:
            VibeError: It cannot be read.
        """
        if not options.like:
            return None
        path = Path(options.like)
        picture = read_reference(path)
        if picture.linear is not None:
            picture = replace(picture, display=_shown(picture.linear, scene))
        return cls(picture, path.name, options)

    @cached_property
    def display(self) -> Tensor:
        """(H, W, 3) as shown, sRGB-encoded."""
        return torch.from_numpy(self.picture.display)

    @property
    def traits(self) -> tuple[str, ...]:
        """What is taken over: what was asked for, else all but materials, which only a picture of this scene tells."""
        return self._only or (TRAITS if self.same else TRAITS[:-1])

    def compare(self, rendered: Tensor) -> None:
        """Finds out, once, whether it shows the same scene as the artist's own image (H, W, 3)."""
        if self.same is None and not self.probe:
            self.same = statements.is_same(self.display, rendered)

    def claims(self, words: tuple[Claim, ...], seen: GBuffer) -> tuple[Claim, ...]:
        """The claims of words and picture together."""
        if self.same:
            said = statements.statements_by_place(self.display, self.picture.alpha, seen, self.name)
            others = [claim for claim in words if claim.measure not in _OWN]
            return merged_claims(others, [s.claim for s in said], self._has)
        return self.of_any_scene(words)

    def of_any_scene(self, words: tuple[Claim, ...]) -> tuple[Claim, ...]:
        """The claims of words and picture together, where it shows another scene."""
        said = [s.claim for s in self.statements if s.trait in self.traits]
        return merged_claims([claim for claim in words if not self._denies(claim)], said, self._has)

    @cached_property
    def probe(self) -> light_probe.LightProbe | None:
        """What a panorama says of light; None for a picture that has a frame."""
        linear = self.picture.linear
        return light_probe.probe(linear) if self.picture.panorama and linear is not None else None

    @cached_property
    def statements(self) -> list[statements.Statement]:
        """What it says of any scene; nothing of one whose light alone is wanted."""
        if self.probe:
            return []
        return statements.statements_of(self._regions, self.name)

    @cached_property
    def _regions(self) -> PictureRegions:
        return regions_of(self.picture.display, self.picture.alpha)

    def _has(self, claim: Claim) -> float | None:
        """What the picture itself has of a word's claim; None where a flat picture does not tell."""
        told = claim.part == "picture" or (claim.part == "subject" and self._regions.subject)
        if self.probe or not told or claim.materials or claim.measure not in _FLAT:
            return None
        where = self._regions.region(claim.part)
        return None if where is None else float(claim.value(self._regions.picture, where)[0])

    def _denies(self, claim: Claim) -> bool:
        """Whether a claim of every picture is not this one's: its tones say how black it is, and in a dark one much may drown."""
        medians = [s.claim for s in self.statements if s.claim.measure == "median"]
        dark = any(median.lower[0] < _DIM for median in medians)
        return claim.measure == "drowned" and (claim.part == "picture" or dark)


def _shown(linear: np.ndarray, scene: SceneData) -> np.ndarray:
    keys = [key for key in ("film/exposure", "film/gamma") if key in scene.instances]
    values = {key: torch.tensor(scene.instances[key].value) for key in keys}
    film = Film(scene.film, (linear.shape[1], linear.shape[0]))
    return film.show(torch.from_numpy(linear), values).numpy()
