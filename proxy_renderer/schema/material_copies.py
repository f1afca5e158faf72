# SPDX-License-Identifier: Apache-2.0
"""Names of the copies of materials that single objects get, so that all others keep theirs: "Paint (on Chair.*)"."""

import re
from collections.abc import Sequence

from .parameters import split_key

_LONGEST = 63  # bytes of a name in Blender 4
_ON, _AND, _END, _ALL = " (on ", ", ", ")", ".*"
_NUMBER = re.compile(r"\.\d+$")  # Blender appends it to a name that is taken


def copy_name(material: str, wearers: Sequence[str]) -> str:
    """The name of a material's copy for some objects, each by its name or by `every`; "" if it is too long for Blender."""
    name = f"{material}{_ON}{_AND.join(wearers)}{_END}"
    return name if len(name.encode()) <= _LONGEST else ""


def copied(owner: str) -> tuple[str, str]:
    """The original material and the wearers (as one text) in a copy's name; any other name itself, and ""."""
    material, _, wearers = owner.removesuffix(_END).rpartition(_ON)
    return (material, wearers) if material and owner.endswith(_END) else (owner, "")


def copied_key(key: str) -> str:
    """For a key of a material's copy, the key of the original's value; any other key as it is."""
    group, owner, name = split_key(key)
    return f"{group}/{copied(owner)[0]}/{name}" if group == "material" else key


def every(name: str) -> str:
    """A pattern for all objects of a name, whatever their numbers: "Chair.*" for "Chair.001"."""
    return _NUMBER.sub("", name) + _ALL


def is_worn_by(wearers: str, name: str) -> bool:
    """True if an object is one of the wearers in a copy's name."""
    return not {name, every(name)}.isdisjoint(wearers.split(_AND))
