# SPDX-License-Identifier: Apache-2.0
"""What is known at one point of a clause."""

from __future__ import annotations

from dataclasses import dataclass, field

from .things import Thing, Word
from .tokens import Token


@dataclass
class ClauseState:
    """What the words so far leave open.

    Attributes:
        waiting: Look words whose noun has not come yet.
        last: The last noun.
        linked: "is", "made of": what follows describes the last noun.
        around: "on", "in front of": what follows lies around the subject.
        inside: "in", "of": so it does if it is a thing; otherwise like `linked`.
        strength: Of the next look word.
        negated: Whether look words are negated.
        prefix: Intensities and negations since the last look word, for quoting.
        bare: Nothing has been said about the last noun: "the wall" in "the wall dark teal".
        definite: The token before is "the".
    """

    waiting: list[Word] = field(default_factory=list)
    last: Thing | None = None
    linked: bool = False
    around: bool = False
    inside: bool = False
    strength: float = 1.0
    negated: bool = False
    prefix: list[str] = field(default_factory=list)
    bare: bool = False
    definite: bool = False

    def word(self, token: Token) -> Word:
        """The look word of a token, with what was said before it."""
        prefix = self.prefix if self.prefix or not self.negated else ["no"]
        word = Word(token, " ".join([*prefix, token.text]), self.strength, self.negated)
        self.prefix, self.strength = [], 1.0
        return word
