# SPDX-License-Identifier: Apache-2.0
"""What chosen targets are in the terms of the planner: things with a region, materials, lights and a role."""

from __future__ import annotations

from dataclasses import dataclass

from ...schema.spec import Region
from ..meaning import NamedThing
from ..mentions.nouns import NounMention, materials_of
from ..types import SceneDescription
from .pairs import PromptPairs, TargetPair
from .sharing import shared_out, told
from .targets import MATTER, NOWHERE, ROLES, rest

_KINDS = {"lights": "light", "key": "light", "air": "fog"}
"""Kind of target -> kind of thing, where they differ."""
_OF_SLOT = {"lighting": "light", "atmosphere": "fog", "grade": "tone", "setting": "surroundings"}
"""Slot -> kind of thing that its words are about in a picture as a whole."""


@dataclass(frozen=True)
class Thing:
    """What look words are bound to; `kind` as in the vocabulary's nouns, or "whole"; all as in `types.Attribute`."""

    kind: str
    thing: str
    region: Region
    owners: tuple[str, ...] = ()
    role: str = ""
    lights: tuple[str, ...] = ()


class Things:
    """The things that the look words of a prompt are bound to.

    Args:
        chosen: The pair of each look word.

    Attributes:
        mentioned: The nouns with a surface: name, region and materials.
        subject: What the prompt, or the scene, calls the subject.
        notes: How looks share the materials of a thing, in words.
    """

    def __init__(self, found: PromptPairs, chosen: list[TargetPair], scene: SceneDescription) -> None:
        self.found, self.chosen, self.scene = found, chosen, scene
        self.mentioned: list[NamedThing] = []
        self.subject = self._called() or scene.subject
        shares = shared_out(found, chosen, scene)
        self.notes = [*map(told, shares)]
        self._shared = {id(p): s.names for each in shares for s in each for p in s.look}

    def _called(self) -> str:
        """The noun by which the prompt calls a subject whose names the scene does not tell: "car" of a scene of cubes."""
        mentions = self.found.mentions
        used = {p.look.index for p in self.chosen if p.target.kind not in NOWHERE}
        said = {item.text for item in self.found.passage.items}
        if self.scene.subject in said or any(self._names_subject(m) for m in mentions):
            return ""
        starts = {m.start for m in mentions}
        mine = (m for m in mentions if _is_unknown(m) and m.end + 1 not in starts)
        return next((m.text for m in mine if not any(m.covers(index) for index in used)), "")

    def _names_subject(self, mention: NounMention) -> bool:
        named = (name for n in mention.named if n.kind == "things" for name in n.names)
        return any(self.scene.materials.get(name) == "subject" for name in named)

    def of(self, pair: TargetPair) -> Thing:
        """The thing that a pair binds its look word to."""
        kind, name = pair.target.kind, self._name(pair)
        if kind in MATTER:
            return self._matter(pair, name)
        if kind == "picture":
            return self._picture(pair)
        return Thing(
            _KINDS.get(kind, kind),
            name,
            "surroundings" if kind == "sky" else "whole",
            role=kind if kind in ROLES else "",
            lights=self._apart(pair.target.names) if kind == "lights" else (),
        )

    def _apart(self, lights: frozenset[str]) -> tuple[str, ...]:
        """Lights that a word singles out; all of them are light as a whole."""
        return tuple(sorted(lights)) if lights != {*self.scene.lights} else ()

    def _name(self, pair: TargetPair) -> str:
        """What the prompt calls the thing; the look word itself where no noun names it."""
        if pair.target.mention >= 0:
            return self.found.mentions[pair.target.mention].text
        if pair.target.kind == "subject":
            return self.subject or "subject"
        return pair.target.kind if pair.target.kind in MATTER else pair.look.token.text

    def _matter(self, pair: TargetPair, name: str) -> Thing:
        """Materials, or a whole region."""
        kind, slot = pair.target.kind, pair.becoming.slot
        names = self._rest() if kind == "others" else pair.target.names
        owners = tuple(n for n in self.scene.materials if n in names)
        regions = {self.scene.materials[n] for n in owners}
        region: Region = (
            "surroundings" if regions == {"surroundings"} or kind == "surroundings" else "subject"
        )
        if slot == "setting" or self._is_all_around(pair, owners):
            region, owners = "surroundings", ()
        self.mentioned.append((name, region, owners))
        return Thing(region, name, region, self._shared.get(id(pair), owners))

    def _is_all_around(self, pair: TargetPair, owners: tuple[str, ...]) -> bool:
        """Whether "background" means the only wall of a scene, or "the rest" all of them: then it is all that lies around, the sky too."""
        by_kind = pair.target.kind == "others" or any(s.endswith("synonym") for s in pair.target.signs)
        return by_kind and {*owners} == materials_of("surroundings", self.scene)

    def _rest(self) -> frozenset[str]:
        """All materials that no word names otherwise, nor the prompt excepts; details only if nothing else is left."""
        each = (
            t.names if t.kind == "things" else materials_of(t.kind, self.scene)
            for t in (pair.target for pair in self.chosen)
        )
        return rest(self.found.mentions, self.scene, frozenset().union(*each))

    def _picture(self, pair: TargetPair) -> Thing:
        """The picture as a whole, or what a word about many things is about in the first place."""
        if pair.becoming.slot == "color":
            named = pair.target.mention >= 0
            return Thing("tone", self._name(pair), "whole") if named else Thing("ambience", "tint", "whole")
        if pair.becoming.way == "row":
            return Thing("tone", pair.look.token.text, "whole")
        kind = _OF_SLOT.get(pair.becoming.slot, "whole")
        region: Region = "surroundings" if kind == "surroundings" else "whole"
        return Thing(kind, pair.look.token.text, region)


def _is_unknown(mention: NounMention) -> bool:
    return mention.noun in ("unknown", "subject") and not mention.named and not mention.text[0].isdigit()
