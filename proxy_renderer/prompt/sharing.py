# SPDX-License-Identifier: Apache-2.0
"""Several colors or materials of one thing that is made of several: "walnut and brushed steel", "a green car, chrome wheels"."""

from __future__ import annotations

from dataclasses import replace

from .names import is_detail
from .types import Attribute, Parsed, SceneWords

_PAINTS = ("color", "material")
"""Slots of which a surface has one each."""
_SURFACE = (*_PAINTS, "finish")


def share_out(parsed: Parsed, said: str, scene: SceneWords) -> None:
    """Gives each of several looks of the subject a part of its materials, where names do not tell whose they are.

    The first look gets the largest material, as a body is named before its trim, and so on in turn.

    Args:
        parsed: Bound; changed.
        said: The prompt as it was read.
        scene: Its materials, and how large the things are that wear them.
    """
    looks = _looks([a for a in parsed.attributes if _is_of_subject(a)], said)
    if len(looks) < 2 or len(looks) > len(materials := _by_size(scene)):
        return
    shares = {id(a): tuple(materials[n :: len(looks)]) for n, look in enumerate(looks) for a in look}
    parsed.attributes = [replace(a, owners=shares.get(id(a), a.owners)) for a in parsed.attributes]
    told = "; ".join(
        f"'{' '.join(a.word for a in look)}' is {', '.join(shares[id(look[0])])}" for look in looks
    )
    parsed.conflicts.append(f"Shared out among the subject's materials, the largest first: {told}.")


def _is_of_subject(attribute: Attribute) -> bool:
    """Whether a look word describes the subject as a whole."""
    named = attribute.kind == "subject" and not attribute.owners
    return named and attribute.slot in _SURFACE and not (attribute.negated or attribute.cause)


def _looks(attributes: list[Attribute], said: str) -> list[list[Attribute]]:
    """The words of each look: another one begins with another thing, or with a second color or material that stands apart."""
    looks: list[list[Attribute]] = []
    for attribute in attributes:
        last = looks[-1] if looks else []
        same = bool(last) and last[-1].thing == attribute.thing
        adjoins = bool(last) and f"{last[-1].word} {attribute.word}" in said
        if adjoins or (same and attribute.slot not in [a.slot for a in last]):
            last.append(attribute)
        else:
            looks.append([attribute])
    return _painted(looks)


def _painted(looks: list[list[Attribute]]) -> list[list[Attribute]]:
    """Looks that have a color or a material; finishes by themselves belong to the look after them, or to the last."""
    found: list[list[Attribute]] = []
    ahead: list[Attribute] = []
    for look in looks:
        ahead += look
        if any(a.slot in _PAINTS for a in look):
            found.append(ahead)
            ahead = []
    if found:
        found[-1] += ahead
    return found


def _by_size(scene: SceneWords) -> list[str]:
    """The subject's materials without details, those of the largest things first."""
    sizes = {n: 0.0 for n, region in scene.materials.items() if region == "subject" and not is_detail(n)}
    for wearer, worn in scene.object_materials.items():
        for name in sizes.keys() & {*worn}:
            sizes[name] += scene.places[wearer][2] ** 2 if wearer in scene.places else 0.0
    return sorted(sizes, key=lambda name: -sizes[name])
