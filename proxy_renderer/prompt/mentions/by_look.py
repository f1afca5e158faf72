# SPDX-License-Identifier: Apache-2.0
"""Materials that a noun means by how they look and what shape they have: "the navy surface", "the roof"."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace

from ...color.floats import oklab_from_srgb
from ...schema import Values
from ..lexicon.vocabulary import Vocabulary
from ..tokens import Token
from ..types import MaterialLook, SceneDescription
from .changes import STRUCTURES
from .nouns import Named

_NEAR = 0.11  # OKLab distance, lightness at less than half, within which a color is called so
_LIGHTNESS = 0.4  # how much lightness counts
_CLEAR = 1.4  # how many times farther away the next color has to be
_ALIKE = 0.05  # within which two materials have one color
_GRAY = 0.04  # chroma below which a hue says nothing
_STRETCH = (0.5, 1.6)  # how much paler or stronger than its name's a color may be
_SHAPED = 0.6  # what multiplies the distance of a material with the shape that the noun says
_SEEN = 0.001  # share of the image from which somebody would speak of a material
_OWN = 0.5  # share of what is seen of a material that has to be on an object by whose name it is found
_MAIN = 3.0  # how many times larger than others of its color a material is that one noun means


class LookIndex:
    """Finds what a noun means by present looks.

    Args:
        words: The scene, with the looks of its materials.
    """

    def __init__(self, words: SceneDescription, vocabulary: Vocabulary) -> None:
        self._vocabulary = vocabulary
        seen = {name: look for name, look in words.looks.items() if look.share >= _SEEN}
        self._looks = {name: look for name, look in seen.items() if name in words.materials}

    def meant(self, noun: str, presents: Iterable[Token]) -> frozenset[str]:
        """The materials that a noun clearly means; none where they cannot be told.

        Args:
            presents: Looks that it has at present.
        """
        shaped = self._shaped(noun)
        color = next((look.color for look in presents if look.color), None)
        if color is None:
            return frozenset(shaped if len(shaped) == 1 else ())
        return self._colored(color, shaped, plural=noun.endswith("s"))

    def own(self, named: Iterable[Named], objects: Iterable[str]) -> list[Named]:
        """What words name, without materials by objects that are mostly seen on others: a sofa that wears the wall's paint."""
        wearers = {*objects}
        others = {
            name
            for name, look in self._looks.items()
            if 0 < sum(share for o, share in look.worn.items() if o in wearers) < _OWN * look.share
        }
        kept = ((n, n.names - others if n.kind == "things" and _by_object(n) else n.names) for n in named)
        return [replace(n, names=names) for n, names in kept if names]

    def narrowed(self, names: frozenset[str], presents: Iterable[Token]) -> frozenset[str]:
        """Those of some materials that have a present look; all where none is known to.

        Args:
            presents: Looks that they have at present.
        """
        color = next((look.color for look in presents if look.color), None)
        known = [n for n in names if n in self._looks]
        if color is None or len(known) < 2:
            return names
        distances = {n: self._distance(color, self._looks[n]) for n in known}
        best = min(distances.values())
        return frozenset(n for n in known if distances[n] <= best + _ALIKE) if best < _NEAR else names

    def _shaped(self, noun: str) -> list[str]:
        """The materials whose shape is what a noun says."""
        said = {noun, noun.rpartition(" ")[2]}
        kinds = {kind for kind in STRUCTURES if said & self._vocabulary.words[kind]}
        return [name for name, look in self._looks.items() if kinds & look.structures]

    def _colored(self, color: Values, shaped: list[str], plural: bool) -> frozenset[str]:
        """The materials of a color, if no other comes near; of several that a singular means, the main one."""
        distances = {
            name: self._distance(color, look) * (_SHAPED if name in shaped else 1.0)
            for name, look in self._looks.items()
        }
        best = min(distances.values(), default=math.inf)
        if best > _NEAR:
            return frozenset()
        alike = [name for name, distance in distances.items() if distance <= best + _ALIKE]
        near = [name for name, distance in distances.items() if distance < _CLEAR * (best + _ALIKE)]
        if not plural:
            alike = [max(alike, key=lambda name: (name in shaped, self._looks[name].share))]
        rivals = [name for name in near if name not in alike]
        return frozenset(alike if self._is_main(alike, rivals, shaped) else ())

    def _is_main(self, names: list[str], rivals: list[str], shaped: list[str]) -> bool:
        """Whether others of about the color of some materials cover far less of the image, or have another shape."""
        if shaped and set(names) <= set(shaped):
            return set(rivals).isdisjoint(shaped)
        least = min(self._looks[name].share for name in names)
        return all(least >= _MAIN * self._looks[name].share for name in rivals)

    def _distance(self, color: Values, look: MaterialLook) -> float:
        """How far a material is from what its color is called; lightness counts less, and how strong the color is hardly."""
        if look.color is None:
            return math.inf
        (light, *named), (own_light, *own) = oklab_from_srgb(color), oklab_from_srgb(look.color)
        strong, length = math.hypot(*named), math.hypot(*own)
        hues = min(strong, length) > _GRAY
        factor = min(max(strong / length, 1 / _STRETCH[1]), 1 / _STRETCH[0]) if hues else 1.0
        lighter = 0.0 if look.glows else _LIGHTNESS * (light - own_light)
        return math.hypot(lighter, *(a - factor * b for a, b in zip(named, own, strict=True)))


def _by_object(named: Named) -> bool:
    """Whether materials were found by the name of an object alone."""
    return not any(sign.startswith("material") for sign in named.signs)
