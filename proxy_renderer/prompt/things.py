# SPDX-License-Identifier: Apache-2.0
"""The two sides of a binding: a look word that waits for its noun, and the thing that a noun names."""

from __future__ import annotations

from dataclasses import dataclass

from ..schema.spec import Region
from .tokens import Token


@dataclass
class Thing:
    """What words are bound to; `kind` as in the vocabulary's nouns, or "whole"."""

    kind: str
    name: str = ""
    region: Region = "subject"
    owners: tuple[str, ...] = ()
    role: str = ""
    lights: tuple[str, ...] = ()

    @property
    def matter(self) -> bool:
        """Whether it has a surface."""
        return self.kind in ("subject", "surroundings")


@dataclass
class Word:
    """A look word that waits for its noun."""

    token: Token
    text: str
    strength: float
    negated: bool
    barred: bool = False  # an "and" came after it

    @property
    def less(self) -> bool:
        """Whether it is to be there in a smaller degree than now: a step towards its opposite."""
        itself = self.token.text.startswith("less ")  # "less contrast" is a word of its own
        return self.text.startswith("less ") and not (itself or self.negated)
