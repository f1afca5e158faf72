# SPDX-License-Identifier: Apache-2.0
"""Several looks of one thing share its materials: "red, green and blue balls", "walnut and brushed steel"."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from ..names import is_detail
from ..types import SceneDescription
from .pairs import PromptPairs, TargetPair
from .targets import MATTER

_PAINTS = ("color", "material")
"""Slots of which a surface has one each."""
_Look = list[TargetPair]
"""The words of one look: "glossy red"."""


@dataclass(frozen=True)
class Share:
    """A look with its part of the materials.

    Attributes:
        look: Its words.
        names: Of its materials.
    """

    look: _Look
    names: tuple[str, ...]


def shared_out(read: PromptPairs, chosen: Iterable[TargetPair], scene: SceneDescription) -> list[list[Share]]:
    """The shares of each thing that has several looks: of alike objects of one noun, or of a subject with as many materials.

    The first look gets the largest material, as a body is named before its trim, and so on in turn.

    Args:
        chosen: The pair of each look word.
        scene: Its materials, and how large the things are that wear them.
    """
    described: dict[int | None, _Look] = {}
    for pair in filter(_may_share, chosen):  # the subject, or several things by one noun
        described.setdefault(pair.target.mention if pair.target.names else None, []).append(pair)
    found = []
    for mention, pairs in described.items():
        looks = _painted(_looks(pairs, read))
        materials = _by_size(pairs[0].target.names, scene) if len(looks) > 1 else []
        enough = len(looks) == len(materials) if mention is None else len(looks) <= len(materials)
        if len(looks) > 1 and enough:
            found.append([Share(look, tuple(materials[n :: len(looks)])) for n, look in enumerate(looks)])
    return found


def told(shares: list[Share]) -> str:
    """Says how looks are shared out."""
    each = (f"'{' '.join(p.look.text for p in s.look)}' is {', '.join(s.names)}" for s in shares)
    return f"Shared out among materials, the largest first: {'; '.join(each)}."


def _may_share(pair: TargetPair) -> bool:
    """Whether a word is about several materials that it does not tell apart; a finish of "glossy red and white balls" is all of theirs."""
    if pair.target.kind == "subject":
        return not pair.look.negated and pair.target.mention < 0
    several = pair.target.kind in MATTER and "several" in pair.target.signs
    return several and pair.becoming.slot in _PAINTS


def _looks(pairs: _Look, read: PromptPairs) -> list[_Look]:
    """The words of each look: another one begins behind a noun, or with a second color or material that stands apart."""
    looks: list[_Look] = []
    for pair in pairs:
        last = looks[-1] if looks else []
        fresh = pair.becoming.slot not in [p.becoming.slot for p in last]
        between = range(last[-1].look.index, pair.look.index) if last else ()
        same = bool(last) and not any(mention.start in between for mention in read.mentions)
        adjoins = bool(last) and read.passage.adjoin(last[-1].look, pair.look)
        if adjoins or (same and fresh):
            last.append(pair)
        else:
            looks.append([pair])
    return looks


def _painted(looks: list[_Look]) -> list[_Look]:
    """Looks that have a color or a material; finishes by themselves belong to the look after them, or to the last."""
    found: list[_Look] = []
    ahead: _Look = []
    for look in looks:
        ahead += look
        if any(pair.becoming.slot in _PAINTS for pair in look):
            found.append(ahead)
            ahead = []
    if found:
        found[-1] += ahead
    return found


def _by_size(names: frozenset[str], scene: SceneDescription) -> list[str]:
    """Some materials, or the subject's without details, those of the largest things first."""
    of_subject = (n for n, region in scene.materials.items() if region == "subject" and not is_detail(n))
    sizes = dict.fromkeys((n for n in scene.materials if n in names) if names else of_subject, 0.0)
    for wearer, worn in scene.object_materials.items():
        for name in sizes.keys() & {*worn}:
            sizes[name] += scene.places[wearer][2] ** 2 if wearer in scene.places else 0.0
    return sorted(sizes, key=lambda name: -sizes[name])
