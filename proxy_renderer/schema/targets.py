# SPDX-License-Identifier: Apache-2.0
"""Names of what a word may describe: those that every scene has, and how several names are written as one."""

from __future__ import annotations

from collections.abc import Iterable

GENERAL = {
    "lights": "light", "light": "light", "key light": "key", "fill light": "fill", "rim light": "rim", "world": "sky", "sky": "sky",
    "air": "air", "image": "picture", "subject": "subject", "surroundings": "surroundings", "shadows": "shadow",
    "highlights": "highlight", "not used": "none",
}  # fmt: skip
"""Name that `--target` takes in every scene -> kind of target, as the reader calls it. Of two names of a kind, the first is shown."""
OFFERED = ("lights", "key light", "world", "image", "not used")
"""Names that every word's menu offers."""
NOT_USED = "not used"
NAME_OF = {kind: name for name, kind in reversed(GENERAL.items())}
"""Kind of target -> its name."""
_AND = " + "


def joined(names: Iterable[str]) -> str:
    """Several names of the scene as one target: "Cup + Table"."""
    return _AND.join(names)


def parted(target: str) -> list[str]:
    """The names in a target, see `joined`."""
    return [name.strip() for name in target.split(_AND)]


def spoken(target: str) -> str:
    """A target as a sentence has it: "Cup + Table", "the key light"."""
    return f"the {target}" if target in GENERAL and target != NOT_USED else target
