# SPDX-License-Identifier: Apache-2.0
"""Objects that a prompt describes and that the scene lacks: "teal water" without water paints nothing else."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

from ..lexicon.spelling import singular
from ..lexicon.things import thing_words
from ..lexicon.vocabulary import Vocabulary
from ..mentions.names import parts
from ..mentions.nouns import NounMention
from ..names import name_words
from ..types import SceneWords
from .becoming import SURFACE
from .pairs import PromptPairs, TargetPair
from .targets import MATTER


class AbsentObjects:
    """Nouns of a prompt that name an object which its scene lacks.

    The first of them is what the artist calls the subject, unless another noun names it: a "boat" of hull and mast.

    Args:
        found: The prompt.
        scene: Its names; where none of them says what a thing is, nothing is known to be absent.
        vocabulary: What words mean.
    """

    def __init__(self, found: PromptPairs, scene: SceneWords, vocabulary: Vocabulary) -> None:
        self._found, self._scene, self._vocabulary = found, scene, vocabulary
        absent = {m.start: m for m in found.mentions if m.members == 1 and self._is_absent(m)}
        telling = thing_words().rows.keys() - name_words("primitives")
        known = any(word in telling for name in (*scene.objects, *scene.materials) for word in parts(name))
        self._objects = absent if known else {}
        self._absent = {m.start: m for m in self._scenery()} | absent if known else {}
        self._subject = self._called()

    def noun_of(self, pair: TargetPair) -> str:
        """The absent object that a look word describes; "" where it describes none.

        Args:
            pair: The look word with its target.
        """
        token, unused = pair.look.token, pair.target.kind == "none"
        slot = (
            ("color" if token.color else self._vocabulary.slot(token.entry)) if unused else pair.becoming.slot
        )
        if slot not in SURFACE or not (unused or pair.target.kind in MATTER):
            return ""
        own = next(self._own_nouns(pair), None)
        return own.text if own and own is not self._subject else ""

    def _own_nouns(self, pair: TargetPair) -> Iterator[NounMention]:
        """The absent noun by which a look word is bound, the look word itself, or the one right after it."""
        mentions, items, look = self._found.mentions, self._found.passage.items, pair.look.index
        bound = mentions[pair.target.mention] if pair.target.mention >= 0 else None
        if bound and bound.start in self._absent:
            yield self._absent[bound.start]
        if look in self._absent:
            yield self._absent[look]
        for place in range(look + 1, len(items)):
            if items[place].clause != items[look].clause:
                return
            if place in self._absent:
                yield self._absent[place]
            if not (items[place].names_a_look or items[place].strength):
                return

    def _scenery(self) -> Iterator[NounMention]:
        """What lies around, not called so in the scene, with a look word before it: "teal water"."""
        items, named = self._found.passage.items, {m.start for m in self._found.mentions if m.named}
        for place, (before, item) in enumerate(pairwise(items), start=1):
            described = before.names_a_look and before.clause == item.clause
            if described and item.text in self._vocabulary.words["scenery"] and place not in named:
                yield NounMention(place, place, item.text, "unknown")

    def _is_absent(self, mention: NounMention) -> bool:
        """Whether a noun is the name of an object, and of none in the scene."""
        token = self._found.passage.items[mention.start]
        thing = singular(mention.text) in thing_words().rows
        return mention.noun == "unknown" and not mention.named and not token.filler and thing

    def _called(self) -> NounMention | None:
        """The noun by which the prompt calls a subject whose names the scene does not tell."""
        named = any(map(self._names_subject, self._found.mentions))
        return None if named else next(iter(self._objects.values()), None)

    def _names_subject(self, mention: NounMention) -> bool:
        named = (name for n in mention.named if n.kind == "things" for name in n.names)
        return mention.noun == "subject" or any(self._scene.materials.get(n) == "subject" for n in named)
