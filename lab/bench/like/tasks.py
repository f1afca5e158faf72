# SPDX-License-Identifier: Apache-2.0
"""Tasks of the product with a picture instead of words."""

from __future__ import annotations

import random
from collections.abc import Iterator
from dataclasses import dataclass

SETS = (
    *("robot", "duck", "mug", "sofa", "car", "vase", "table", "donut", "temple", "plant"),
    *("boat", "mushroom", "living_room", "balls", "head", "breakfast", "letters", "cottage", "lamp", "supper"),
)
"""Sets of `python -m lab paper`, by name: indoors, outdoors and in a studio."""

WHOLE_LOOK = ("light", "world", "volume", "film")
"""Groups of the schema that a look changes."""

FILTERS = (
    *("_1977", "aden", "brannan", "brooklyn", "clarendon", "earlybird", "gingham", "hudson", "inkwell"),
    *("kelvin", "lark", "lofi", "maven", "mayfair", "moon", "nashville", "perpetua", "reyes", "rise"),
    *("slumber", "stinson", "toaster", "valencia", "walden", "willow", "xpro2"),
)
"""Photo filters of the package pilgram, by name."""

_FILTERED = 3
"""Sets that the filters are tried on, in turn."""

_HIDDEN: dict[str, tuple[str, ...]] = {
    "recovery": WHOLE_LOOK,
    "lamps": ("light",),  # where nothing else may explain it, a picture tells a lamp's direction, color and power
    "materials": (*WHOLE_LOOK, "material"),
}
"""Part -> what its look changes, where the picture shows the very scene."""

PARTS = ("recovery", "lamps", "materials", "transfer", "filters")


@dataclass(frozen=True)
class HiddenLook:
    """A set and a look that is drawn for it.

    Attributes:
        set: Its name.
        seed: Of the look.
        groups: What the look changes; none for the set as it is.
    """

    set: str
    seed: str
    groups: tuple[str, ...]


@dataclass(frozen=True)
class LikeTask:
    """One task.

    Attributes:
        part: Of the measurement, in `PARTS`.
        truth: The scene that is given, and the look that it should end with.
        shown: Where the picture that is given comes from: the same, or the look on another scene.
        photo_filter: What is done to that picture, in `FILTERS`; "" for nothing.
        options: More options of `vibe run`.
    """

    part: str
    truth: HiddenLook
    shown: HiddenLook
    photo_filter: str = ""
    options: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        """Its name in tables."""
        other = "" if self.shown == self.truth else f" from {self.shown.set}"
        return f"{self.part} {self.truth.seed} {self.truth.set}{other}{self.photo_filter and f' {self.photo_filter}'}"


def tasks(part: str, count: int, seed: str) -> Iterator[LikeTask]:
    """Tasks of a part; fewer are the first of more.

    Args:
        part: One of `PARTS`.
        count: How many; of the filters there are no more than `FILTERS`.
    """
    for number in range(min(count, len(FILTERS)) if part == "filters" else count):
        luck = random.Random(f"{seed}/{part}/{number}")
        name, other = luck.sample(SETS, 2)
        look = f"{seed}-{number}"
        if part == "filters":
            few = random.Random(f"{seed}/{part}").sample(SETS, _FILTERED)
            plain = HiddenLook(few[number % _FILTERED], "plain", ())
            yield LikeTask(part, plain, plain, FILTERS[number], ("--groups=film",))
        elif part == "transfer":
            yield LikeTask(part, HiddenLook(name, look, WHOLE_LOOK), HiddenLook(other, look, WHOLE_LOOK))
        else:
            hidden = HiddenLook(name, look, _HIDDEN[part])
            options = ("--groups=light",) if part == "lamps" else ()
            yield LikeTask(part, hidden, hidden, options=options)
