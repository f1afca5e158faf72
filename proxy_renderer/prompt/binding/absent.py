# SPDX-License-Identifier: Apache-2.0
"""Objects that a prompt describes and that the scene lacks: "teal water" without water paints nothing else."""

from __future__ import annotations

from ..lexicon.things import thing_words
from ..lexicon.vocabulary import Vocabulary
from ..mentions.changes import STRUCTURES
from ..mentions.names import parts
from ..mentions.nouns import NounMention, materials_of
from ..names import is_detail, name_words
from ..types import SceneWords
from .becoming import SURFACE
from .own_nouns import OwnNouns
from .pairs import PromptPairs, TargetPair

_MAIN = 0.6  # share of the subject from which one material is what a name for the subject means


class AbsentObjects:
    """Nouns of a prompt that name an object which its scene lacks.

    The first of them is what the artist calls the subject, where the subject is of one material and no noun names it.

    Args:
        found: The prompt.
        scene: Its names, and how its materials look.
        vocabulary: What words mean.
    """

    def __init__(self, found: PromptPairs, scene: SceneWords, vocabulary: Vocabulary) -> None:
        self._found, self._scene, self._vocabulary = found, scene, vocabulary
        self._own = OwnNouns(found.passage, found.mentions, vocabulary)
        self._subject = self._called()

    def noun_of(self, pair: TargetPair) -> str:
        """The absent object that a look word describes; "" where it describes none.

        Args:
            pair: The look word with its target.
        """
        token = pair.look.token
        slot = "color" if token.color else self._vocabulary.slot(token.entry) or pair.becoming.slot
        own = self._own.of(pair.look.index) if slot in SURFACE else None
        absent = own is not None and own.text != self._subject and self._is_absent(own)
        return own.text if own and absent else ""

    def _is_absent(self, noun: NounMention) -> bool:
        """Whether a noun names an object, and none in the scene."""
        if noun.named:
            return False
        if noun.noun == "surroundings":
            words = self._vocabulary.words
            shaped = any(noun.text in words[kind] for kind in STRUCTURES)
            return shaped and bool(self._scene.looks) and len(materials_of("surroundings", self._scene)) != 1
        return noun.noun == "unknown"

    def _called(self) -> str:
        """What the prompt calls a subject whose names the scene does not tell: the only object that it describes; "" for none."""
        nouns = [noun for look in self._found.passage.looks if (noun := self._own.of(look.index))]
        called = {noun.text for noun in nouns if self._is_absent(noun) and noun.noun == "unknown"}
        named = any(map(self._names_subject, self._found.mentions))
        return called.pop() if len(called) == 1 and not named and self._is_of_one_material() else ""

    def _is_of_one_material(self) -> bool:
        """Whether the subject is of one material, or nearly so; where only names are known it may be."""
        looks = {name: look for name, look in self._scene.looks.items() if not look.structures}
        mine = [n for n in materials_of("subject", self._scene) if not is_detail(n)]
        shares = [looks[name].share for name in mine if name in looks]
        return not shares or len(mine) < 2 or max(shares) > _MAIN * sum(shares)

    def _names_subject(self, mention: NounMention) -> bool:
        named = (name for n in mention.named if n.kind == "things" for name in n.names)
        return mention.noun == "subject" or any(self._scene.materials.get(n) == "subject" for n in named)
