# SPDX-License-Identifier: Apache-2.0
"""A picture in the place of words, for one vibe: its claims, and its plan. Nothing of it is sent anywhere."""

from __future__ import annotations

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
from . import light_probe, same_scene, statements
from .merge import MOVED, together
from .picture import ReferencePicture, read_reference
from .regions import Told, tell

_DIM = 22.0  # L* of the median from where a picture's subject may drown in black
_OWN = ("burnt", "drowned", "separation")
"""What is claimed of every subject: a picture of this very scene says more of it."""

_FLAT = frozenset(MOVED) | {"chroma", "vignette"}
"""What words measure that a flat picture has, too."""


class Reference:
    """The picture that a look is taken from.

    Args:
        options: `like_only`, `like_same`, and whether there are words is for the others to say.

    Attributes:
        name: Its file's name.
        same: Whether it shows this very scene; None before the artist's own picture was seen.
    """

    def __init__(self, picture: ReferencePicture, name: str, options: Options) -> None:
        self.picture, self.name, self._only = picture, name, options.like_only
        self.same: bool | None = True if options.like_same else None

    @classmethod
    def of(cls, options: Options, scene: SceneData) -> Reference | None:
        """The picture that the options name; None if they name none. Linear light is shown as the scene shows its own.

        Args:
            options: Name it, and say what is taken over.

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
        """Finds out whether it shows this very scene, once.

        Args:
            rendered: (H, W, 3) the artist's own picture.
        """
        if self.same is None and not self.probe:
            self.same = same_scene.is_same(self.display, rendered)

    def claims(self, words: tuple[Claim, ...], seen: GBuffer) -> tuple[Claim, ...]:
        """The claims of words and picture together.

        Args:
            words: Those of the words, and of every picture.
            seen: What the camera sees at the artist's values.
        """
        if self.same:
            said = same_scene.statements_of(self.display, self.picture.alpha, seen, self.name)
            others = [claim for claim in words if claim.measure not in _OWN]
            return together(others, [s.claim for s in said], self._has)
        return self.of_any_scene(words)

    def of_any_scene(self, words: tuple[Claim, ...]) -> tuple[Claim, ...]:
        """The claims of words and picture together, where it shows another scene.

        Args:
            words: Those of the words, and of every picture.
        """
        said = [s.claim for s in self.statements if s.trait in self.traits]
        return together([claim for claim in words if not self._denies(claim)], said, self._has)

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
        return statements.statements_of(self._told, self.name)

    @cached_property
    def _told(self) -> Told:
        return tell(self.picture.display, self.picture.alpha)

    def _has(self, claim: Claim) -> float | None:
        """What the picture itself has of a word's claim; None where a flat picture does not tell."""
        told = claim.part == "picture" or (claim.part == "subject" and self._told.subject)
        if self.probe or not told or claim.materials or claim.measure not in _FLAT:
            return None
        where = self._told.region(claim.part)
        return None if where is None else float(claim.value(self._told.picture, where)[0])

    def _denies(self, claim: Claim) -> bool:
        """Whether a claim of every picture is not this one's: its tones say how black it is, and in a dark one much may drown."""
        medians = [s.claim for s in self.statements if s.claim.measure == "median"]
        dark = any(median.lower[0] < _DIM for median in medians)
        return claim.measure == "drowned" and (claim.part == "picture" or dark)


def _shown(linear: np.ndarray, scene: SceneData) -> np.ndarray:
    """Scene-linear light (H, W, 3) as a scene's view shows it: its transform, look, exposure and gamma."""
    keys = [key for key in ("film/exposure", "film/gamma") if key in scene.instances]
    values = {key: torch.tensor(scene.instances[key].value) for key in keys}
    film = Film(scene.film, (linear.shape[1], linear.shape[0]))
    return film.show(torch.from_numpy(linear), values).numpy()
