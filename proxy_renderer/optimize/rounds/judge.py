# SPDX-License-Identifier: Apache-2.0
"""Images are judged by claims, which stay as they were understood at first, and by the encoder, as a round's advice says."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from torch import Tensor

from ...claims.claim import Claim, ClaimSet
from ...claims.measures.picture import MeasuredPicture
from ...goals.resolve import Goals
from ...guidance.encoder import Encoder
from ...guidance.guide import Guidance
from ...planning.advice import Advice
from ...reference.like import Reference
from ...render.proxy import Render
from ..shots import ShotState
from .method import Method


class Judge:
    """Says how near the images of all shots are to the words.

    Args:
        every_word: Whether the encoder is asked for all words.
        word_claims: The claims of goals, without those of the reference image.

    Attributes:
        claims: Of words and reference image; none before `begin`.
    """

    def __init__(
        self,
        method: Method,
        encoder: Encoder,
        prompt: str,
        every_word: bool,
        word_claims: Callable[[Goals], tuple[Claim, ...]],
        reference: Reference | None,
    ) -> None:
        self._method, self._encoder, self._prompt, self._every_word = method, encoder, prompt, every_word
        self._word_claims, self._reference = word_claims, reference
        self.claims: tuple[Claim, ...] = ()
        self._artist: list[
            tuple[Render, MeasuredPicture, ClaimSet]
        ] = []  # of each shot: the artist's image, as measured, its claims
        self._asked: object = None
        self._guidance: list[Guidance] = []

    @property
    def has_begun(self) -> bool:
        """Whether the claims are known."""
        return bool(self._artist)

    def claims_of(self, goals: Goals, shot: ShotState) -> tuple[Claim, ...]:
        """The claims of words and reference image about the first shot; about the others the same."""
        claims = self._word_claims(goals)
        if self._reference:
            return self._reference.claims(claims, shot.gbuffer(shot.vector.encode({})))
        return claims

    def begin(self, shots: Sequence[ShotState], u: Tensor, goals: Goals) -> None:
        """Settles the claims, and keeps the artist's images, drawn at u (N,): changes and guidance are relative to them."""
        self.claims = self._method.claims(self.claims_of(goals, shots[0]))
        for shot in shots:
            image = shot.draw(u)
            before = MeasuredPicture(image.display.detach(), shot.gbuffer(u))
            self._artist.append((image, before, ClaimSet.about(self.claims, before)))

    def equipped(self, shots: Sequence[ShotState], advice: Advice) -> list[ShotState]:
        """The shots with their claims, and with guidance by a round's advice."""
        if self._asked != (asked := (advice.prompts, advice.unmeasured)):
            self._asked = asked
            self._guidance = [
                self._method.guidance(self._encoder, self._prompt, advice, image, self._every_word)
                for image, _, _ in self._artist
            ]
        found = []
        for shot, guidance, (_, before, claims) in zip(shots, self._guidance, self._artist, strict=True):
            if shot.claims is None:
                shot = replace(shot, claims=claims, before=before, seen=before.seen)
            found.append(replace(shot, guidance=guidance))
        return found
