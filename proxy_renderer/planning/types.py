# SPDX-License-Identifier: Apache-2.0
"""The records of planning: a plan has an entry with a range for each parameter of a scene."""

from __future__ import annotations

from dataclasses import dataclass, field

from ..goals.wish import Wish
from ..schema import Instance, Values
from ..words.lexicon.entries import Effect
from ..words.types import Attribute


@dataclass(frozen=True)
class PlanEntry:
    """The range and the priority of one parameter instance."""

    lower: Values  # component-wise, within the instance's hard bounds
    upper: Values  # likewise
    priority: int | None  # the smaller the more important; None is never optimized (but still projected)
    reason: str  # for the artist; quotes the word that caused it
    prior: float = 1.0  # weight in [0, 1] of the pull to the artist's value: 0 where words named the value
    usual: bool = False  # whether it is only usual, as nights are blue: it is not widened for missed claims
    varies: bool = False  # whether variants may differ in it though words name it: the side of a candle
    any_hue: bool = False  # whether a color may take any hue in its range; if not, the search keeps its hue
    start: Values | None = None  # where the search begins; None for the artist's value, projected

    @classmethod
    def kept(cls, instance: Instance, reason: str) -> PlanEntry:
        """An entry that is not optimized: the artist's value if that is locked, else the full bounds."""
        if instance.locked:
            return cls(instance.value, instance.value, None, f"locked: {instance.locked}")
        return cls(instance.lower, instance.upper, None, reason)

    @property
    def is_named(self) -> bool:
        """True if words give the parameter its range."""
        return self.priority is not None and self.prior == 0.0


@dataclass(frozen=True)
class LightPlan:
    """The plan of a lighting rig, which replaces the effects of the words that ask for the rig."""

    entries: dict[str, PlanEntry] = field(default_factory=dict)  # for every parameter that it sets, by key
    served: tuple[Attribute, ...] = ()  # the words that ask for the rig; they ask for no other light
    grade: tuple[tuple[Attribute, Effect], ...] = ()  # the rig's effects on the film, each with its word
    shown: tuple[Wish, ...] = ()  # wishes about how the rig's light looks in the image


LEFT_ALONE = "Left alone, though the words ask for it"  # how the note on locked values begins


class Plan(dict[str, PlanEntry]):
    """The plan of a scene: key -> entry, for every instance."""

    def __init__(self, entries: dict[str, PlanEntry] | None = None, notes: tuple[str, ...] = ()) -> None:
        super().__init__(entries or {})
        self.notes = notes  # sentences for the artist on overridden words, locked values and missing lights
