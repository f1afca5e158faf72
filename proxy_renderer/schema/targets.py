# SPDX-License-Identifier: Apache-2.0
"""Names of targets, which words may describe: those that every scene has, and several names joined into one."""

import re
from collections.abc import Iterable

GENERAL = {
    "lights": "light", "light": "light", "key light": "key", "fill light": "fill", "rim light": "rim", "world": "sky", "sky": "sky",
    "air": "air", "image": "picture", "subject": "subject", "surroundings": "surroundings", "shadows": "shadow",
    "highlights": "highlight", "not used": "none",
}  # fmt: skip
"""Name that `--target` takes in every scene -> the target's kind. Of two names of a kind, the first is shown."""
OFFERED = ("lights", "key light", "world", "image", "not used")  # names that every word's menu offers
NOT_USED = "not used"
NAME_OF = {kind: name for name, kind in reversed(GENERAL.items())}  # kind of target -> its name
NUMBER = "#"  # between a word and its number, if the prompt has the word several times: "red#2"
_AND = " + "


def joined(names: Iterable[str]) -> str:
    """Several names of the scene as one target: "Cup + Table"."""
    return _AND.join(names)


def target_names(target: str) -> list[str]:
    """The names in a target, the inverse of `joined`."""
    return [name.strip() for name in target.split(_AND)]


def listed(target: str) -> str:
    """A target as a sentence has it: "Cup and Table", "the key light"."""
    names = [f"the {name}" if name in GENERAL and name != NOT_USED else name for name in target_names(target)]
    return " and ".join([", ".join(names[:-1]), names[-1]] if len(names) > 1 else names)


def is_said(key: str, prompt: str) -> bool:
    """True if a prompt contains the last word of a key, such as "very glossy" or "red#2"."""
    words = re.findall(r"[^\W_]+", key.partition(NUMBER)[0].casefold())
    text = prompt.casefold().replace("colour", "color")
    return bool(words) and words[-1] in text  # the last word decides: "very" may stand elsewhere
