# SPDX-License-Identifier: Apache-2.0
"""Objects that a prompt describes and that the scene lacks: "teal water" without water paints nothing else."""

from __future__ import annotations

from ..lexicon.things import thing_words
from ..lexicon.vocabulary import Vocabulary
from ..mentions.changes import STRUCTURES
from ..mentions.names import parts
from ..mentions.nouns import NounMention, materials_of
from ..names import is_detail, name_words
from ..types import SceneDescription
from .becoming import SURFACE
from .own_nouns import NO_MATTER, OwnNouns
from .pairs import PromptPairs, TargetPair
from .targets import MATTER

_MAIN = 0.6  # share of the subject from which one material is what a name for the subject means


class AbsentObjects:
    """Nouns of a prompt that name an object which its scene lacks.

    The first of them is what the artist calls the subject, where the subject is of one material and no noun names it.

    Args:
        scene: Its names, and how its materials look.
    """

    def __init__(self, found: PromptPairs, scene: SceneDescription, vocabulary: Vocabulary) -> None:
        self._found, self._scene, self._vocabulary = found, scene, vocabulary
        self._own = OwnNouns(found.passage, found.mentions, vocabulary)
        self._subject = self._called()

    def noun_of(self, pair: TargetPair) -> str:
        """The absent object that a look word describes; "" where it describes none.

        Args:
            pair: The look word with its target.
        """
        own = self._own_of(pair)
        return own.text if own and own.text != self._subject and self._is_absent(own) else ""

    def is_astray(self, pair: TargetPair) -> bool:
        """Whether a word that is said of light, the sky or the like would paint an object: "a yellow beam on the rug".

        Args:
            pair: The look word with its target.
        """
        if pair.target.kind not in MATTER or pair.becoming.slot == "material":
            return False
        own = self._own_of(pair)
        named = pair.names_itself or pair.look.negated
        if pair.look.token.color and not named and self._own.is_noun(pair.look.index):
            return True
        return own is not None and own.noun in NO_MATTER and not own.named and own.start > pair.look.index

    def _own_of(self, pair: TargetPair) -> NounMention | None:
        """The noun that a word about surfaces is said of."""
        token = pair.look.token
        slot = "color" if token.color else self._vocabulary.slot(token.entry) or pair.becoming.slot
        return self._own.of(pair.look.index) if slot in SURFACE else None

    def _is_absent(self, noun: NounMention) -> bool:
        """Whether a noun names an object, and none in the scene."""
        if noun.named or not self._scene.materials:
            return False
        if noun.noun == "surroundings":
            words = self._vocabulary.words
            shaped = any(noun.text in words[kind] for kind in STRUCTURES)
            return shaped and bool(self._scene.looks) and len(materials_of("surroundings", self._scene)) != 1
        if noun.noun == "subject":
            whole = noun.text in self._vocabulary.words["whole"]
            return not whole and bool(self._scene.looks) and not self._is_of_one_material()
        return noun.noun == "unknown"

    def _called(self) -> str:
        """What the prompt calls a subject whose names the scene does not tell: the only object that it describes; "" for none."""
        mentions = self._found.mentions
        nouns = [noun for look in self._found.passage.looks if (noun := self._own.of(look.index))]
        absent = [noun for noun in nouns if self._is_absent(noun) and noun.noun == "unknown"]
        listed = any(m.members > 1 and m.covers(noun.start) for m in mentions for noun in absent)
        called = {noun.text for noun in absent} - self._vocabulary.words["scenery"]
        told = (
            listed
            or any(map(self._names_subject, mentions))
            or self._is_told()
            or not self._is_of_one_material()
        )
        return "" if told or len(called) != 1 else called.pop()

    def _is_told(self) -> bool:
        """Whether the subject's objects are called what they are, so that nobody calls it otherwise."""
        scene = self._scene
        things = (
            thing_words().rows.keys() - name_words("primitives") - name_words("limbs") - name_words("details")
        )
        names = (*scene.objects.items(), *scene.materials.items())
        mine = (name for name, region in names if region == "subject")
        told = any(word in things for name in mine for word in parts(name))
        return told and bool(scene.looks) and len(scene.materials) > 1

    def _is_of_one_material(self) -> bool:
        """Whether the subject is of one material, or nearly so; where only names are known it may be."""
        mine = [n for n in materials_of("subject", self._scene) if not is_detail(n)]
        looks = [look for name in mine if (look := self._scene.looks.get(name))]
        if not looks or len(mine) < 2:
            return True
        main = max(looks, key=lambda look: look.share)
        return not main.structures and main.share > _MAIN * sum(look.share for look in looks)

    def _names_subject(self, mention: NounMention) -> bool:
        named = (name for n in mention.named if n.kind == "things" for name in n.names)
        return mention.noun == "subject" or any(self._scene.materials.get(n) == "subject" for n in named)
