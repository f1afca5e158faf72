# SPDX-License-Identifier: Apache-2.0
"""Names of the copies of materials that single objects get, so that all others keep theirs: "Paint (on Chair.*)"."""

import re
from collections.abc import Sequence

from .parameters import split_key

_LONGEST = 63  # bytes of a name in Blender 4
_ON, _AND, _END, _ALL = " (on ", ", ", ")", ".*"
_NUMBER = re.compile(r"\.\d+$")  # Blender appends it to a name that is taken


def copy_name(material: str, wearers: Sequence[str]) -> str:
    """The name of a material's copy for its wearers, names of objects or patterns of `every`; "" if it is too long."""
    name = f"{material}{_ON}{_AND.join(wearers)}{_END}"
    return name if len(name.encode()) <= _LONGEST else ""


def copied(owner: str) -> tuple[str, str]:
    """(original material, wearers) in a copy's name: ("Paint", "Cup") of "Paint (on Cup)"; else (name, "")."""
    material, _, wearers = owner.removesuffix(_END).rpartition(_ON)
    return (material, wearers) if material and owner.endswith(_END) else (owner, "")


def copied_key(key: str) -> str:
    """For a key of a material's copy, the key of the original's value; any other key as it is."""
    group, owner, name = split_key(key)
    return f"{group}/{copied(owner)[0]}/{name}" if group == "material" else key


def every(name: str) -> str:
    """A pattern for all objects whose names differ only in the number: "Chair.*" for "Chair.001"."""
    return _NUMBER.sub("", name) + _ALL


def is_worn_by(wearers: str, name: str) -> bool:
    """True if the object `name` is one of the wearers of a copy; `wearers` is the text that `copied` returns."""
    return not {name, every(name)}.isdisjoint(wearers.split(_AND))
