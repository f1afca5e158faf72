# SPDX-License-Identifier: Apache-2.0
"""What chosen targets are in the terms of the planner: things with a region, materials, lights and a role."""

from __future__ import annotations

from ...schema.spec import Region
from ..meaning import NamedThing
from ..names import is_detail
from ..things import Thing
from ..types import SceneWords
from .mentions import surest
from .pairs import PromptPairs, TargetPair
from .targets import MATTER

_KIND_OF_SLOT = {"lighting": "light", "atmosphere": "fog", "setting": "surroundings"}
"""What a word about the whole picture is about."""


class Things:
    """The things that the look words of a prompt are bound to.

    Args:
        found: The prompt.
        chosen: The pair of each look word.
        scene: The names in the scene.

    Attributes:
        mentioned: The nouns with a surface: name, region and materials.
    """

    def __init__(self, found: PromptPairs, chosen: list[TargetPair], scene: SceneWords) -> None:
        self.found, self.chosen, self.scene = found, chosen, scene
        self.mentioned: list[NamedThing] = []

    def of(self, pair: TargetPair) -> Thing:
        """The thing that a pair binds its look word to.

        Args:
            pair: One of those chosen.
        """
        kind, name = pair.target.kind, self._name(pair)
        if kind in MATTER:
            return self._matter(pair, name)
        if kind == "lights":
            return Thing("light", name, "whole", lights=tuple(sorted(pair.target.names)))
        if kind == "key":
            return Thing("light", name, "whole", role="key")
        if kind in ("fill", "rim"):
            return Thing(kind, name, "whole", role=kind)
        if kind == "sky":
            return Thing("sky", name, "surroundings")
        if kind == "picture":
            return self._picture(pair)
        return Thing({"air": "fog"}.get(kind, kind), name, "whole")

    def _name(self, pair: TargetPair) -> str:
        """What the prompt calls the thing; the look word itself where no noun names it."""
        if pair.target.mention >= 0:
            return self.found.mentions[pair.target.mention].text
        return pair.target.kind if pair.target.kind in MATTER else pair.look.word.token.text

    def _matter(self, pair: TargetPair, name: str) -> Thing:
        """Materials, or a whole region."""
        kind, slot = pair.target.kind, pair.becoming.slot
        names = self._rest(pair) if kind == "others" else pair.target.names
        owners = tuple(n for n in self.scene.materials if n in names)
        regions = {self.scene.materials[n] for n in owners}
        region: Region = (
            "surroundings" if regions == {"surroundings"} or kind == "surroundings" else "subject"
        )
        if slot == "setting":
            region, owners = "surroundings", ()
        self.mentioned.append((name, region, owners))
        return Thing(region, name, region, owners)

    def _rest(self, pair: TargetPair) -> frozenset[str]:
        """All materials that no word names otherwise, nor the prompt excepts; details only if nothing else is left."""
        named: set[str] = set()
        for other in self.chosen:
            kind = other.target.kind
            if kind == "things":
                named |= other.target.names
            elif kind in ("subject", "surroundings") and other is not pair:
                named |= {n for n, region in self.scene.materials.items() if region == kind}
        for mention in self.found.mentions:
            best = surest(mention, "things", "object") if mention.members == 1 else None
            named |= best.names if best else frozenset()
        left = frozenset(self.scene.materials) - named
        return frozenset(n for n in left if not is_detail(n)) or left

    def _picture(self, pair: TargetPair) -> Thing:
        """The picture as a whole, or what a word about many things is about in the first place."""
        if pair.becoming.slot == "color":
            return Thing("ambience", "tint", "whole")
        if pair.becoming.way == "row":
            return Thing("tone", pair.look.word.token.text, "whole")
        kind = _KIND_OF_SLOT.get(pair.becoming.slot, "whole")
        region: Region = "surroundings" if kind == "surroundings" else "whole"
        return Thing(kind, pair.look.word.token.text, region)
