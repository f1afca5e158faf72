# SPDX-License-Identifier: Apache-2.0
"""Names of the copies of materials that single objects get, so that all others keep theirs: "Paint (on Chair.*)"."""

import re
from collections.abc import Sequence

from .parameters import split_key

_LONGEST = 63  # bytes of a name in Blender 4
_ON, _AND, _END, _ALL = " (on ", ", ", ")", ".*"
_NUMBER = re.compile(r"\.\d+$")  # that Blender gives the second object of a name


def copy_name(material: str, wearers: Sequence[str]) -> str:
    """The name of the copy for some objects, each as it is called or as `every`; "" where Blender could not hold it."""
    name = f"{material}{_ON}{_AND.join(wearers)}{_END}"
    return name if len(name.encode()) <= _LONGEST else ""


def copied(owner: str) -> tuple[str, str]:
    """The material that an owner's name says it is a copy of, and who wears it; the owner and "" for any other name."""
    material, _, wearers = owner.removesuffix(_END).rpartition(_ON)
    return (material, wearers) if material and owner.endswith(_END) else (owner, "")


def copied_key(key: str) -> str:
    """The key of the value that a copy starts with; of any other value its own."""
    group, owner, name = split_key(key)
    return f"{group}/{copied(owner)[0]}/{name}" if group == "material" else key


def every(name: str) -> str:
    """All objects of a name, whatever their numbers: "Chair.*" of "Chair.001"."""
    return _NUMBER.sub("", name) + _ALL


def is_worn_by(wearers: str, name: str) -> bool:
    """True if an object is one of the wearers in a copy's name."""
    return not {name, every(name)}.isdisjoint(wearers.split(_AND))
