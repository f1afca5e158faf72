# SPDX-License-Identifier: Apache-2.0
"""Comparison of what an attribute reaches with what a label says; each label in every way that comes to the same in its scene."""

from __future__ import annotations

import re
from collections.abc import Mapping

from lab.bench.binding.reading import Reach
from lab.train.sentences.labels import LabeledSentence, LabelTarget, LookWord
from proxy_renderer.words.lexicon.vocabulary import Vocabulary
from proxy_renderer.words.names import is_detail, plain_name

MATTER = ("materials", "subject", "surroundings", "others")
"""Kinds of targets that are materials."""
_WHOLE = ("mood", "grade", "setting")  # slots of words that set many things at once
_ROLES = ("key", "fill", "rim")


class SentenceTargets:
    """Meanings of a sentence's labels in its scene.

    Args:
        roles: Role -> the scene's lights that have it.
    """

    def __init__(self, sentence: LabeledSentence, roles: Mapping[str, frozenset[str]], vocabulary: Vocabulary) -> None:
        self.sentence, self.scene, self.vocabulary = sentence, sentence.scene, vocabulary
        self.roles, self.glows = roles, frozenset(sentence.scene.glows)

    def is_right(self, word: LookWord, reach: Reach) -> bool:
        """True if one of a word's targets is what an attribute reaches."""
        return any(self._hits(word, target, reach) for target in word.targets)

    def materials(self, word: LookWord, target: LabelTarget) -> frozenset[str]:
        """The materials that a target of a word stands for; of "others", those that no word may mean otherwise."""
        if target.kind == "others":
            left = frozenset(self.scene.materials) - self._named(self.sentence.words) - self._mentioned()
            return frozenset(name for name in left if not is_detail(name)) or left
        return target.names if target.kind == "materials" else self.scene.materials_of(target.kind)

    def _hits(self, word: LookWord, target: LabelTarget, reach: Reach) -> bool:
        attribute, kind = reach.attribute, target.kind
        if kind in MATTER:
            return self._hits_matter(word, target, reach)
        if kind == "lights":
            by_role = attribute.role in _ROLES or attribute.kind in _ROLES
            return target.names in (reach.lights, painted(reach), self._lamps(reach) if by_role else None)
        if kind in _ROLES:
            return attribute.kind == kind or self._lamps(reach) == self.roles.get(kind)
        if kind == "light":
            return self._is_any_light(reach)
        if kind == "sky":
            return self._is_sky(reach)
        if kind == "air":
            return attribute.kind == "fog" or attribute.slot == "atmosphere" or "volume" in reach.parts
        return kind == "picture" and _is_picture(reach)

    def _hits_matter(self, word: LookWord, target: LabelTarget, reach: Reach) -> bool:
        """True if an attribute paints what is meant; a region as a whole is all of its materials, or its backdrop."""
        attribute, found, wanted = reach.attribute, painted(reach), self.materials(word, target)
        if target.kind == "others":
            return self._is_rest(word, found, wanted)
        region = not attribute.owners and not is_light_word(reach) and attribute.kind
        if region in ("subject", "surroundings") and wanted == self.scene.materials_of(region):
            return True
        behind = attribute.kind in ("surroundings", "sky") and "world" in reach.parts and not reach.materials
        return (bool(wanted) and found == wanted) or (behind and target.kind == "surroundings")

    def _is_rest(self, word: LookWord, found: frozenset[str], least: frozenset[str]) -> bool:
        """True if materials are all but those named before; what the sentence spares without a label is left out too."""
        before = self._named([w for w in self.sentence.words if w.start < word.start])
        most = frozenset(self.scene.materials) - before
        spares = bool(before or not self._mentioned() or found != most)
        return bool(least) and least <= found <= most and spares

    def _named(self, words: list[LookWord] | tuple[LookWord, ...]) -> frozenset[str]:
        """Materials that the labels of words stand for."""
        targets = [word.targets[0] for word in words]
        named = (
            t.names if t.kind == "materials" else self.scene.materials_of(t.kind)
            for t in targets
            if t.kind in MATTER[:3]
        )
        return frozenset().union(*named)

    def _mentioned(self) -> frozenset[str]:
        """Materials that a word of the sentence may name, by their own names or their objects'."""
        said = {_singular(word) for word in re.findall(r"\w+", self.sentence.text.lower())}
        things = [*((name, (name,)) for name in self.scene.materials), *self.scene.objects.items()]
        spoken = (worn for name, worn in things if said & {_singular(w) for w in plain_name(name).split()})
        return frozenset(name for worn in spoken for name in worn)

    def _lamps(self, reach: Reach) -> frozenset[str]:
        """The lights that it reaches, but for glows: which of them count as fill lights is a matter of their brightness."""
        return reach.lights - self.glows

    def _is_any_light(self, reach: Reach) -> bool:
        """True if it is about light as a whole: all of it, the key, or what shadows say of it."""
        key = self.roles.get("key", frozenset())
        general = reach.lights == key or not key or (not reach.particular and bool(key & reach.lights))
        return self._speaks_of(reach, "shadow") or (is_light_word(reach) and general)

    def _is_sky(self, reach: Reach) -> bool:
        """True if it is about the world as it is seen; "grey sky" is, though it changes all light."""
        attribute = reach.attribute
        if attribute.kind == "sky" and attribute.slot in ("color", "setting"):
            return True
        if self._speaks_of(reach, "sky"):
            return "world" in reach.touched or not reach.touched
        return reach.parts == {"world"} and not (reach.materials | reach.lights)

    def _speaks_of(self, reach: Reach, kind: str) -> bool:
        """True if an attribute's own words name a kind of thing: "heavy grey sky", "blue shadows"."""
        words = reach.attribute.word.split()
        return reach.attribute.kind == kind or any(self.vocabulary.nouns.get(word) == kind for word in words)


def is_light_word(reach: Reach) -> bool:
    """True if it says something of light."""
    return reach.attribute.kind in ("light", "fill", "rim") or reach.attribute.slot == "lighting"


def painted(reach: Reach) -> frozenset[str]:
    """Its materials; a glow is one whether it is called a light or a thing."""
    return reach.materials or reach.lights


def _is_picture(reach: Reach) -> bool:
    """True if it is about all of the picture: a mood, a grade, a setting, or several kinds of things at once."""
    attribute = reach.attribute
    if attribute.owners or attribute.lights:
        return False
    if attribute.slot in _WHOLE or attribute.kind in ("whole", "tone", "ambience"):
        return True
    general = attribute.slot in ("lighting", "atmosphere") and not attribute.role
    return general and len(reach.touched) > 1


def _singular(word: str) -> str:
    return word.removesuffix("s")
